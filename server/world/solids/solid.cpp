#include "server/world/solids/solid.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "server/exact_phase/solid/point_signs.hpp"
#include "server/geometry/placing_error.hpp"
#include "server/geometry/tolerance.hpp"
#include "server/world/objects/scene_touch.hpp"

namespace collided::engine {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The direction in which a point leaves the box soonest.
AxisDirection shortest_way_out(const Aabb& box, const Vec3& point) {
  AxisDirection best;
  double best_m = kInfinity;
  for (int axis = 0; axis < 3; ++axis) {
    for (const int sign : {1, -1}) {
      const double way_m = sign > 0 ? box.high[axis] - point[axis] : point[axis] - box.low[axis];
      if (!(way_m < best_m)) continue;
      best_m = way_m;
      best = {axis, sign};
    }
  }
  return best;
}

Vec3 along(const AxisDirection& ray) {
  Vec3 direction = Vec3::Zero();
  direction[ray.axis] = ray.sign;
  return direction;
}

/// State of a ray's walk: how often it leaves the solid less how often it enters.
template <class Point>
class CrossingCount {
 public:
  CrossingCount(Point point, const AxisDirection& ray) : point_(std::move(point)), ray_(ray) { counted().clear(); }

  double operator()(std::uint32_t number, const Triangle& corners, double limit) {
    if (is_on_) return -1;
    const SurfaceCrossing crossing = crossing_of(point_, corners, ray_);
    is_on_ = crossing.on || lies_on(point_, corners);
    if (is_on_) return -1;
    if (crossing.step == 0) return limit;
    // A clipped split produces a triangle twice.
    std::vector<std::uint32_t>& numbers = counted();
    if (std::find(numbers.begin(), numbers.end(), number) != numbers.end()) return limit;
    numbers.push_back(number);
    steps_ += crossing.step;
    return limit;
  }
  SideFound found() const {
    const SolidSide side = is_on_ ? SolidSide::on : steps_ > 0 ? SolidSide::in : SolidSide::out;
    return {side, point_.level()};
  }

 private:
  /// Reused between questions, so that no answer allocates once it has grown.
  static std::vector<std::uint32_t>& counted() {
    thread_local std::vector<std::uint32_t> numbers;
    return numbers;
  }

  Point point_;
  AxisDirection ray_;
  int steps_ = 0;
  bool is_on_ = false;
};

/// How far the point, transformed to the object's frame in double, may be from its exact place.
double seen_slack_m(const Placed& object, double away_m, const Vec3& point, double radius_m) {
  const double rounded_m = placement_slack(object.frame, away_m + point.lpNorm<1>(), radius_m);
  // The frame's own error grows with the distance, like that of a point placed so far out.
  const double given_m = object.pose != nullptr ? placing_error_m(object.frame, away_m + radius_m) : 0;
  return (rounded_m + given_m) * (1 + kChainSlack);
}

/// True if its points are exactly where its own numbers put them.
bool is_unmoved(const Placed& object) {
  if (object.pose != nullptr && !object.pose->rotation.vec().isZero(0)) return false;
  return object.frame.position.isZero(0) && object.frame.rotation == Mat3::Identity();
}

/// A point with the coordinates at / weight.
struct ExactPoint {
  kernel::Vector<Dyadic> at;
  Dyadic weight;
};

/// q p q*, exactly, for the quaternion with real part w and vector part v.
kernel::Vector<Dyadic> turned(const Dyadic& w, const kernel::Vector<Dyadic>& v, const kernel::Vector<Dyadic>& p) {
  const Dyadic two(2.0);
  return (w * w - square(v)) * p + two * dot(v, p) * v + two * w * cross(v, p);
}

/// The point in the object's frame, exactly: q* (point - position) q / |q|^2.
QuotientPoint seen_exactly(const Pose& pose, const ExactPoint& point) {
  using Vector = kernel::Vector<Dyadic>;
  const Dyadic w(pose.rotation.w());
  const Vector v(-pose.rotation.x(), -pose.rotation.y(), -pose.rotation.z());
  return {turned(w, v, point.at - point.weight * Vector(pose.position)), point.weight * (w * w + square(v))};
}

/// A world point, rounded by at most off_m if it belongs to an object with a given pose.
struct AskedPoint {
  Vec3 at;
  double off_m = 0;
  const Placed* of = nullptr;
  Vec3 own = Vec3::Zero();

  /// q own q* / |q|^2 + position, if it is rounded.
  ExactPoint exact() const {
    using Vector = kernel::Vector<Dyadic>;
    if (off_m == 0) return {Vector(at), Dyadic(1.0)};
    const Pose& pose = *of->pose;
    const Dyadic w(pose.rotation.w());
    const Vector v(pose.rotation.x(), pose.rotation.y(), pose.rotation.z());
    const Dyadic weight = w * w + square(v);
    return {turned(w, v, Vector(own)) + weight * Vector(pose.position), weight};
  }
};

AskedPoint placed_point(const Placed& object, const Vec3& own) {
  const Vec3 at = place(object.frame, own);
  const bool is_exact = object.pose == nullptr || is_unmoved(object);
  return {.at = at,
          .off_m = is_exact ? 0 : placing_error_m(object.frame, Triangle{own, own, own}),
          .of = &object,
          .own = own};
}

/// True if the surface has a triangle within reach of the point.
bool is_near_surface(const IndexedMesh& surface, const Vec3& point, double reach_m, WalkCost& cost) {
  bool is_near = false;
  const auto candidate = [&](std::uint32_t, double) {
    is_near = true;
    return -1.0;
  };
  surface.tree.walk_near(point, square_up(reach_m), reach_m, candidate, cost);
  return is_near;
}

/// If no pose was given, the placed corners are the exact input: the ray runs along an axis of the world.
template <class Point>
SideFound side_of_placed_corners(const IndexedMesh& surface, const Placed& object, const AskedPoint& asked, Point exact,
                                 WalkCost& cost) {
  const AxisDirection way = shortest_way_out(object.bounds, asked.at);
  CrossingCount<Point> count(std::move(exact), way);
  const Mat3 back = object.frame.rotation.transpose();
  const Vec3 away = asked.at - object.frame.position;
  const Ray seen{.origin = back * away, .direction = back * along(way)};
  const double far_m = away.lpNorm<1>() + asked.at.lpNorm<1>();
  const double slack_m = 2 * (placement_slack(object.frame, far_m, surface.radius_m) + asked.off_m);
  const auto candidate = [&](std::uint32_t number, double limit) {
    return count(number, place(object.frame, surface.mesh->triangle(number)), limit);
  };
  surface.tree.walk_ray(seen, kInfinity, slack_m, candidate, cost);
  return count.found();
}

}  // namespace

SideFound side_by_ray(const IndexedMesh& surface, const Vec3& point, WalkCost& cost) {
  const Aabb& box = surface.tree.bounds();
  if ((point.array() < box.low.array()).any() || (point.array() > box.high.array()).any()) return {};
  const AxisDirection way = shortest_way_out(box, point);
  CrossingCount<PlainPoint> count(PlainPoint(point), way);
  surface.tree.walk_ray({.origin = point, .direction = along(way)}, kInfinity, 0, *surface.mesh, count, cost);
  return count.found();
}

namespace {

SideFound side_by(const IndexedMesh& surface, const SolidTree* tree, const Vec3& point, WalkCost& cost) {
  if (tree != nullptr) {
    if (const std::optional<SolidSide> side = tree->side(point, cost.nodes)) return {*side, Level::filter};
  }
  return side_by_ray(surface, point, cost);
}

/// Decides exactly, for a point so near the surface that rounding may have moved it across.
SideFound side_near_surface(const IndexedMesh& surface, const Placed& object, const AskedPoint& asked, const Vec3& seen,
                            double slack_m, WalkCost& cost) {
  if (object.pose == nullptr && !is_unmoved(object)) {
    if (asked.off_m == 0) return side_of_placed_corners(surface, object, asked, PlainPoint(asked.at), cost);
    ExactPoint exact = asked.exact();
    return side_of_placed_corners(surface, object, asked, QuotientPoint(std::move(exact.at), exact.weight), cost);
  }
  const AxisDirection way = shortest_way_out(surface.tree.bounds(), seen);
  CrossingCount<QuotientPoint> count(seen_exactly(object.pose != nullptr ? *object.pose : Pose{}, asked.exact()), way);
  surface.tree.walk_ray({.origin = seen, .direction = along(way)}, kInfinity, slack_m, *surface.mesh, count, cost);
  return count.found();
}

SideFound side_placed(const IndexedMesh& surface, const SolidTree* tree, const Placed& object, const AskedPoint& asked,
                      WalkCost& cost) {
  if (is_unmoved(object) && asked.off_m == 0) return side_by(surface, tree, asked.at, cost);
  const Vec3 away = asked.at - object.frame.position;
  const Vec3 seen = object.frame.rotation.transpose() * away;
  const double slack_m =
      (seen_slack_m(object, away.lpNorm<1>(), asked.at, surface.radius_m) + asked.off_m) * (1 + kChainSlack);
  const bool is_seen = seen.allFinite() && std::isfinite(slack_m);
  if (is_seen && !is_near_surface(surface, seen, slack_m, cost)) return side_by(surface, tree, seen, cost);
  return side_near_surface(surface, object, asked, seen, slack_m, cost);
}

const SolidTree* tree_of(const SolidMesh& solid) { return solid.tree ? &*solid.tree : nullptr; }

}  // namespace

SideFound side_of(const SolidMesh& solid, const Vec3& point, WalkCost& cost) {
  return side_by(*solid.surface, tree_of(solid), point, cost);
}

SideFound side_of_placed(const SolidMesh& solid, const Placed& object, const Vec3& point, WalkCost& cost) {
  return side_placed(*solid.surface, tree_of(solid), object, {.at = point}, cost);
}

SideFound side_of_placed(const SolidMesh& solid, const Placed& object, const Placed& inner, const Vec3& own,
                         WalkCost& cost) {
  return side_placed(*solid.surface, tree_of(solid), object, placed_point(inner, own), cost);
}

SideFound side_of_placed(const IndexedMesh& surface, const Placed& object, const Vec3& point, WalkCost& cost) {
  return side_placed(surface, nullptr, object, {.at = point}, cost);
}

PointSeen point_seen_from(const Placed& object, const Vec3& point, double radius_m) {
  if (is_unmoved(object)) return {.at = point, .slack_m = 0};
  const Vec3 away = point - object.frame.position;
  return {.at = object.frame.rotation.transpose() * away,
          .slack_m = seen_slack_m(object, away.lpNorm<1>(), point, radius_m)};
}

SolidSide side_by_rationals(const SolidMesh& solid, const Placed& object, const Vec3& point) {
  const TriangleMesh& mesh = *solid.surface->mesh;
  const bool is_given = object.pose != nullptr && !is_unmoved(object);
  const ExactPoint exact{kernel::Vector<Dyadic>(point), Dyadic(1.0)};
  QuotientPoint seen = is_given ? seen_exactly(*object.pose, exact) : QuotientPoint(exact.at, exact.weight);
  CrossingCount<QuotientPoint> count(std::move(seen), AxisDirection{});
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle own = mesh.triangle(i);
    if (count(i, is_given ? own : place(object.frame, own), kInfinity) < 0) break;
  }
  return count.found().side;
}

}  // namespace collided::engine
