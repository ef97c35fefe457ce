#include "client/library/watching/watch_feed.hpp"

#include <type_traits>
#include <utility>

#include "client/library/connection/wait_until.hpp"

namespace collided::client {
namespace {

// Maximum number of messages that wait for the watch's thread. Further ones are dropped, which causes a gap in the
// sequence.
constexpr std::size_t kMostMessages = 8'192;

}  // namespace

template <class News>
WatchFeed<News>::WatchFeed(std::shared_ptr<Connection> connection, Emit emit, bool persisted,
                           std::function<void()> heard)
    : connection_(std::move(connection)),
      state_(std::move(emit)),
      heard_(std::move(heard)),
      frame_topic_(connection_->participant(), connection_->options().name_space, WireOf<News>::kFrames),
      shard_topic_(connection_->participant(), connection_->options().name_space, WireOf<News>::kShards) {
  using Frames = dds::Taker<Frame>;
  using FrameReader = dds::ReaderOptions<Frame>;
  // A callback that runs before its reader exists leaves the samples in it.
  if (persisted) {
    persisted_topic_.emplace(connection_->participant(), connection_->options().name_space,
                             wire_contract::kPersistedTopic);
    persisted_reader_.emplace(
        *persisted_topic_, FrameReader{.data = [this](Frames) { take<PersistedFrame>(persisted_reader_, frames_); }});
  }
  frame_reader_.emplace(frame_topic_,
                        FrameReader{.data = [this](Frames) { take<FramePointer>(frame_reader_, frames_); }});
  shard_reader_.emplace(shard_topic_, dds::ReaderOptions<Shard>{.data = [this](dds::Taker<Shard>) {
                          take<ShardPointer>(shard_reader_, shards_);
                        }});
  if (heard_) {
    watermark_topic_.emplace(connection_->participant(), connection_->options().name_space,
                             wire_contract::kWatermarkTopic);
    watermark_reader_.emplace(*watermark_topic_,
                              FrameReader{.data = [this](Frames) { take<FramePointer>(watermark_reader_, frames_); }});
  }
  has_readers_.store(true);
  if (persisted) take<PersistedFrame>(persisted_reader_, frames_);
  take<FramePointer>(frame_reader_, frames_);
  take<ShardPointer>(shard_reader_, shards_);
}

template <class News>
std::optional<Error> WatchFeed<News>::wait_for_server() {
  const Clock::time_point deadline = Clock::now() + connection_->options().wait;
  const auto is_offered = [&] { return frame_reader_->matched_writers() > 0 && shard_reader_->matched_writers() > 0; };
  if (!wait_until(deadline, is_offered)) {
    if (connection_->pulse().silent()) return connection_->disconnected();
    return Error{ErrorCode::no_server, "watch: the server offers no events", ""};
  }
  if constexpr (std::is_same_v<News, Event>) {
    status_observer_ = connection_->pulse().observe([this](const wire::Status& status) { queue(decode(status)); });
  }
  return std::nullopt;
}

template <class News>
void WatchFeed<News>::run(std::function<void()> first) {
  thread_ = std::thread([this, first = std::move(first)] {
    first();
    work();
  });
}

template <class News>
WatchFeed<News>::~WatchFeed() {
  if (status_observer_) { connection_->pulse().stop_observing(*status_observer_); }
  persisted_reader_.reset();
  watermark_reader_.reset();
  frame_reader_.reset();
  shard_reader_.reset();
  if (!thread_.joinable()) { return; }
  {
    const std::lock_guard lock(messages_mutex_);
    ending_ = true;
  }
  message_came_.notify_one();
  thread_.join();
}

template <class News>
template <class As, class T>
void WatchFeed<News>::take(std::optional<dds::Reader<T>>& reader, SamplePool<T>& pool) {
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

template <class News>
void WatchFeed<News>::queue(Message message) {
  {
    const std::lock_guard lock(messages_mutex_);
    if (messages_.size() >= kMostMessages) { return; }
    messages_.emplace_back(std::move(message), Clock::now());
  }
  message_came_.notify_one();
}

template <class News>
void WatchFeed<News>::work() {
  while (true) {
    std::unique_lock lock(messages_mutex_);
    message_came_.wait(lock, [this] { return ending_ || !messages_.empty(); });
    if (ending_) { return; }
    auto [message, came] = std::move(messages_.front());
    messages_.pop_front();
    lock.unlock();
    hear(message, came);
    resyncs_ = state_.resyncs();
    gaps_ = state_.gaps();
    in_step_ = state_.in_step();
    {
      const std::lock_guard told_lock(told_mutex_);
      settled_ = state_.settled();
      life_change_ = state_.life_change();
    }
    if (heard_) heard_();
  }
}

template <class News>
void WatchFeed<News>::hear(Message& message, Clock::time_point came) {
  if (auto* const frame = std::get_if<FramePointer>(&message)) {
    if (const auto heard = decode(***frame, connection_->names())) { state_.hear(*heard, came); }
    frames_.put(std::move(*frame));
  } else if (auto* const persisted = std::get_if<PersistedFrame>(&message)) {
    if (const auto heard = decode(**persisted->sample, connection_->names())) { state_.hear_persisted(*heard); }
    frames_.put(std::move(persisted->sample));
  } else if (auto* const shard = std::get_if<ShardPointer>(&message)) {
    if (const auto bookmark = bookmark_in(***shard)) {
      // DDS keeps the newest sum for whoever joins, and it may be from before what else DDS keeps.
      if (std::exchange(has_sum_, true)) state_.hear(*bookmark, came);
    } else if (const auto heard = decode(***shard, connection_->names())) {
      state_.hear(*heard, came);
    }
    shards_.put(std::move(*shard));
  } else {
    state_.hear(std::get<HeardBookmark>(message), came);
  }
}

template class WatchFeed<Event>;
template class WatchFeed<StandingNews>;

}  // namespace collided::client
