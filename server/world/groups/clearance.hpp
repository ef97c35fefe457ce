#pragma once

#include <atomic>
#include <functional>
#include <limits>
#include <vector>

#include "server/world/groups/members.hpp"
#include "server/world/groups/object_clearance.hpp"

namespace collided::engine {

/// A question about the pairs of two groups of objects: each of `from` with each of `to`. The groups may share objects;
/// every two objects are a pair once.
struct ClearanceAsk {
  std::vector<ObjectId> from;
  std::vector<ObjectId> to;
  double within_m = std::numeric_limits<double>::infinity();  // pairs certainly farther apart are not reported
  std::size_t most = 1;                                       // how many of the nearest pairs are reported
  bool is_all_else = false;      // `to` is everything else: uncovered space near `from` counts, too
  bool with_filtered = false;    // also pairs that filters let pass through each other
  bool certificates = false;     // a proof for each reported pair
  std::int64_t deadline_ns = 0;  // steady clock; 0: none
  // called now and then, at most ten times a second, with a lower bound on the fraction of pairs examined
  std::function<void(double)> progress = {};
  const std::atomic<bool>* called_off = nullptr;  // when another thread sets it, the deadline counts as over
};

/// One pair of a group question's answer; the clearance's `a` belongs to `from`.
struct MemberPair {
  ObjectId a = 0;
  ObjectId b = 0;
  bool is_stale = false;  // the pose of one of them is the last one of a lost publisher
  ObjectClearance clearance;
  // If requested:
  std::optional<Proof> proof = {};
  std::string no_proof = {};  // reason if there is none
};

/// The nearest pairs of two groups in one state.
struct GroupClearance {
  // Whether any pair touches; undecided if that is open for one and no other certainly does, or at the deadline.
  Decision touches = Decision::no;
  std::vector<MemberPair> pairs;  // least clearance first
  bool is_cut = false;            // more pairs are within the requested distance than requested
  bool is_late = false;           // the deadline was over: some pairs were not examined
  // An object of a lost publisher may by now be in a pair nearer than the last one reported.
  bool is_stale = false;
  // With ClearanceAsk::is_all_else: a point of space not stated to be complete, nearer than the last reported pair or
  // the requested distance. Then a nearer pair may be missing, and nothing is called apart.
  std::optional<Vec3> uncovered = {};
  std::uint64_t filtered = 0;  // near pairs left out, since they may pass through each other
  std::uint64_t tested = 0;    // pairs whose parts were tested
};

/// Answers on one snapshot, in which all objects must exist; those without parts are in no pair.
///
/// cost     a tree over each group's bounds; then best first over pairs of them, so that usually few more pairs are
///          tested than reported
/// threads  any
GroupClearance clearance_of(const Snapshot& snapshot, const ClearanceAsk& ask, PartMeshes& part_meshes);

/// The clearance of two members, decided in the order of their names, so that it depends neither on the order of the
/// request nor on the order in which a server received the objects.
std::optional<ObjectClearance> clearance_in_order(Members& members, std::uint32_t a, std::uint32_t b,
                                                  const ClearanceWanted& wanted, Deadline& deadline);

}  // namespace collided::engine
