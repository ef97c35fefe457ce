#include <algorithm>
#include <array>

#include "server/exact_phase/box_kernel.hpp"
#include "server/exact_phase/overlap.hpp"
#include "server/exact_phase/ray_cast.hpp"
#include "server/exact_phase/ray_kernel.hpp"
#include "server/exact_phase/value.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided {
namespace {

using namespace kernel;

Verdict joined(const Verdict& a, const Verdict& b) {
  return {either(a.decision, b.decision), std::max(a.level, b.level)};
}

/// Where a ray is inside a round thing: a s^2 + 2 b s + c <= 0, with the quarter discriminant b^2 - a c computed apart
/// because a cross product gives it without cancellation.
template <class N>
struct Quadratic {
  N a;
  N b;
  N c;
  N discriminant;
};

template <class N>
Quadratic<N> ball_along(const Ray& ray, const Vec3& center, double radius_m) {
  const Vector<N> d(ray.direction);
  const Vector<N> m = Vector<N>(ray.origin) - Vector<N>(center);
  const N r2 = N(radius_m) * N(radius_m);
  const N dd = square(d);
  return {dd, dot(m, d), square(m) - r2, r2 * dd - square(cross(m, d))};
}

template <class N>
Quadratic<N> cylinder_along(const Ray& ray, const Capsule& capsule) {
  const Vector<N> d(ray.direction);
  const Vector<N> m = Vector<N>(ray.origin) - Vector<N>(capsule.a);
  const Vector<N> axis = Vector<N>(capsule.b) - Vector<N>(capsule.a);
  const N r2 = N(capsule.radius_m) * N(capsule.radius_m);
  const N ww = square(axis);
  const Vector<N> m_across = cross(m, axis);
  const Vector<N> d_across = cross(d, axis);
  const N dd = square(d_across);
  const N skew = dot(axis, cross(m, d));
  return {dd, dot(m_across, d_across), square(m_across) - r2 * ww, ww * (r2 * dd - skew * skew)};
}

/// The first root lies ahead and within the length, for a start outside (c > 0).
template <class N>
Decision enters(const Quadratic<N>& q, const Ray& ray) {
  AllOf all;
  if (all.add(is_positive(-q.b))) return Decision::no;
  if (all.add(at_most(N(0.0), q.discriminant))) return Decision::no;
  if (std::isinf(ray.length_m)) return all.result();
  // The end at L |d|^-1 is past the vertex, or inside: a L^2 + c d.d <= 2 |b| L |d|.
  const N dd = square(Vector<N>(ray.direction));
  const N limit = N(ray.length_m);
  const N limit2 = limit * limit;
  const N past = q.a * limit2 + q.c * dd;
  AnyOf reaches;
  if (!reaches.add(at_most(q.b * q.b * dd, limit2 * (q.a * q.a))) && !reaches.add(at_most(past, N(0.0)))) {
    reaches.add(at_most(past * past, N(4.0) * (limit2 * (q.b * q.b * dd))));
  }
  all.add(reaches.result());
  return all.result();
}

template <class N>
Scaled root_of_discriminant(const Quadratic<N>& q) {
  return sign(q.discriminant) == Sign::negative ? Scaled{} : sqrt(scaled(q.discriminant));
}

/// First root for b < 0 and c >= 0: c / (-b + sqrt(D)) adds what the textbook form subtracts.
template <class N>
Scaled entry(const Quadratic<N>& q) {
  if (sign(q.c) == Sign::zero) return {};
  return scaled(q.c) / (scaled(-q.b) + root_of_discriminant(q));
}

/// Second root, for c <= 0 or b < 0.
template <class N>
Scaled exit(const Quadratic<N>& q) {
  const Scaled root = root_of_discriminant(q);
  if (sign(q.b) == Sign::negative) return (scaled(-q.b) + root) / scaled(q.a);
  if (sign(q.c) == Sign::zero) return {};
  return scaled(-q.c) / (scaled(q.b) + root);
}

template <class N>
Scaled length_of(const Ray& ray) {
  return sqrt(scaled(square(Vector<N>(ray.direction))));
}

/// value<N>() in double, and exactly where that is not sharp.
template <class Value>
Bounded sharpened(const Value& value) {
  const Bounded quick = value.template operator()<Bounded>();
  return sharp(quick, kRefineRay) ? quick : value.template operator()<Dyadic>();
}

Bounded entry_distance(const Ray& ray, const Vec3& center, double radius_m) {
  return sharpened([&]<class N>() {
    return plain(entry(ball_along<N>(ray, center, radius_m)) * length_of<N>(ray));
  });
}

Bounded exit_distance(const Ray& ray, const Vec3& center, double radius_m) {
  return sharpened([&]<class N>() {
    return plain(exit(ball_along<N>(ray, center, radius_m)) * length_of<N>(ray));
  });
}

Vec3 at_distance(const Ray& ray, double distance_m) {
  return ray.origin + distance_m * unit(ray.direction);
}

/// Distances that differ from a start at 0, the point on the ray, and no normal yet.
void set_interval(const Ray& ray, bool inside, const Bounded& first, double exit_m, RayHit& hit) {
  hit.inside = inside;
  hit.distance_m = inside ? 0.0 : first.value;
  hit.distance_error_m = inside ? 0.0 : first.bound();
  hit.exit_m = std::max(exit_m, hit.distance_m);
  hit.point = inside ? ray.origin : at_distance(ray, first.value);
  hit.weights = Vec3::Zero();
}

/// Outward at the exit for a start inside, else against the ray; `outward` may be zero where there is no direction.
void set_normal(const Ray& ray, const Vec3& outward, RayHit& hit) {
  const Vec3 direction = unit(ray.direction);
  const Vec3 normal = unit(outward);
  hit.normal = normal.isZero(0) ? Vec3(hit.inside ? direction : -direction) : normal;
}

}  // namespace

Verdict cast_ray(const Ray& ray, const Sphere& sphere, RayHit& hit) {
  const Verdict inside = overlaps(Sphere{ray.origin, 0}, sphere);
  Verdict verdict = inside;
  if (inside.decision != Decision::yes) {
    verdict = joined(inside, climb([&]<class N>() { return enters(ball_along<N>(ray, sphere.center, sphere.radius_m), ray); }));
  }
  if (!verdict.yes()) return verdict;
  const bool starts_inside = inside.yes();
  const Bounded first = starts_inside ? Bounded() : entry_distance(ray, sphere.center, sphere.radius_m);
  const double leave = exit_distance(ray, sphere.center, sphere.radius_m).value;
  set_interval(ray, starts_inside, first, leave, hit);
  const Vec3 surface = starts_inside ? at_distance(ray, hit.exit_m) : hit.point;
  set_normal(ray, sphere.radius_m > 0 ? Vec3(surface - sphere.center) : Vec3(Vec3::Zero()), hit);
  return verdict;
}

namespace {

/// One pair of faces: the ray is between them for near <= s * speed <= far, speed >= 0. At speed 0 the two are the
/// distances to the faces and only their signs mean anything.
template <class N>
struct Slab {
  N near;
  N far;
  N speed;
  Sign direction;
};

template <class N>
std::array<Slab<N>, 3> slabs_along(const Ray& ray, const Solid<N>& box) {
  const Vector<N> w = Vector<N>(ray.origin) - box.center;
  const Vector<N> d(ray.direction);
  std::array<Slab<N>, 3> slabs;
  for (int i = 0; i < 3; ++i) {
    const N along = dot(w, box.normal[i]);
    const N speed = dot(d, box.normal[i]);
    const Sign s = sign(speed);
    if (s == Sign::negative) slabs[i] = {along - box.height[i], along + box.height[i], -speed, s};
    else slabs[i] = {-box.height[i] - along, box.height[i] - along, speed, s};
  }
  return slabs;
}

/// The slabs, the half line s >= 0 and the length have a common parameter.
template <class N>
Decision slabs_meet(const std::array<Slab<N>, 3>& slabs, const Ray& ray) {
  AllOf all;
  for (const Slab<N>& slab : slabs) {
    if (slab.direction == Sign::unsure) return Decision::undecided;
    all.add(at_most(N(0.0), slab.far));
    if (slab.direction == Sign::zero) all.add(at_most(slab.near, N(0.0)));
    if (all.result() == Decision::no) return Decision::no;
  }
  const N dd = square(Vector<N>(ray.direction));
  for (int i = 0; i < 3; ++i) {
    const Slab<N>& in = slabs[i];
    if (in.direction == Sign::zero) continue;
    for (int j = 0; j < 3; ++j) {
      if (j == i || slabs[j].direction == Sign::zero) continue;
      if (all.add(at_most(in.near * slabs[j].speed, slabs[j].far * in.speed))) return Decision::no;
    }
    if (std::isinf(ray.length_m)) continue;
    const N limit = N(ray.length_m) * in.speed;
    if (all.add(either(at_most(in.near, N(0.0)), at_most(in.near * in.near * dd, limit * limit)))) return Decision::no;
  }
  return all.result();
}

template <class N>
Decision starts_between(const std::array<Slab<N>, 3>& slabs) {
  AllOf all;
  for (const Slab<N>& slab : slabs) all.add(at_most(slab.near, N(0.0)));
  return all.result();
}

struct BoxCrossing {
  Bounded entry_m;
  Bounded exit_m;
  int entry_face = 0;
  int exit_face = 0;
  bool inside = false;
};

/// The latest entry and the earliest exit; where two compete, the bound covers both.
template <class N>
void cross_slabs(const Ray& ray, const Solid<N>& box, const std::array<Slab<N>, 3>& slabs, BoxCrossing& crossing) {
  const Scaled length = length_of<N>(ray);
  bool first = true;
  for (int i = 0; i < 3; ++i) {
    if (slabs[i].direction == Sign::zero || !box.spans()) continue;
    const Scaled speed = scaled(slabs[i].speed);
    const Bounded in = plain(scaled(slabs[i].near) / speed * length);
    const Bounded out = plain(scaled(slabs[i].far) / speed * length);
    if (first || in.value > crossing.entry_m.value) crossing.entry_face = i;
    if (first || out.value < crossing.exit_m.value) crossing.exit_face = i;
    crossing.entry_m = first ? in : greater(crossing.entry_m, in);
    crossing.exit_m = first ? out : lesser(crossing.exit_m, out);
    first = false;
  }
}

template <class N>
Decision cast_box(const Ray& ray, const Box& shape, BoxCrossing& crossing) {
  const Solid<N> box(shape);
  if (!box.spans()) return Decision::undecided;
  const std::array<Slab<N>, 3> slabs = slabs_along(ray, box);
  const Decision meets = slabs_meet(slabs, ray);
  if (meets != Decision::yes) return meets;
  const Decision inside = starts_between(slabs);
  crossing.inside = inside == Decision::yes;
  cross_slabs(ray, box, slabs, crossing);
  return inside == Decision::undecided ? inside : meets;
}

}  // namespace

Verdict cast_ray(const Ray& ray, const Box& box, RayHit& hit) {
  BoxCrossing crossing;
  const Verdict verdict = climb([&]<class N>() { return cast_box<N>(ray, box, crossing); });
  if (!verdict.yes()) return verdict;
  const Bounded& needed = crossing.inside ? crossing.exit_m : crossing.entry_m;
  if (!sharp(needed, kRefineRay)) cast_box<Dyadic>(ray, box, crossing);
  set_interval(ray, crossing.inside, crossing.entry_m, crossing.exit_m.value, hit);
  const int face = crossing.inside ? crossing.exit_face : crossing.entry_face;
  const Solid<Bounded> solid(box);
  const Vec3 normal = unit(solid.normal[face]);
  const bool flip = (normal.dot(unit(ray.direction)) > 0) != crossing.inside;
  set_normal(ray, flip ? Vec3(-normal) : normal, hit);
  return verdict;
}

namespace {

/// The sign of p + q sqrt(r) for r >= 0, asked as "at least zero".
template <class N>
Decision root_sum_not_negative(const N& p, const N& q, const N& r) {
  const Decision p_up = at_most(N(0.0), p);
  const Decision q_up = at_most(N(0.0), q);
  if (p_up == Decision::yes && q_up == Decision::yes) return Decision::yes;
  const N p2 = p * p;
  const N q2r = q * q * r;
  if (p_up == Decision::yes && q_up == Decision::no) return at_most(q2r, p2);
  if (p_up == Decision::no && q_up == Decision::yes) return at_most(p2, q2r);
  return p_up == Decision::no && q_up == Decision::no ? Decision::no : Decision::undecided;
}

/// The ray enters the round wall between the capsule's two ends. (Entries through the ends are entries of a ball.)
template <class N>
Decision enters_wall(const Ray& ray, const Capsule& capsule) {
  const Vector<N> axis = Vector<N>(capsule.b) - Vector<N>(capsule.a);
  const Decision no_axis = is_zero(axis);
  if (no_axis == Decision::yes) return Decision::no;
  const Quadratic<N> q = cylinder_along<N>(ray, capsule);
  AllOf all;
  if (all.add(is_positive(q.c)) || all.add(enters(q, ray))) return Decision::no;
  // Along the axis the entry is at start + speed s with s = (-b - sqrt(D)) / a; all times a.
  const N start = dot(Vector<N>(ray.origin) - Vector<N>(capsule.a), axis);
  const N speed = dot(Vector<N>(ray.direction), axis);
  const N at = start * q.a - speed * q.b;
  if (all.add(root_sum_not_negative(at, -speed, q.discriminant))) return Decision::no;
  all.add(root_sum_not_negative(square(axis) * q.a - at, speed, q.discriminant));
  return all.result();
}

Vec3 from_axis(const Vec3& point, const Capsule& capsule) {
  const Vec3 axis = unit(Vec3(capsule.b - capsule.a));
  const double length = (capsule.b - capsule.a).stableNorm();
  const double along = std::clamp((point - capsule.a).dot(axis), 0.0, length);
  return (point - capsule.a) - along * axis;
}

/// Second root on the round wall, as a distance, if it lies between the capsule's two ends; else 0.
template <class N>
Bounded wall_exit(const Ray& ray, const Capsule& capsule) {
  const Quadratic<N> q = cylinder_along<N>(ray, capsule);
  const Vector<N> axis = Vector<N>(capsule.b) - Vector<N>(capsule.a);
  if (sign(q.discriminant) == Sign::negative || sign(q.a) == Sign::zero) return {};
  if (sign(q.b) != Sign::negative && sign(q.c) == Sign::positive) return {};
  const Scaled parameter = exit(q);
  const N start = dot(Vector<N>(ray.origin) - Vector<N>(capsule.a), axis);
  const N speed = dot(Vector<N>(ray.direction), axis);
  const double along = plain((scaled(start) + scaled(speed) * parameter) / scaled(square(axis))).value;
  if (!(along >= 0 && along <= 1)) return {};
  return plain(parameter * length_of<N>(ray));
}

/// Where the line leaves the capsule: the last of the exits of its two balls and, between the ends, its wall.
double capsule_exit(const Ray& ray, const Capsule& capsule) {
  double last = 0;
  for (const Vec3& end : {capsule.a, capsule.b}) {
    const Bounded leave = sharpened([&]<class N>() {
      const Quadratic<N> q = ball_along<N>(ray, end, capsule.radius_m);
      const bool behind = sign(q.b) != Sign::negative && sign(q.c) == Sign::positive;
      return behind || sign(q.discriminant) == Sign::negative ? Bounded() : plain(exit(q) * length_of<N>(ray));
    });
    last = std::max(last, leave.value);
  }
  const Bounded wall = sharpened([&]<class N>() { return wall_exit<N>(ray, capsule); });
  return std::max(last, wall.value);
}

}  // namespace

Verdict cast_ray(const Ray& ray, const Capsule& capsule, RayHit& hit) {
  const Verdict inside = overlaps(Sphere{ray.origin, 0}, capsule);
  Verdict verdict = inside;
  Bounded first(std::numeric_limits<double>::max());
  const auto consider = [&](const Verdict& part, const auto& distance) {
    verdict = joined(verdict, part);
    if (part.yes()) first = lesser(first, distance());
  };
  if (inside.decision == Decision::no) {
    for (const Vec3& end : {capsule.a, capsule.b}) {
      consider(climb([&]<class N>() { return enters(ball_along<N>(ray, end, capsule.radius_m), ray); }),
               [&] { return entry_distance(ray, end, capsule.radius_m); });
    }
    consider(climb([&]<class N>() { return enters_wall<N>(ray, capsule); }), [&] {
      return sharpened([&]<class N>() { return plain(entry(cylinder_along<N>(ray, capsule)) * length_of<N>(ray)); });
    });
  }
  if (!verdict.yes()) return verdict;
  set_interval(ray, inside.yes(), first, capsule_exit(ray, capsule), hit);
  const Vec3 surface = inside.yes() ? at_distance(ray, hit.exit_m) : hit.point;
  set_normal(ray, capsule.radius_m > 0 ? from_axis(surface, capsule) : Vec3(Vec3::Zero()), hit);
  return verdict;
}

}  // namespace collided
