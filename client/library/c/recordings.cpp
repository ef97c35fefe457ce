#include <collided/recording.hpp>

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "client/library/c/lent_events.hpp"
#include "client/library/c/values.hpp"

using namespace collided;
using namespace collided::c;

struct collided_recorded_standing {
  RecordedStandingEvents read;
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

}  // namespace

extern "C" {

int collided_read_recorded_standing(const char* path, const collided_recorded_options* options,
                                    collided_recorded_standing** recorded, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!path) return missing("path");
    if (!recorded) return missing("recorded");
    *recorded = nullptr;
    const Result<RecordedEventsOptions> asked = options_of(options);
    if (!asked) return asked.error();
    Result<RecordedStandingEvents> read = recorded_standing_events(path, *asked);
    if (!read) return read.error();
    *recorded = new collided_recorded_standing{std::move(*read)};
    return {};
  });
}

void collided_free_recorded_standing(collided_recorded_standing* recorded) { delete recorded; }

void collided_about_recorded_standing(const collided_recorded_standing* recorded, collided_recorded_about* about) {
  if (!recorded) return;
  const RecordedStandingEvents& read = recorded->read;
  give({.size = 0,
        .reserved = 0,
        .events = read.events.size(),
        .warnings = read.warnings.size(),
        .lost = read.lost,
        .begin_ns = read.begin.count(),
        .end_ns = read.end.count()},
       about);
}

int collided_recorded_standing_event(const collided_recorded_standing* recorded, size_t number,
                                     collided_standing_event* event) {
  if (!recorded || number >= recorded->read.events.size()) return COLLIDED_NOTHING;
  give(lent(recorded->read.events[number]), event);
  return COLLIDED_OK;
}
const char* collided_recorded_warning(const collided_recorded_standing* recorded, size_t number) {
  return recorded && number < recorded->read.warnings.size() ? recorded->read.warnings[number].c_str() : nullptr;
}

}  // extern "C"
