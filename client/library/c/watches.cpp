#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "client/library/c/event_fields.hpp"
#include "client/library/c/options.hpp"
#include "client/library/watching/probes.hpp"

using namespace collided;
using namespace collided::c;

struct collided_watch {
  std::variant<Watch, StandingWatch, ProbeWatch> of;
  std::vector<Event> lent = {};  // events of collided_watch_read, whose texts are valid until the next call
};

namespace {

Result<WatchOptions> watch_options(const char* options) {
  Result<WatchOptions> made = options_of<WatchOptions>(options, "watch");
  if (made && made->capacity == 0)
    return Error{ErrorCode::bad_input, "watch: a capacity of 0 events; allowed from 1 on", "nothing was sent"};
  return made;
}

Result<StandingWatchOptions> standing_watch_options(const char* options) {
  const Result<StandingWatchWords> given = options_of<StandingWatchWords>(options, "watch");
  if (!given) return given.error();
  StandingWatchOptions made{.only = given->only, .skip = given->skip, .capacity = given->capacity};
  if (given->form.empty() && made.capacity > 0) return made;
  for (std::uint8_t code = 0; code < codes::kCodeCount<StandingForm>; ++code) {
    if (name_of(static_cast<StandingForm>(code)) == given->form) made.form = static_cast<StandingForm>(code);
  }
  if (made.form && made.capacity > 0) return made;
  return Error{ErrorCode::bad_input,
               "watch: the form is '" + given->form + "' and the capacity " + std::to_string(made.capacity) +
                   "; allowed are region, bands or nearest, and from 1 on",
               "nothing was sent"};
}

/// Starts a watch, unless its options are an error.
template <class Options, class Start>
Result<collided_watch> started(const Result<Options>& options, const Start& start) {
  if (!options) return options.error();
  auto watch = start(*options);
  if (!watch) return watch.error();
  return collided_watch{.of = std::move(*watch)};
}

Result<collided_watch> start_watch(Client& client, collided_followed followed, const char* options) {
  switch (followed) {
    case COLLIDED_WATCH_CONTACTS:
      return started(watch_options(options), [&](const auto& made) { return client.watch(made); });
    case COLLIDED_WATCH_STANDING:
      return started(standing_watch_options(options), [&](const auto& made) { return client.watch_standing(made); });
    case COLLIDED_WATCH_PROBES:
      return started(watch_options(options), [&](const auto& made) { return client.watch_probes(made); });
    default: return unknown_kind("watch", followed, 2);
  }
}

/// Takes the queued events, at most `capacity`; waits for the first.
void take_contacts(Watch& watch, std::chrono::nanoseconds wait, std::size_t capacity, std::vector<Event>& taken) {
  taken.clear();
  while (taken.size() < capacity) {
    std::optional<Event> event = watch.next(taken.empty() ? wait : std::chrono::nanoseconds(0));
    if (!event) return;
    taken.push_back(std::move(*event));
  }
}

/// Runs a call that may return COLLIDED_NOTHING.
template <class Take>
int guarded_take(collided_error* error, const Take& take) {
  bool found = false;
  const int code = guarded(error, [&]() -> Result<void> { return take(found); });
  return code == COLLIDED_OK && !found ? static_cast<int>(COLLIDED_NOTHING) : code;
}

}  // namespace

extern "C" {

int collided_watch_start(collided_client* client, collided_followed followed, const char* options,
                         collided_watch** watch, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!client) return missing("client");
    if (!watch) return missing("watch");
    *watch = nullptr;
    Result<collided_watch> made = start_watch(client->client, followed, options);
    if (!made) return made.error();
    *watch = new collided_watch(std::move(*made));
    return {};
  });
}

int collided_watch_next(collided_watch* watch, int64_t wait_ns, char** event, collided_error* error) {
  return guarded_take(error, [&](bool& found) -> Result<void> {
    if (!watch) return missing("watch");
    if (event) *event = nullptr;
    return std::visit(
        [&](auto& of) -> Result<void> {
          const auto news = of.next(std::chrono::nanoseconds(wait_ns));
          found = news.has_value();
          return found ? hand_out_json(*news, event) : Result<void>();
        },
        watch->of);
  });
}

int collided_watch_read(collided_watch* watch, int64_t wait_ns, collided_event* events, size_t capacity, size_t* count,
                        collided_error* error) {
  return guarded_take(error, [&](bool& found) -> Result<void> {
    if (!watch) return missing("watch");
    if (!events || !count || capacity == 0) return missing("events or count");
    *count = 0;
    auto* const contacts = std::get_if<Watch>(&watch->of);
    if (!contacts) return Error{ErrorCode::bad_input, "the watch is not one of contacts", "use collided_watch_next"};
    take_contacts(*contacts, std::chrono::nanoseconds(wait_ns), capacity, watch->lent);
    // The events are spaced by the struct's size in the caller's header.
    const std::uint32_t size = events->size;
    auto* bytes = reinterpret_cast<unsigned char*>(events);
    for (const Event& event : watch->lent) {
      give(lent(event), bytes, size);
      bytes += size;
    }
    *count = watch->lent.size();
    found = *count > 0;
    return {};
  });
}

void collided_watch_health(const collided_watch* watch, uint64_t* lost, int32_t* in_step) {
  const SubscriptionHealth health =
      watch ? std::visit([](const auto& of) { return of.health(); }, watch->of) : SubscriptionHealth{.in_step = false};
  if (lost) *lost = health.lost;
  if (in_step) *in_step = health.in_step ? 1 : 0;
}

void collided_watch_close(collided_watch* watch) { delete watch; }

}  // extern "C"
