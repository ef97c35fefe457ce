#include "client/library/watching/watch.hpp"

#include <algorithm>
#include <utility>

#include "client/library/commands/fetching.hpp"
#include "client/library/connection/errors.hpp"
#include "client/library/recordings/recorded_events.hpp"
#include "client/library/watching/pair_filter.hpp"
#include "idl/clocks.hpp"

namespace collided {

namespace {

/// The recording is fetched from this much earlier, since the server's clock may be behind.
constexpr std::chrono::seconds kClockMargin{1};
/// The most that a server keeps.
constexpr std::chrono::nanoseconds kLongestRecording = std::chrono::hours(24);

}  // namespace

Watch::Watch(std::unique_ptr<State> state) : Subscription(std::move(state)) {}
Watch::State& Watch::state() const { return static_cast<State&>(source()); }
std::size_t Watch::open_contacts() const { return state().open_contacts(); }
std::chrono::nanoseconds Watch::tells_since() const { return state().tells_since(); }

Watch::State::State(std::shared_ptr<client::Connection> connection, const WatchOptions& options, Callback callback,
                    std::function<void()> heard)
    : options_(options),
      callback_(std::move(callback)),
      events_(options.capacity),
      feed_(
          std::move(connection), [this](const Event& event) { emit(event); }, options.persisted, std::move(heard)) {}

Result<std::unique_ptr<Watch::State>> Watch::State::start(std::shared_ptr<client::Connection> connection,
                                                          const WatchOptions& options, Callback callback,
                                                          std::function<void()> heard) {
  try {
    std::unique_ptr<State> state(new State(connection, options, std::move(callback), std::move(heard)));
    if (auto error = state->feed_.wait_for_server()) { return *error; }
    // The readers are already active: new messages are queued. An event that is also in the recording counts once, by
    // its sequence number.
    if (options.since) {
      if (auto error = state->hear_recorded(*connection, *options.since)) { return *error; }
    }
    state->feed_.run([watch = state.get()] {
      for (const Event& event : std::exchange(watch->recorded_, {})) { watch->emit(event); }
    });
    return state;
  } catch (const dds::DdsError& failed) { return client::failure_of(failed); }
}

std::optional<Error> Watch::State::hear_recorded(client::Connection& connection, std::chrono::nanoseconds since) {
  const std::chrono::nanoseconds now = wire_contract::since_1970();
  const auto last =
      now - std::clamp<std::chrono::nanoseconds>(since, now - kLongestRecording + kClockMargin, now) + kClockMargin;
  Result<std::vector<std::byte>> bytes = client::fetch_recorded(connection, last);
  if (!bytes) { return bytes.error(); }
  try {
    const client::RecordedItems recorded =
        client::read_items(std::move(*bytes), "the server's flight recorder", "Nothing is told");
    is_hearing_recorded_ = true;
    client::hear_recording(recorded, connection.names(), feed_.state());
    is_hearing_recorded_ = false;
    tells_since_ = std::max(since, client::span_of(recorded).begin);
  } catch (const std::runtime_error& failed) { return Error{ErrorCode::internal, failed.what(), ""}; }
  recorded_ =
      client::in_window(std::move(recorded_), since, std::chrono::nanoseconds::max(), client::EventOrder::sequence);
  events_.grow(recorded_.size());  // the caller cannot have polled them yet
  return std::nullopt;
}

void Watch::State::emit(const Event& event) {
  if (!client::is_wanted(event, options_.only, options_.skip)) { return; }
  if (is_hearing_recorded_) {
    recorded_.push_back(event);
    return;
  }
  if (event.kind == EventKind::ended) {
    --open_contacts_;
  } else if (event.kind == EventKind::began || event.kind == EventKind::open) {
    ++open_contacts_;
  }
  if (callback_) {
    callback_(event);
    return;
  }
  events_.push(event);
}

}  // namespace collided
