#include "server/exact_phase/motion/lasting_contact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/exact_phase/distance/closest.hpp"
#include "server/exact_phase/given/margin.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine {
namespace {

constexpr double kApart = std::numeric_limits<double>::infinity();
constexpr double kHopeless = std::numeric_limits<double>::max();

/// The radius of a ball about the point that the part surely holds; negative: how far from the part the point may be.
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

/// A point that the two parts share at one time, or nearly, and the margins of both about it.
struct SharedPoint {
  Vec3 point = Vec3::Zero();
  double margin_m = 0;

  SharedPoint(const ConvexPart& a, const ConvexPart& b, const Contact* known) {
    if (known != nullptr) {
      point = known->point;
    } else if (overlaps(a, b).yes()) {
      point = contact(a, b).point;
    } else {
      const Separation gap = separation(a, b);
      point = (gap.on_a + gap.on_b) / 2;
    }
    // Nothing about a point beside its plane is a triangle's.
    for (const ConvexPart* part : {&a, &b}) {
      if (const auto* triangle = std::get_if<Triangle>(part)) point = closest(point, *triangle).point;
    }
    margin_m = margin_about(point, a) + margin_about(point, b);
  }
};

bool touch_at(const PartOnMotion& a, const PartOnMotion& b, double t, double off_m) {
  const ConvexPart placed_a = a.at(t);
  const ConvexPart placed_b = b.at(t);
  return overlaps(placed_a, placed_b).yes() || !(off_m > 0 && surely_apart(placed_a, placed_b, off_m));
}

/// The two points as fixed in the body, in the world's directions when the span begins.
struct FixedPoints {
  double moved_m = 0;      // from one to the other
  double from_axis_m = 0;  // the farther one

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

double length_of(const Triangle& t) { return std::max({(t.b - t.a).norm(), (t.c - t.b).norm(), (t.a - t.c).norm()}); }

/// By how much common points can come apart, divided by s (1 - s).
double parting_m(const BodyMotion& motion, const TimeSpan& span, double moved_m, double from_axis_m) {
  const double turn_rad = motion.turn_rad * (span.high - span.low);
  return turn_rad * (moved_m + turn_rad * from_axis_m / 2) * (1 + kBoundSlack);
}

/// Triangles hold no balls. What bridges the distance is how far the two may be moved apart in any direction at both
/// ends, and the points that coincide are then any of theirs.
double shortfall_of_triangles(const PartOnMotion& a, const PartOnMotion& b, const TimeSpan& span, double off_m) {
  double parting = off_m;
  for (const PartOnMotion* part : {&a, &b}) {
    const auto& triangle = std::get<Triangle>(part->own);
    const double reach_m = std::max({triangle.a.norm(), triangle.b.norm(), triangle.c.norm()});
    parting += parting_m(part->motion, span, length_of(triangle), part->motion.lever_m(reach_m));
  }
  const ConvexPart low_a = a.at(span.low);
  const ConvexPart low_b = b.at(span.low);
  const ConvexPart high_a = a.at(span.high);
  const ConvexPart high_b = b.at(span.high);
  if (surely_meet(low_a, low_b, parting) || surely_meet(high_a, high_b, parting)) return 0;
  if (surely_meet(low_a, low_b, parting / 4) && surely_meet(high_a, high_b, parting / 4)) return 0;
  constexpr double kFar = 0x1p-10;
  const bool is_near = surely_meet(low_a, low_b, parting * kFar) || surely_meet(high_a, high_b, parting * kFar);
  return is_near ? 1 / kFar : 1 / (kFar * kFar);
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
  const SharedPoint first(a.at(span.low), b.at(span.low), known.low);
  const SharedPoint last(a.at(span.high), b.at(span.high), known.high);
  double parting = 0;
  for (const PartOnMotion* part : {&a, &b}) {
    const FixedPoints fixed(part->motion, span, first.point, last.point);
    parting += parting_m(part->motion, span, fixed.moved_m, fixed.from_axis_m);
  }
  const double low_m = first.margin_m + off_m;
  const double high_m = last.margin_m + off_m;
  if (!(low_m >= 0 && high_m >= 0)) return kHopeless;
  const double bridged = std::sqrt(low_m) + std::sqrt(high_m);
  if (parting <= bridged * bridged * (1 - kBoundSlack)) return 0;
  return std::min(parting / (bridged * bridged), kHopeless);
}

}  // namespace collided::engine
