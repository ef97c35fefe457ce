#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "collided/codes.hpp"
#include "server/exact_phase/manifold.hpp"
#include "server/exact_phase/overlap/triangle_crossing.hpp"
#include "server/exact_phase/proof.hpp"
#include "server/world/objects/contained.hpp"
#include "server/world/objects/deadline.hpp"
#include "server/world/objects/snapshot.hpp"
#include "server/world/query/part_pairs.hpp"

namespace collided::engine {

/// The verdict for the question whether they touch.
constexpr codes::Verdict verdict_of(Decision touches) {
  if (touches == Decision::undecided) return codes::Verdict::undecided;
  return touches == Decision::yes ? codes::Verdict::hit : codes::Verdict::miss;
}

/// Content of a pair report besides the answer.
struct PairAsk {
  // A proof of the answer.
  bool certificate = false;
  // All pairs of touching triangles of two meshes.
  bool triangles = false;
  std::uint32_t most_crossings = 10'000;
  std::int64_t deadline_ns = 0;                   // steady clock; 0: none
  const std::atomic<bool>* called_off = nullptr;  // when another thread sets it, the deadline counts as over
};

/// Two triangles that share a point, and the kind of what they share.
struct TriangleCrossing {
  std::uint32_t a = 0;
  std::uint32_t b = 0;
  Crossing crossing;
};

/// The relation of two objects. The order of naming them changes only the direction of the normal.
struct PairReport {
  Decision touches = Decision::no;
  // One of the two is stale: its publisher is lost and it may have moved on. `touches` is `no` only if neither can have
  // reached the other.
  bool is_stale = false;
  // The deadline ended the work: `touches` is undecided and nothing else is set.
  bool is_late = false;
  // If they touch: the contact of the deepest pair of parts, as in events. The depth of two meshes is that of two of
  // their triangles: the shortest translation that separates these, not the whole meshes.
  Contact contact;
  std::uint32_t a_triangle = kNoTriangle;
  std::uint32_t b_triangle = kNoTriangle;
  std::vector<ManifoldPoint> manifold;
  // If they do not touch:
  Separation separation;
  Contained contained = Contained::none;  // in a closed mesh, declared solid or not
  // For an object within a declared solid: the contact of the two, as in events, with its depth and the way out.
  std::optional<Contact> within;
  // If requested:
  std::vector<TriangleCrossing> crossings;  // ordered by (a, b); the first most_crossings
  std::uint64_t crossing_count = 0;         // number of all, which may exceed crossings.size()
  std::optional<Proof> proof;
  // The reason if there is no proof.
  std::string no_proof;
};

/// Reports on two objects of the snapshot; both must exist.
///
/// cost     that of the collision step's test, plus for separate objects a search for the nearest parts; proof and
/// triangles grow with their size
/// threads  any
PairReport report_pair(const Snapshot& snapshot, ObjectId a, ObjectId b, const PairAsk& ask);

// Steps of the report, each implemented in a file of its own. If the deadline ends one, its result is wrong.

/// The least distance between two objects that do not touch.
Separation distance_between(const Placed& a, const Placed& b, WalkCost& cost, Deadline& deadline);
/// Whether one object lies within the other's mesh, if that is closed; the two must not touch.
Contained containment(const Placed& a, const Placed& b, Deadline& deadline);
/// The contact of one object that lies within the other, normal from a to b; nothing if that is not a declared solid.
std::optional<Contact> contact_of_contained(const Placed& a, const Placed& b, Contained which);
/// At most four points for the contact, from all parts that touch along its normal.
///
/// met  the overlapping triangles of two meshes; null: search for the parts
std::vector<ManifoldPoint> manifold_of(const Placed& a, const Placed& b, const Contact& contact,
                                       const TrianglePairs* met, WalkCost& cost, Deadline& deadline);
/// A proof that the two touch, or that they do not; nothing if there is none, for the reason in `why_not`. It ignores
/// deadlines, since the number of parts that it takes is bounded.
std::optional<Proof> proof_of(const Placed& a, const Placed& b, bool touches, std::string& why_not, WalkCost& cost);

}  // namespace collided::engine
