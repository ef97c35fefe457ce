#include "server/exact_phase/round_solids/ellipsoid_exact.hpp"

#include <array>

#include "server/exact_phase/arithmetic/real_root.hpp"
#include "server/exact_phase/distance/polytope_kernel.hpp"
#include "server/exact_phase/round_solids/plane_conics.hpp"

namespace collided::engine::kernel {
namespace {

using Point = Vector<Dyadic>;

/// {x : |row . (x - center)| <= size}, with the three products as coordinates of one vector.
struct StretchedBall {
  Point row[3];
  Dyadic size;

  explicit StretchedBall(const ExactSolid& set) {
    if (set.kind != ExactSolid::Kind::ellipsoid) {
      for (int i = 0; i < 3; ++i) row[i] = Point(Vec3(Vec3::Unit(i)));
      size = set.radius;
      return;
    }
    // By Cramer's rule: everything is multiplied by the determinant of the three half axes.
    for (std::size_t i = 0; i < 3; ++i) row[i] = cross(set.half[(i + 1) % 3], set.half[(i + 2) % 3]);
    size = abs(dot(set.half[0], row[0]));
  }

  bool has_extent() const { return size.finite() && size.sign() > 0; }
  Point seen(const Point& x) const { return {dot(row[0], x), dot(row[1], x), dot(row[2], x)}; }
};

using Quadric = std::array<std::array<Dyadic, 4>, 4>;

/// (x, 1) Q (x, 1) is negative inside. `center` is relative to the same origin as x.
Quadric quadric_of(const StretchedBall& ball, const Point& center) {
  const Point own = ball.seen(center);
  // Columns of the linear map that takes (x, 1) to the ball's coordinates.
  const std::array<Point, 4> column{Point{ball.row[0].x, ball.row[1].x, ball.row[2].x},
                                    Point{ball.row[0].y, ball.row[1].y, ball.row[2].y},
                                    Point{ball.row[0].z, ball.row[1].z, ball.row[2].z}, -own};
  Quadric q;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) q[i][j] = dot(column[i], column[j]);
  }
  q[3][3] = q[3][3] - ball.size * ball.size;
  return q;
}

/// det(x A + B), by minors of two rows each (Laplace).
ExactRayPolynomial characteristic(const Quadric& a, const Quadric& b) {
  const auto entry = [&](std::size_t i, std::size_t j) { return ExactRayPolynomial(b[i][j], a[i][j]); };
  const auto minor = [&](std::size_t row, std::size_t i, std::size_t j) {
    return entry(row, i) * entry(row + 1, j) - entry(row, j) * entry(row + 1, i);
  };
  // Pairs of columns, the remaining pairs, and the sign of the permutation.
  constexpr std::size_t kPairs[6][4] = {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2},
                                        {1, 2, 0, 3}, {1, 3, 0, 2}, {2, 3, 0, 1}};
  constexpr bool kIsEven[6] = {true, false, true, true, false, true};
  ExactRayPolynomial sum;
  for (std::size_t i = 0; i < 6; ++i) {
    const auto& [p, q, r, s] = kPairs[i];
    const ExactRayPolynomial product = minor(0, p, q) * minor(2, r, s);
    sum = kIsEven[i] ? sum + product : sum - product;
  }
  sum.trim();
  return sum;
}

}  // namespace

/// The plane cuts the ellipsoid in an ellipse, touches it in a point or misses it.
Decision ellipsoid_meets_disc(const ExactSolid& ellipsoid, const ExactSolid& cylinder, int end) {
  const StretchedBall ball(ellipsoid);
  const AcrossAxis plane(cylinder, end);
  const Point center = plane.from - ellipsoid.points[0];
  if (!ball.has_extent() || !plane.is_usable() || !square(center).finite()) return Decision::undecided;
  const Point column[3] = {ball.seen(plane.u), ball.seen(plane.v), ball.seen(center)};
  Conic section;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) section[i][j] = dot(column[i], column[j]);
  }
  section[2][2] = section[2][2] - ball.size * ball.size;
  // The plane's squared distance from the centre, in the coordinates in which the ellipsoid is a ball, times normal^2.
  const Point normal = cross(column[0], column[1]);
  const Dyadic height = dot(normal, column[2]);
  const int room = (ball.size * ball.size * square(normal) - height * height).sign();
  if (room < 0) return Decision::no;
  if (room > 0) return ellipses_meet(section, disc_in_shares(plane));
  // The point of contact, with s and t as quotients over the square of the normal's square.
  const Dyadic nn = square(normal);
  const Point to_touch = height * normal - nn * column[2];
  const Dyadic s = dot(cross(to_touch, column[1]), normal);
  const Dyadic t = dot(cross(column[0], to_touch), normal);
  const Dyadic reach = plane.radius * (nn * nn);
  return (s * s * square(plane.u) + t * t * square(plane.v) - reach * reach).sign() <= 0 ? Decision::yes : Decision::no;
}

/// Their projections along the axis are an ellipse and a disc.
Decision ellipsoid_meets_endless(const ExactSolid& ellipsoid, const ExactSolid& cylinder) {
  const AcrossAxis plane(cylinder, 0);
  const Point center = ellipsoid.points[0] - plane.from;
  if (!StretchedBall(ellipsoid).has_extent() || !plane.is_usable() || !square(center).finite())
    return Decision::undecided;
  Dyadic uu, uv, vv;
  for (const Point& half : ellipsoid.half) {
    const Dyadic along_u = dot(plane.u, half);
    const Dyadic along_v = dot(plane.v, half);
    uu = uu + along_u * along_u;
    uv = uv + along_u * along_v;
    vv = vv + along_v * along_v;
  }
  // {y : (y - c) (G G^T)^-1 (y - c) <= 1}, times the determinant.
  const Dyadic cu = dot(plane.u, center);
  const Dyadic cv = dot(plane.v, center);
  const Dyadic at_u = vv * cu - uv * cv;
  const Dyadic at_v = uu * cv - uv * cu;
  Conic shadow;
  shadow[0][0] = vv;
  shadow[0][1] = shadow[1][0] = -uv;
  shadow[1][1] = uu;
  shadow[0][2] = shadow[2][0] = -at_u;
  shadow[1][2] = shadow[2][1] = -at_v;
  shadow[2][2] = cu * at_u + cv * at_v - (uu * vv - uv * uv);
  return ellipses_meet(shadow, disc_in_products(plane));
}

Decision ellipsoid_meets_flat(const Convex& ellipsoid, const Convex& flat, const StraightMotion* motion) {
  return ellipsoid_meets_hull(
      ExactSolid(ellipsoid),
      motion == nullptr ? corners_of(flat) : corners_swept(flat, motion->turned().displacement<Dyadic>()));
}

Decision ellipsoid_meets_hull(const ExactSolid& ellipsoid, const std::vector<Point>& corners) {
  const StretchedBall ball(ellipsoid);
  if (!ball.has_extent()) return Decision::undecided;
  std::vector<Point> seen;
  for (const Point& corner : corners) seen.push_back(ball.seen(corner - ellipsoid.points[0]));
  return hull_meets_ball(seen, ball.size);
}

Decision ellipsoids_meet(const ExactSolid& a, const ExactSolid& b) {
  const StretchedBall ball_a(a);
  const StretchedBall ball_b(b);
  const Point between = b.points[0] - a.points[0];
  if (!ball_a.has_extent() || !ball_b.has_extent() || !square(between).finite()) return Decision::undecided;
  const Quadric of_a = quadric_of(ball_a, Point(Vec3(Vec3::Zero())));
  const RealRoots positive = roots_from_zero(characteristic(of_a, quadric_of(ball_b, between)));
  if (positive.roots.size() == 2) return Decision::no;
  return positive.complete ? Decision::yes : Decision::undecided;
}

}  // namespace collided::engine::kernel
