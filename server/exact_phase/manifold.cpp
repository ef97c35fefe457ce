#include "server/exact_phase/manifold.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "server/exact_phase/arithmetic/value.hpp"
#include "server/exact_phase/part_convex.hpp"
#include "server/geometry/mesh.hpp"
#include "server/geometry/pose.hpp"

namespace collided::engine {
namespace {

using kernel::Vector;

/// The feature of a part that faces a direction: the corners of a polygon in order, the ends of a segment, a tip, or a
/// whole plane (no points). Depth is measured to the plane through `on` with normal `across`.
struct Feature {
  std::vector<Vec3> points;
  Vec3 on = Vec3::Zero();
  Vec3 across = Vec3::UnitZ();  // any length
  double slack_m = 0;           // bound on each coordinate's error of the points
};

/// A cap faces the other part if its axis is within 45 degrees of the normal, else the side does. Cosine of 45 degrees.
constexpr double kFacing = std::numbers::sqrt2 / 2;
/// Features smaller than this share of the size, seen along the normal, count as points. At zero Manifold.OfRoundShapes
/// fails (standing).
constexpr double kSeenAsPoint = 1e-6;
/// Corners of a hull this close to a plane, relative to its size, belong to one face, which rounding has bent.
/// At zero Manifold.AHullBearsAsItsBox fails.
constexpr double kSamePlane = 1e-9;
// Relative to the size squared, like the areas of the clip: points this far out are still on the border, since the
// border's own points are rounded when projected (a few 1e-16). A larger value does no harm, since the depth of each
// point is computed again.
constexpr double kProjectedSlack = 1e-12;
// Relative to the size of the patch: points this near count as one. It affects the choice of points, but no bound.
constexpr double kSamePoint = 1e-9;
constexpr int kRimPoints = 8;

/// The error of a feature's points: for corners and rims the rounding of at most six products and sums, for hulls that
/// of placing them; if a direction had to be normalised, that of a support point. Relative to size and position.
/// At zero, Manifold.TheDepthsOfTiltedBoxesAreWithinTheirBounds fails.
double slack_of(const ConvexPart& part) {
  if (half_space_of(part) != nullptr || std::holds_alternative<Triangle>(part)) return 0;
  const kernel::Convex set = convex_of(part);
  const bool has_directions = set.disc_m > 0 || set.ball_m > 0 || set.plus == kernel::Convex::Plus::ellipsoid;
  const double extent_m = set.carrier[0].cwiseAbs().maxCoeff() + set.reach_m + set.ball_m + set.disc_m;
  return (has_directions ? kSupportError : 8 * kRoundoff) * extent_m;
}

Feature tip(const Vec3& point, const Vec3& m) { return {.points = {point}, .on = point, .across = m}; }

/// A segment, with the plane that contains it and is otherwise perpendicular to m; seen end-on, a tip.
Feature segment(const Vec3& a, const Vec3& b, const Vec3& m) {
  const Vec3 along = b - a;
  const Vec3 across = along.squaredNorm() * m - along.dot(m) * along;
  if (!(along.cross(m).norm() > kSeenAsPoint * along.norm())) return tip(a.dot(m) > b.dot(m) ? a : b, m);
  return {.points = {a, b}, .on = a, .across = across / along.squaredNorm()};
}

Feature facing(const Sphere& s, const Vec3& m) { return tip(s.center + s.radius_m * m, m); }
Feature facing(const Capsule& c, const Vec3& m) { return segment(c.a + c.radius_m * m, c.b + c.radius_m * m, m); }
Feature facing(const Triangle& t, const Vec3& m) {
  const Vec3 across = (t.b - t.a).cross(t.c - t.a);
  if (across.isZero(0)) return tip(t.a, m);
  return {.points = {t.a, t.b, t.c}, .on = t.a, .across = across};
}
Feature facing(const HalfSpace& h, const Vec3&) { return {.points = {}, .on = h.point, .across = h.normal}; }

Feature facing(const Box& b, const Vec3& m) {
  int face = 0;
  for (int i = 1; i < 3; ++i) {
    if (std::abs(b.axes.col(i).dot(m)) > std::abs(b.axes.col(face).dot(m))) face = i;
  }
  const Vec3 u = b.half_m[(face + 1) % 3] * b.axes.col((face + 1) % 3);
  const Vec3 v = b.half_m[(face + 2) % 3] * b.axes.col((face + 2) % 3);
  const Vec3 middle = b.center + std::copysign(b.half_m[face], b.axes.col(face).dot(m)) * b.axes.col(face);
  const Vec3 across = Vec3(b.axes.col((face + 1) % 3)).cross(Vec3(b.axes.col((face + 2) % 3)));
  return {.points = {middle - u - v, middle + u - v, middle + u + v, middle - u + v}, .on = middle, .across = across};
}

Feature facing(const Ellipsoid& e, const Vec3& m) { return tip(e.center + kernel::Convex(e).support(m), m); }

/// Points on a disc's rim, starting at the farthest along m.
Feature rim(const Vec3& middle, const Vec3& axis, double radius_m, const Vec3& m) {
  Vec3 u = m - m.dot(axis) * axis;
  u = u.norm() > kSeenAsPoint ? Vec3(u.normalized()) : Vec3(axis.unitOrthogonal());
  const Vec3 v = axis.cross(u);
  Feature feature{.points = {}, .on = middle, .across = axis};
  for (int i = 0; i < kRimPoints; ++i) {
    const double turn = 2 * std::numbers::pi * i / kRimPoints;
    feature.points.push_back(middle + radius_m * (std::cos(turn) * u + std::sin(turn) * v));
  }
  return feature;
}

Feature facing(const Cylinder& c, const Vec3& m) {
  const Vec3 axis = (c.b - c.a).stableNormalized();
  const double cosine = axis.dot(m);
  if (std::abs(cosine) > kFacing) return rim(cosine > 0 ? c.b : c.a, axis, c.radius_m, m);
  const Vec3 out = c.radius_m * (m - cosine * axis).normalized();
  return segment(c.a + out, c.b + out, m);
}

Feature facing(const Cone& c, const Vec3& m) {
  const Vec3 axis = (c.base - c.apex).stableNormalized();
  const double cosine = axis.dot(m);
  if (cosine > kFacing) return rim(c.base, axis, c.radius_m, m);
  const Vec3 across = m - cosine * axis;
  if (!(across.norm() > kSeenAsPoint)) return tip(c.apex, m);
  return segment(c.apex, c.base + c.radius_m * across.normalized(), m);
}

/// Sorts corners by angle around the plane's normal.
void order_round(std::vector<Vec3>& corners, const Vec3& across) {
  Vec3 middle = Vec3::Zero();
  for (const Vec3& corner : corners) middle += corner / static_cast<double>(corners.size());
  const Vec3 u = across.unitOrthogonal();
  const Vec3 v = across.normalized().cross(u);
  const auto angle = [&](const Vec3& p) { return std::atan2(v.dot(p - middle), u.dot(p - middle)); };
  std::sort(corners.begin(), corners.end(), [&](const Vec3& a, const Vec3& b) { return angle(a) < angle(b); });
}

/// The face that points most along m, rebuilt from all vertices in its plane.
Feature facing(const Hull& h, const Vec3& m) {
  const Vec3 own = h.rotation.transpose() * m;
  double most = -2;
  Triangle face{};
  for (std::uint32_t i = 0; i < h.mesh->triangles.size(); ++i) {
    const Triangle t = h.mesh->triangle(i);
    const Vec3 out = (t.b - t.a).cross(t.c - t.a);
    const double cosine = out.dot(own) / std::max(out.norm(), std::numeric_limits<double>::min());
    if (cosine > most) face = t;
    most = std::max(most, cosine);
  }
  const Vec3 out = (face.b - face.a).cross(face.c - face.a).normalized();
  const double slack_m = kSamePlane * kernel::Convex(h).reach_m;
  const Frame frame{h.rotation, h.position};
  Feature feature{.points = {}, .on = place(frame, face.a), .across = h.rotation * out};
  for (const Vec3& vertex : h.mesh->vertices) {
    if (out.dot(vertex - face.a) > -slack_m) feature.points.push_back(place(frame, vertex));
  }
  feature.slack_m = slack_m;
  order_round(feature.points, feature.across);
  return feature;
}

Feature facing(const ConvexPart& part, const Vec3& m) {
  Feature feature = std::visit(
      [&](const auto& shape) {
        if constexpr (std::is_same_v<std::decay_t<decltype(shape)>, Triangle>) return facing(shape, m);
        else return std::visit([&](const auto& solid) { return facing(solid, m); }, shape);
      },
      part);
  feature.slack_m += slack_of(part);
  return feature;
}

/// Coordinates in the plane perpendicular to the normal.
struct Flat {
  double x;
  double y;
};

// Projects points along the normal.
struct Projection {
  Vec3 u;
  Vec3 v;
  Flat of(const Vec3& p, const Vec3& origin) const { return {u.dot(p - origin), v.dot(p - origin)}; }
};

double turn(const Flat& a, const Flat& b, const Flat& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// A point in space with its projection.
struct ProjectedPoint {
  Vec3 point;
  Flat seen;
};

/// The part of a polygon, segment or point to the left of the line from p to q.
std::vector<ProjectedPoint> clipped(const std::vector<ProjectedPoint>& corners, const Flat& p, const Flat& q,
                                    double slack) {
  std::vector<ProjectedPoint> kept;
  const std::size_t count = corners.size();
  const std::size_t edges = count == 2 ? 1 : count;
  const auto keep = [&](const ProjectedPoint& c) { kept.push_back(c); };
  if (count == 1) {
    if (turn(p, q, corners[0].seen) >= -slack) keep(corners[0]);
    return kept;
  }
  for (std::size_t i = 0; i < edges; ++i) {
    const ProjectedPoint& a = corners[i];
    const ProjectedPoint& b = corners[(i + 1) % count];
    const double at_a = turn(p, q, a.seen);
    const double at_b = turn(p, q, b.seen);
    if (at_a >= -slack) keep(a);
    if ((at_a < -slack && at_b > slack) || (at_a > slack && at_b < -slack)) {
      const double t = at_a / (at_a - at_b);
      keep({a.point + t * (b.point - a.point),
            {a.seen.x + t * (b.seen.x - a.seen.x), a.seen.y + t * (b.seen.y - a.seen.y)}});
    }
    if (edges == 1 && at_b >= -slack) keep(b);
  }
  return kept;
}

double area_of(const std::vector<ProjectedPoint>& polygon) {
  double twice = 0;
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
    twice += turn(polygon[0].seen, polygon[i].seen, polygon[i + 1].seen);
  return twice;
}

/// The part of a that lies over the polygon b.
std::vector<ProjectedPoint> shared(std::vector<ProjectedPoint> a, std::vector<ProjectedPoint> b, double size_m) {
  const double area = area_of(b);
  if (area < 0) std::reverse(b.begin(), b.end());
  const double slack = kProjectedSlack * size_m * size_m;
  for (std::size_t i = 0; i < b.size() && !a.empty(); ++i) a = clipped(a, b[i].seen, b[(i + 1) % b.size()].seen, slack);
  return a;
}

/// Parallel segments share a segment; others share a point, for which the contact's own is used.
std::vector<ProjectedPoint> shared_segments(const std::vector<ProjectedPoint>& a,
                                            const std::vector<ProjectedPoint>& b) {
  const Flat d{a[1].seen.x - a[0].seen.x, a[1].seen.y - a[0].seen.y};
  const Flat e{b[1].seen.x - b[0].seen.x, b[1].seen.y - b[0].seen.y};
  const double dd = d.x * d.x + d.y * d.y;
  const double ee = e.x * e.x + e.y * e.y;
  if (std::abs(d.x * e.y - d.y * e.x) > kSeenAsPoint * std::sqrt(dd * ee)) return {};
  const auto along = [&](const Flat& p) { return ((p.x - a[0].seen.x) * d.x + (p.y - a[0].seen.y) * d.y) / dd; };
  const double first = std::max(0.0, std::min(along(b[0].seen), along(b[1].seen)));
  const double last = std::min(1.0, std::max(along(b[0].seen), along(b[1].seen)));
  if (!(first < last)) return {};
  const auto at = [&](double t) {
    return ProjectedPoint{a[0].point + t * (a[1].point - a[0].point), {a[0].seen.x + t * d.x, a[0].seen.y + t * d.y}};
  };
  return {at(first), at(last)};
}

std::vector<ProjectedPoint> shared(const Feature& a, const Feature& b, const Vec3& normal) {
  const Projection view{normal.unitOrthogonal(), normal.cross(normal.unitOrthogonal())};
  const Vec3& origin = a.points.empty() ? b.on : a.points[0];
  double size_m = 0;
  const auto seen = [&](const Feature& feature) {
    std::vector<ProjectedPoint> corners;
    for (const Vec3& p : feature.points) corners.push_back({p, view.of(p, origin)});
    for (const ProjectedPoint& c : corners) size_m = std::max({size_m, std::abs(c.seen.x), std::abs(c.seen.y)});
    return corners;
  };
  const std::vector<ProjectedPoint> of_a = seen(a);
  const std::vector<ProjectedPoint> of_b = seen(b);
  if (of_a.empty()) return of_b;
  if (of_b.empty()) return of_a;
  if (of_a.size() == 1 || of_b.size() == 1) return {};
  if (of_a.size() == 2 && of_b.size() == 2) return shared_segments(of_a, of_b);
  return of_b.size() > 2 ? shared(of_a, of_b, size_m) : shared(of_b, of_a, size_m);
}

/// The height of the feature's plane over the point, along the normal.
Bounded height_over(const Feature& feature, const Vec3& point, const Vec3& normal) {
  const Vector<Bounded> across(feature.across);
  const Bounded slope = dot(across, Vector<Bounded>(normal));
  const Bounded height = dot(across, Vector<Bounded>(feature.on) - Vector<Bounded>(point)) / slope;
  // The plane goes through rounded points: its position is off by their slack, its tilt by the slack over their span.
  double span_m = 0;
  for (const Vec3& p : feature.points) span_m = std::max(span_m, (p - feature.on).norm());
  const double lever = span_m > 0 ? 1 + (point - feature.on).norm() / span_m : 1;
  const double tilt = std::abs(slope.value) / feature.across.norm();
  return {height.value, height.error + 2 * feature.slack_m * lever / tilt};
}

}  // namespace

void append_manifold(const ConvexPart& a, const ConvexPart& b, const Contact& contact, const Vec3& normal,
                     std::vector<ManifoldPoint>& points) {
  const std::size_t before = points.size();
  const bool two_triangles = std::holds_alternative<Triangle>(a) && std::holds_alternative<Triangle>(b);
  if (!two_triangles) {
    const Feature of_a = facing(a, normal);
    const Feature of_b = facing(b, -normal);
    for (const ProjectedPoint& corner : shared(of_a, of_b, normal)) {
      const Bounded top = height_over(of_a, corner.point, normal);
      const Bounded bottom = height_over(of_b, corner.point, normal);
      const Bounded depth = top - bottom;
      if (!(depth.value + depth.bound() >= 0)) continue;
      const double depth_m = std::max(depth.value, 0.0);
      points.push_back(
          {corner.point + (top.value + bottom.value) / 2 * normal, depth_m, depth.bound() + (depth_m - depth.value)});
    }
  }
  if (points.size() == before) points.push_back({contact.point, contact.depth_m, contact.depth_error_m});
}

namespace {

bool before_in_order(const ManifoldPoint& a, const ManifoldPoint& b) {
  return std::lexicographical_compare(a.point.begin(), a.point.end(), b.point.begin(), b.point.end());
}

/// The point with the largest measure; ties go to the first in order.
template <class Measure>
std::size_t farthest(const std::vector<ManifoldPoint>& points, double slack, const Measure& measure) {
  std::size_t best = 0;
  double most = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double here = measure(points[i]);
    if (!(here > most + (i == 0 ? 0 : slack))) continue;
    best = i;
    most = here;
  }
  return best;
}

}  // namespace

void keep_extremes(const Vec3& normal, std::vector<ManifoldPoint>& points) {
  if (points.empty()) return;
  std::sort(points.begin(), points.end(), before_in_order);
  double size_m = 0;
  for (const ManifoldPoint& p : points) size_m = std::max(size_m, (p.point - points[0].point).norm());
  const double slack_m = kSamePoint * size_m;
  std::vector<ManifoldPoint> kept;
  const auto is_new = [&](const ManifoldPoint& p) {
    return std::none_of(kept.begin(), kept.end(),
                        [&](const ManifoldPoint& k) { return (k.point - p.point).norm() <= slack_m; });
  };
  const auto take = [&](std::size_t i) {
    if (is_new(points[i])) kept.push_back(points[i]);
  };
  take(farthest(points, slack_m, [](const ManifoldPoint& p) { return p.depth_m; }));
  const Vec3 first = kept[0].point;
  const auto across = [&](const ManifoldPoint& p) {
    return Vec3((p.point - first) - (p.point - first).dot(normal) * normal);
  };
  take(farthest(points, slack_m, [&](const ManifoldPoint& p) { return across(p).norm(); }));
  if (kept.size() == 2) {
    const Vec3 line = across(kept[1]);
    const double slack = slack_m * line.norm();
    const auto side = [&](const ManifoldPoint& p) { return normal.dot(line.cross(across(p))); };
    const std::size_t third = farthest(points, slack, [&](const ManifoldPoint& p) { return std::abs(side(p)); });
    const double of_third = side(points[third]);
    if (std::abs(of_third) > slack) {
      take(third);
      const std::size_t fourth =
          farthest(points, slack, [&](const ManifoldPoint& p) { return of_third > 0 ? -side(p) : side(p); });
      if (side(points[fourth]) * of_third < 0 && std::abs(side(points[fourth])) > slack) take(fourth);
    }
  }
  points = std::move(kept);
}

}  // namespace collided::engine
