#pragma once

#include "server/exact_phase/arithmetic/decision.hpp"
#include "server/geometry/implicit_surface.hpp"
#include "server/geometry/ray.hpp"

namespace collided::engine {

/// Relative width of a hit's bracket when nothing else is asked: eight neighbouring doubles at most.
inline constexpr double kBracketAsked = 0x1p-50;

/// Where a ray first meets an implicit surface.
struct ImplicitHit {
  double low = 0;  // the parameter is in [low, high]: the point is origin + parameter * direction
  double high = 0;
  double distance_m = 0;
  double distance_error_m = 0;  // |true distance - distance_m| at most
  Vec3 point = Vec3::Zero();
  double point_error_m = 0;

  /// The direction in which f grows, so out of f < 0, whichever way the ray comes; of length 1.
  /// singular   the gradient is exactly zero there (an apex, a crease, a surface written squared): there is none
  /// undecided  not told apart from that, or known too badly, within the precision allowed
  enum class Normal { known, singular, undecided };
  Normal normal_state = Normal::undecided;
  Vec3 normal = Vec3::Zero();
  double normal_error = 0;  // |true normal - normal| at most

  bool runs_along = false;  // f is zero all along the ray; this is its first point in the box
};

/// Whether the ray meets the surface in its box, exact for the given doubles; touching counts, so do both ends of the ray
/// and the box's faces. A surface, not a solid: a start inside is no hit. `hit` is filled on yes only.
///
/// relative_width  of the bracket at most, where double can tell so much apart; above 0
/// returns  undecided only where the thread's precision forbids rationals
/// cost     0.7 us (sphere) to 1.4 us (torus) where double decides, 25 to 65 us by rationals (implicit_bench); up to
/// milliseconds
///          for degree 8, more where exponents are hundreds apart. Half of a torus's hits climb for a bracket this narrow
/// threads  pure; allocates only on Level::rational
/// source   isolation by Descartes' rule in Bernstein form (Collins, Akritas, 1976; Lane, Riesenfeld, 1981), narrowing by
///          sign changes about a Newton guess
ExactResult cast_ray(const Ray& ray, const ImplicitSurface& surface, ImplicitHit& hit, double relative_width = kBracketAsked);

enum class Side : signed char { inside = -1, on = 0, outside = 1 };

/// The sign of f, exact for the given doubles; beyond the box everything is outside.
///
/// returns  yes but where the thread's precision forbids to go on; side is filled on yes only
/// threads  pure; allocates only on Level::rational
ExactResult side_of(const Vec3& point, const ImplicitSurface& surface, Side& side);

/// The same by rationals alone, without any filter.
ExactResult cast_ray_by_rationals(const Ray& ray, const ImplicitSurface& surface, ImplicitHit& hit,
                              double relative_width = kBracketAsked);

}  // namespace collided::engine
