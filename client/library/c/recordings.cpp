#include <collided/recording.hpp>

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "client/library/c/lent_events.hpp"
#include "client/library/c/values.hpp"

using namespace collided;
using namespace collided::c;

struct collided_recorded_fences {
  RecordedFenceEvents told;
};

namespace {

/// since  COLLIDED_SINCE_...
Result<std::optional<RunTime>> time_of(std::int32_t since, std::int64_t offset_ns, const char* what) {
  if (since == COLLIDED_SINCE_NONE) return std::optional<RunTime>();
  if (since < COLLIDED_SINCE_1970 || since > COLLIDED_SINCE_END)
    return Error{ErrorCode::bad_input, std::string(what) + " is " + std::to_string(since) + "; allowed 0 to 3", ""};
  return std::optional(RunTime{.since = static_cast<RunTime::Since>(since - COLLIDED_SINCE_1970),
                               .offset = std::chrono::nanoseconds(offset_ns)});
}

Result<RecordedEventsOptions> options_of(const collided_recorded_options* options) {
  const collided_recorded_options given = taken(options);
  const auto from = time_of(given.from_since, given.from_ns, "from_since");
  const auto to = time_of(given.to_since, given.to_ns, "to_since");
  if (!from) return from.error();
  if (!to) return to.error();
  return RecordedEventsOptions{.only = text(given.only), .skip = text(given.skip), .from = *from, .to = *to};
}

/// events  those of one kind in `told`
template <class OneEvent, class Told>
int read_event(const collided_recorded_fences* recorded, std::vector<OneEvent> RecordedFenceEvents::*events,
               std::size_t number, Told* event) {
  if (!recorded || number >= (recorded->told.*events).size()) return COLLIDED_NOTHING;
  give(lent((recorded->told.*events)[number]), event);
  return COLLIDED_OK;
}

}  // namespace

extern "C" {

int collided_read_recorded_fences(const char* path, const collided_recorded_options* options,
                                  collided_recorded_fences** recorded, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!path) return missing("path");
    if (!recorded) return missing("recorded");
    *recorded = nullptr;
    const Result<RecordedEventsOptions> asked = options_of(options);
    if (!asked) return asked.error();
    Result<RecordedFenceEvents> told = recorded_fence_events(path, *asked);
    if (!told) return told.error();
    *recorded = new collided_recorded_fences{std::move(*told)};
    return {};
  });
}

void collided_free_recorded_fences(collided_recorded_fences* recorded) { delete recorded; }

void collided_about_recorded_fences(const collided_recorded_fences* recorded, collided_recorded_about* about) {
  if (!recorded) return;
  const RecordedFenceEvents& told = recorded->told;
  give({.size = 0,
        .reserved = 0,
        .fences = told.fences.size(),
        .margins = told.margins.size(),
        .nearest = told.nearest.size(),
        .warnings = told.warnings.size(),
        .lost = told.lost,
        .begin_ns = told.begin.count(),
        .end_ns = told.end.count()},
       about);
}

int collided_recorded_fence_event(const collided_recorded_fences* recorded, size_t number,
                                  collided_fence_event* event) {
  return read_event(recorded, &RecordedFenceEvents::fences, number, event);
}
int collided_recorded_margin_event(const collided_recorded_fences* recorded, size_t number,
                                   collided_margin_event* event) {
  return read_event(recorded, &RecordedFenceEvents::margins, number, event);
}
int collided_recorded_nearest_event(const collided_recorded_fences* recorded, size_t number,
                                    collided_nearest_event* event) {
  return read_event(recorded, &RecordedFenceEvents::nearest, number, event);
}
const char* collided_recorded_warning(const collided_recorded_fences* recorded, size_t number) {
  return recorded && number < recorded->told.warnings.size() ? recorded->told.warnings[number].c_str() : nullptr;
}

}  // extern "C"
