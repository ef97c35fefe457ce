#include <optional>

#include "client/library/c/lent_events.hpp"
#include "client/library/c/values.hpp"

using namespace collided;
using namespace collided::c;

struct collided_watch {
  Watch watch;
  std::optional<Event> newest = {};  // its texts are lent to the caller until the next call
};
struct collided_standing_watch {
  StandingWatch watch;
  std::optional<StandingEvent> newest = {};
};

namespace {

Result<Region> region_of(const collided_standing& given) {
  Region region{.to = text(given.to)};
  if (given.detect != 0) {
    region.enter = (given.detect & codes::kDetectEnter) != 0;
    region.exit = (given.detect & codes::kDetectExit) != 0;
    region.cross = (given.detect & codes::kDetectCross) != 0;
  }
  Result<Shape> shape = shape_of(given.parts, given.part_count);
  if (!shape) return shape.error();
  region.shape = std::move(*shape);
  return region;
}

Result<Bands> bands_of(const collided_standing& given) {
  if (given.band_count > 0 && !given.bands_m) return missing("bands_m");
  return Bands{.around = text(given.around),
               .bands_m = {given.bands_m, given.bands_m + given.band_count},
               .hysteresis_m = given.hysteresis_m,
               .dwell = std::chrono::nanoseconds(given.dwell_ns)};
}

Nearest nearest_of(const collided_standing& given) {
  Nearest nearest{.to = text(given.to), .within_m = given.within_m, .hysteresis_m = given.hysteresis_m};
  if (nearest.to.empty()) nearest.point = vector(given.point);
  return nearest;
}

Error no_form(std::int32_t form) {
  return {ErrorCode::bad_input,
          "the form is " + std::to_string(form) + "; known are COLLIDED_FORM_REGION, _BANDS, _NEAREST",
          "nothing was sent"};
}

Result<Standing> standing_of(const collided_standing& given) {
  Standing standing{.name = text(given.name),
                    .only = text(given.only),
                    .skip = text(given.skip),
                    .mask = ~given.left_out_layers,
                    .keep = given.keep != 0};
  const auto take = [&](auto&& of) -> Result<Standing> {
    if (!of) return of.error();
    standing.of = std::move(*of);
    return standing;
  };
  switch (given.form) {
    case COLLIDED_FORM_REGION: return take(region_of(given));
    case COLLIDED_FORM_BANDS: return take(bands_of(given));
    case COLLIDED_FORM_NEAREST: return take(Result<Nearest>(nearest_of(given)));
    default: return no_form(given.form);
  }
}

/// One form, or nothing for COLLIDED_FORM_ANY.
Result<std::optional<StandingForm>> form_of(collided_standing_form form) {
  if (form == COLLIDED_FORM_ANY) return std::optional<StandingForm>();
  if (form < COLLIDED_FORM_REGION || form > COLLIDED_FORM_NEAREST) return no_form(form);
  return std::optional(static_cast<StandingForm>(form));
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
template <class EventWatch, class LentEvent>
int next_event(EventWatch* watch, std::int64_t wait_ns, LentEvent* event, collided_error* error) {
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
        const collided_event given = lent(event);
        callback(&given, user);
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

int collided_standing_add(collided_client* client, const collided_standing* standing, uint64_t* parts,
                          collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!client) return missing("client");
    if (!standing) return missing("standing");
    const Result<Standing> made = standing_of(taken(standing));
    if (!made) return made.error();
    const Result<AddedStanding> added = client->client.add(*made);
    if (!added) return added.error();
    if (parts) *parts = added->parts;
    return {};
  });
}

int collided_standing_remove(collided_client* client, const char* name, collided_standing_form form, uint64_t* removed,
                             collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!client) return missing("client");
    const Result<std::optional<StandingForm>> of_form = form_of(form);
    if (!of_form) return of_form.error();
    const Result<std::size_t> count = client->client.remove_standing(text(name), *of_form);
    if (!count) return count.error();
    if (removed) *removed = *count;
    return {};
  });
}

int collided_standing_watch_start(collided_client* client, const char* only, const char* skip,
                                  collided_standing_form form, collided_standing_watch** watch, collided_error* error) {
  return start_watch(client, watch, error, [&](Client& from) -> Result<StandingWatch> {
    const Result<std::optional<StandingForm>> of_form = form_of(form);
    if (!of_form) return of_form.error();
    return from.watch_standing({.only = text(only), .skip = text(skip), .form = *of_form});
  });
}

int collided_standing_watch_next(collided_standing_watch* watch, int64_t wait_ns, collided_standing_event* event,
                                 collided_error* error) {
  return next_event(watch, wait_ns, event, error);
}
uint64_t collided_standing_watch_lost(const collided_standing_watch* watch) { return watch ? watch->watch.lost() : 0; }
int32_t collided_standing_watch_in_step(const collided_standing_watch* watch) {
  return watch && watch->watch.in_step() ? 1 : 0;
}
void collided_standing_watch_close(collided_standing_watch* watch) { delete watch; }

}  // extern "C"
