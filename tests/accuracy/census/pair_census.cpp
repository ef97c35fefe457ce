#include "server/exact_phase/overlap/overlap.hpp"
#include "tests/accuracy/census/inputs.hpp"
#include "tests/accuracy/census/pair_inputs.hpp"
#include "tests/accuracy/census/peers.hpp"
#include "tests/accuracy/census/subjects.hpp"

namespace collided::census {
using namespace engine;
namespace {

using Narrow = Int128;

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

template <class A, class B>
struct PairCase {
  A a;
  B b;
  bool meets = false;
};

template <class A, class B, class InputA, class InputB>
PairCase<A, B> pair_case(Maker& make, const std::pair<InputA, InputB>& input) {
  const auto& [a, b] = input;
  const Placing at = make.placing();
  return {placed(a, at), placed(b, at), meets(a, b)};
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
    take<PairCase<A, B>>(
        table, query, name(family), effort.count(10'000'000 / 6 + 1),
        [&] { return pair_case<A, B>(make, make_case(make)); }, methods);
  }
}

}  // namespace

void count_pairs(Table& table, const Effort& effort) {
  using TrianglePair = PairCase<Triangle, Triangle>;
  std::vector<Method<TrianglePair>> peers;
  peers.push_back(method<TrianglePair>(
      "moeller_double",
      [](const TrianglePair& c) { return moeller_triangles(c.a, c.b) ? Decision::yes : Decision::no; },
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
