#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

/// Why two objects touch or do not, in a form that can be checked without trusting whoever says it.
#pragma GCC visibility push(default)

namespace collided {

/// A convex set in world coordinates, by the doubles that the server decided about. What stands beside the points:
///   nothing     the hull of the points
///   ball        every point within radius_m of that hull
///   box         the points moved by sums u_k half_m[k] axes[k] with |u_k| <= 1; ellipsoid: with |u| <= 1
///   disc        two points, the second one and, unless tapers, the first about the middle of a disc of radius_m across
///               their line: a cylinder or a cone
///   half_space  everything x with axes[0] . (x - points[0]) <= 0
struct CertifiedPart {
  enum class Summand { nothing, ball, box, ellipsoid, disc, half_space };
  using Numbers = std::array<double, 3>;
  Summand summand = Summand::nothing;
  std::uint32_t triangle = 0xffffffff;  // its number in the object's mesh; 0xffffffff: no triangle
  std::vector<Numbers> points = {};
  double radius_m = 0;
  bool tapers = false;
  std::array<Numbers, 3> axes = {};
  Numbers half_m = {};
};

struct Certificate {
  /// The unevaluated sum of its doubles: an exact number.
  using Sum = std::vector<double>;
  /// How a point of the hull of a part's points is made of them: the index of a point and its weight, which is not below 0.
  using Mix = std::vector<std::pair<std::uint32_t, Sum>>;

  /// A step of the proof that the sets are apart. plane: every part of a in question lies where
  /// normal . (x - point) <= 0, every part of b where it is above 0. Else the parts of a (or b) in question are taken in
  /// two, those below number `at` and the others, and a proof of each follows.
  struct Step {
    enum class Kind { plane, split_a, split_b };
    Kind kind = Kind::plane;
    CertifiedPart::Numbers normal = {};
    CertifiedPart::Numbers point = {};
    std::uint32_t at = 0;
  };

  bool touches = false;
  std::vector<CertifiedPart> a = {};  // apart: all parts of the object; touching: the one that holds the point
  std::vector<CertifiedPart> b = {};
  std::vector<Step> steps = {};   // apart; each split is followed by the proof of its lower half, then of its upper
  std::array<Sum, 3> point = {};  // touching: the common point is point / divisor
  Sum divisor = {};
  Mix mix_a = {};  // touching: what of each part's points the common point stands beside
  Mix mix_b = {};
};

/// Whether the certificate proves what it says, decided by exact arithmetic of its own: true means that the sets of
/// points that `a` and `b` describe share the point (touches), or share none. It says nothing of whether `a` and `b` are
/// the objects that were asked about: their numbers are there to be compared. False also where a product of its numbers
/// leaves the range of double.
///
/// cost     a few microseconds for each part and step
/// threads  pure
/// source   Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates", 1997
bool proves(const Certificate& certificate);

}  // namespace collided

#pragma GCC visibility pop
