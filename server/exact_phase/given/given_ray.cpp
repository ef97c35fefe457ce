#include "server/exact_phase/given/given_ray.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/exact_phase/given/exact_placing.hpp"
#include "server/exact_phase/given/given_overlap.hpp"
#include "server/exact_phase/given/margin.hpp"
#include "server/exact_phase/ray/ray_hit_value.hpp"
#include "server/exact_phase/ray/ray_triangle_kernel.hpp"
#include "server/geometry/stable_length.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Roundings of the double arithmetic in holds_within, in units of 2^-53 of the largest length met: some 20 sums and
/// products in a row. At zero, GivenRay.DoubleAloneIsNotTrustedNearTheSurface fails.
constexpr double kHoldsRoundoffs = 64 * kRoundoff;

/// The position of a number that is known up to some margin.
enum class Where { below, doubtful, above };
Where where(double value, double margin) {
  if (value > margin) return Where::above;
  return value < -margin ? Where::below : Where::doubtful;
}

/// True if the start and the path agree with the verdict: inside or not, hit or not.
bool agrees(Where start, Where way, const ExactResult& verdict, const RayHit& hit) {
  if (start == Where::doubtful || verdict.decision == Decision::undecided) return false;
  if (start == Where::below) return verdict.yes() && hit.inside;
  if (way == Where::doubtful || (verdict.yes() && hit.inside)) return false;
  return verdict.yes() == (way == Where::below);
}

}  // namespace

bool holds_within(const Ray& ray, const Sphere& placed, double off_m, const ExactResult& verdict, const RayHit& hit) {
  const Vec3 to = placed.center - ray.origin;
  const Vec3 direction = ray.direction / stable_length(ray.direction);
  const double away_m = to.norm();
  const double margin_m = off_m + kHoldsRoundoffs * (away_m + placed.radius_m);
  const double along_m = to.dot(direction);
  const double nearest_m = along_m <= 0              ? away_m
                           : along_m <= ray.length_m ? to.cross(direction).norm()
                                                     : (to - ray.length_m * direction).norm();
  return agrees(where(away_m - placed.radius_m, margin_m), where(nearest_m - placed.radius_m, margin_m), verdict, hit);
}

bool holds_within(const Ray& ray, const Box& placed, double off_m, const ExactResult& verdict, const RayHit& hit) {
  const Vec3 to = placed.axes.transpose() * (ray.origin - placed.center);
  const Vec3 direction = placed.axes.transpose() * (ray.direction / stable_length(ray.direction));
  const double margin_m = off_m + kHoldsRoundoffs * (to.norm() + placed.half_m.norm());
  const Where start = where((to.cwiseAbs() - placed.half_m).maxCoeff(), margin_m);
  // The sections of the ray in the box enlarged and reduced by the margin.
  double in[2] = {0, 0};
  double out[2] = {ray.length_m, ray.length_m};
  for (int axis = 0; axis < 3; ++axis) {
    const double speed = std::abs(direction[axis]);
    const double from = direction[axis] < 0 ? -to[axis] : to[axis];
    for (int k = 0; k < 2; ++k) {
      const double half_m = placed.half_m[axis] + (k == 0 ? margin_m : -margin_m);
      if (speed == 0) {
        if (!(std::abs(from) <= half_m)) out[k] = -1;
        continue;
      }
      in[k] = std::max(in[k], (-half_m - from) / speed);
      out[k] = std::min(out[k], (half_m - from) / speed);
    }
  }
  const Where way = in[0] > out[0] ? Where::above : in[1] < out[1] ? Where::below : Where::doubtful;
  return agrees(start, way, verdict, hit);
}

bool holds_within(const Ray& ray, const HalfSpace& placed, double off_m, const ExactResult& verdict,
                  const RayHit& hit) {
  const Vec3 normal = kernel::unit(placed.normal);
  const Vec3 to = ray.origin - placed.point;
  // The plane's error grows with the distance: kTurnedPoint twice of the distance, as in placing_error_m().
  constexpr double kPlaneTurned = 2 * kTurnedPoint + kHoldsRoundoffs;
  const auto off_at = [&](double distance_m) { return off_m + kPlaneTurned * (to.norm() + distance_m); };
  const double ahead_m = normal.dot(to);
  const double slope = normal.dot(kernel::unit(ray.direction));
  const Where start = where(ahead_m, off_at(0));
  Where way = where(slope, kPlaneTurned);
  if (way == Where::below && ray.length_m < kInfinity)
    way = where(ahead_m + slope * ray.length_m, off_at(ray.length_m));
  return agrees(start, way, verdict, hit);
}

/// In coordinates in which the ellipsoid is the unit ball, a length is at most 1 / least half axis times as long.
bool holds_within(const Ray& ray, const Ellipsoid& placed, double off_m, const ExactResult& verdict,
                  const RayHit& hit) {
  const auto seen = [&](const Vec3& v) { return Vec3((placed.axes.transpose() * v).cwiseQuotient(placed.half_m)); };
  const double least_m = placed.half_m.minCoeff();
  const Vec3 to = ray.origin - placed.center;
  const Vec3 direction = seen(ray.direction / stable_length(ray.direction));
  const double margin_m = off_m + kHoldsRoundoffs * (to.norm() + placed.half_m.maxCoeff());
  const Ray own{seen(to), direction, ray.length_m * direction.norm()};
  return holds_within(own, Sphere{Vec3::Zero(), 1}, margin_m / least_m, verdict, hit);
}

namespace {

/// The axis of a capsule, cylinder or cone, and a point relative to its first end.
struct SeenAlong {
  double length_m;
  double along_m;
  double across_m;

  SeenAlong(const Vec3& from, const Vec3& to, const Vec3& point) {
    const Vec3 axis = to - from;
    length_m = axis.norm();
    const Vec3 unit = length_m > 0 ? Vec3(axis / length_m) : Vec3(Vec3::UnitZ());
    along_m = unit.dot(point - from);
    across_m = unit.cross(point - from).norm();
  }
};

/// How far a point is outside, or, if negative, inside: at most its distance from the border.
double outside_m(const Capsule& c, const Vec3& point) {
  const SeenAlong seen(c.a, c.b, point);
  const double beyond_m = std::max({-seen.along_m, seen.along_m - seen.length_m, 0.0});
  return std::hypot(beyond_m, seen.across_m) - c.radius_m;
}
double outside_m(const Cylinder& c, const Vec3& point) {
  const SeenAlong seen(c.a, c.b, point);
  return std::max({-seen.along_m, seen.along_m - seen.length_m, seen.across_m - c.radius_m});
}
double outside_m(const Cone& c, const Vec3& point) {
  const SeenAlong seen(c.apex, c.base, point);
  const double beside_m =
      (seen.across_m * seen.length_m - c.radius_m * seen.along_m) / std::hypot(seen.length_m, c.radius_m);
  return std::max(seen.along_m - seen.length_m, beside_m);
}

/// Decides by the midpoint of the section in the solid, or, for a ray that misses, by its distance from the whole axis.
template <class Solid>
bool holds_about_axis(const Ray& ray, const Solid& placed, const Vec3& from, const Vec3& to, double off_m,
                      const ExactResult& verdict, const RayHit& hit) {
  const Vec3 direction = ray.direction / stable_length(ray.direction);
  const Vec3 away = ray.origin - from;
  const Vec3 axis = to - from;
  const double margin_m = off_m + kHoldsRoundoffs * (away.norm() + axis.norm() + placed.radius_m);
  const Where start = where(outside_m(placed, ray.origin), margin_m);
  if (start != Where::above) return agrees(start, Where::doubtful, verdict, hit);
  if (verdict.yes()) {
    const double middle_m = hit.distance_m + (std::min(hit.exit_m, ray.length_m) - hit.distance_m) / 2;
    const Vec3 middle = ray.origin + middle_m * direction;
    if (where(outside_m(placed, middle), margin_m) == Where::below) return !hit.inside;
  } else {
    const Vec3 across = direction.cross(axis);
    const double sine_m = across.norm();
    // For a nearly parallel axis, the distance of the lines is known too badly.
    constexpr double kLeastSine = 0.125;
    const bool is_skew = sine_m > kLeastSine * axis.norm();
    if (is_skew && std::abs(away.dot(across)) > (placed.radius_m + 2 * margin_m) * sine_m)
      return verdict.decision == Decision::no;
  }
  return holds_within(ray, as_part(Primitive(placed)), off_m, verdict, hit);
}

}  // namespace

bool holds_within(const Ray& ray, const Capsule& placed, double off_m, const ExactResult& verdict, const RayHit& hit) {
  return holds_about_axis(ray, placed, placed.a, placed.b, off_m, verdict, hit);
}
bool holds_within(const Ray& ray, const Cylinder& placed, double off_m, const ExactResult& verdict, const RayHit& hit) {
  return holds_about_axis(ray, placed, placed.a, placed.b, off_m, verdict, hit);
}
bool holds_within(const Ray& ray, const Cone& placed, double off_m, const ExactResult& verdict, const RayHit& hit) {
  return holds_about_axis(ray, placed, placed.apex, placed.base, off_m, verdict, hit);
}

namespace {

/// Beyond this distance along the ray, nothing of a part within the box follows.
double reach_along(const Ray& ray, const Aabb& box, double off_m) {
  const Vec3 most = (box.high - ray.origin).cwiseAbs().cwiseMax((box.low - ray.origin).cwiseAbs());
  return (most.norm() + 2 * off_m) * (1 + kBoundSlack);
}

}  // namespace

bool holds_within(const Ray& ray, const ConvexPart& placed, double off_m, const ExactResult& verdict,
                  const RayHit& hit) {
  const ConvexPart start{Primitive(Sphere{ray.origin, 0})};
  const double length_m = std::min(ray.length_m, reach_along(ray, bounds_of_part(placed), off_m));
  const Vec3 end = kernel::at_distance(ray, length_m);
  const double margin_m = off_m + kHoldsRoundoffs * (ray.origin.norm() + length_m);
  if (!(margin_m < kInfinity)) return false;
  if (!surely_apart(start, placed, margin_m))
    return verdict.yes() && hit.inside && surely_meet(start, placed, margin_m);
  if (verdict.decision == Decision::undecided || (verdict.yes() && hit.inside)) return false;
  const ConvexPart way{Primitive(Capsule{ray.origin, end, 0})};
  return verdict.yes() ? surely_meet(way, placed, margin_m) : surely_apart(way, placed, margin_m);
}

namespace {

/// A ray against a part with exact corners. All numbers `s` are multiples of the direction.
class RayOnGiven {
 public:
  RayOnGiven(const Ray& ray, const ConvexPart& placed, const GivenPart& given, double off_m)
      : ray_(ray), placed_(placed), given_(given), length_m_(stable_length(ray.direction)) {
    reach_ = reach_along(ray, bounds_of_part(placed), off_m) / length_m_ * (1 + kBoundSlack);
    width_ = kWideBracket * off_m / length_m_;
  }

  double length_m() const { return length_m_; }
  Decision meets(double from, double to) const {
    return overlaps_as_given(RaySegment{ray_, from, to}, placed_, given_);
  }

  /// Whether the ray, up to its length, meets the part.
  Decision meets() const {
    const double end = ray_.length_m / length_m_;
    if (!(end < reach_)) return meets(0, reach_);
    if (has_length_of(end)) return meets(0, end);
    // The quotient is within a few roundings of the end, which is not a double.
    if (meets(0, end * (1 - kFewSlack)) == Decision::yes) return Decision::yes;
    return meets(0, end * (1 + kFewSlack)) == Decision::no ? Decision::no : Decision::undecided;
  }
  /// Distances at which the ray enters the part, if it begins outside, and leaves it, metres.
  Bounded entry_m(double guess_m) const {
    return metres(bracket(guess_m, [&](double s) { return meets(0, s); }));
  }
  Bounded exit_m(double guess_m) const {
    return metres(bracket(guess_m, [&](double s) { return kernel::opposite(meets(s, reach_)); }));
  }
  double reach_m() const { return reach_ * length_m_; }

 private:
  static constexpr double kWideBracket = 16;  // brackets up to this many placing errors wide are not narrowed

  struct StepBracket {
    double low;
    double high;
  };

  bool has_length_of(double s) const {
    const Dyadic length(ray_.length_m);
    return (Dyadic(s) * Dyadic(s) * kernel::square(kernel::Vector<Dyadic>(ray_.direction)) - length * length).sign() ==
           0;
  }
  /// Brackets the point at which `is_past` turns from no to yes; it is yes at reach_. Undecided points stay in the
  /// bracket.
  template <class IsPast>
  StepBracket bracket(double guess_m, const IsPast& is_past) const {
    StepBracket found{0, reach_};
    const auto look = [&](double s) {
      if (!(s > found.low && s < found.high)) return true;
      const Decision past = is_past(s);
      if (past == Decision::undecided) return false;
      (past == Decision::yes ? found.high : found.low) = s;
      return true;
    };
    const double guess = std::isfinite(guess_m) ? guess_m / length_m_ : 0;
    constexpr double kWider = 256;
    for (double by = width_ / 4; by < reach_ && (found.low < guess - by || found.high > guess + by); by *= kWider) {
      const bool is_open = look(guess - by) && look(guess + by);
      if (!is_open || (found.low >= guess - by && found.high <= guess + by)) break;
    }
    constexpr double kFinest = 4 * kRoundoff;
    while (found.high - found.low > std::max(width_, kFinest * found.high)) {
      const double middle = found.low + (found.high - found.low) / 2;
      if (!(middle > found.low && middle < found.high) || !look(middle)) break;
    }
    return found;
  }
  Bounded metres(const StepBracket& found) const {
    const double middle = found.low + (found.high - found.low) / 2;
    const double error = std::max(middle - found.low, found.high - middle);
    return Bounded(middle * length_m_, (error + 8 * kRoundoff * found.high) * length_m_ * (1 + kBoundSlack));
  }

  const Ray& ray_;
  const ConvexPart& placed_;
  const GivenPart& given_;
  double length_m_;
  double reach_;  // the part ends before this distance
  double width_;
};

/// A normal against the ray, at the point where the ray touches the part or passes within its placing error.
Vec3 normal_beside(const Ray& ray, const ConvexPart& placed, double reach_m) {
  if (const auto* triangle = std::get_if<Triangle>(&placed)) {
    const Vec3 normal = kernel::unit(Vec3((triangle->b - triangle->a).cross(triangle->c - triangle->a)));
    return normal.dot(ray.direction) > 0 ? Vec3(-normal) : normal;
  }
  const ConvexPart way{Primitive(Capsule{ray.origin, kernel::at_distance(ray, reach_m), 0})};
  return overlaps(way, placed).yes() ? -contact(way, placed).normal : -separation(way, placed).normal;
}

/// The plane of a posed half-space along a ray: numbers in one unit.
ExactResult ray_on_ground(const Ray& ray, const HalfSpace& own, const Pose& pose, RayHit& hit) {
  const ExactPart exact = exactly_placed(Primitive(own), pose, Dyadic(1.0), Primitive(own));
  const Ground& ground = std::get<Ground>(exact);
  const Dyadic norm2 = square_norm(pose.rotation);
  const Dyadic ahead = dot(ground.normal, norm2 * kernel::Vector<Dyadic>(ray.origin) - ground.point);
  const Dyadic slope = norm2 * dot(ground.normal, kernel::Vector<Dyadic>(ray.direction));
  if (!ahead.finite() || !slope.finite()) return {Decision::undecided, Level::rational};
  const bool is_inside = ahead.sign() <= 0;
  const bool crosses = is_inside ? slope.sign() > 0 : slope.sign() < 0;
  if (!is_inside && !crosses) return {Decision::no, Level::rational};
  const Dyadic size = slope.sign() < 0 ? -slope : slope;
  const Dyadic way = is_inside ? -ahead : ahead;
  if (!is_inside && ray.length_m < kInfinity) {
    // way / size * |direction| <= length
    const Dyadic limit = Dyadic(ray.length_m) * size;
    const Dyadic over = way * way * kernel::square(kernel::Vector<Dyadic>(ray.direction)) - limit * limit;
    if (over.sign() > 0) return {Decision::no, Level::rational};
  }
  const Bounded at_m =
      crosses ? kernel::plain(kernel::scaled(way) / kernel::scaled(size) * kernel::length_of<Dyadic>(ray)) : Bounded();
  kernel::set_interval(ray, is_inside, at_m, at_m, hit);
  if (!crosses) {
    hit.exit_m = kInfinity;
    hit.exit_error_m = 0;
  }
  kernel::set_normal(ray, pose.rotation * own.normal, hit);
  return {Decision::yes, Level::rational};
}

}  // namespace

ExactResult ray_as_given(const Ray& ray, const ConvexPart& placed, const GivenPart& given, double off_m,
                         ExactResult verdict, RayHit& hit) {
  if (kernel::precision.highest != Level::rational) return {Decision::undecided, verdict.level};
  if (half_space_of(placed) != nullptr) {
    const auto* const* own = std::get_if<const Primitive*>(&given.own);
    if (own == nullptr || given.pose == nullptr) return verdict;
    const ExactResult exact = ray_on_ground(ray, std::get<HalfSpace>(**own), *given.pose, hit);
    return exact.decision == Decision::undecided ? verdict : exact;
  }
  const RayOnGiven on_given(ray, placed, given, off_m);
  if (!std::isfinite(on_given.reach_m())) return verdict;
  const Decision begins_in = on_given.meets(0, 0);
  const Decision meets = begins_in == Decision::yes ? begins_in : on_given.meets();
  if (meets == Decision::undecided || begins_in == Decision::undecided) return verdict;
  if (meets == Decision::no) return {meets, Level::rational};
  const auto* triangle = std::get_if<Triangle>(&placed);
  const double guess_m = verdict.yes() ? hit.distance_m : 0;
  const Bounded entry = begins_in == Decision::yes ? Bounded() : on_given.entry_m(guess_m);
  const Bounded exit = triangle != nullptr ? entry : on_given.exit_m(verdict.yes() ? hit.exit_m : entry.value);
  const bool had_normal = verdict.yes();
  kernel::set_interval(ray, begins_in == Decision::yes && triangle == nullptr, entry, exit, hit);
  if (!had_normal) {
    const Vec3 beside = normal_beside(ray, placed, on_given.reach_m());
    kernel::set_normal(ray, hit.inside ? Vec3(-beside) : beside, hit);
  }
  if (triangle != nullptr) hit.weights = kernel::weights_of(hit.point, *triangle);
  return {Decision::yes, Level::rational};
}

}  // namespace collided::engine
