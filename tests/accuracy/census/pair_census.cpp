#include "server/exact_phase/overlap.hpp"
#include "tests/accuracy/census/inputs.hpp"
#include "tests/accuracy/census/peers.hpp"
#include "tests/accuracy/census/subjects.hpp"

namespace collided::census {
namespace {

using Narrow = Int128;
using Wide = WideInt<8>;

template <class T>
Corners<T> corners(const TriangleInput& t, int shift = 0) {
  return {finer<T>(t.a, shift), finer<T>(t.b, shift), finer<T>(t.c, shift)};
}

Wide squared(std::int64_t n, int shift = 0) {
  const Wide finer_n = Wide(n) * Wide(std::int64_t{1} << shift);
  return finer_n * finer_n;
}

bool meets(const BallInput& a, const BallInput& b) {
  return square(Vec<Wide>(a.center - b.center)) <= squared(a.radius + b.radius);
}
bool meets(const BallInput& a, const BoxInput& b) {
  return box_within<Wide>(finer<Wide>(a.center, b.shift), grid_box<Wide>(b), squared(a.radius, b.shift));
}
bool meets(const BallInput& a, const PillInput& b) {
  return at_most(squared_distance<Wide>(a.center, b.a, b.b), squared(a.radius + b.radius));
}
bool meets(const BallInput& a, const TriangleInput& b) {
  return at_most(squared_distance<Wide>(a.center, corners<Wide>(b)), squared(a.radius));
}
bool meets(const BoxInput& a, const BoxInput& b) {
  // Both in the finer of their two units.
  const int finest = std::max(a.shift, b.shift);
  const auto axes = [](const BoxInput& box) { return std::array<Vec<Wide>, 3>{box.axes[0], box.axes[1], box.axes[2]}; };
  const auto refined = [&](const BoxInput& box) {
    GridBox<Wide> solid = grid_box<Wide>(box);
    const Wide factor(std::int64_t{1} << (finest - box.shift));
    for (Vec<Wide>* v : {&solid.center, &solid.reach[0], &solid.reach[1], &solid.reach[2]}) *v = factor * *v;
    return solid;
  };
  return boxes_meet(refined(a), axes(a), refined(b), axes(b));
}
bool meets(const BoxInput& a, const PillInput& b) {
  return box_within<Wide>(finer<Wide>(b.a, a.shift), finer<Wide>(b.b, a.shift), grid_box<Wide>(a),
                          squared(b.radius, a.shift));
}
bool meets(const BoxInput& a, const TriangleInput& b) {
  return box_meets(grid_box<Wide>(a), corners<Wide>(b, a.shift));
}
bool meets(const PillInput& a, const PillInput& b) {
  return at_most(squared_distance<Wide>(a.a, a.b, b.a, b.b), squared(a.radius + b.radius));
}
bool meets(const PillInput& a, const TriangleInput& b) {
  return triangle_within<Wide>(a.a, a.b, corners<Wide>(b), squared(a.radius));
}
bool meets(const TriangleInput& a, const TriangleInput& b) {
  std::int64_t largest = 0;
  for (const TriangleInput* t : {&a, &b}) {
    for (const GridPoint* p : {&t->a, &t->b, &t->c}) {
      for (const std::int64_t x : *p) largest = std::max(largest, std::abs(x));
    }
  }
  if (largest < (1 << 26)) return triangles_meet(corners<Narrow>(a), corners<Narrow>(b));
  return triangles_meet(corners<Wide>(a), corners<Wide>(b));
}

double approximate(const Fraction<Wide>& f) { return approximate(f.numerator) / approximate(f.denominator); }

/// Moves a shape so that its point `from` comes to `to`, or one step beside it.
void move(Maker& make, TriangleInput& t, const GridPoint& from, const GridPoint& to) {
  const GridPoint step = to + make.nudged() - from;
  t = {t.a + step, t.b + step, t.c + step};
}
void move(Maker& make, BoxInput& b, const GridPoint& from, const GridPoint& to) { b.center = b.center + (to + make.nudged() - from); }

template <class A, class B>
struct PairCase {
  A a;
  B b;
  bool meets = false;
};

template <class A, class B, class InputA, class InputB>
PairCase<A, B> pair_case(Maker& make, const InputA& a, const InputB& b) {
  const Placing at = make.placing();
  return {placed(a, at), placed(b, at), meets(a, b)};
}

/// The first shape's radius, so that the pair touches when the squared distance is that of their cores.
std::int64_t rest_of(Maker& make, double squared_distance, std::int64_t other_radius) {
  return std::max<std::int64_t>(0, touching_radius(make, squared_distance) - other_radius);
}

auto ball_ball(Maker& make) {
  BallInput a = make.ball();
  const BallInput b = make.ball();
  if (make.aims()) a.radius = rest_of(make, approximate(square(Vec<Wide>(a.center - b.center))), b.radius);
  return pair_case<Sphere, Sphere>(make, a, b);
}

auto ball_box(Maker& make) {
  BallInput a = make.ball();
  const BoxInput b = make.box();
  if (make.aims()) {
    const GridBox<Wide> box = grid_box<Wide>(b);
    const Vec<Wide> center = finer<Wide>(a.center, b.shift);
    double least = approximate(squared_distance(center, box.face(0)));
    for (int k = 1; k < 12; ++k) least = std::min(least, approximate(squared_distance(center, box.face(k))));
    a.radius = touching_radius(make, std::ldexp(least, -2 * b.shift));
  }
  return pair_case<Sphere, Box>(make, a, b);
}

auto ball_pill(Maker& make) {
  BallInput a = make.ball();
  const PillInput b = make.pill();
  if (make.aims()) a.radius = rest_of(make, approximate(squared_distance<Wide>(a.center, b.a, b.b)), b.radius);
  return pair_case<Sphere, Capsule>(make, a, b);
}

auto ball_triangle(Maker& make) {
  BallInput a = make.ball();
  const TriangleInput b = make.triangle();
  if (make.aims()) a.radius = touching_radius(make, approximate(squared_distance<Wide>(a.center, corners<Wide>(b))));
  return pair_case<Sphere, Triangle>(make, a, b);
}

auto box_box(Maker& make) {
  const BoxInput a = make.box();
  BoxInput b = make.box();
  if (make.aims()) move(make, b, make.on(b), make.on(a));
  return pair_case<Box, Box>(make, a, b);
}

auto box_pill(Maker& make) {
  const BoxInput a = make.box();
  PillInput b = make.pill();
  if (make.aims()) {
    // An end or the middle of the pill stands off the box by about its radius.
    const GridPoint axis = b.b - b.a;
    const GridPoint surface = make.on(a);
    const GridPoint off{make.whole(-3, 3), make.whole(-3, 3), make.whole(-3, 3)};
    const std::int64_t far = make.size() / 8;
    b.a = surface + far * off + make.nudged();
    b.b = b.a + axis;
    const double length = static_cast<double>(far) * std::sqrt(static_cast<double>(off[0] * off[0] + off[1] * off[1] + off[2] * off[2]));
    b.radius = touching_radius(make, length * length);
  }
  return pair_case<Box, Capsule>(make, a, b);
}

auto box_triangle(Maker& make) {
  const BoxInput a = make.box();
  TriangleInput b = make.triangle();
  if (make.aims()) move(make, b, make.on(b), make.on(a));
  return pair_case<Box, Triangle>(make, a, b);
}

auto pill_pill(Maker& make) {
  PillInput a = make.pill();
  const PillInput b = make.pill();
  if (make.aims()) a.radius = rest_of(make, approximate(squared_distance<Wide>(a.a, a.b, b.a, b.b)), b.radius);
  return pair_case<Capsule, Capsule>(make, a, b);
}

auto pill_triangle(Maker& make) {
  PillInput a = make.pill();
  const TriangleInput b = make.triangle();
  if (make.aims()) {
    const Corners<Wide> t = corners<Wide>(b);
    double least = std::min(approximate(squared_distance<Wide>(a.a, t)), approximate(squared_distance<Wide>(a.b, t)));
    for (int i = 0; i < 3; ++i) {
      least = std::min(least, approximate(squared_distance<Wide>(a.a, a.b, t[i], t[(i + 1) % 3])));
    }
    a.radius = touching_radius(make, least);
  }
  return pair_case<Capsule, Triangle>(make, a, b);
}

auto triangle_triangle(Maker& make) {
  TriangleInput a = make.triangle();
  TriangleInput b = make.triangle();
  if (!make.aims()) return pair_case<Triangle, Triangle>(make, a, b);
  const std::int64_t kind = make.whole(0, 5);
  if (kind == 0) b = {a.a, a.b, make.point()};               // a shared edge
  if (kind == 1) b = {a.c, make.point(), make.point()};      // a shared vertex
  if (kind == 2) b = {make.on(a), make.on(a), make.point()}; // an edge in the other's plane
  if (kind == 3) b = {make.on(a) + make.nudged(), make.on(a) + 2 * (a.b - a.a), make.on(a) - (a.c - a.a)};  // nearly coplanar
  if (kind >= 4) move(make, b, make.on(b), make.on(a));      // edges cross, a vertex on a face, and beside it
  return pair_case<Triangle, Triangle>(make, a, b);
}

template <class A, class B, class MakeCase>
void subject(Table& table, const Effort& effort, const char* query, MakeCase make_case,
             std::vector<Method<PairCase<A, B>>> peers = {}) {
  if (!effort.wants(query)) return;
  std::vector<Method<PairCase<A, B>>> methods;
  methods.push_back(method<PairCase<A, B>>(kOurs, [](const PairCase<A, B>& c) { return overlaps(c.a, c.b).decision; }));
  for (auto& peer : peers) methods.push_back(std::move(peer));
  for (const Family family : kAllFamilies) {
    Maker make(effort.generator, family);
    take<PairCase<A, B>>(table, query, name(family), effort.count(10'000'000 / 6 + 1), [&] { return make_case(make); }, methods);
  }
}

}  // namespace

void count_pairs(Table& table, const Effort& effort) {
  using TrianglePair = PairCase<Triangle, Triangle>;
  std::vector<Method<TrianglePair>> peers;
  peers.push_back(method<TrianglePair>(
      "moeller_double", [](const TrianglePair& c) { return moeller_triangles(c.a, c.b) ? Decision::yes : Decision::no; },
      effort.peer_count));
  subject<Triangle, Triangle>(table, effort, "triangle_triangle", triangle_triangle, peers);
  subject<Sphere, Sphere>(table, effort, "sphere_sphere", ball_ball);
  subject<Sphere, Box>(table, effort, "sphere_box", ball_box);
  subject<Sphere, Capsule>(table, effort, "sphere_capsule", ball_pill);
  subject<Sphere, Triangle>(table, effort, "sphere_triangle", ball_triangle);
  subject<Box, Box>(table, effort, "box_box", box_box);
  subject<Box, Capsule>(table, effort, "box_capsule", box_pill);
  subject<Box, Triangle>(table, effort, "box_triangle", box_triangle);
  subject<Capsule, Capsule>(table, effort, "capsule_capsule", pill_pill);
  subject<Capsule, Triangle>(table, effort, "capsule_triangle", pill_triangle);
}

}  // namespace collided::census
