#include "server/exact_phase/distance/general_shapes.hpp"

#include <algorithm>
#include <cmath>

#include "server/exact_phase/distance/convex_pair.hpp"
#include "server/exact_phase/distance/polytope_kernel.hpp"
#include "server/exact_phase/kernels/membership_kernel.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine {
namespace {

using kernel::Convex;
using kernel::ConvexPair;

/// Whether the shape contains the point, by the ladder.
ExactResult holds(const ShapeView& view, const Vec3& point) {
  return std::visit(
      [&](const auto* shape) {
        if constexpr (std::is_same_v<decltype(shape), const Hull*>) {
          return ExactResult{kernel::polytopes_meet(Convex(Sphere{point, 0}), Convex(*shape)), Level::rational};
        } else {
          return kernel::climb([&]<class N>() { return kernel::holds_point<N>(*shape, point); });
        }
      },
      view);
}

/// The exact test of a common point that convex_pair.hpp requires.
struct BothHold {
  const ShapeView& a;
  const ShapeView& b;

  ExactResult operator()(const Vec3& point) const {
    const ExactResult held = holds(a, point);
    if (!held.yes()) return held;
    const ExactResult b_held = holds(b, point);
    return {b_held.decision, std::max(held.level, b_held.level)};
  }
};

/// Whether the shape contains the point, by rationals alone.
Decision surely_holds(const ShapeView& view, const Vec3& point) {
  return std::visit(
      [&](const auto* shape) {
        if constexpr (std::is_same_v<decltype(shape), const Hull*>) {
          return kernel::polytopes_meet(Convex(Sphere{point, 0}), Convex(*shape));
        } else {
          return kernel::holds_point<Dyadic>(*shape, point);
        }
      },
      view);
}

}  // namespace

kernel::Convex convex(const ShapeView& view) {
  return std::visit([](const auto* shape) { return Convex(*shape); }, view);
}

ExactResult overlaps_in_general(const ShapeView& a, const ShapeView& b) {
  const BothHold both_hold{a, b};
  const ExactResult verdict = kernel::sets_overlap({convex(a), convex(b), both_hold});
  if (verdict.decision != Decision::undecided) return verdict;
  // Tries both orders, so that the answer does not depend on the order of the request.
  return kernel::sets_overlap({convex(b), convex(a), both_hold});
}

Decision overlaps_by_rationals(const ShapeView& a, const ShapeView& b) {
  const auto both_hold = [&](const Vec3& point) {
    return ExactResult{kernel::both(surely_holds(a, point), surely_holds(b, point)), Level::rational};
  };
  return kernel::sets_overlap_by_rationals({convex(a), convex(b), both_hold});
}

Contact contact_in_general(const ShapeView& a, const ShapeView& b) {
  return kernel::contact_of({convex(a), convex(b), BothHold{a, b}});
}

Closest closest_in_general(const Vec3& point, const ShapeView& shape) {
  const Sphere at{point, 0};
  const ShapeView point_view = &at;
  const BothHold both_hold{shape, point_view};
  const ConvexPair pair{convex(shape), Convex(at), both_hold};
  if (kernel::sets_overlap(pair).yes()) return {0, 0, point, kernel::contact_of(pair).normal, 0};
  const Separation apart = kernel::separation_of(pair);
  Closest result{apart.distance_m, apart.error_m, apart.on_a, apart.normal};
  // If the nearest point of a convex set is at distance l or more, it is within sqrt(h^2 - l^2) of any point of the set
  // at distance h. With h and l one error off the distance, that is the root of 4 distance error; h - l itself would
  // cancel.
  const double distance = apart.distance_m;
  const double error = apart.error_m;
  const double within_m = distance > error ? 2 * std::sqrt(distance) * std::sqrt(error) : distance + error;
  result.point_error_m = within_m * (1 + kChainSlack) + apart.point_error_m;
  return result;
}

}  // namespace collided::engine
