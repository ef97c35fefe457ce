#include "server/exact_phase/distance/ball_inside.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/exact_phase/arithmetic/number.hpp"
#include "server/exact_phase/arithmetic/triple.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine::kernel {
namespace {

/// Errors on a face with edges of at most E and corners of at most M, by largest coordinate, as for kSeparationError:
/// the normal is off by 8 u E^2 per coordinate (14 as a length), its product with a corner by 40 u E^2 M, the
/// difference of two of them by 80 and a rounding of 12. 128 covers each together with the roundings of the bound. No
/// unit.
/// At zero, ExactBallInside.HoldsWhatRationalsSay fails.
constexpr double kFaceError = 128 * kRoundoff;

/// Tests in plain double.
bool quickly_holds_ball(const Triple* corner, double radius_m) {
  const double largest = std::max({corner[0].largest(), corner[1].largest(), corner[2].largest(), corner[3].largest()});
  for (int skipped = 0; skipped < 4; ++skipped) {
    const Triple& p = corner[(skipped + 1) & 3];
    const Triple e = corner[(skipped + 2) & 3] - p;
    const Triple f = corner[(skipped + 3) & 3] - p;
    const Triple n = cross(e, f);
    const double edge = std::max(e.largest(), f.largest());
    const double error = kFaceError * edge * edge;
    const double of_face = dot(n, p);
    const double of_corner = dot(n, corner[skipped]) - of_face;
    // The origin must be on the corner's side of the plane, and far enough from it. Written so that NaN fails.
    const double inward = of_corner > 0 ? -of_face : of_face;
    const double length = std::sqrt(dot(n, n)) + error;
    if (!(std::abs(of_corner) > error * largest) ||
        !(inward - error * largest > radius_m * length * (1 + 8 * kRoundoff)))
      return false;
  }
  // In this range products of such lengths keep their digits.
  constexpr double kLargest = 0x1p300;  // up to it products of three stay in the range of double
  return largest < kLargest && largest > 1 / kLargest;
}

/// A lower bound on the radius of the ball around the origin that the tetrahedron contains; 0: unknown.
double ball_inside(const DifferencePoint* corner) {
  double least = std::numeric_limits<double>::infinity();
  for (int skipped = 0; skipped < 4; ++skipped) {
    const Vector<Bounded> p(corner[(skipped + 1) % 4].w);
    const Vector<Bounded> n =
        cross(Vector<Bounded>(corner[(skipped + 2) % 4].w) - p, Vector<Bounded>(corner[(skipped + 3) % 4].w) - p);
    const Bounded length = sqrt(square(n));
    const Bounded of_face = dot(n, p);
    const Bounded of_corner = dot(n, Vector<Bounded>(corner[skipped].w)) - of_face;
    // The origin must be on the corner's side of the plane.
    const Bounded inward = of_corner.value > 0 ? -of_face : of_face;
    if (!(std::abs(of_corner.value) > of_corner.bound()) || length.exactly_zero()) return 0;
    const double depth = (inward / length).low();
    if (!(depth > 0)) return 0;
    least = std::min(least, depth);
  }
  return least;
}

}  // namespace

bool surely_holds_ball(const DifferencePoint* corner, double radius_m) {
  const Triple plain[4] = {triple(corner[0].w), triple(corner[1].w), triple(corner[2].w), triple(corner[3].w)};
  return quickly_holds_ball(plain, radius_m) || ball_inside(corner) > radius_m;
}

}  // namespace collided::engine::kernel
