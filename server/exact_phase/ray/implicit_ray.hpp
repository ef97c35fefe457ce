#pragma once

#include "server/exact_phase/arithmetic/decision.hpp"
#include "server/geometry/implicit_surface.hpp"
#include "server/geometry/ray.hpp"

namespace collided::engine {

/// Default relative width of a hit's bracket: at most eight neighbouring doubles.
inline constexpr double kBracketAsked = 0x1p-50;

/// The point where a ray first meets an implicit surface f = 0.
struct ImplicitHit {
  double low = 0;  // the parameter is in [low, high]: the point is origin + parameter * direction
  double high = 0;
  double distance_m = 0;
  double distance_error_m = 0;  // bound on |true distance - distance_m|
  Vec3 point = Vec3::Zero();
  double point_error_m = 0;

  /// The direction in which f grows, so out of f < 0, regardless of the ray's direction; length 1.
  /// singular   the gradient is exactly zero there (an apex, a crease, a squared surface): there is no normal
  /// undecided  not distinguishable from that, or known too badly, within the allowed precision
  enum class Normal { known, singular, undecided };
  Normal normal_state = Normal::undecided;
  Vec3 normal = Vec3::Zero();
  double normal_error = 0;  // bound on |true normal - normal|

  bool runs_along = false;  // f is zero all along the ray; the hit is its first point in the box
};

/// Whether the ray meets the surface within its box, exact for the given doubles; touching counts, and so do both ends
/// of the ray and the box's faces. This is a surface, not a solid: a start inside is not a hit. Fills `hit` on yes
/// only.
///
/// relative_width  largest width of the bracket, if double can resolve it; above 0
/// returns  undecided only if the thread's precision forbids rationals
/// cost     0.7 us (sphere) to 1.4 us (torus) if double decides, 25 to 65 us by rationals (implicit_bench); up to
///          milliseconds for degree 8, more if exponents are hundreds apart. Half of a torus's hits need rationals for
///          a bracket this narrow
/// threads  pure; allocates only on Level::rational
/// source   isolation by Descartes' rule in Bernstein form (Collins, Akritas, 1976; Lane, Riesenfeld, 1981), narrowing
///          by sign changes around a Newton guess
ExactResult cast_ray(const Ray& ray, const ImplicitSurface& surface, ImplicitHit& hit,
                     double relative_width = kBracketAsked);

enum class Side : signed char { inside = -1, on = 0, outside = 1 };

/// The sign of f, exact for the given doubles; everything beyond the box is outside.
///
/// returns  yes, unless the thread's precision ends too early; fills side on yes only
/// threads  pure; allocates only on Level::rational
ExactResult side_of(const Vec3& point, const ImplicitSurface& surface, Side& side);

/// Decides by rationals alone, without any filter; for audits.
ExactResult cast_ray_by_rationals(const Ray& ray, const ImplicitSurface& surface, ImplicitHit& hit,
                                  double relative_width = kBracketAsked);

}  // namespace collided::engine
