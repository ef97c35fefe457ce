#include "server/world/groups/what_if.hpp"

#include <algorithm>
#include <cassert>

#include "server/geometry/float_environment.hpp"
#include "server/world/groups/uncovered.hpp"
#include "server/world/query/unknown_space.hpp"

namespace collided::engine {

WhatIf::WhatIf(std::shared_ptr<const Snapshot> snapshot, const WhatIfAsk& ask, PartMeshes& part_meshes)
    : snapshot_(std::move(snapshot)),
      within_m_(ask.within_m),
      depth_(ask.depth),
      with_filtered_(ask.with_filtered),
      has_unknown_(snapshot_->objects.counts().unknown > 0),
      members_(*snapshot_, part_meshes),
      pose_count_(ask.moved.size()) {
  for (const ObjectId id : ask.moved) members_.add(id);
  add_followers(ask);
  poses_.resize(members_.size());
  moved_reaches_.resize(members_.size());
  first_rest_ = static_cast<std::uint32_t>(members_.size());
  for (std::uint32_t i = 0; i < first_rest_; ++i) {
    const auto found = std::find(ask.left_out.begin(), ask.left_out.end(), members_.info(i).id);
    left_out_.push_back(found != ask.left_out.end() ? 1 : 0);
  }
  std::vector<Aabb> reaches;
  for (const ObjectId id : ask.against) reaches.push_back(members_.reach(members_.add(id)));
  rest_.emplace(reaches);
}

void WhatIf::add_followers(const WhatIfAsk& ask) {
  std::vector<ObjectId> moving = ask.moved;
  for (const Attachment& attached : ask.attached) {
    const auto parent = std::find(moving.begin(), moving.end(), attached.parent);
    assert(parent != moving.end() && "the parent of an attached object does not move");
    const Pose& of_parent = snapshot_->poses[slot_of(attached.parent)];
    const Pose& of_child = snapshot_->poses[slot_of(attached.child)];
    followers_.push_back({static_cast<std::uint32_t>(parent - moving.begin()), composed(inverse(of_parent), of_child)});
    moving.push_back(attached.child);
    members_.add(attached.child);
  }
}

void WhatIf::place_all(std::span<const Pose> poses) {
  assert(poses.size() == pose_count_ && "a configuration has a pose for each moved object");
  std::copy(poses.begin(), poses.end(), poses_.begin());
  for (std::size_t i = 0; i < followers_.size(); ++i)
    poses_[pose_count_ + i] = composed(poses_[followers_[i].parent], followers_[i].in_parent);
  for (std::uint32_t i = 0; i < first_rest_; ++i) {
    members_.set_pose(i, poses_[i]);
    moved_reaches_[i] = members_.reach(i);
  }
}

double WhatIf::limit_m(const NearestYet& yet) const {
  if (!yet.answer.nearest) return within_m_;
  return std::min(within_m_, yet.answer.nearest->clearance.high_m());
}

bool WhatIf::look_at(std::uint32_t a, std::uint32_t b, NearestYet& yet, Deadline& deadline) {
  if (deadline.is_over()) return false;
  if (is_left_out(a) || is_left_out(b)) return true;
  if (!with_filtered_ && !members_.may_meet(a, b)) return true;
  const auto found = clearance_in_order(members_, a, b, {.limit_m = limit_m(yet), .depth = depth_}, deadline);
  if (deadline.was_over()) return false;
  WhatIfAnswer& answer = yet.answer;
  const bool is_stale = members_.is_stale(a) || members_.is_stale(b);
  const bool may_have_met = is_stale && overlaps(members_.reach(a), members_.reach(b));
  Decision touches = found ? found->touches : Decision::no;
  if (may_have_met && touches == Decision::no) touches = Decision::undecided;
  if (touches == Decision::yes || answer.touches == Decision::no) answer.touches = touches;
  if (!found) return true;
  const bool is_contact = found->touches == Decision::yes;
  if (!answer.nearest || (is_contact && !depth_) || found->clearance_m < answer.nearest->clearance.clearance_m) {
    answer.nearest =
        MemberPair{.a = members_.info(a).id, .b = members_.info(b).id, .is_stale = is_stale, .clearance = *found};
    answer.nearest->clearance.touches = touches;
    yet.a = a;
    yet.b = b;
  }
  return depth_ || !is_contact;
}

/// That nothing is met, and nothing nearer than reported, is certain only if the loaded geometry is complete and no
/// space is unknown.
void WhatIf::look_at_covers(WhatIfAnswer& answer) const {
  const double claimed_m = answer.nearest ? std::max(0.0, answer.nearest->clearance.high_m()) : within_m_;
  std::vector<Aabb> reaches;
  for (std::uint32_t i = 0; i < first_rest_; ++i) {
    if (!is_left_out(i)) reaches.push_back(moved_reaches_[i]);
  }
  if (snapshot_->covers) answer.uncovered = uncovered_near(reaches, claimed_m, *snapshot_->covers);
  if (!answer.uncovered && has_unknown_) answer.uncovered = unknown_near(*snapshot_, reaches, claimed_m);
  if (answer.uncovered) answer.touches = Decision::undecided;
}

WhatIfAnswer WhatIf::at(std::span<const Pose> poses, Deadline& deadline) {
  const OwnFloatEnvironment own_floats;
  place_all(poses);
  NearestYet yet;
  const auto before = nearest_before_;
  bool goes_on = !before || look_at(before->first, before->second, yet, deadline);
  const auto is_done = [&](std::uint32_t a, std::uint32_t b) { return before && *before == std::pair(a, b); };
  const auto limit = [&] { return limit_m(yet); };
  const BoundsTree moved(moved_reaches_);
  if (goes_on) {
    walk_nearest_pairs(moved, *rest_, limit, [&](std::uint32_t i, std::uint32_t k, double) {
      return goes_on = is_done(i, first_rest_ + k) || look_at(i, first_rest_ + k, yet, deadline);
    });
  }
  if (goes_on && first_rest_ > 1) {
    walk_nearest_pairs(moved, moved, limit, [&](std::uint32_t i, std::uint32_t k, double) {
      return goes_on = i >= k || is_done(i, k) || look_at(i, k, yet, deadline);
    });
  }
  yet.answer.is_late = deadline.was_over();
  if (yet.answer.is_late && yet.answer.touches == Decision::no) yet.answer.touches = Decision::undecided;
  if (yet.answer.touches == Decision::no && (snapshot_->covers || has_unknown_)) look_at_covers(yet.answer);
  if (yet.answer.nearest) nearest_before_ = {yet.a, yet.b};
  return yet.answer;
}

}  // namespace collided::engine
