#include <optional>

#include "client/library/c/values.hpp"

using namespace collided;
using namespace collided::c;

struct collided_watch {
  explicit collided_watch(Watch started) : watch(std::move(started)) {}
  Watch watch;
  std::optional<Event> newest;  // its texts are lent to the caller until the next call
};

namespace {

WatchOptions watch_options(const collided_watch_options* options) {
  const collided_watch_options given = taken(options);
  WatchOptions made;
  made.only = text(given.only);
  made.skip = text(given.skip);
  made.persisted = given.persisted != 0;
  if (given.capacity > 0) made.capacity = given.capacity;
  if (given.since_ns != 0) made.since = std::chrono::nanoseconds(given.since_ns);
  return made;
}

collided_event lent(const Event& event) {
  collided_event told{};
  told.size = sizeof told;
  told.kind = static_cast<std::int32_t>(event.kind);
  told.reason = static_cast<std::int32_t>(event.reason);
  told.doubt = static_cast<std::int32_t>(event.doubt);
  told.resync = event.resync ? 1 : 0;
  told.a_triangle = event.a_triangle;
  told.b_triangle = event.b_triangle;
  told.a = event.a.c_str();
  told.b = event.b.c_str();
  told.a_id = event.a_id;
  told.b_id = event.b_id;
  told.epoch = event.epoch;
  told.sequence = event.sequence;
  told.episode = event.episode;
  told.world_time_ns = event.world_time.count();
  told.began_ns = event.began.count();
  told.bracket_low_s = event.bracket_low_s;
  told.bracket_high_s = event.bracket_high_s;
  put(event.point, told.point);
  put(event.normal, told.normal);
  told.depth_m = event.depth_m;
  told.depth_error_m = event.depth_error_m;
  put(event.relative_velocity, told.relative_velocity);
  told.velocity_error = event.velocity_error;
  told.contained = static_cast<std::int32_t>(event.contained);
  put(event.surface_normal, told.surface_normal);
  told.surface_depth_m = event.surface_depth_m;
  told.surface_depth_error_m = event.surface_depth_error_m;
  told.poses_merged = event.poses_merged ? 1 : 0;
  return told;
}

}  // namespace

extern "C" {

int collided_watch_start(collided_client* client, const collided_watch_options* options,
                         collided_event_callback callback, void* user, collided_watch** watch, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!client) return missing("client");
    if (!watch) return missing("watch");
    *watch = nullptr;
    std::function<void(const Event&)> call;
    if (callback) {
      call = [callback, user](const Event& event) {
        const collided_event told = lent(event);
        callback(&told, user);
      };
    }
    Result<Watch> started = client->client.watch(watch_options(options), std::move(call));
    if (!started) return started.error();
    *watch = new collided_watch(std::move(*started));
    return {};
  });
}

int collided_watch_next(collided_watch* watch, int64_t wait_ns, collided_event* event, collided_error* error) {
  bool nothing = false;
  const int code = guarded(error, [&]() -> Result<void> {
    if (!watch) return missing("watch");
    watch->newest = watch->watch.next(std::chrono::nanoseconds(wait_ns));
    nothing = !watch->newest;
    if (!nothing) give(lent(*watch->newest), event);
    return {};
  });
  return code == COLLIDED_OK && nothing ? static_cast<int>(COLLIDED_NOTHING) : code;
}

uint64_t collided_watch_lost(const collided_watch* watch) { return watch ? watch->watch.lost() : 0; }
int32_t collided_watch_in_step(const collided_watch* watch) { return watch && watch->watch.in_step() ? 1 : 0; }
void collided_watch_close(collided_watch* watch) { delete watch; }

}  // extern "C"
