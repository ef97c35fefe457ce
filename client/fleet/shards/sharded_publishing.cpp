#include "client/fleet/shards/sharded_publishing.hpp"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cstdint>
#include <iterator>
#include <string>
#include <utility>

#include "client/library/asking/question_encoding.hpp"
#include "client/library/connection/errors.hpp"
#include "client/library/publishing/publisher.hpp"
#include "client/fleet/shards/shape_reach.hpp"
#include "idl/clocks.hpp"

namespace collided::client {

using shards::for_each_place;
using shards::ShardBox;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

ShardedPublishing::ShardedPublishing(std::shared_ptr<ShardLinks> links, const std::string& name,
                                     const PublishOptions& options)
    : links_(std::move(links)), name_(name), options_(options) {
  members_.reserve(shards::ShardMap::kMostShards);
  follow_view();
}

/// Takes the shards that there are now: what new ones should hold is missing there, and those that are gone hold nothing.
void ShardedPublishing::follow_view() {
  std::shared_ptr<const ShardView> newest = links_->view();
  if (newest == view_) return;
  view_ = std::move(newest);
  const shards::ShardMap& map = view_->held;
  const std::size_t known = members_.size();
  members_.resize(map.size());
  neighbours_.clear();
  for (std::size_t shard = 0; shard < map.size(); ++shard) {
    neighbours_.push_back(map.holders_of(map.held_by(shard)));
    if ((map.all() & shards::set_of(shard)) == 0) give_up(shard);
  }
  missing_ &= map.all();
  wanted_ &= map.all();
  new_in_ &= map.all();
  for (std::uint32_t number = 0; number < objects_.numbers_used(); ++number) {
    const PublishedObject& object = objects_.at(number);
    if (!object.used) continue;
    const Vec3& at = object.sent.position;
    missing_ |= map.holders_of(box_around(at, at, copies_[number].reach_m)) & ~copies_[number].held;
  }
  if (known != 0 && missing_ != 0) news_.notify_all();
}

/// Others hold what this shard held. Its own objects go with the publisher.
void ShardedPublishing::give_up(std::size_t shard) {
  for (Copies& copies : copies_) {
    if ((copies.held & shards::set_of(shard)) == 0) continue;
    copies.in_each.erase(copies.in_each.begin() + static_cast<std::ptrdiff_t>(place_of(copies, shard)));
    copies.held &= ~shards::set_of(shard);
  }
  members_[shard] = {};
  // Whoever waits to join it need not.
  members_[shard].tried = Clock::now();
  joined_.notify_all();
}

Result<std::unique_ptr<ShardedPublishing>> ShardedPublishing::start(std::shared_ptr<ShardLinks> links,
                                                                    const std::string& name,
                                                                    const PublishOptions& options) {
  std::unique_ptr<ShardedPublishing> state(new ShardedPublishing(std::move(links), name, options));
  // What a publisher may be called, and what its lease may be, the first one says.
  for (std::size_t shard = 0; shard < state->members_.size(); ++shard) {
    if ((state->view_->held.all() & shards::set_of(shard)) == 0) continue;
    const std::shared_ptr<Client> client = state->links_->answers(shard) ? state->links_->shard(shard) : nullptr;
    if (!client) continue;
    Result<Publisher> first = client->publish(name, options);
    if (!first) return first.error();
    state->take_part(shard, std::move(*first));
    break;
  }
  state->thread_ = std::thread([state = state.get()] { state->run(); });
  return state;
}

ShardedPublishing::~ShardedPublishing() {
  {
    const std::lock_guard lock(mutex_);
    is_over_ = true;
  }
  news_.notify_all();
  if (thread_.joinable()) thread_.join();
}

Error ShardedPublishing::unknown(Object object) const {
  return bad_input("object " + std::to_string(object) + " was not added to this publisher, or is removed");
}

/// Around everything of an object on its way from one place to the other.
ShardBox ShardedPublishing::box_around(const Vec3& a, const Vec3& b, double reach_m) const {
  ShardBox box;
  for (int axis = 0; axis < 3; ++axis) {
    box.low[static_cast<std::size_t>(axis)] = std::min(a[axis], b[axis]);
    box.high[static_cast<std::size_t>(axis)] = std::max(a[axis], b[axis]);
  }
  return shards::grown(box, reach_m);
}

// ---- which shard holds what

std::size_t ShardedPublishing::place_of(const Copies& copies, std::size_t shard) {
  return static_cast<std::size_t>(std::popcount(copies.held & (shards::set_of(shard) - 1)));
}

/// Defines an object in a shard where it was at the last flush: what waits is a motion from there.
std::optional<Error> ShardedPublishing::enter(std::uint32_t number, std::size_t shard) {
  const PublishedObject& object = objects_.at(number);
  Copies& copies = copies_[number];
  ObjectOptions options = object.options;
  options.shape = copies.shape;
  options.pose = object.sent;
  const Result<Publisher::Object> added = members_[shard].publisher->state_->add(options, true);
  if (!added) return added.error();
  copies.in_each.insert(copies.in_each.begin() + static_cast<std::ptrdiff_t>(place_of(copies, shard)),
                        {.handle = *added});
  copies.held |= shards::set_of(shard);
  ++members_[shard].objects;
  return std::nullopt;
}

void ShardedPublishing::leave(std::uint32_t number, std::size_t shard) {
  Copies& copies = copies_[number];
  if ((copies.held & shards::set_of(shard)) == 0) return;
  const std::size_t place = place_of(copies, shard);
  // A shard that takes nothing now keeps it, until the object moves again: one copy too many changes nothing.
  if (!members_[shard].publisher->remove(copies.in_each[place].handle)) return;
  copies.in_each.erase(copies.in_each.begin() + static_cast<std::ptrdiff_t>(place));
  copies.held &= ~shards::set_of(shard);
  --members_[shard].objects;
}

/// The shards on the ways of what moved since the last flush, and those that were not there when they were needed.
ShardedPublishing::ShardSet ShardedPublishing::needed() const {
  ShardSet needed = 0;
  for (const std::uint32_t number : objects_.waiting()) needed |= holders_on_way(number) & ~copies_[number].held;
  return needed;
}

ShardedPublishing::ShardSet ShardedPublishing::holders_on_way(std::uint32_t number) const {
  const PublishedObject& object = objects_.at(number);
  const bool is_teleported = object.waiting == PublishedObject::Waiting::teleported;
  const Vec3& to = object.options.pose.position;
  return view_->held.holders_of(box_around(is_teleported ? to : object.sent.position, to, copies_[number].reach_m));
}

/// Shards that were not there when they were needed, and are now, get what they should hold.
ShardedPublishing::ShardSet ShardedPublishing::fill_missing() {
  ShardSet filled = 0;
  for_each_place(missing_, [&](std::size_t shard) {
    if (may_fill(shard)) filled |= shards::set_of(shard);
    else if (!members_[shard].publisher && links_->answers(shard)) wanted_ |= shards::set_of(shard);
  });
  if (filled != 0) fill(filled);
  return filled;
}

/// Enters what shards should hold that this is a publisher of.
void ShardedPublishing::fill(ShardSet into) {
  for (std::uint32_t number = 0; number < objects_.numbers_used(); ++number) {
    const PublishedObject& object = objects_.at(number);
    if (!object.used) continue;
    const Vec3& at = object.sent.position;
    const ShardSet holders = view_->held.holders_of(box_around(at, at, copies_[number].reach_m));
    for_each_place(holders & into & ~copies_[number].held, [&](std::size_t shard) { enter(number, shard); });
  }
  missing_ &= ~into;
  for_each_place(into, [&](std::size_t shard) { members_[shard].decided.reset(); });
}

/// Has the shards on the ways of what moved hold it, and tells them when it was where it was.
std::optional<Error> ShardedPublishing::enter_all(ShardSet& entered) {
  std::optional<Error> failed;
  for (const std::uint32_t number : objects_.waiting()) {
    for_each_place(holders_on_way(number) & ~copies_[number].held, [&](std::size_t shard) {
      const bool is_missing = (missing_ & shards::set_of(shard)) != 0;
      if (!members_[shard].publisher || is_missing) {
        missing_ |= shards::set_of(shard);
      } else if (auto error = enter(number, shard)) {
        failed = std::move(error);
      } else {
        entered |= shards::set_of(shard);
      }
    });
  }
  // A shard that has had objects of this publisher all the while has heard of that instant.
  for_each_place(entered, [&](std::size_t shard) {
    ShardMember& member = members_[shard];
    if (flushed_.count() == 0 || member.flushed == flushed_ || !links_->may_answer(shard)) return;
    if (auto said = member.publisher->flush(flushed_); !said) failed = said.error();
  });
  return failed;
}

/// Hands the new pose of an object to the shards that hold it; flush() sends it.
std::optional<Error> ShardedPublishing::move_copies(std::uint32_t number) {
  const bool is_teleported = objects_.at(number).waiting == PublishedObject::Waiting::teleported;
  const Copies& copies = copies_[number];
  std::optional<Error> failed;
  for_each_place(copies.held, [&](std::size_t shard) {
    ShardMember& member = members_[shard];
    const Result<void> moved =
        member.publisher->move(copies.in_each[place_of(copies, shard)].handle, objects_.at(number).options.pose,
                               is_teleported || member.was_away);
    if (!moved && !failed && links_->may_answer(shard)) failed = moved.error();
  });
  return failed;
}

std::optional<Error> ShardedPublishing::tell(std::size_t shard, nanoseconds instant, bool is_entered) {
  ShardMember& member = members_[shard];
  if (!member.publisher) return std::nullopt;
  // A standby that takes a shard's place has heard what the shard was told meanwhile.
  if (!links_->may_answer(shard)) {
    member.was_away = true;
    return std::nullopt;
  }
  const bool is_first = is_entered && member.flushed != flushed_;
  const Result<FlushReport> said = member.publisher->flush(instant);
  if (!said) return said.error();
  if (lost_.empty() && !said->lost.empty()) lost_ = "shard '" + view_->held.at(shard).name + "': " + said->lost;
  member.flushed = instant;
  member.was_away = false;
  // The others must not decide beyond this instant before this shard knows of it.
  if (is_first) static_cast<void>(member.publisher->wait_applied(kEnterWait));
  return std::nullopt;
}

/// Notes which of the objects that moved are out of a shard that holds them.
void ShardedPublishing::note_left(nanoseconds instant) {
  const shards::ShardMap& map = view_->held;
  for (const std::uint32_t number : objects_.waiting()) {
    Copies& copies = copies_[number];
    // The shards where it is now may be away: the last one that holds it keeps it.
    if (std::has_single_bit(copies.held)) {
      copies.in_each.front().left = nanoseconds(0);
      continue;
    }
    const Vec3& at = objects_.at(number).options.pose.position;
    const ShardSet near = map.holders_of(box_around(at, at, copies.reach_m));
    for_each_place(copies.held, [&](std::size_t shard) {
      nanoseconds& left = copies.in_each[place_of(copies, shard)].left;
      if ((near & shards::set_of(shard)) != 0) left = nanoseconds(0);
      else if (left.count() == 0) left = instant;
    });
    if ((copies.held & ~near) != 0 && !std::exchange(copies.is_leaving, true)) leaving_.push_back(number);
  }
}

// ---- what the user calls

Result<ShardedPublisher::Object> ShardedPublishing::add(const ObjectOptions& options) {
  std::unique_lock lock(mutex_);
  follow_view();
  if (objects_.has_name(options.name)) {
    return bad_input("object '" + options.name + "': this publisher has an object of that name already");
  }
  const std::optional<Object> object = objects_.add(options, {});
  if (!object) {
    return bad_input("object '" + options.name + "': a publisher holds at most " +
                     std::to_string(PublishedObjects::kMost) + " objects");
  }
  const std::uint32_t number = PublishedObjects::number(*object);
  if (number >= copies_.size()) copies_.resize(number + 1);
  const bool is_leaving = copies_[number].is_leaving;  // as the object that had the number before
  copies_[number] = {.shape = options.shape,
                     .reach_m = reach_of(options.shape, options.scale),
                     .in_each = {},
                     .is_leaving = is_leaving};
  const Vec3& at = options.pose.position;
  ShardSet holders = view_->held.holders_of(box_around(at, at, copies_[number].reach_m));
  join(holders, lock);
  std::optional<Error> failed;
  // Others may be there since, and some of them have it already.
  holders = view_->held.holders_of(box_around(at, at, copies_[number].reach_m)) & ~copies_[number].held;
  for_each_place(holders, [&](std::size_t shard) {
    const bool is_missing = (missing_ & shards::set_of(shard)) != 0;
    if (!members_[shard].publisher || is_missing) missing_ |= shards::set_of(shard);
    else if (!failed) failed = enter(number, shard);
  });
  join_ahead();
  if (!failed) {
    new_in_ |= copies_[number].held;
    return *object;
  }
  for_each_place(copies_[number].held, [&](std::size_t shard) { leave(number, shard); });
  objects_.remove(*object);
  return *failed;
}

Result<void> ShardedPublishing::remove(Object object) {
  const std::lock_guard lock(mutex_);
  if (objects_.find(object) == nullptr) return unknown(object);
  const std::uint32_t number = PublishedObjects::number(object);
  for_each_place(copies_[number].held, [&](std::size_t shard) { leave(number, shard); });
  if (copies_[number].held != 0) {
    return Error{ErrorCode::timeout, "publish: a shard takes nothing more", "the object stays there; remove it again"};
  }
  copies_[number] = {.shape = {}, .in_each = {}, .is_leaving = copies_[number].is_leaving};
  objects_.remove(object);
  return {};
}

Result<void> ShardedPublishing::move(Object object, const Pose& pose, bool teleport) {
  const std::lock_guard lock(mutex_);
  const PublishedObject* const moved = objects_.find(object);
  if (moved == nullptr) return unknown(object);
  std::optional<std::string> reason = finite_fault(pose.position, "position");
  if (!reason) reason = rotation_fault(pose.rotation);
  if (reason) { return bad_input("object '" + moved->options.name + "': " + *reason, "its pose is as before"); }
  if (!moved->options.moving) {
    return bad_input("object '" + moved->options.name + "' was added as static", "its pose is as before");
  }
  objects_.set_pose(object, pose, teleport);
  return {};
}

Result<FlushReport> ShardedPublishing::flush(nanoseconds source_time) {
  std::unique_lock lock(mutex_);
  follow_view();
  has_own_clock_ = source_time.count() == 0;
  const nanoseconds said = source_time.count() != 0 ? source_time : nanoseconds(wire_contract::since_1970_ns());
  const nanoseconds instant = std::max(said, flushed_ + nanoseconds(1));
  join(needed(), lock);
  ShardSet entered = fill_missing() | std::exchange(new_in_, 0);
  std::optional<Error> failed = enter_all(entered);
  const auto note = [&](std::optional<Error> error) {
    if (error && !failed) failed = std::move(error);
  };
  for (const std::uint32_t number : objects_.waiting()) note(move_copies(number));
  note_left(instant);
  for_each_place(entered, [&](std::size_t shard) { note(tell(shard, instant, true)); });
  for_each_place(view_->held.all() & ~entered, [&](std::size_t shard) { note(tell(shard, instant, false)); });
  objects_.mark_sent(objects_.waiting().size());
  flushed_ = instant;
  flushed_at_ = Clock::now();
  join_ahead();
  if (failed) return *failed;
  return FlushReport{.lost = std::exchange(lost_, {})};
}

Result<void> ShardedPublishing::keep_alive(nanoseconds source_time) {
  const std::lock_guard lock(mutex_);
  if (source_time.count() == 0 && has_own_clock_) source_time = nanoseconds(wire_contract::since_1970_ns());
  std::optional<Error> failed;
  for (std::size_t shard = 0; shard < members_.size(); ++shard) {
    if (!members_[shard].publisher || !links_->may_answer(shard)) continue;
    if (auto said = members_[shard].publisher->keep_alive(source_time); !said && !failed) failed = said.error();
  }
  if (failed) return *failed;
  return {};
}

Result<void> ShardedPublishing::wait_applied(nanoseconds timeout) {
  const Clock::time_point deadline = Clock::now() + timeout;
  const std::lock_guard lock(mutex_);
  for (std::size_t shard = 0; shard < members_.size(); ++shard) {
    if (!members_[shard].publisher || !links_->answers(shard)) continue;
    const nanoseconds left = std::max<nanoseconds>(deadline - Clock::now(), milliseconds(1));
    if (auto applied = members_[shard].publisher->wait_applied(left); !applied) {
      Error error = applied.error();
      error.message = "shard '" + view_->held.at(shard).name + "': " + error.message;
      return error;
    }
  }
  return {};
}

Result<PublisherReport> ShardedPublishing::report(nanoseconds timeout) {
  const Clock::time_point deadline = Clock::now() + timeout;
  const std::lock_guard lock(mutex_);
  PublisherReport all;
  for (std::size_t shard = 0; shard < members_.size(); ++shard) {
    if (!members_[shard].publisher || !links_->answers(shard)) continue;
    Result<PublisherReport> one =
        members_[shard].publisher->report(std::max<nanoseconds>(deadline - Clock::now(), milliseconds(1)));
    if (!one) return one.error();
    if (all.refused.empty()) all.refused = std::move(one->refused);
    std::move(one->left_out.begin(), one->left_out.end(), std::back_inserter(all.left_out));
    all.left_out_count += one->left_out_count;
    all.merged_poses += one->merged_poses;
  }
  return all;
}

std::size_t ShardedPublishing::copies() const {
  const std::lock_guard lock(mutex_);
  std::size_t count = 0;
  for (const ShardMember& member : members_) count += member.objects;
  return count;
}

}  // namespace collided::client
