#include <optional>
#include <span>
#include <utility>

#include "client/library/c/options.hpp"
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

template <class Number>
Result<VoxelScan> insert(collided_voxels& into, std::size_t count, const Number* points, const double* origin,
                         std::int64_t time_ns) {
  const auto from = origin ? std::optional<Vec3>(vector(origin)) : std::nullopt;
  return into.voxels.insert(*into.publisher, std::span<const Number>(points, 3 * count), from, time_of(time_ns));
}

}  // namespace

extern "C" {

int collided_voxels_start(collided_publisher* publisher, const char* name, const char* options,
                          collided_voxels** voxels, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!publisher) return missing("publisher");
    if (!voxels) return missing("voxels");
    *voxels = nullptr;
    const Result<VoxelsShown> asked = options_of<VoxelsShown>(options, "voxels");
    if (!asked) return asked.error();
    Result<PublishedVoxels> made =
        PublishedVoxels::start(publisher->publisher, text(name), *asked, asked->layers, asked->lost);
    if (!made) return made.error();
    *voxels = new collided_voxels{&publisher->publisher, std::move(*made)};
    return {};
  });
}

void collided_voxels_close(collided_voxels* voxels) { delete voxels; }

int collided_voxels_insert(collided_voxels* voxels, size_t count, const double* points, const float* floats,
                           const double* origin, int64_t time_ns, char** scan, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!voxels) return missing("voxels");
    if (scan) *scan = nullptr;
    if (count > 0 && !points && !floats) return missing("points");
    const Result<VoxelScan> taken =
        points ? insert(*voxels, count, points, origin, time_ns) : insert(*voxels, count, floats, origin, time_ns);
    if (!taken) return taken.error();
    return hand_out_json(*taken, scan);
  });
}

int collided_voxels_clear(collided_voxels* voxels, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!voxels) return missing("voxels");
    return voxels->voxels.clear(*voxels->publisher);
  });
}

}  // extern "C"
