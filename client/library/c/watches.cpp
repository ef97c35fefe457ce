#include <optional>

#include "client/library/c/lent_events.hpp"
#include "client/library/c/values.hpp"

using namespace collided;
using namespace collided::c;

struct collided_watch {
  Watch watch;
  std::optional<Event> newest = {};  // its texts are lent to the caller until the next call
};
struct collided_fence_watch {
  FenceWatch watch;
  std::optional<FenceEvent> newest = {};
};
struct collided_margin_watch {
  MarginWatch watch;
  std::optional<MarginEvent> newest = {};
};
struct collided_nearest_watch {
  NearestWatch watch;
  std::optional<NearestEvent> newest = {};
};

namespace {

Result<Fence> fence_of(const collided_fence& given) {
  Fence fence{.name = text(given.name),
              .to = text(given.to),
              .only = text(given.only),
              .skip = text(given.skip),
              .mask = ~given.left_out_layers,
              .keep = given.keep != 0};
  if (given.tells != 0) {
    fence.enter = (given.tells & codes::kTellsEnter) != 0;
    fence.exit = (given.tells & codes::kTellsExit) != 0;
    fence.cross = (given.tells & codes::kTellsCross) != 0;
  }
  Result<Shape> shape = shape_of(given.parts, given.part_count);
  if (!shape) return shape.error();
  fence.shape = std::move(*shape);
  return fence;
}

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

/// The next event of a watch of any kind. Its texts are lent until the next call.
template <class EventWatch, class Told>
int next_event(EventWatch* watch, std::int64_t wait_ns, Told* event, collided_error* error) {
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

/// Removes fences, margins or questions by a glob.
int remove_by_glob(collided_client* client, const char* name, std::uint64_t* removed, collided_error* error,
                   Result<std::size_t> (Client::*remove)(const std::string&)) {
  return guarded(error, [&]() -> Result<void> {
    if (!client) return missing("client");
    const Result<std::size_t> count = (client->client.*remove)(text(name));
    if (!count) return count.error();
    if (removed) *removed = *count;
    return {};
  });
}

/// Starts a watch of any kind.
template <class FollowedWatch, class Start>
int start_watch(collided_client* client, FollowedWatch** watch, collided_error* error, const Start& start) {
  return guarded(error, [&]() -> Result<void> {
    if (!client) return missing("client");
    if (!watch) return missing("watch");
    *watch = nullptr;
    auto started = start(client->client);
    if (!started) return started.error();
    *watch = new FollowedWatch{std::move(*started)};
    return {};
  });
}

}  // namespace

extern "C" {

int collided_watch_start(collided_client* client, const collided_watch_options* options,
                         collided_event_callback callback, void* user, collided_watch** watch, collided_error* error) {
  return start_watch(client, watch, error, [&](Client& from) {
    std::function<void(const Event&)> call;
    if (callback) {
      call = [callback, user](const Event& event) {
        const collided_event told = lent(event);
        callback(&told, user);
      };
    }
    return from.watch(watch_options(options), std::move(call));
  });
}

int collided_watch_next(collided_watch* watch, int64_t wait_ns, collided_event* event, collided_error* error) {
  return next_event(watch, wait_ns, event, error);
}

uint64_t collided_watch_lost(const collided_watch* watch) { return watch ? watch->watch.lost() : 0; }
int32_t collided_watch_in_step(const collided_watch* watch) { return watch && watch->watch.in_step() ? 1 : 0; }
void collided_watch_close(collided_watch* watch) { delete watch; }

int collided_fence_add(collided_client* client, const collided_fence* fence, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!client) return missing("client");
    if (!fence) return missing("fence");
    const Result<Fence> made = fence_of(taken(fence));
    if (!made) return made.error();
    return client->client.add_fence(*made);
  });
}

int collided_fence_remove(collided_client* client, const char* name, uint64_t* removed, collided_error* error) {
  return remove_by_glob(client, name, removed, error, &Client::remove_fences);
}

int collided_margin_add(collided_client* client, const collided_margin* margin, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!client) return missing("client");
    if (!margin) return missing("margin");
    const collided_margin given = taken(margin);
    if (given.band_count > 0 && !given.bands_m) return missing("bands_m");
    const Result<AddedMargin> added =
        client->client.add_margin({.name = text(given.name),
                                   .around = text(given.around),
                                   .only = text(given.only),
                                   .skip = text(given.skip),
                                   .mask = ~given.left_out_layers,
                                   .bands_m = {given.bands_m, given.bands_m + given.band_count},
                                   .hysteresis_m = given.hysteresis_m,
                                   .dwell = std::chrono::nanoseconds(given.dwell_ns),
                                   .keep = given.keep != 0});
    if (!added) return added.error();
    return {};
  });
}

int collided_margin_remove(collided_client* client, const char* name, uint64_t* removed, collided_error* error) {
  return remove_by_glob(client, name, removed, error, &Client::remove_margins);
}

int collided_nearest_add(collided_client* client, const collided_nearest* nearest, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!client) return missing("client");
    if (!nearest) return missing("nearest");
    const collided_nearest given = taken(nearest);
    NearestQuestion asked{.name = text(given.name),
                          .only = text(given.only),
                          .to = text(given.to),
                          .within_m = given.within_m,
                          .hysteresis_m = given.hysteresis_m,
                          .skip = text(given.skip),
                          .mask = ~given.left_out_layers,
                          .keep = given.keep != 0};
    if (asked.to.empty()) asked.point = Vec3(given.point[0], given.point[1], given.point[2]);
    return client->client.add_nearest(asked);
  });
}

int collided_nearest_remove(collided_client* client, const char* name, uint64_t* removed, collided_error* error) {
  return remove_by_glob(client, name, removed, error, &Client::remove_nearest);
}

int collided_fence_watch_start(collided_client* client, const char* only, const char* skip,
                               collided_fence_watch** watch, collided_error* error) {
  return start_watch(client, watch, error,
                     [&](Client& from) { return from.watch_fences({.only = text(only), .skip = text(skip)}); });
}

int collided_fence_watch_next(collided_fence_watch* watch, int64_t wait_ns, collided_fence_event* event,
                              collided_error* error) {
  return next_event(watch, wait_ns, event, error);
}
uint64_t collided_fence_watch_lost(const collided_fence_watch* watch) { return watch ? watch->watch.lost() : 0; }
int32_t collided_fence_watch_in_step(const collided_fence_watch* watch) {
  return watch && watch->watch.in_step() ? 1 : 0;
}
void collided_fence_watch_close(collided_fence_watch* watch) { delete watch; }

int collided_margin_watch_start(collided_client* client, const char* only, const char* skip,
                                collided_margin_watch** watch, collided_error* error) {
  return start_watch(client, watch, error,
                     [&](Client& from) { return from.watch_margins({.only = text(only), .skip = text(skip)}); });
}

int collided_margin_watch_next(collided_margin_watch* watch, int64_t wait_ns, collided_margin_event* event,
                               collided_error* error) {
  return next_event(watch, wait_ns, event, error);
}
uint64_t collided_margin_watch_lost(const collided_margin_watch* watch) { return watch ? watch->watch.lost() : 0; }
int32_t collided_margin_watch_in_step(const collided_margin_watch* watch) {
  return watch && watch->watch.in_step() ? 1 : 0;
}
void collided_margin_watch_close(collided_margin_watch* watch) { delete watch; }

int collided_nearest_watch_start(collided_client* client, const char* only, const char* skip,
                                 collided_nearest_watch** watch, collided_error* error) {
  return start_watch(client, watch, error,
                     [&](Client& from) { return from.watch_nearest({.only = text(only), .skip = text(skip)}); });
}

int collided_nearest_watch_next(collided_nearest_watch* watch, int64_t wait_ns, collided_nearest_event* event,
                                collided_error* error) {
  return next_event(watch, wait_ns, event, error);
}
uint64_t collided_nearest_watch_lost(const collided_nearest_watch* watch) { return watch ? watch->watch.lost() : 0; }
int32_t collided_nearest_watch_in_step(const collided_nearest_watch* watch) {
  return watch && watch->watch.in_step() ? 1 : 0;
}
void collided_nearest_watch_close(collided_nearest_watch* watch) { delete watch; }

}  // extern "C"
