#include "client/fleet/shards/sharded_publishing.hpp"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "client/library/publishing/publisher.hpp"

// Of which shards it is a publisher, and since when what it says counts there.
namespace collided::client {

using shards::for_each_place;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

namespace {

/// A shard that could not be joined is not tried again for so long.
constexpr nanoseconds kTryAgain = std::chrono::seconds(1);
/// Who has not said anything for so long, and for so long in a shard, rests.
constexpr nanoseconds kRests = std::chrono::seconds(2);
/// So often it is looked whether shards have come or gone, also where nobody calls.
constexpr nanoseconds kLookAround = milliseconds(200);

}  // namespace

/// Waits until this is a publisher of those shards that are there. The lock is given up meanwhile.
void ShardedPublishing::join(ShardSet needed, std::unique_lock<std::mutex>& lock) {
  const auto was_tried = [&](const ShardMember& member) { return Clock::now() - member.tried < kTryAgain; };
  for_each_place(needed, [&](std::size_t shard) {
    const ShardMember& member = members_[shard];
    if (member.publisher || !links_->answers(shard) || was_tried(member)) return;
    wanted_ |= shards::set_of(shard);
    news_.notify_all();
    joined_.wait(lock, [&] { return member.publisher || was_tried(member) || is_over_; });
  });
}

void ShardedPublishing::take_part(std::size_t shard, Publisher publisher) {
  publisher.state_->announce();
  ShardMember& member = members_[shard];
  member.publisher = std::make_unique<Publisher>(std::move(publisher));
  member.joined = Clock::now();
  member.decided.reset();
}

/// A shard that others publish to has decided up to some instant without this publisher. From one after that on what enters
/// moves there as everywhere else: so it says its instants first, and its objects enter with one that the shard waits for.
bool ShardedPublishing::may_fill(std::size_t shard) const {
  const ShardMember& member = members_[shard];
  return member.publisher && (flushed_.count() == 0 || (member.decided && *member.decided <= flushed_));
}

/// Up to when a shard has decided, by its newest status; 0 if it is silent.
nanoseconds ShardedPublishing::decided_by(std::size_t shard) const {
  const std::shared_ptr<Connection> connection = links_->connection(shard);
  return connection && !connection->pulse().silent() ? connection->pulse().settled() : nanoseconds(0);
}

/// Finds how far shards that miss something have decided.
void ShardedPublishing::find_decided() {
  for_each_place(missing_, [&](std::size_t shard) {
    ShardMember& member = members_[shard];
    if (!member.publisher || member.decided || !links_->answers(shard)) return;
    if (may_fill(shard) || (flushed_at_ < Clock::now() - kRests && member.joined < Clock::now() - kRests))
      return catch_up(shard);
    if (member.flushed.count() == 0 || !member.publisher->wait_applied(kEnterWait)) return;
    if (const nanoseconds decided = decided_by(shard); decided.count() != 0) member.decided = decided;
  });
}

/// Removes objects from shards that they left before the instant up to which the shard has decided: with a slower publisher
/// it may have found until then that they touched.
void ShardedPublishing::drop_left() {
  std::erase_if(leaving_, [&](std::uint32_t number) {
    Copies& copies = copies_[number];
    for_each_place(copies.held, [&](std::size_t shard) {
      const nanoseconds left = copies.in_each[place_of(copies, shard)].left;
      const bool may_leave = left.count() != 0 && !std::has_single_bit(copies.held);
      if (may_leave && left <= decided_by(shard)) leave(number, shard);
    });
    copies.is_leaving = !std::has_single_bit(copies.held) &&
                        std::ranges::any_of(copies.in_each, [](const Copy& copy) { return copy.left.count() != 0; });
    return !copies.is_leaving;
  });
}

/// A shard has the objects of one who rests as of the last flush: there may be no other one.
void ShardedPublishing::catch_up(std::size_t shard) {
  fill(shards::set_of(shard));
  ShardMember& member = members_[shard];
  if (flushed_.count() == 0 || member.objects == 0 || !member.publisher->flush(flushed_)) return;
  member.flushed = flushed_;
  static_cast<void>(member.publisher->wait_applied(kEnterWait));
}

/// Has this become a publisher of the shards that are there again, or for the first time.
void ShardedPublishing::try_missing() {
  for_each_place(missing_, [&](std::size_t shard) {
    const ShardMember& member = members_[shard];
    if (!member.publisher && links_->answers(shard) && Clock::now() - member.tried >= kTryAgain)
      wanted_ |= shards::set_of(shard);
  });
}

/// Becomes a publisher of what objects may enter next, so that none waits for it at a border.
void ShardedPublishing::join_ahead() {
  ShardSet near = 0;
  for (std::size_t shard = 0; shard < members_.size(); ++shard) {
    if (members_[shard].objects > 0) near |= neighbours_[shard];
  }
  for_each_place(near, [&](std::size_t shard) {
    if (members_[shard].publisher || Clock::now() - members_[shard].tried < kTryAgain) return;
    wanted_ |= shards::set_of(shard);
  });
  if (wanted_ != 0) news_.notify_all();
}

void ShardedPublishing::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    news_.wait_for(lock, kLookAround, [&] { return is_over_ || wanted_ != 0; });
    if (is_over_) return;
    follow_view();
    try_missing();
    find_decided();
    drop_left();
    if (wanted_ == 0) continue;
    const auto shard = static_cast<std::size_t>(std::countr_zero(wanted_));
    const std::shared_ptr<Client> client = links_->answers(shard) ? links_->shard(shard) : nullptr;
    std::optional<Publisher> publisher;
    if (client) {
      lock.unlock();
      Result<Publisher> made = client->publish(name_, options_);
      if (made) publisher = std::move(*made);
      lock.lock();
    }
    wanted_ &= ~shards::set_of(shard);
    const bool is_held = (view_->held.all() & shards::set_of(shard)) != 0;
    if (publisher && is_held) take_part(shard, std::move(*publisher));
    else members_[shard].tried = Clock::now();
    joined_.notify_all();
  }
}

}  // namespace collided::client
