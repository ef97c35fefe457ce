#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "server/world/groups/bounds_tree.hpp"
#include "server/world/groups/clearance.hpp"

namespace collided::engine {

/// An object attached to another: it keeps its place relative to it when that one moves.
struct Attachment {
  ObjectId child = 0;
  ObjectId parent = 0;
};

/// Which objects are hypothetically elsewhere, and against which others they are tested.
struct WhatIfAsk {
  std::vector<ObjectId> moved;
  std::vector<Attachment> attached;     // parents are among the moved, or children of earlier ones
  std::vector<ObjectId> against;        // further objects, at their poses
  std::vector<ObjectId> left_out = {};  // moved or attached, but pairs with them do not count
  double within_m = std::numeric_limits<double>::infinity();  // pairs certainly farther apart are ignored
  bool depth = false;          // find the deepest contact; else any contact ends a configuration's search
  bool with_filtered = false;  // also pairs that filters let pass through each other
};

/// The result for one configuration.
struct WhatIfAnswer {
  Decision touches = Decision::no;
  bool is_late = false;  // the deadline was over: not examined
  // The least clearance within the requested distance. Without depth, a touching pair has only its names and an
  // infinite bound.
  std::optional<MemberPair> nearest;
  // A point at which the answer leaves the space stated to be complete; then it is undecided, not free.
  std::optional<Vec3> uncovered = {};
};

/// One state of the world in which some objects are moved hypothetically, any number of times: each configuration is
/// answered on its own, and the world does not change. Pairs of two unmoved objects are in no answer.
///
/// owner    keeps the snapshot; the part meshes must outlive it
/// cost     a configuration: a tree over the moved objects, then best first over their pairs with the rest; the nearest
///          pair of the previous configuration comes first, since the next is often similar
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
  /// False if the search may end.
  bool look_at(std::uint32_t a, std::uint32_t b, NearestYet& yet, Deadline& deadline);

  std::shared_ptr<const Snapshot> snapshot_;
  double within_m_;
  bool depth_;
  bool with_filtered_;
  bool has_unknown_;  // unknown space; without it no configuration searches for any
  Members members_;
  std::size_t pose_count_;  // members with given poses come first, then their children, then the rest
  std::vector<CarriedMember> followers_;
  std::vector<Pose> poses_;  // of all members that move
  std::vector<Aabb> moved_reaches_;
  std::vector<char> left_out_;  // by member, for those that move
  std::optional<BoundsTree> rest_;
  std::uint32_t first_rest_ = 0;
  std::optional<std::pair<std::uint32_t, std::uint32_t>> nearest_before_;
};

}  // namespace collided::engine
