#include "server/exact_phase/given/given_gap.hpp"

#include "server/exact_phase/distance/polytope_kernel.hpp"
#include "server/exact_phase/given/exact_placing.hpp"
#include "server/exact_phase/given/given_overlap.hpp"
#include "server/exact_phase/part_convex.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine {
namespace {

/// A part before exact placing: in its own frame with its pose, or in world coordinates without one.
struct UnplacedPart {
  ConvexPart own;
  Pose pose = {};

  UnplacedPart(const ConvexPart& placed, const GivenPart& given) : own(placed) {
    if (given.pose != nullptr) pose = *given.pose;
    if (const auto* triangle = std::get_if<Triangle>(&given.own)) own = *triangle;
    if (const auto* const* primitive = std::get_if<const Primitive*>(&given.own)) own = **primitive;
  }
};

bool has_corners_and_radius(const kernel::ExactSolid& solid) {
  using Kind = kernel::ExactSolid::Kind;
  return solid.kind == Kind::flat || solid.kind == Kind::ball || solid.kind == Kind::capsule;
}

Decision reaches(const Ground& ground, const kernel::ExactSolid& grown) {
  const kernel::ReachAlong<Dyadic> reach = reach_along(grown, -ground.normal, ground.point);
  const kernel::ReachAlong<Dyadic> plane{.part = {{Dyadic(), Dyadic(), Dyadic(1.0)}, {}}, .count = 1};
  return kernel::opposite(kernel::parted(reach, plane));
}

}  // namespace

double GapLimit::high_m() const { return (gap_m + more_m) * (1 + 2 * kRoundoff); }
double GapLimit::low_m() const { return (gap_m + more_m) * (1 - 2 * kRoundoff); }

Decision within_as_given(const ConvexPart& placed_a, const ConvexPart& placed_b, const GivenPair& given,
                         const GapLimit& limit) {
  const UnplacedPart first(placed_a, given.a);
  const UnplacedPart second(placed_b, given.b);
  const Dyadic scale_a = square_norm(first.pose.rotation);
  const Dyadic scale_b = square_norm(second.pose.rotation);
  ExactPart a = exactly_placed(first.own, first.pose, scale_b, second.own);
  ExactPart b = exactly_placed(second.own, second.pose, scale_a, first.own);
  const Dyadic limit_scaled = (Dyadic(limit.gap_m) + Dyadic(limit.more_m)) * (scale_a * scale_b);
  if (!limit_scaled.finite()) return Decision::undecided;
  auto* solid_a = std::get_if<kernel::ExactSolid>(&a);
  auto* solid_b = std::get_if<kernel::ExactSolid>(&b);
  for (kernel::ExactSolid* solid : {solid_a, solid_b}) {
    if (solid != nullptr && !has_corners_and_radius(*solid)) return Decision::undecided;
  }
  if (solid_a != nullptr && solid_b != nullptr)
    return kernel::hulls_meet(solid_a->points, solid_b->points, solid_a->radius + solid_b->radius + limit_scaled);
  kernel::ExactSolid* grown = solid_a != nullptr ? solid_a : solid_b;
  if (grown == nullptr) return Decision::undecided;
  grown->radius = grown->radius + limit_scaled;
  return reaches(std::get<Ground>(solid_a != nullptr ? b : a), *grown);
}

}  // namespace collided::engine
