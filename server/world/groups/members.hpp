#pragma once

#include <deque>
#include <memory>
#include <vector>

#include "server/world/groups/part_meshes.hpp"
#include "server/world/objects/contact_search.hpp"
#include "server/world/objects/snapshot.hpp"

namespace collided::engine {

/// Some objects of a snapshot in the form that searches over their pairs need: placed, and a part of a scene with a
/// mesh of its own, built on first use.
///
/// owner    the snapshot must outlive it
/// threads  one at a time
class Members {
 public:
  Members(const Snapshot& snapshot, PartMeshes& part_meshes) : snapshot_(snapshot), part_meshes_(part_meshes) {}
  Members(const Members&) = delete;
  Members& operator=(const Members&) = delete;

  /// Adds an object of the snapshot; returns its number.
  std::uint32_t add(ObjectId id);
  std::size_t size() const { return members_.size(); }
  const ObjectInfo& info(std::uint32_t number) const { return *members_[number].info; }
  /// True if a contact of the two counts: neither filters nor the rules for pairs let them pass through each other.
  bool may_meet(std::uint32_t a, std::uint32_t b) const;
  bool is_stale(std::uint32_t number) const { return members_[number].is_stale; }
  /// Contains everything that the object may reach: more than its bounds if its publisher is lost. Empty for an object
  /// without parts.
  const Aabb& reach(std::uint32_t number) const { return members_[number].reach; }
  /// Its bounds, without that doubt.
  const Aabb& bounds(std::uint32_t number) const { return members_[number].placed.bounds; }
  const Placed& placed(std::uint32_t number, Deadline& deadline);
  /// Moves it to another pose than in the snapshot; not for a part of a scene. The new pose is certain.
  void set_pose(std::uint32_t number, const Pose& pose);

 private:
  struct Member {
    std::shared_ptr<const ObjectInfo> info;
    std::shared_ptr<const StaticScene> scene;  // for a part; else null
    Pose pose;
    Placed placed;
    Aabb reach;
    bool is_stale = false;
    RuleFit rule_fit;
  };

  void add_part(Member& member);

  const Snapshot& snapshot_;
  PartMeshes& part_meshes_;
  std::deque<Member> members_;  // a deque, since pointers refer to the poses
};

}  // namespace collided::engine
