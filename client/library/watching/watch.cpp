#include "client/library/watching/watch.hpp"

#include <algorithm>

#include "client/library/commands/fetching.hpp"
#include "client/library/connection/errors.hpp"
#include "client/library/connection/wait_until.hpp"
#include "client/library/recordings/recorded_events.hpp"
#include "client/library/watching/pair_filter.hpp"
#include "client/library/watching/watch_decoding.hpp"
#include "idl/clocks.hpp"

namespace collided {

using client::Clock;

namespace {

// Messages that may wait for the watch's thread. More are dropped, which then shows as a gap in the sequence.
constexpr std::size_t kMostMessages = 8'192;

/// The recording is fetched from this much earlier than needed, since the server's clock may be behind.
constexpr std::chrono::seconds kClockMargin{1};
/// No server keeps more than this.
constexpr std::chrono::nanoseconds kLongestRecording = std::chrono::hours(24);

}  // namespace

Watch::Watch(std::unique_ptr<State> state) : Subscription(std::move(state)) {}
Watch::State& Watch::state() const { return static_cast<State&>(source()); }
std::size_t Watch::open_contacts() const { return state().open_contacts(); }
std::chrono::nanoseconds Watch::tells_since() const { return state().tells_since(); }

Watch::State::State(std::shared_ptr<client::Connection> connection, const WatchOptions& options, Callback callback,
                    WatchOf subject)
    : connection_(std::move(connection)),
      options_(options),
      callback_(std::move(callback)),
      watch_([this](const Event& event) { emit(event); }),
      events_(options.capacity),
      event_topic_(connection_->participant(), connection_->options().name_space,
                   subject == WatchOf::fences ? wire_contract::kFenceEventTopic : wire_contract::kEventTopic),
      contact_topic_(connection_->participant(), connection_->options().name_space,
                     subject == WatchOf::fences ? wire_contract::kFenceStateTopic : wire_contract::kContactTopic) {
  if (subject == WatchOf::fences) {
    bookmark_topic_.emplace(connection_->participant(), connection_->options().name_space,
                            wire_contract::kFenceStatusTopic);
  }
  using Frames = dds::Taker<wire::EventFrame>;
  using FrameReader = dds::ReaderOptions<wire::EventFrame>;
  using Shards = dds::Taker<wire::ContactShard>;
  // A callback that comes before its reader is there leaves the samples with it.
  if (options_.persisted) {
    persisted_topic_.emplace(connection_->participant(), connection_->options().name_space,
                             wire_contract::kPersistedTopic);
    persisted_reader_.emplace(
        *persisted_topic_, FrameReader{.data = [this](Frames) { take<PersistedFrame>(persisted_reader_, frames_); }});
  }
  event_reader_.emplace(event_topic_,
                        FrameReader{.data = [this](Frames) { take<FramePool::Pointer>(event_reader_, frames_); }});
  contact_reader_.emplace(contact_topic_, dds::ReaderOptions<wire::ContactShard>{.data = [this](Shards) {
                            take<ShardPool::Pointer>(contact_reader_, shards_);
                          }});
  has_readers_.store(true);
  if (options_.persisted) take<PersistedFrame>(persisted_reader_, frames_);
  take<FramePool::Pointer>(event_reader_, frames_);
  take<ShardPool::Pointer>(contact_reader_, shards_);
}

Result<std::unique_ptr<Watch::State>> Watch::State::start(std::shared_ptr<client::Connection> connection,
                                                          const WatchOptions& options, Callback callback,
                                                          WatchOf subject) {
  try {
    std::unique_ptr<State> state(new State(std::move(connection), options, std::move(callback), subject));
    if (auto error = state->wait_for_server()) { return *error; }
    // Bookmarks count only from here on: before the event reader is matched, events after a bookmark could be missed.
    state->follow_bookmarks();
    // The readers are active already: what comes meanwhile is queued, and an event that is in the recording too counts
    // once, by its sequence number.
    if (options.since) {
      if (auto error = state->hear_recorded(*options.since)) { return *error; }
    }
    state->thread_ = std::thread([watch = state.get()] { watch->work(); });
    return state;
  } catch (const dds::DdsError& failed) { return client::failure_of(failed); }
}

void Watch::State::follow_bookmarks() {
  if (!bookmark_topic_) {
    status_observer_ =
        connection_->pulse().observe([this](const wire::Status& status) { queue(client::decode(status)); });
    return;
  }
  using Statuses = dds::Taker<wire::Status>;
  bookmark_reader_.emplace(*bookmark_topic_,
                           dds::ReaderOptions<wire::Status>{.data = [this](Statuses) { take_bookmarks(); }});
  has_bookmark_reader_.store(true);
  take_bookmarks();
}

/// A callback that comes before its reader is there leaves the samples with it.
void Watch::State::take_bookmarks() {
  if (!has_bookmark_reader_.load()) return;
  const std::lock_guard lock(bookmark_mutex_);
  while (bookmark_reader_->take(bookmark_)) {
    const dds_sample_info_t& info = bookmark_.info();
    const bool is_taken = info.valid_data && connection_->is_from_server(*bookmark_reader_, info, bookmark_->server);
    if (is_taken) queue(client::decode(*bookmark_));
  }
}

std::optional<Error> Watch::State::wait_for_server() const {
  const Clock::time_point deadline = Clock::now() + connection_->options().wait;
  const auto is_offered = [&] {
    return event_reader_->matched_writers() > 0 && contact_reader_->matched_writers() > 0;
  };
  if (client::wait_until(deadline, is_offered)) return std::nullopt;
  if (connection_->pulse().silent()) return connection_->disconnected();
  return Error{ErrorCode::no_server, "watch: the server offers no events", ""};
}

std::optional<Error> Watch::State::hear_recorded(std::chrono::nanoseconds since) {
  const std::chrono::nanoseconds now = wire_contract::since_1970();
  const auto last =
      now - std::clamp<std::chrono::nanoseconds>(since, now - kLongestRecording + kClockMargin, now) + kClockMargin;
  Result<std::vector<std::byte>> bytes = client::fetch_recorded(*connection_, last);
  if (!bytes) { return bytes.error(); }
  try {
    const client::RecordedItems recorded =
        client::read_items(std::move(*bytes), "the server's flight recorder", "Nothing is told");
    is_hearing_recorded_ = true;
    client::hear_recording(recorded, connection_->names(), watch_);
    is_hearing_recorded_ = false;
    tells_since_ = std::max(since, client::span_of(recorded).begin);
  } catch (const std::runtime_error& failed) { return Error{ErrorCode::internal, failed.what(), ""}; }
  recorded_ =
      client::in_window(std::move(recorded_), since, std::chrono::nanoseconds::max(), client::EventOrder::sequence);
  events_.grow(recorded_.size());  // the caller could not have polled them yet
  return std::nullopt;
}

Watch::State::~State() {
  if (status_observer_) { connection_->pulse().stop_observing(*status_observer_); }
  bookmark_reader_.reset();
  if (!thread_.joinable()) { return; }
  persisted_reader_.reset();
  event_reader_.reset();
  contact_reader_.reset();
  {
    const std::lock_guard lock(messages_mutex_);
    ending_ = true;
  }
  message_came_.notify_one();
  thread_.join();
}

template <class As, class T>
void Watch::State::take(std::optional<dds::Reader<T>>& reader, client::SamplePool<T>& pool) {
  if (!has_readers_.load()) return;
  const std::lock_guard lock(taking_mutex_);
  auto sample = pool.get();
  while (reader->take(*sample)) {
    const dds_sample_info_t& info = sample->info();
    if (!info.valid_data) continue;
    const bool is_taken = connection_->is_from_server(*reader, info, (*sample)->server, (*sample)->epoch);
    if (is_taken) queue(As{std::exchange(sample, pool.get())});
  }
  pool.put(std::move(sample));
}

void Watch::State::queue(Message message) {
  {
    const std::lock_guard lock(messages_mutex_);
    if (messages_.size() >= kMostMessages) { return; }
    messages_.push_back(std::move(message));
  }
  message_came_.notify_one();
}

void Watch::State::work() {
  for (const Event& event : std::exchange(recorded_, {})) { emit(event); }
  while (true) {
    std::unique_lock lock(messages_mutex_);
    message_came_.wait(lock, [this] { return ending_ || !messages_.empty(); });
    if (ending_) { return; }
    Message message = std::move(messages_.front());
    messages_.pop_front();
    lock.unlock();
    hear(message);
    resyncs_ = watch_.resyncs();
    gaps_ = watch_.gaps();
    in_step_ = watch_.in_step();
    const std::lock_guard told_lock(told_mutex_);
    told_through_ = watch_.emitted_through();
    life_change_ = watch_.life_change();
  }
}

void Watch::State::hear(Message& message) {
  const Clock::time_point now = Clock::now();
  if (auto* const frame = std::get_if<FramePool::Pointer>(&message)) {
    if (const auto heard = client::decode(***frame, connection_->names())) { watch_.hear(*heard, now); }
    frames_.put(std::move(*frame));
  } else if (auto* const persisted = std::get_if<PersistedFrame>(&message)) {
    if (const auto heard = client::decode(**persisted->sample, connection_->names())) { watch_.hear_persisted(*heard); }
    frames_.put(std::move(persisted->sample));
  } else if (auto* const shard = std::get_if<ShardPool::Pointer>(&message)) {
    if (const auto heard = client::decode(***shard, connection_->names())) { watch_.hear(*heard, now); }
    shards_.put(std::move(*shard));
  } else {
    watch_.hear(std::get<client::HeardBookmark>(message), now);
  }
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
