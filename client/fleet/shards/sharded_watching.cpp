#include "client/fleet/shards/sharded_watching.hpp"

#include <algorithm>
#include <utility>

#include "client/library/commands/command.hpp"
#include "idl/commands.hpp"

namespace collided::client {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;

namespace {

/// How often shards are looked at that report nothing.
constexpr nanoseconds kNoNewsWait = milliseconds(20);
/// While a shard is split, how often its server learns which map is watched, and how long one may take to answer.
constexpr nanoseconds kMapReport = milliseconds(500);

}  // namespace

ShardedWatching::ShardedWatching(std::shared_ptr<ShardLinks> links, const WatchOptions& options)
    : links_(std::move(links)),
      options_(options),
      number_(random_number()),
      view_(links_->view()),
      shards_(view_->held.size()),
      merge_(view_->held, [this](const Event& event) { events_.push(event); }),
      events_(options.capacity),
      thread_([this] { run(); }) {}

ShardedWatching::~ShardedWatching() {
  {
    const std::lock_guard lock(heard_mutex_);
    is_over_ = true;
  }
  news_came_.notify_all();
  thread_.join();
}

/// Returns false when it is over.
bool ShardedWatching::wait_for_news() {
  std::unique_lock lock(heard_mutex_);
  news_came_.wait_for(lock, kNoNewsWait, [this] { return is_over_ || has_news_; });
  has_news_ = false;
  return !is_over_;
}

void ShardedWatching::note_news() {
  {
    const std::lock_guard lock(heard_mutex_);
    has_news_ = true;
  }
  news_came_.notify_one();
}

void ShardedWatching::run() {
  while (wait_for_news()) {
    settle();
    report_map();
    for (std::size_t shard = 0; shard < shards_.size(); ++shard) count_gaps(shard);
    follow_view();
  }
}

void ShardedWatching::take_heard() {
  std::vector<ShardEvent> heard;
  {
    const std::lock_guard lock(heard_mutex_);
    heard.swap(heard_);
  }
  for (const ShardEvent& one : heard) {
    if ((view_->held.all() & shards::set_of(one.shard)) != 0) merge_.hear(one.shard, one.event);
  }
}

/// Watches the shards that there are now. One that is gone was split some time ago: since then those in its place have held
/// all that it held, and have been heard with it.
void ShardedWatching::follow_view() {
  std::shared_ptr<const ShardView> newest = links_->view();
  if (newest == view_) return;
  view_ = std::move(newest);
  shards_.resize(view_->held.size());
  merge_.set_map(view_->held);
  for (std::size_t shard = 0; shard < shards_.size(); ++shard) {
    if ((view_->held.all() & shards::set_of(shard)) != 0 || !shards_[shard].watch) continue;
    shards_[shard] = {};
    merge_.forget(shard);
  }
}

/// The settled time of a shard up to which its events have been received; nothing if it is silent or not in step.
std::optional<SettledTime> ShardedWatching::settled_of(std::size_t shard) const {
  const std::unique_ptr<Watch::State>& watch = shards_[shard].watch;
  if (!watch || !watch->health().connected || !links_->answers(shard)) return std::nullopt;
  return watch->feed().settled();
}

/// Returns false while the shard comes in step, or another server may be taking its place: until then, nothing can be
/// settled.
bool ShardedWatching::look_at(std::size_t shard) {
  WatchedShard& watched = shards_[shard];
  if (!watched.watch) watch_new(shard);
  if (const std::optional<SettledTime> now = settled_of(shard)) {
    const bool is_replaced = watched.settled && watched.settled->life != now->life;
    watched.settled = now;
    watched.there = Clock::now();
    there_ |= shards::set_of(shard);
    return !is_replaced;
  }
  // A shard that answers comes in step soon, and until then its events may be late.
  if (!watched.settled) return !links_->answers(shard);
  if (Clock::now() - watched.there < links_->replaced_within(shard)) return false;
  watched.settled.reset();
  ++gaps_;
  return true;
}

/// Events that all shards have decided are passed on once each shard has sent a later watermark: a shard without publishers
/// follows its clock, and by then its events include everything that it received before another shard went on. A shard that
/// was added, removed or replaced since has not sent that watermark.
void ShardedWatching::settle() {
  const shards::ShardSet before = std::exchange(there_, 0);
  bool is_any_awaited = false;
  SettledByAll all{.to = nanoseconds::max(), .came = {}};
  Clock::time_point oldest = Clock::time_point::max();
  shards::for_each_place(view_->held.all(), [&](std::size_t shard) {
    is_any_awaited = !look_at(shard) || is_any_awaited;
    const std::optional<SettledTime>& settled = shards_[shard].settled;
    if (!settled) return;
    all.to = std::min(all.to, settled->to);
    all.came = std::max(all.came, settled->came);
    oldest = std::min(oldest, settled->came);
  });
  take_heard();
  if (is_any_awaited || there_ != before) to_settle_.clear();
  if (is_any_awaited || there_ == 0) return;
  std::optional<nanoseconds> decided;
  for (; !to_settle_.empty() && oldest > to_settle_.front().came; to_settle_.pop_front())
    decided = to_settle_.front().to;
  if (to_settle_.empty() || all.to > to_settle_.back().to) to_settle_.push_back(all);
  if (!decided) return;
  merge_.settle(*decided);
  settled_ns_ = std::max<std::int64_t>(settled_ns_, decided->count());
  open_contacts_ = merge_.open_contacts();
}

/// While a shard is split, the servers learn which map this watches: the newest one all of whose shards are in step.
void ShardedWatching::report_map() {
  if (there_ == view_->held.all()) watched_map_ = shards::fingerprint_text(view_->held_by);
  if (view_->asked.all() == view_->held.all() || Clock::now() - reported_ < kMapReport) return;
  reported_ = Clock::now();
  shards::for_each_place(there_, [&](std::size_t shard) {
    const std::shared_ptr<Connection> connection = links_->connection(shard);
    if (connection)
      static_cast<void>(command(*connection, wire_contract::command::kWatching,
                                {{"watch", number_}, {"map", watched_map_}}, kMapReport));
  });
}

void ShardedWatching::watch_new(std::size_t shard) {
  if (!links_->answers(shard)) return;
  const auto callback = [this, shard](const Event& event) {
    const std::lock_guard lock(heard_mutex_);
    heard_.push_back({shard, event});
  };
  Result<std::unique_ptr<Watch::State>> watch = Watch::State::start(
      links_->connection(shard), {.only = options_.only, .skip = options_.skip}, callback, [this] { note_news(); });
  if (watch) shards_[shard].watch = std::move(*watch);
}

void ShardedWatching::count_gaps(std::size_t shard) {
  WatchedShard& watched = shards_[shard];
  if (!watched.watch) return;
  const std::uint64_t gaps = watched.watch->feed().gaps();
  gaps_ += gaps - std::exchange(watched.gaps, gaps);
  judge_life_change(watched);
}

/// What happened between two lives of a server may be missing, unless the second one has taken the first one's place and tells
/// all from before that, and the watch has heard that from its first event on.
void ShardedWatching::judge_life_change(WatchedShard& watched) {
  const LifeChange change = watched.watch->feed().life_change();
  if (change.changes == watched.life_changes) return;
  // Where it does not come in step at all, that is counted when it is given up.
  if (!watched.settled || watched.settled->life != change.now) return;
  const SettledTime& settled = *watched.settled;
  const bool tells_all =
      settled.heir_of != 0 && settled.heir_of == change.before.server && change.heard_from <= settled.told_from;
  gaps_ += change.changes - std::exchange(watched.life_changes, change.changes) - (tells_all ? 1 : 0);
}

}  // namespace collided::client
