#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "server/exact_phase/manifold.hpp"
#include "server/exact_phase/overlap/triangle_crossing.hpp"
#include "server/exact_phase/proof.hpp"
#include "server/world/objects/snapshot.hpp"
#include "server/world/query/part_pairs.hpp"

namespace collided::engine {

struct PairAsk {
  bool certificate = false;
  bool triangles = false;
  std::uint32_t most_crossings = 10'000;
};

/// Two triangles that share a point.
struct TriangleCrossing {
  std::uint32_t a = 0;
  std::uint32_t b = 0;
  Crossing crossing;
};

enum class Contained : std::uint8_t { none, a_in_b, b_in_a };

/// How two objects stand to each other. Told alike whichever is named first, but for the normal, which turns round.
struct PairReport {
  Decision touches = Decision::no;
  // One of the two is where it was heard of last, and moved then. Apart is said only where neither can have come to the other.
  bool is_stale = false;
  // yes: the deepest pair of parts, as the events tell it. A depth of two meshes is that of two of their triangles: the
  // shortest way that parts these, not the whole.
  Contact contact;
  std::uint32_t a_triangle = kNoTriangle;
  std::uint32_t b_triangle = kNoTriangle;
  std::vector<ManifoldPoint> manifold;
  // no
  Separation separation;
  Contained contained = Contained::none;
  // asked for
  std::vector<TriangleCrossing> crossings;  // by (a, b)
  std::uint64_t crossing_count = 0;         // all there are; more than told where cut
  std::optional<Proof> proof;
  std::string no_proof;
};

/// cost     that of the collision step's test, and for two that are apart of a search for the nearest parts; the proof and
///          the triangles what they are large
/// threads  any
PairReport report_pair(const Snapshot& snapshot, ObjectId a, ObjectId b, const PairAsk& ask);

// Its parts, each in a file of its own.

/// The least distance of two objects that do not touch.
Separation distance_between(const Placed& a, const Placed& b, WalkCost& cost);
/// Whether one lies within the other's mesh, where that is closed; they do not touch.
Contained containment(const Placed& a, const Placed& b);
/// At most four points for the contact, from all parts that bear on each other along its normal.
std::vector<ManifoldPoint> manifold_of(const Placed& a, const Placed& b, const Contact& contact, WalkCost& cost);
/// Why they touch, or that they do not; `why_not` says why there is none.
std::optional<Proof> proof_of(const Placed& a, const Placed& b, bool touches, std::string& why_not, WalkCost& cost);

}  // namespace collided::engine
