#include "server/exact_phase/given/given_overlap.hpp"

#include "server/exact_phase/distance/polytope_kernel.hpp"
#include "server/exact_phase/distance/witnesses.hpp"
#include "server/exact_phase/given/exact_placing.hpp"
#include "server/exact_phase/kernels/straight_motion.hpp"
#include "server/exact_phase/part_convex.hpp"
#include "server/exact_phase/round_solids/axial_exact.hpp"
#include "server/exact_phase/round_solids/ellipsoid_exact.hpp"
#include "server/exact_phase/round_solids/refined_search.hpp"
#include "server/exact_phase/round_solids/round_pair.hpp"
#include "server/geometry/mesh.hpp"
#include "server/geometry/placing_error.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine {
namespace {

using kernel::ExactSolid;
using Point = kernel::Vector<Dyadic>;

/// Pose of parts given in world coordinates.
const Pose kNowhere;

const Pose& pose_of(const GivenPart& part) { return part.pose != nullptr ? *part.pose : kNowhere; }

/// As it was given, in its own frame.
ConvexPart own_part(const ConvexPart& in_world, const GivenPart& given) {
  if (const auto* triangle = std::get_if<Triangle>(&given.own)) return *triangle;
  if (const auto* const* own = std::get_if<const Primitive*>(&given.own)) return **own;
  return in_world;
}

/// The part in double, relative to a place nearby, so that coordinates are small and placing rounds little.
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
  double a_off_m = 0;  // how far points of `a` are from those of its exact form

  /// The origin for the comparison. A hull in world coordinates is not moved.
  Vec3 place() const {
    const auto is_hull = [](const ConvexPart& part) {
      const auto* primitive = std::get_if<Primitive>(&part);
      return primitive != nullptr && std::holds_alternative<Hull>(*primitive);
    };
    if (&pose_a == &kNowhere) return is_hull(a) ? Vec3::Zero() : pose_b.position;
    return &pose_b == &kNowhere && is_hull(b) ? Vec3::Zero() : pose_a.position;
  }
};

/// Both sets in double and exactly, relative to `place`.
struct NearPair {
  SeenNear near_a;
  SeenNear near_b;
  kernel::Convex a;
  kernel::Convex b;

  explicit NearPair(const OwnPair& own)
      : near_a(own.a, own.pose_a, own.place()),
        near_b(own.b, own.pose_b, own.place()),
        a(convex_of(near_a.part)),
        b(convex_of(near_b.part)) {
    near_a.off_m += own.a_off_m;
  }
};

/// A plane between the two or a point of both, found by a search in double and tested exactly. `to_exact` converts a
/// point of the search to the coordinates of the solids.
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

/// Extends a set to what it sweeps during a translation; false if that has no form here.
bool extend(ExactSolid& set, const Point& displacement) {
  if (is_round(set)) return false;
  const auto count = static_cast<std::uint32_t>(set.points.size());
  for (std::uint32_t i = 0; i < count; ++i) set.points.push_back(set.points[i] + displacement);
  if (set.kind == ExactSolid::Kind::ball) set.kind = ExactSolid::Kind::capsule;
  if (!set.border) return true;
  // The features at both ends, and what corners and edges sweep; those that lie inside do no harm.
  const kernel::FlatBorder begin = *set.border;
  for (const auto& [from, to] : begin.edges) {
    set.border->edges.push_back({from + count, to + count});
    set.border->faces.push_back({{from, to, to + count, from + count}, 4});
  }
  for (std::uint32_t i = 0; i < count; ++i) set.border->edges.push_back({i, i + count});
  for (kernel::FlatBorder::Face face : begin.faces) {
    for (std::uint32_t& corner : face.corner) corner += count;
    set.border->faces.push_back(face);
  }
  set.border->is_solid = true;
  return true;
}

/// One of two parts in relative motion: in world coordinates at its beginning, and the error of that.
struct BeginPart {
  const ConvexPart& placed;
  const GivenPart& given;
  Vec3 way_m;  // relative to the other part
};

/// `swept` is what the first part sweeps; the second one is at rest, in its own frame.
Decision swept_meets(const ExactSolid& swept, const BeginPart& begin, const ExactSolid& other,
                     const ConvexPart& other_own, const Pose& other_pose, const Dyadic& scale) {
  using Kind = ExactSolid::Kind;
  if (!is_round(other)) return kernel::hulls_meet(swept.points, other.points, swept.radius + other.radius);
  if (swept.kind == Kind::capsule && swept.points.size() == 2) {
    const Sphere& ball = std::get<Sphere>(std::get<Primitive>(begin.placed));
    const Capsule rounded{ball.center, ball.center + begin.way_m, ball.radius_m};
    const double off_m = begin.given.placing_error_m(0) + 8 * kRoundoff * (ball.center.norm() + begin.way_m.norm());
    return meets(swept, other, {Primitive(rounded), other_own, kNowhere, other_pose, off_m}, scale);
  }
  Decision by_algebra = Decision::undecided;
  if (swept.kind == Kind::flat && other.kind == Kind::ellipsoid)
    by_algebra = kernel::ellipsoid_meets_hull(other, swept.points);
  else if (swept.kind == Kind::flat && swept.border) by_algebra = kernel::axial_meets_border(other, swept);
  return by_algebra != Decision::undecided ? by_algebra : kernel::refined_meet(swept, other);
}

/// The part is lowest at one end of its path.
Decision comes_to(const Ground& ground, ExactSolid part, const Point& displacement) {
  const Decision at_begin = meets(ground, part);
  if (at_begin != Decision::no) return at_begin;
  for (Point& point : part.points) point = point + displacement;
  return meets(ground, part);
}

}  // namespace

Decision overlaps_as_given(const ConvexPart& placed_a, const ConvexPart& placed_b, const GivenPair& given) {
  return overlaps_as_given(placed_a, placed_b, given, {});
}

Decision overlaps_as_given(const ConvexPart& placed_a, const ConvexPart& placed_b, const GivenPair& given,
                           const kernel::StraightMotion& motion) {
  const OwnPair own{own_part(placed_a, given.a), own_part(placed_b, given.b), pose_of(given.a), pose_of(given.b)};
  const Dyadic scale_a = square_norm(own.pose_a.rotation);
  const Dyadic scale_b = square_norm(own.pose_b.rotation);
  const Dyadic scale = scale_a * scale_b;
  ExactPart a = exactly_placed(own.a, own.pose_a, scale_b, own.b);
  ExactPart b = exactly_placed(own.b, own.pose_b, scale_a, own.a);
  const Point displacement = scale * motion.displacement<Dyadic>();
  auto* solid_a = std::get_if<ExactSolid>(&a);
  auto* solid_b = std::get_if<ExactSolid>(&b);
  if (solid_a == nullptr && solid_b == nullptr) return Decision::undecided;
  if (solid_b == nullptr) return comes_to(std::get<Ground>(b), std::move(*solid_a), displacement);
  if (solid_a == nullptr) return comes_to(std::get<Ground>(a), std::move(*solid_b), -displacement);
  if (displacement.x.sign() == 0 && displacement.y.sign() == 0 && displacement.z.sign() == 0)
    return meets(*solid_a, *solid_b, own, scale);
  const Vec3 way_m = motion.until * ((motion.to_a - motion.from_a) - (motion.to_b - motion.from_b));
  // Moving a relative to b is moving b back relative to a.
  if (extend(*solid_a, displacement))
    return swept_meets(*solid_a, {placed_a, given.a, way_m}, *solid_b, own.b, own.pose_b, scale);
  if (extend(*solid_b, -displacement))
    return swept_meets(*solid_b, {placed_b, given.b, -way_m}, *solid_a, own.a, own.pose_a, scale);
  return Decision::undecided;
}

Decision overlaps_as_given(const RaySegment& segment, const ConvexPart& placed, const GivenPart& given) {
  const Ray& ray = segment.ray;
  const Capsule rounded{ray.origin + segment.from * ray.direction, ray.origin + segment.to * ray.direction, 0};
  const double size_m = ray.origin.norm() + std::max(segment.from, segment.to) * ray.direction.stableNorm();
  const OwnPair own{Primitive(rounded), own_part(placed, given), kNowhere, pose_of(given), 4 * kRoundoff * size_m};
  const Dyadic scale = square_norm(own.pose_b.rotation);
  const ExactPart b = exactly_placed(own.b, own.pose_b, Dyadic(1.0), own.a);
  ExactSolid line;
  for (const double s : {segment.from, segment.to})
    line.points.push_back(scale * (Point(ray.origin) + Dyadic(s) * Point(ray.direction)));
  line.border.emplace().edges.push_back({0, 1});
  const auto* solid = std::get_if<ExactSolid>(&b);
  return solid != nullptr ? meets(line, *solid, own, scale) : meets(std::get<Ground>(b), line);
}

}  // namespace collided::engine
