#include <collided/voxels.hpp>

#include "client/library/c/publisher.hpp"
#include "idl/clocks.hpp"

using namespace collided;
using namespace collided::c;

struct collided_voxels {
  Publisher* publisher;
  PublishedVoxels voxels;
};

namespace {

std::chrono::nanoseconds time_of(std::int64_t time_ns) {
  return std::chrono::nanoseconds(time_ns == 0 ? wire_contract::since_1970_ns() : time_ns);
}

collided_voxel_options default_voxel_options() {
  const VoxelOptions defaults;
  collided_voxel_options options{};
  options.cell_m = defaults.cell_m;
  options.reach_m = defaults.reach_m;
  options.layers = 1;
  options.lost_policy = static_cast<std::int32_t>(LostPolicy::freeze);
  options.most_blocks = defaults.most_blocks;
  return options;
}

void give_scan(const VoxelScan& from, collided_voxel_scan* to) {
  give({.size = 0,
        .reserved = 0,
        .points = from.points,
        .refused = from.refused,
        .far_off = from.far,
        .dropped = from.dropped,
        .occupied = from.occupied,
        .crossed = from.crossed,
        .changed = from.changed},
       to);
}

template <class Number>
int insert(collided_voxels* voxels, std::size_t count, const Number* points, const double* origin, std::int64_t time_ns,
           collided_voxel_scan* scan, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!voxels) return missing("voxels");
    if (count > 0 && !points) return missing("points");
    const auto from = origin ? std::optional<Vec3>(vector(origin)) : std::nullopt;
    const Result<VoxelScan> taken =
        voxels->voxels.insert(*voxels->publisher, std::span<const Number>(points, 3 * count), from, time_of(time_ns));
    if (!taken) return taken.error();
    give_scan(*taken, scan);
    return {};
  });
}

}  // namespace

extern "C" {

void collided_voxel_defaults(collided_voxel_options* options, uint32_t size) {
  if (!options) return;
  options->size = size;
  give(default_voxel_options(), options);
}

int collided_voxels_start(collided_publisher* publisher, const char* name, const collided_voxel_options* options,
                          collided_voxels** voxels, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!publisher) return missing("publisher");
    if (!voxels) return missing("voxels");
    *voxels = nullptr;
    const collided_voxel_options asked = taken(options, default_voxel_options());
    if (asked.unknown < 0 || asked.unknown > 2 || asked.lost_policy < 0 || asked.lost_policy > 2)
      return Error{ErrorCode::bad_input, "voxels: unknown and lost policy are 0 to 2", "nothing was sent"};
    Result<PublishedVoxels> made = PublishedVoxels::start(publisher->publisher, text(name),
                                                          {.cell_m = asked.cell_m,
                                                           .unknown = static_cast<UnknownCells>(asked.unknown),
                                                           .decay = std::chrono::nanoseconds(asked.decay_ns),
                                                           .reach_m = asked.reach_m,
                                                           .most_blocks = asked.most_blocks},
                                                          asked.layers, static_cast<LostPolicy>(asked.lost_policy));
    if (!made) return made.error();
    *voxels = new collided_voxels{&publisher->publisher, std::move(*made)};
    return {};
  });
}

void collided_voxels_close(collided_voxels* voxels) { delete voxels; }

int collided_voxels_insert(collided_voxels* voxels, size_t count, const double* points, const double* origin,
                           int64_t time_ns, collided_voxel_scan* scan, collided_error* error) {
  return insert(voxels, count, points, origin, time_ns, scan, error);
}

int collided_voxels_insert_floats(collided_voxels* voxels, size_t count, const float* points, const double* origin,
                                  int64_t time_ns, collided_voxel_scan* scan, collided_error* error) {
  return insert(voxels, count, points, origin, time_ns, scan, error);
}

int collided_voxels_decay(collided_voxels* voxels, int64_t time_ns, size_t* changed, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!voxels) return missing("voxels");
    const Result<std::size_t> done = voxels->voxels.decay(*voxels->publisher, time_of(time_ns));
    if (!done) return done.error();
    if (changed) *changed = *done;
    return {};
  });
}

int collided_voxels_clear(collided_voxels* voxels, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!voxels) return missing("voxels");
    return voxels->voxels.clear(*voxels->publisher);
  });
}

}  // extern "C"
