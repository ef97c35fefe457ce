#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

/// Certificates: proofs that two objects touch or not, which can be checked without trusting the server.
#pragma GCC visibility push(default)

namespace collided {

/// A convex set in world coordinates, in metres, with exactly the doubles that the server used. `summand` defines how
/// it is made of the points:
///   nothing     their convex hull
///   ball        everything within radius_m of their hull
///   box         the points translated by all sums u_k half_m[k] axes[k] with |u_k| <= 1
///   ellipsoid   the same with |u| <= 1
///   disc        the hull of a cylinder's or cone's ends. There are two points: the second is the centre of a disc of
///               radius_m perpendicular to their line, and so is the first, unless the set tapers to it
///   half_space  every x with axes[0] . (x - points[0]) <= 0
struct CertifiedPart {
  enum class Summand { nothing, ball, box, ellipsoid, disc, half_space };
  using Numbers = std::array<double, 3>;
  Summand summand = Summand::nothing;
  std::uint32_t triangle = 0xffffffff;  // index in the object's mesh; 0xffffffff: not a triangle
  std::vector<Numbers> points = {};
  double radius_m = 0;               // of a ball or disc
  bool tapers = false;               // of a disc: a cone with its apex at the first point
  std::array<Numbers, 3> axes = {};  // of a box, ellipsoid or half-space
  Numbers half_m = {};               // of a box or ellipsoid
};

/// The proof itself. If `touches` is true: a point that lies in a part of each object. Otherwise: planes that separate
/// every part of the one object from every part of the other.
struct Certificate {
  /// An exact number: the unevaluated sum of its doubles.
  using Sum = std::vector<double>;
  /// A point in the hull of a part's points, as a convex combination: pairs of a point's index and its weight, which is
  /// not negative.
  using Mix = std::vector<std::pair<std::uint32_t, Sum>>;

  /// A step of the proof that two ranges of parts are apart; the first step is about all parts of both objects.
  /// plane             for every part of a in its range normal . (x - point) <= 0, for every part of b in its range it
  ///                   is above 0; these ranges are done
  /// split_a, split_b  the range of a (or b) is split into parts with numbers below `at` and the others; a proof of
  ///                   each follows
  struct Step {
    enum class Kind { plane, split_a, split_b };
    Kind kind = Kind::plane;
    CertifiedPart::Numbers normal = {};
    CertifiedPart::Numbers point = {};
    std::uint32_t at = 0;
  };

  bool touches = false;
  std::vector<CertifiedPart> a = {};  // apart: all parts of the object; touching: the part that contains the point
  std::vector<CertifiedPart> b = {};
  std::vector<Step> steps = {};   // apart: each split is followed by the proof of its lower half, then of its upper
  std::array<Sum, 3> point = {};  // touching: the common point is point / divisor
  Sum divisor = {};
  Mix mix_a = {};  // touching: a point in the hull of part a, from which the common point is reached by the summand
  Mix mix_b = {};
};

/// Checks whether the certificate is valid, by the library's own exact arithmetic.
///
/// returns  true: the point sets that `a` and `b` describe share the point (touches), or share no point. The caller
///          must check that `a` and `b` are the objects in question, by comparing their numbers. False also if a
///          product of the certificate's numbers leaves the range of double.
/// cost     a few microseconds for each part and step
/// threads  pure
/// source   Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates", 1997
bool proves(const Certificate& certificate);

}  // namespace collided

#pragma GCC visibility pop
