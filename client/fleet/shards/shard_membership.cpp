#include "client/fleet/shards/sharded_publishing.hpp"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "client/library/commands/command.hpp"
#include "client/library/publishing/publisher.hpp"
#include "idl/commands.hpp"

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

/// Up to when a shard has decided; nothing if it does not answer. The lock is given up meanwhile.
std::optional<nanoseconds> ShardedPublishing::ask_decided(std::size_t shard, std::unique_lock<std::mutex>& lock) {
  const std::shared_ptr<Connection> connection = links_->connection(shard);
  const Publisher* const asked_for = members_[shard].publisher.get();
  if (!connection || asked_for == nullptr) return std::nullopt;
  lock.unlock();
  const Result<std::string> answer =
      command(*connection, wire_contract::command::kSettled, nlohmann::json::object(), kEnterWait);
  lock.lock();
  if (!answer || members_[shard].publisher.get() != asked_for) return std::nullopt;
  const nlohmann::json said = nlohmann::json::parse(*answer, nullptr, false);
  if (!said.is_object()) return std::nullopt;
  return nanoseconds(said.value("settled_ns", std::int64_t{0}));
}

/// Asks shards that miss something how far they have decided.
void ShardedPublishing::find_decided(std::unique_lock<std::mutex>& lock) {
  for_each_place(missing_, [&](std::size_t shard) {
    const ShardMember& member = members_[shard];
    if (!member.publisher || member.decided || !links_->answers(shard)) return;
    if (may_fill(shard) || (flushed_at_ < Clock::now() - kRests && member.joined < Clock::now() - kRests))
      return catch_up(shard);
    if (member.flushed.count() == 0 || !member.publisher->wait_applied(kEnterWait)) return;
    if (const std::optional<nanoseconds> decided = ask_decided(shard, lock)) members_[shard].decided = decided;
  });
}

/// Removes what has left shards that have decided past that.
void ShardedPublishing::drop_left(std::unique_lock<std::mutex>& lock) {
  ShardSet asked = 0;
  for (const std::uint32_t number : leaving_) {
    const Copies& copies = copies_[number];
    for_each_place(copies.held, [&](std::size_t shard) {
      if (copies.in_each[place_of(copies, shard)].left.count() != 0) asked |= shards::set_of(shard);
    });
  }
  for_each_place(asked, [&](std::size_t shard) {
    if (is_over_ || !links_->answers(shard)) return;
    if (const std::optional<nanoseconds> decided = ask_decided(shard, lock)) drop_left(shard, *decided);
  });
  std::erase_if(leaving_, [&](std::uint32_t number) {
    Copies& copies = copies_[number];
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
    find_decided(lock);
    drop_left(lock);
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
