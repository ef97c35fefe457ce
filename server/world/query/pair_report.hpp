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

/// Of "do they touch?", as it is answered.
constexpr codes::Verdict verdict_of(Decision touches) {
  if (touches == Decision::undecided) return codes::Verdict::undecided;
  return touches == Decision::yes ? codes::Verdict::hit : codes::Verdict::miss;
}

/// What a pair report should contain besides the answer.
struct PairAsk {
  // A proof for the answer.
  bool certificate = false;
  // Every pair of triangles that touch, of two meshes.
  bool triangles = false;
  std::uint32_t most_crossings = 10'000;
  std::int64_t deadline_ns = 0;                   // steady clock; 0: none
  const std::atomic<bool>* called_off = nullptr;  // once set by another thread, as if the deadline were over
};

/// Two triangles that share a point, and what they share.
struct TriangleCrossing {
  std::uint32_t a = 0;
  std::uint32_t b = 0;
  Crossing crossing;
};

/// How two objects stand to each other. The order of naming them changes nothing but the direction of the normal.
struct PairReport {
  Decision touches = Decision::no;
  // One of the two is stale: its publisher is lost and it may have moved on. `touches` is `no` only where neither can
  // have reached the other.
  bool is_stale = false;
  // The deadline was over before all was done: `touches` is undecided and nothing else is said.
  bool is_late = false;
  // For yes: the contact of the deepest pair of parts, as in events. The depth of two meshes is that of two of their
  // triangles: the shortest translation that separates these, not the whole meshes.
  Contact contact;
  std::uint32_t a_triangle = kNoTriangle;
  std::uint32_t b_triangle = kNoTriangle;
  std::vector<ManifoldPoint> manifold;
  // For no:
  Separation separation;
  Contained contained = Contained::none;  // in a closed mesh, declared solid or not
  // Of one that lies within a declared solid, its contact with it, as in events: how deep, and which way out.
  std::optional<Contact> within;
  // Where requested:
  std::vector<TriangleCrossing> crossings;  // ordered by (a, b); the first most_crossings
  std::uint64_t crossing_count = 0;         // of all there are, which may be more than crossings holds
  std::optional<Proof> proof;
  // Why there is no proof.
  std::string no_proof;
};

/// Reports on two objects of the snapshot; both must exist.
///
/// cost     that of the collision step's test, plus for separate objects a search for the nearest parts; proof and
/// triangles grow with their size
/// threads  any
PairReport report_pair(const Snapshot& snapshot, ObjectId a, ObjectId b, const PairAsk& ask);

// The report's parts, each implemented in a file of its own. Where the deadline ends one, what it returns is wrong.

/// The least distance between two objects that do not touch.
Separation distance_between(const Placed& a, const Placed& b, WalkCost& cost, Deadline& deadline);
/// Whether one object lies within the other's mesh, if that is closed; the two must not touch.
Contained containment(const Placed& a, const Placed& b, Deadline& deadline);
/// The contact of one object that lies within the other, normal from a to b; nothing where that is no declared solid.
std::optional<Contact> contact_of_contained(const Placed& a, const Placed& b, Contained which);
/// At most four points for the contact, from all parts that touch along its normal.
///
/// met  of two meshes: the triangles that overlap; null: look for the parts
std::vector<ManifoldPoint> manifold_of(const Placed& a, const Placed& b, const Contact& contact,
                                       const TrianglePairs* met, WalkCost& cost, Deadline& deadline);
/// A proof that the two touch, or that they do not; nothing: `why_not` says why there is none. It looks at
/// no deadline: the number of parts that it takes is bounded.
std::optional<Proof> proof_of(const Placed& a, const Placed& b, bool touches, std::string& why_not, WalkCost& cost);

}  // namespace collided::engine
