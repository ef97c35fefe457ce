#pragma once

#include <atomic>
#include <functional>
#include <limits>
#include <vector>

#include "server/world/groups/members.hpp"
#include "server/world/groups/object_clearance.hpp"

namespace collided::engine {

/// A question about the pairs of two groups of objects: each of `from` with each of `to`, which may have objects in
/// common; every two objects are a pair once.
struct ClearanceAsk {
  std::vector<ObjectId> from;
  std::vector<ObjectId> to;
  double within_m = std::numeric_limits<double>::infinity();  // pairs surely farther apart are not told
  std::size_t most = 1;                                       // of the nearest pairs are told
  bool is_all_else = false;      // `to` is all that there is: what is near `from` and not covered counts, too
  bool with_filtered = false;    // also pairs whose filters let them pass through each other
  bool certificates = false;     // a proof for each pair that is told
  std::int64_t deadline_ns = 0;  // steady clock; 0: none
  // called now and then, at most ten times a second, with the fraction of the pairs that were looked at, at least
  std::function<void(double)> progress = {};
  const std::atomic<bool>* called_off = nullptr;  // once set by another thread, as if the deadline were over
};

/// One pair of a group question's answer; the clearance's `a` is of `from`.
struct MemberPair {
  ObjectId a = 0;
  ObjectId b = 0;
  bool is_stale = false;  // one of them is where a lost publisher said last
  ObjectClearance clearance;
  // Where requested:
  std::optional<Proof> proof = {};
  std::string no_proof = {};  // why there is none
};

/// The nearest pairs of two groups in one state.
struct GroupClearance {
  // Whether any pair touches; undecided where that is open of one and no other surely does, or at the deadline.
  Decision touches = Decision::no;
  std::vector<MemberPair> pairs;  // least clearance first
  bool is_cut = false;            // more are within the distance asked for than were to be told
  bool is_late = false;           // the deadline was over: some pairs were not looked at
  // An object of a lost publisher may by now be in a pair that is nearer than the last one told.
  bool is_stale = false;
  // Where ClearanceAsk::is_all_else: a point nearer than the last pair told, or the distance asked for, in which the
  // loaded geometry is not said to be complete. Then a nearer pair may be missing, and nothing is called apart.
  std::optional<Vec3> uncovered = {};
  std::uint64_t filtered =
      0;                     // pairs near enough to be told that were left out, since they may pass through each other
  std::uint64_t tested = 0;  // pairs whose parts were looked at
};

/// Answers on one snapshot, in which all objects must exist; those without parts are in no pair.
///
/// cost     a tree over each group's bounds; then best first over pairs of them, so that mostly few more pairs are
///          tested than are told
/// threads  any
GroupClearance clearance_of(const Snapshot& snapshot, const ClearanceAsk& ask, PartMeshes& part_meshes);

/// The clearance of two members, decided in the order of their names, so that it depends neither on the order of the
/// request nor on that in which a server met the objects.
std::optional<ObjectClearance> clearance_in_order(Members& members, std::uint32_t a, std::uint32_t b,
                                                  const ClearanceWanted& wanted, Deadline& deadline);

}  // namespace collided::engine
