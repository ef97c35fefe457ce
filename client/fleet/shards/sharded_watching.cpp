#include "client/fleet/shards/sharded_watching.hpp"

#include <algorithm>
#include <utility>

#include <nlohmann/json.hpp>

#include "client/library/commands/command.hpp"
#include "idl/commands.hpp"

namespace collided::client {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;

namespace {

/// Between two rounds. An event waits for two of them.
constexpr nanoseconds kRound = milliseconds(20);
/// A server that has more to do than it can answers after seconds, and is waited for as long as it is heard. The wait ends
/// early if the server dies or is replaced.
constexpr nanoseconds kAskTimeout = std::chrono::seconds(5);

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
    const std::lock_guard lock(over_mutex_);
    is_over_ = true;
  }
  over_came_.notify_all();
  thread_.join();
}

/// Returns true when it is over.
bool ShardedWatching::sleep() {
  std::unique_lock lock(over_mutex_);
  return over_came_.wait_for(lock, kRound, [this] { return is_over_; });
}

void ShardedWatching::run() {
  while (!sleep()) {
    if (may_settle_ && is_outdated()) may_settle_.reset();
    if (!may_settle_ || has_heard_all()) {
      take_heard();
      if (may_settle_) {
        merge_.settle(*may_settle_);
        settled_ns_ = std::max<std::int64_t>(settled_ns_, may_settle_->count());
        open_contacts_ = merge_.open_contacts();
      }
      follow_view();
      ask_all();
    }
    for (std::size_t shard = 0; shard < shards_.size(); ++shard) count_gaps(shard);
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

/// The newest map all of whose shards are watched, and told of this.
std::string ShardedWatching::watched_map() const {
  for (std::size_t shard = 0; shard < shards_.size(); ++shard) {
    const bool is_held = (view_->held.all() & shards::set_of(shard)) != 0;
    if (is_held && !shards_[shard].now) return told_map_;
  }
  return shards::fingerprint_text(view_->held_by);
}

/// A round: how far has each shard come? What all had decided in the round before may be told once what each one has told
/// by now has been heard: what a shard was given before another went on is in that. While a shard is silent that a standby
/// may be replacing, nothing is told; what the standby has told by then counts from the round after.
void ShardedWatching::ask_all() {
  nanoseconds all_decided = nanoseconds::max();
  for (const WatchedShard& shard : shards_) {
    if (shard.now) all_decided = std::min(all_decided, shard.now->settled);
  }
  const shards::ShardSet before = std::exchange(there_, 0);
  told_map_ = watched_map();
  bool is_any_awaited = false;
  for (std::size_t shard = 0; shard < shards_.size(); ++shard) {
    if ((view_->held.all() & shards::set_of(shard)) == 0) continue;
    WatchedShard& watched = shards_[shard];
    if (!watched.watch) watch_new(shard);
    if (const std::optional<ShardProgress> said = ask(shard)) {
      const bool is_replaced = watched.now && watched.now->told.epoch != said->told.epoch;
      is_any_awaited = is_any_awaited || is_replaced;
      watched.now = said;
    } else if (watched.now && Clock::now() - watched.there < links_->replaced_within(shard)) {
      is_any_awaited = true;
    } else if (watched.now) {
      watched.now.reset();
      ++gaps_;
    }
    if (watched.now) there_ |= shards::set_of(shard);
  }
  // One that has come or gone since then was not in that round.
  const bool is_same = before == there_ && !is_any_awaited && all_decided != nanoseconds::max();
  may_settle_ = is_same ? std::optional(all_decided) : std::nullopt;
}

/// Since the newest round a shard has fallen silent, or another server has taken its place.
bool ShardedWatching::is_outdated() const {
  return std::ranges::any_of(shards_, [](const WatchedShard& shard) {
    if (!shard.now) return false;
    const std::optional<EventPlace> through = shard.watch->feed().told_through();
    return !shard.watch->health().connected || (through && through->epoch > shard.now->told.epoch);
  });
}

bool ShardedWatching::has_heard_all() const {
  return std::ranges::all_of(shards_, [](const WatchedShard& shard) {
    if (!shard.now) return true;
    const std::optional<EventPlace> through = shard.watch->feed().told_through();
    return through && through->epoch == shard.now->told.epoch && through->sequence >= shard.now->told.sequence;
  });
}

void ShardedWatching::watch_new(std::size_t shard) {
  if (!links_->answers(shard)) return;
  const auto callback = [this, shard](const Event& event) {
    const std::lock_guard lock(heard_mutex_);
    heard_.push_back({shard, event});
  };
  Result<std::unique_ptr<Watch::State>> watch =
      Watch::State::start(links_->connection(shard), {.only = options_.only, .skip = options_.skip}, callback);
  if (watch) shards_[shard].watch = std::move(*watch);
}

std::optional<ShardedWatching::ShardProgress> ShardedWatching::ask(std::size_t shard) {
  WatchedShard& watched = shards_[shard];
  if (!watched.watch || !watched.watch->health().in_step || !links_->answers(shard)) return std::nullopt;
  const Result<std::string> answer = command(*links_->connection(shard), wire_contract::command::kSettled,
                                             {{"watch", number_}, {"map", told_map_}}, kAskTimeout);
  const bool is_late = !answer && answer.error().code == ErrorCode::timeout && links_->answers(shard);
  if (answer || is_late) watched.there = Clock::now();
  if (!answer) return std::nullopt;
  const nlohmann::json said = nlohmann::json::parse(*answer, nullptr, false);
  if (!said.is_object()) return std::nullopt;
  return ShardProgress{.settled = nanoseconds(said.value("settled_ns", std::int64_t{0})),
                       .told = {said.value("epoch", std::uint64_t{0}), said.value("event_sequence", std::uint64_t{0})},
                       .heir_of = said.value("heir_of", std::uint64_t{0}),
                       .told_from = said.value("told_from", std::uint64_t{0})};
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
  const std::optional<EventPlace> through = watched.watch->feed().told_through();
  const bool is_heard = watched.now && watched.now->told.epoch == change.now.epoch && through &&
                        through->epoch == change.now.epoch && through->sequence >= watched.now->told.sequence;
  // Where it does not answer at all, that is counted when it is given up.
  if (!is_heard) return;
  const ShardProgress& said = *watched.now;
  const bool tells_all =
      said.heir_of != 0 && said.heir_of == change.before.server && change.heard_from <= said.told_from;
  gaps_ += change.changes - std::exchange(watched.life_changes, change.changes) - (tells_all ? 1 : 0);
}

}  // namespace collided::client
