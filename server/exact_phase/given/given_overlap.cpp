#include "server/exact_phase/given/given_overlap.hpp"

#include "server/exact_phase/distance/polytope_kernel.hpp"
#include "server/exact_phase/distance/witnesses.hpp"
#include "server/exact_phase/given/exact_placing.hpp"
#include "server/exact_phase/part_convex.hpp"
#include "server/exact_phase/round_solids/refined_search.hpp"
#include "server/exact_phase/round_solids/round_pair.hpp"
#include "server/geometry/mesh.hpp"
#include "server/geometry/placing_error.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine {
namespace {

using kernel::ExactSolid;
using Point = kernel::Vector<Dyadic>;

/// Of parts whose world coordinates are what was given.
const Pose kNowhere;

const Pose& pose_of(const GivenPart& part) { return part.pose != nullptr ? *part.pose : kNowhere; }

/// As it was given, in its own frame.
ConvexPart own_part(const ConvexPart& in_world, const GivenPart& given) {
  if (const auto* triangle = std::get_if<Triangle>(&given.own)) return *triangle;
  if (const auto* const* own = std::get_if<const Primitive*>(&given.own)) return **own;
  return in_world;
}

/// The part in double, seen from a place near to it, where coordinates are small and placing rounds little.
struct SeenNear {
  ConvexPart part;
  double off_m;

  SeenNear(const ConvexPart& own, const Pose& pose, const Vec3& from) {
    if (&pose == &kNowhere && from.isZero(0)) {
      part = own;
      off_m = 0;
      return;
    }
    const Vec3 to = pose.position - from;
    const Frame frame = frame_of({.position = to, .rotation = pose.rotation});
    std::visit(
        [&](const auto& shape) {
          part = place(frame, shape);
          off_m = placing_error_m(frame, shape) + 2 * kRoundoff * to.norm();
        },
        own);
  }
};

Decision meets(const Ground& ground, const ExactSolid& part) {
  const kernel::ReachAlong<Dyadic> reach = reach_along(part, -ground.normal, ground.point);
  const kernel::ReachAlong<Dyadic> plane{.part = {{Dyadic(), Dyadic(), Dyadic(1.0)}, {}}, .count = 1};
  return kernel::opposite(kernel::parted(reach, plane));
}

bool is_round(const ExactSolid& part) { return part.kind >= ExactSolid::Kind::axial; }

/// Two parts in their own frames, and their poses.
struct OwnPair {
  ConvexPart a;
  ConvexPart b;
  const Pose& pose_a;
  const Pose& pose_b;

  /// Where to look at them from. A hull in world coordinates is not placed anew.
  Vec3 place() const {
    const auto is_hull = [](const ConvexPart& part) {
      const auto* primitive = std::get_if<Primitive>(&part);
      return primitive != nullptr && std::holds_alternative<Hull>(*primitive);
    };
    if (&pose_a == &kNowhere) return is_hull(a) ? Vec3::Zero() : pose_b.position;
    return &pose_b == &kNowhere && is_hull(b) ? Vec3::Zero() : pose_a.position;
  }
};

/// Both sets in double and exactly, near `place`.
struct NearPair {
  SeenNear near_a;
  SeenNear near_b;
  kernel::Convex a;
  kernel::Convex b;

  explicit NearPair(const OwnPair& own)
      : near_a(own.a, own.pose_a, own.place()),
        near_b(own.b, own.pose_b, own.place()),
        a(convex_of(near_a.part)),
        b(convex_of(near_b.part)) {}
};

/// A plane between the two or a point of both, as a search in double finds them, tested exactly. `to_exact` takes
/// a point of the search to the coordinates of the solids.
template <class ToExact>
Decision certified(const ExactSolid& a, const ExactSolid& b, const NearPair& near, const ToExact& to_exact) {
  const kernel::Witnesses witnesses(near.a, near.b);
  for (const Vec3& n : witnesses.normal) {
    if (!n.isZero(0) && n.allFinite() && parted_along(Point(n), a, b) == Decision::yes) return Decision::no;
  }
  for (const Vec3& own : witnesses.point) {
    if (!own.allFinite()) continue;
    const Point point = to_exact(own);
    if (holds_point(a, point) == Decision::yes && holds_point(b, point) == Decision::yes) return Decision::yes;
  }
  return Decision::undecided;
}

Decision meets(const ExactSolid& a, const ExactSolid& b, const OwnPair& own, const Dyadic& scale) {
  if (!is_round(a) && !is_round(b)) return kernel::hulls_meet(a.points, b.points, a.radius + b.radius);
  const ExactSolid& flat = is_round(a) ? b : a;
  const ExactSolid& round = is_round(a) ? a : b;
  if (flat.kind == ExactSolid::Kind::flat && round.kind == ExactSolid::Kind::axial && !flat.border)
    return Decision::undecided;
  const NearPair near(own);
  const Point place(own.place());
  const Decision certain = certified(a, b, near, [&](const Vec3& point) { return scale * (Point(point) + place); });
  if (certain != Decision::undecided) return certain;
  const Decision by_algebra = kernel::round_sets_meet({a, near.a, near.near_a.off_m}, {b, near.b, near.near_b.off_m});
  return by_algebra != Decision::undecided ? by_algebra : kernel::refined_meet(a, b);
}

}  // namespace

Decision overlaps_as_given(const ConvexPart& placed_a, const ConvexPart& placed_b, const GivenPair& given) {
  const OwnPair own{own_part(placed_a, given.a), own_part(placed_b, given.b), pose_of(given.a), pose_of(given.b)};
  const Dyadic scale_a = square_norm(own.pose_a.rotation);
  const Dyadic scale_b = square_norm(own.pose_b.rotation);
  const ExactPart a = exactly_placed(own.a, own.pose_a, scale_b, own.b);
  const ExactPart b = exactly_placed(own.b, own.pose_b, scale_a, own.a);
  const auto* solid_a = std::get_if<ExactSolid>(&a);
  const auto* solid_b = std::get_if<ExactSolid>(&b);
  if (solid_a != nullptr && solid_b != nullptr) return meets(*solid_a, *solid_b, own, scale_a * scale_b);
  if (solid_a != nullptr) return meets(std::get<Ground>(b), *solid_a);
  if (solid_b != nullptr) return meets(std::get<Ground>(a), *solid_b);
  return Decision::undecided;
}

}  // namespace collided::engine
