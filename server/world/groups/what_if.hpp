#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "server/world/groups/bounds_tree.hpp"
#include "server/world/groups/clearance.hpp"

namespace collided::engine {

/// An object that moves along with another: where that one goes, it keeps its place relative to it.
struct Attachment {
  ObjectId child = 0;
  ObjectId parent = 0;
};

/// Which objects are to be thought elsewhere, and against what.
struct WhatIfAsk {
  std::vector<ObjectId> moved;
  std::vector<Attachment> attached;     // parents are among the moved, or children of earlier ones
  std::vector<ObjectId> against;        // further objects, where they are
  std::vector<ObjectId> left_out = {};  // of the moved and attached: they go along, but no pair of theirs counts
  double within_m = std::numeric_limits<double>::infinity();  // pairs surely farther apart are not looked at
  bool depth = false;          // the deepest contact, with its depth; else any contact ends a configuration's search
  bool with_filtered = false;  // also pairs whose filters let them pass through each other
};

/// What one configuration comes to.
struct WhatIfAnswer {
  Decision touches = Decision::no;
  bool is_late = false;  // the deadline was over: not looked at
  // The least clearance within the distance asked for. Without depth a pair that touches has no more than its names and
  // an endless bound.
  std::optional<MemberPair> nearest;
  // Where the answer reaches out of the space in which the loaded geometry was said to be complete: then it is undecided,
  // not free.
  std::optional<Vec3> uncovered = {};
};

/// One state of the world in which some objects are put elsewhere, again and again: each configuration is answered for
/// itself, and the world is as it was. Pairs of two objects of which neither is moved are in no answer.
///
/// owner    keeps the snapshot; the part meshes must outlive it
/// cost     a configuration: a tree over what is moved, then best first over pairs of it with the rest; the pair that was
///          nearest in the configuration before comes first, since the next is often much like it
/// threads  one at a time
class WhatIf {
 public:
  WhatIf(std::shared_ptr<const Snapshot> snapshot, const WhatIfAsk& ask, PartMeshes& part_meshes);

  /// poses  one for each of WhatIfAsk::moved
  WhatIfAnswer at(std::span<const Pose> poses, Deadline& deadline);
  const Snapshot& snapshot() const { return *snapshot_; }
  std::size_t moved_count() const { return pose_count_; }

 private:
  struct CarriedMember {
    std::uint32_t parent;  // a moved member
    Pose in_parent;
  };
  struct NearestYet {
    WhatIfAnswer answer;
    std::uint32_t a = 0;
    std::uint32_t b = 0;
  };

  void add_followers(const WhatIfAsk& ask);
  void place_all(std::span<const Pose> poses);
  double limit_m(const NearestYet& yet) const;
  void look_at_covers(WhatIfAnswer& answer) const;
  bool is_left_out(std::uint32_t member) const { return member < first_rest_ && left_out_[member] != 0; }
  /// False: the search may end.
  bool look_at(std::uint32_t a, std::uint32_t b, NearestYet& yet, Deadline& deadline);

  std::shared_ptr<const Snapshot> snapshot_;
  double within_m_;
  bool depth_;
  bool with_filtered_;
  bool has_unknown_;  // space; without it none is looked for at each configuration
  Members members_;
  std::size_t pose_count_;  // members whose poses are given come first, then followers, then the rest
  std::vector<CarriedMember> followers_;
  std::vector<Pose> poses_;  // of all that move
  std::vector<Aabb> moved_reaches_;
  std::vector<char> left_out_;  // by member, of those that move
  std::optional<BoundsTree> rest_;
  std::uint32_t first_rest_ = 0;
  std::optional<std::pair<std::uint32_t, std::uint32_t>> nearest_before_;
};

}  // namespace collided::engine
