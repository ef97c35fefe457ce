#include "server/exact_phase/motion/lasting_contact.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "server/exact_phase/distance/closest.hpp"
#include "server/exact_phase/distance/simplex_search.hpp"
#include "server/exact_phase/given/margin.hpp"
#include "server/exact_phase/part_convex.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine {
namespace {

constexpr double kApart = std::numeric_limits<double>::infinity();
/// A margin may come out this much below 0 if the two just touch, relative to their coordinates and sizes. The
/// coordinates are relative to a common origin (common_origin.hpp): a billion metres out this would otherwise be a
/// metre.
constexpr double kResolution = 0x1p-30;
constexpr double kHopeless = std::numeric_limits<double>::max();

/// The radius of a ball around the point that the part certainly contains; negative: how far the point may be from the
/// part.
double margin_about(const Vec3& point, const ConvexPart& part) {
  if (const auto* primitive = std::get_if<Primitive>(&part)) {
    if (const auto* sphere = std::get_if<Sphere>(primitive)) {
      const double away_m = (point - sphere->center).norm();
      return sphere->radius_m - away_m - kBoundSlack * (away_m + sphere->radius_m);
    }
    if (const auto* box = std::get_if<Box>(primitive)) {
      const Vec3 away = point - box->center;
      const Vec3 left = box->half_m - (box->axes.transpose() * away).cwiseAbs();
      const double inside_m = left.minCoeff();
      const double slack_m = kBoundSlack * (away.lpNorm<1>() + box->half_m.sum());
      return (inside_m >= 0 ? inside_m : -left.cwiseMin(0).norm()) - slack_m;
    }
  }
  const ConvexPart ball = Primitive(Sphere{point, 0});
  if (overlaps(ball, part).yes()) {
    const Contact depth = contact(ball, part);
    return depth.depth_m - depth.depth_error_m;
  }
  const Separation gap = separation(ball, part);
  return -(gap.distance_m + gap.error_m);
}

double size_of(const ConvexPart& part) {
  const Aabb box = bounds_of_part(part);
  return (box.high - box.low).maxCoeff();
}

/// The part's point nearest to the given one, which is the given one if inside.
Vec3 nearest_of(const Vec3& point, const ConvexPart& part) {
  const Closest found = std::visit([&](const auto& own) { return closest(point, own); }, part);
  return found.distance_m == 0 ? point : found.point;
}

/// The part of a convex polygon that is not beyond the plane.
std::vector<Vec3> cut_off(const std::vector<Vec3>& polygon, const Vec3& normal, const Vec3& on_plane) {
  std::vector<Vec3> left;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3& from = polygon[i];
    const Vec3& to = polygon[(i + 1) % polygon.size()];
    const double above_from = normal.dot(from - on_plane);
    const double above_to = normal.dot(to - on_plane);
    if (above_from <= 0) left.push_back(from);
    if ((above_from < 0 && above_to > 0) || (above_from > 0 && above_to < 0))
      left.push_back(from + above_from / (above_from - above_to) * (to - from));
  }
  return left;
}

/// A point of both parts, if a search in plain double finds one.
std::optional<Vec3> searched_point(const ConvexPart& a, const ConvexPart& b) {
  if (half_space_of(a) != nullptr || half_space_of(b) != nullptr) return std::nullopt;
  const kernel::Convex set_a = convex_of(a);
  const kernel::Convex set_b = convex_of(b);
  const kernel::Proposal found = kernel::nearest_proposal(set_a, set_b, kernel::Seek::distance);
  const Vec3 on_a = set_a.carrier[0] + found.on_a();
  if (found.encloses) return on_a;
  const double apart_m = found.nearest.norm();
  if (!(apart_m > 0)) return on_a;
  // The middle of what the balls of both cover.
  return on_a - (set_a.ball_m + (apart_m - set_b.ball_m)) / 2 / apart_m * found.nearest;
}

/// A point that the two parts share at one time, or nearly, and the sum of both margins around it.
struct SharedPoint {
  Vec3 point = Vec3::Zero();
  double margin_m = 0;

  /// known_off_m  how much smaller than in truth the margins may come out at a known point
  SharedPoint(const ConvexPart& a, const ConvexPart& b, const Vec3* known, double known_off_m) {
    if (known != nullptr) {
      point = *known;
    } else if (overlaps(a, b).yes()) {
      point = contact(a, b).point;
    } else {
      const Separation gap = separation(a, b);
      point = (gap.on_a + gap.on_b) / 2;
    }
    // Off a triangle's plane its margin is negative, so the point moves onto the triangle.
    for (const ConvexPart* part : {&a, &b}) {
      if (std::holds_alternative<Triangle>(*part)) point = nearest_of(point, *part);
    }
    margin_m = margin_about(point, a) + margin_about(point, b);
    if (known == nullptr || !(margin_m + known_off_m > 0)) go_inside(a, b);
  }

 private:
  /// A contact's point is halfway between its deepest ones, and may lie beside the overlap. A search for the distance
  /// ends at a point of both, possibly on a border.
  void go_inside(const ConvexPart& a, const ConvexPart& b) {
    if (margin_m > 0) return;
    if (const std::optional<Vec3> found = searched_point(a, b)) take(*found, a, b);
    if (margin_m > 0) return;
    if (const auto* triangle = std::get_if<Triangle>(&a)) return cut_down(*triangle, a, b);
    if (const auto* triangle = std::get_if<Triangle>(&b)) return cut_down(*triangle, b, a);
    go_to_and_fro(a, b);
  }

  /// The middle of the triangle, after cutting off what lies beyond the solid's border planes found at earlier middles.
  void cut_down(const Triangle& triangle, const ConvexPart& own, const ConvexPart& solid) {
    constexpr int kMostRounds = 12;
    std::vector<Vec3> rest{triangle.a, triangle.b, triangle.c};
    for (int round = 0; round < kMostRounds && margin_m <= 0 && rest.size() >= 3; ++round) {
      Vec3 middle = Vec3::Zero();
      for (const Vec3& corner : rest) middle += corner / static_cast<double>(rest.size());
      take(middle, own, solid);
      const Vec3 border = nearest_of(middle, solid);
      rest = cut_off(rest, middle - border, border);
    }
  }

  /// Projects onto the two alternately (Bregman 1965).
  void go_to_and_fro(const ConvexPart& a, const ConvexPart& b) {
    constexpr int kMostRounds = 6;
    for (int round = 0; round < kMostRounds && margin_m <= 0; ++round) {
      const Vec3 across = nearest_of(point, a) - point;
      const Vec3 along = nearest_of(Vec3(point + across), b) - point;
      if (along.isZero(0)) break;
      // The border is across.norm() / sin off, and along.norm() is across.norm() sin, for the angle between the two.
      constexpr double kBeyond = 1.5;
      const Vec3 beyond = kBeyond * across.squaredNorm() / along.squaredNorm() * along;
      if (!take(nearest_of(Vec3(point + beyond), b), a, b) && !take(point + along, a, b)) break;
    }
    const Aabb box_a = bounds_of_part(a);
    const Aabb box_b = bounds_of_part(b);
    const Vec3 inwards = ((box_a.low + box_a.high) / 2 + (box_b.low + box_b.high) / 2) / 2 - point;
    for (double share = 1; margin_m <= 0 && share > kResolution; share /= 8) take(point + share * inwards, a, b);
  }

  bool take(const Vec3& other, const ConvexPart& a, const ConvexPart& b) {
    const double margin_there_m = margin_about(other, a) + margin_about(other, b);
    if (margin_there_m <= margin_m) return false;
    margin_m = margin_there_m;
    point = other;
    return true;
  }
};

bool touch_at(const PartOnMotion& a, const PartOnMotion& b, double t, double off_m) {
  const ConvexPart placed_a = a.at(t);
  const ConvexPart placed_b = b.at(t);
  return overlaps(placed_a, placed_b).yes() || !(off_m > 0 && surely_apart(placed_a, placed_b, off_m));
}

/// The two points as fixed in the body, in the world's directions at the beginning of the span.
struct FixedPoints {
  double moved_m = 0;      // from one point to the other
  double from_axis_m = 0;  // distance of the farther one

  FixedPoints(const BodyMotion& motion, const TimeSpan& span, const Vec3& first, const Vec3& last) {
    if (motion.turn_rad == 0) return;
    const Frame low = motion.at(span.low);
    const Frame high = motion.at(span.high);
    const Vec3 own_first = low.rotation.transpose() * (first - low.position);
    const Vec3 own_last = high.rotation.transpose() * (last - high.position);
    moved_m = (own_last - own_first).norm();
    const auto away_m = [&](const Frame& frame, const Vec3& point) {
      return motion.axis.cross(point - (frame.position + frame.rotation * motion.pivot)).norm();
    };
    from_axis_m = std::max(away_m(low, first), away_m(high, last));
  }
};

/// How far common points can come apart, divided by s (1 - s).
double parting_m(const BodyMotion& motion, const TimeSpan& span, double moved_m, double from_axis_m) {
  const double turn_rad = motion.turn_rad * (span.high - span.low);
  return turn_rad * (moved_m + turn_rad * from_axis_m / 2) * (1 + kBoundSlack);
}

/// Where the line of an edge meets the plane of a triangle.
struct Piercing {
  Vec3 point = Vec3::Zero();
  double slope = 0;                // sine of the angle between the two
  std::array<double, 5> left_m{};  // to the ends of the edge and the sides of the triangle; negative beyond them

  Piercing(const Vec3& from, const Vec3& to, const Triangle& triangle) {
    const double length_m = (to - from).norm();
    const Vec3 along = (to - from) / length_m;
    const Vec3 normal = (triangle.b - triangle.a).cross(triangle.c - triangle.a).normalized();
    const double rise = normal.dot(along);
    slope = std::abs(rise);
    if (!(slope > 0)) return;
    const double way_m = normal.dot(triangle.a - from) / rise;
    point = from + way_m * along;
    const auto inside_m = [&](const Vec3& u, const Vec3& v) {
      return normal.dot((v - u).cross(point - u)) / (v - u).norm();
    };
    left_m = {way_m, length_m - way_m, inside_m(triangle.a, triangle.b), inside_m(triangle.b, triangle.c),
              inside_m(triangle.c, triangle.a)};
  }
};

/// An edge of one triangle against the other, both on their motions over the span.
///
/// If the edge's line meets the plane, common points separate as usual, and then the line meets the plane within 1 /
/// slope of that distance from both points. The distances to the ends and sides change linearly from the beginning to
/// the end.
double shortfall_of_edge(const PartOnMotion& edge, int number, const PartOnMotion& other, const TimeSpan& span,
                         double off_m) {
  const auto at = [&](double t) {
    const auto holder = std::get<Triangle>(edge.at(t));
    const std::array<Vec3, 3> corners{holder.a, holder.b, holder.c};
    return Piercing(corners[number], corners[(number + 1) % 3], std::get<Triangle>(other.at(t)));
  };
  const Piercing low = at(span.low);
  const Piercing high = at(span.high);
  const double turn_rad = (edge.motion.turn_rad + other.motion.turn_rad) * (span.high - span.low);
  const double slope = std::min(low.slope, high.slope) - turn_rad;
  if (!(slope > 0)) return kApart;
  const double length_m = low.left_m[0] + low.left_m[1];
  double bridged_m = kApart;
  for (std::size_t i = 0; i < low.left_m.size(); ++i) {
    const double unknown_m = off_m + kResolution * (low.point.lpNorm<1>() + length_m);
    if (!(std::min(low.left_m[i], high.left_m[i]) >= -unknown_m)) return kApart;
    const double bridged =
        std::sqrt(std::max(0.0, low.left_m[i] + off_m)) + std::sqrt(std::max(0.0, high.left_m[i] + off_m));
    bridged_m = std::min(bridged_m, bridged * bridged);
  }
  double parting = 0;
  for (const PartOnMotion* part : {&edge, &other}) {
    const FixedPoints fixed(part->motion, span, low.point, high.point);
    parting += parting_m(part->motion, span, fixed.moved_m, fixed.from_axis_m) / slope;
  }
  if (parting <= bridged_m * (1 - kBoundSlack)) return 0;
  return std::min(parting / bridged_m, kHopeless);
}

/// Triangles contain no balls: lasting contact means that an edge of one passes through the other.
double shortfall_of_triangles(const PartOnMotion& a, const PartOnMotion& b, const TimeSpan& span, double off_m) {
  double least = kApart;
  for (int number = 0; number < 3 && least > 0; ++number)
    least =
        std::min({least, shortfall_of_edge(a, number, b, span, off_m), shortfall_of_edge(b, number, a, span, off_m)});
  if (least < kApart) return least;
  // If both lie in one plane, no edge passes through the other.
  const auto normal_at = [](const PartOnMotion& part, double t) {
    const auto triangle = std::get<Triangle>(part.at(t));
    return Vec3((triangle.b - triangle.a).cross(triangle.c - triangle.a).normalized());
  };
  const auto are_even_at = [&](double t) { return normal_at(a, t).cross(normal_at(b, t)).norm() <= kResolution; };
  return are_even_at(span.low) && are_even_at(span.high) ? kHopeless : kApart;
}

}  // namespace

ConvexPart PartOnMotion::at(double t) const {
  const Frame frame = motion.at(t);
  return std::visit([&](const auto& part) { return as_part(place(frame, part)); }, own);
}

double shortfall_between(const PartOnMotion& a, const PartOnMotion& b, const TimeSpan& span, double off_m,
                         const KnownContacts& known) {
  if (known.low == nullptr && !touch_at(a, b, span.low, off_m)) return kApart;
  if (known.high == nullptr && !touch_at(a, b, span.high, off_m)) return kApart;
  if (a.motion.turn_rad == 0 && b.motion.turn_rad == 0) return 0;
  if (std::holds_alternative<Triangle>(a.own) && std::holds_alternative<Triangle>(b.own))
    return shortfall_of_triangles(a, b, span, off_m);
  const SharedPoint first(a.at(span.low), b.at(span.low), known.low, known.off_m);
  const SharedPoint last(a.at(span.high), b.at(span.high), known.high, known.off_m);
  double parting = 0;
  for (const PartOnMotion* part : {&a, &b}) {
    const FixedPoints fixed(part->motion, span, first.point, last.point);
    parting += parting_m(part->motion, span, fixed.moved_m, fixed.from_axis_m);
  }
  const auto known_m = [&](const SharedPoint& shared) {
    if (shared.margin_m + off_m >= 0) return shared.margin_m + off_m;
    const double smaller_m = std::min(size_of(a.own), size_of(b.own));
    const double unknown_m = kResolution * (shared.point.lpNorm<1>() + smaller_m);
    return shared.margin_m + off_m + unknown_m + known.off_m >= 0 ? 0 : kApart;
  };
  const double low_m = known_m(first);
  const double high_m = known_m(last);
  if (low_m == kApart || high_m == kApart) return kApart;
  const double bridged = std::sqrt(low_m) + std::sqrt(high_m);
  if (parting <= bridged * bridged * (1 - kBoundSlack)) return 0;
  return std::min(parting / (bridged * bridged), kHopeless);
}

}  // namespace collided::engine
