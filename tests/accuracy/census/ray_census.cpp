#include "server/exact_phase/ray_cast.hpp"
#include "tests/accuracy/census/inputs.hpp"
#include "tests/accuracy/census/peers.hpp"
#include "tests/accuracy/census/subjects.hpp"

namespace collided::census {
namespace {

/// Degree 3 without a length, 10 with one.
using Narrow = Int128;
using Wide = WideInt<8>;

template <class T>
LineEnd<T> end_of(const RayInput& ray) {
  LineEnd<T> end;
  if (ray.length < 0) return end;
  end.kind = LineEnd<T>::at_length;
  end.length = T(ray.length);
  return end;
}

bool meets(const RayInput& ray, const TriangleInput& t) {
  const auto ask = [&]<class T>(T) {
    return line_meets_triangle<T>(ray.origin, ray.direction, end_of<T>(ray), Corners<T>{Vec<T>(t.a), Vec<T>(t.b), Vec<T>(t.c)});
  };
  const auto small = [](const GridPoint& p) { return std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])}) < (1 << 24); };
  // Flat triangles and rays in their plane have truths of degree 5, 24 bits each.
  if (ray.length < 0 && small(t.a) && small(t.b) && small(t.c) && small(ray.origin) && small(ray.direction)) {
    return ask(Narrow{});
  }
  return ask(Wide{});
}

bool meets(const RayInput& ray, const BallInput& ball) {
  return line_meets_ball<Wide>(ray.origin, ray.direction, end_of<Wide>(ray), ball.center, Wide(ball.radius));
}

bool meets(const RayInput& ray, const PillInput& pill) {
  const Wide reach2 = Wide(pill.radius) * Wide(pill.radius);
  if (ray.length < 0) return at_most(squared_distance_to_ray<Wide>(ray.origin, ray.direction, pill.a, pill.b), reach2);
  // The end is on the grid: the length is a whole number of directions.
  const auto direction_length = static_cast<std::int64_t>(std::llround(std::sqrt(
      static_cast<double>(ray.direction[0] * ray.direction[0] + ray.direction[1] * ray.direction[1] + ray.direction[2] * ray.direction[2]))));
  const GridPoint end = ray.origin + (ray.length / direction_length) * ray.direction;
  return at_most(squared_distance<Wide>(ray.origin, end, pill.a, pill.b), reach2);
}

bool meets(const RayInput& ray, const BoxInput& box) {
  LineEnd<Wide> end = end_of<Wide>(ray);
  end.length = end.length * Wide(std::int64_t{1} << box.shift);
  return line_meets_box<Wide>(finer<Wide>(ray.origin, box.shift), ray.direction, end, grid_box<Wide>(box));
}

/// A direction whose length is whole: any of these, mirrored and swapped, times a factor.
GridPoint whole_direction(Maker& make) {
  static constexpr std::int64_t kQuadruples[][3] = {{1, 2, 2}, {2, 3, 6}, {1, 4, 8}, {4, 4, 7}, {2, 6, 9}, {6, 6, 7}, {3, 4, 12}, {0, 3, 4}, {0, 0, 1}};
  const auto& q = kQuadruples[make.whole(0, 8)];
  const auto first = static_cast<std::size_t>(make.whole(0, 2));
  GridPoint d;
  for (std::size_t k = 0; k < 3; ++k) d[(first + k) % 3] = (make.whole(0, 1) == 0 ? 1 : -1) * q[k];
  return d;
}

std::int64_t length_of(const GridPoint& d) {
  return std::llround(std::sqrt(static_cast<double>(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])));
}

/// From a random origin through `target`, or (one in four) from a grid point behind it along a direction of whole
/// length, ending at the target, one step before it or one after.
RayInput ray_through(Maker& make, const GridPoint& target) {
  if (make.whole(0, 3) != 0) {
    RayInput ray{make.point(), {}};
    ray.direction = target + make.nudged() - ray.origin;
    if (ray.direction == GridPoint{0, 0, 0}) ray.direction = {1, 0, 0};
    return ray;
  }
  const GridPoint d = whole_direction(make);
  const std::int64_t steps = make.whole(0, make.family() == Family::lattice ? 2 : 1 << 18);
  return {target - steps * d, d, (steps + make.nudge() > 0 ? steps + make.nudge() : 0) * length_of(d)};
}

RayInput any_ray(Maker& make) {
  RayInput ray{make.point(), make.point() - make.point()};
  while (ray.direction == GridPoint{0, 0, 0}) ray.direction = make.point() - make.point();
  return ray;
}

template <class Shape>
struct RayCase {
  Ray ray;
  Shape shape;
  bool meets = false;
};

template <class Shape, class Input>
RayCase<Shape> ray_case(Maker& make, const RayInput& ray, const Input& shape) {
  const Placing at = make.placing();
  return {placed(ray, at), placed(shape, at), meets(ray, shape)};
}

/// In the triangle's plane, or off it by one step in 2^20.
RayInput grazing_ray(Maker& make, const TriangleInput& t) {
  RayInput ray{t.a + 3 * (t.b - t.a) - 2 * (t.c - t.a) + make.nudged(), {}};
  ray.direction = make.on(t) + make.nudged() - ray.origin;
  if (ray.direction == GridPoint{0, 0, 0}) ray.direction = {0, 0, 1};
  return ray;
}

auto triangle_case(Maker& make) {
  const TriangleInput t = make.triangle();
  if (!make.aims()) return ray_case<Triangle>(make, any_ray(make), t);
  const bool graze = make.whole(0, 3) == 0;
  return ray_case<Triangle>(make, graze ? grazing_ray(make, t) : ray_through(make, make.on(t)), t);
}

RayInput ray_towards(Maker& make, const GridPoint& target) {
  RayInput ray{make.point(), {}};
  ray.direction = target - ray.origin;
  if (ray.direction == GridPoint{0, 0, 0}) ray.direction = {1, 0, 0};
  return ray;
}

/// Exactly through a corner: always a hit.
auto vertex_case(Maker& make) {
  const TriangleInput t = make.triangle();
  return ray_case<Triangle>(make, ray_towards(make, t.b), t);
}

/// Exactly through an edge: always a hit.
auto edge_case(Maker& make) {
  const TriangleInput t = make.triangle();
  GridPoint target = t.a;
  const std::int64_t i = make.whole(1, 7);
  for (std::size_t k = 0; k < 3; ++k) target[k] += i * (t.b[k] - t.a[k]) / 8;
  return ray_case<Triangle>(make, ray_towards(make, target), t);
}

auto grazing_case(Maker& make) {
  const TriangleInput t = make.triangle();
  return ray_case<Triangle>(make, grazing_ray(make, t), t);
}

auto box_case(Maker& make) {
  const BoxInput b = make.box();
  return ray_case<Box>(make, make.aims() ? ray_through(make, make.on(b)) : any_ray(make), b);
}

/// The radius is worked out from the ray's line, so that the ray is a tangent but for one step.
auto ball_case(Maker& make) {
  BallInput ball = make.ball();
  if (!make.aims()) return ray_case<Sphere>(make, any_ray(make), ball);
  const RayInput ray = make.whole(0, 1) == 0 ? any_ray(make) : ray_through(make, make.point());
  const Fraction<Wide> squared = squared_distance_to_ray<Wide>(ray.origin, ray.direction, ball.center, ball.center);
  ball.radius = touching_radius(make, approximate(squared.numerator) / approximate(squared.denominator));
  return ray_case<Sphere>(make, ray, ball);
}

auto pill_case(Maker& make) {
  PillInput pill = make.pill();
  if (!make.aims()) return ray_case<Capsule>(make, any_ray(make), pill);
  const RayInput ray = make.whole(0, 1) == 0 ? any_ray(make) : ray_through(make, make.point());
  const Fraction<Wide> squared = squared_distance_to_ray<Wide>(ray.origin, ray.direction, pill.a, pill.b);
  pill.radius = touching_radius(make, approximate(squared.numerator) / approximate(squared.denominator));
  return ray_case<Capsule>(make, ray, pill);
}

template <class Shape>
std::vector<Method<RayCase<Shape>>> ours() {
  return {method<RayCase<Shape>>(kOurs, [](const RayCase<Shape>& c) {
    RayHit hit;
    return cast_ray(c.ray, c.shape, hit).decision;
  })};
}

template <class Shape, class MakeCase>
void subject(Table& table, const Effort& effort, const char* query, MakeCase make_case, std::uint64_t random_long,
             std::vector<Method<RayCase<Shape>>> peers = {}) {
  if (!effort.wants(query)) return;
  std::vector<Method<RayCase<Shape>>> methods = ours<Shape>();
  for (auto& peer : peers) methods.push_back(std::move(peer));
  for (const Family family : kAllFamilies) {
    Maker make(effort.generator, family);
    const std::uint64_t count = family == Family::random ? effort.count(random_long) : effort.count(10'000'000 / 5);
    take<RayCase<Shape>>(table, query, name(family), count, [&] { return make_case(make); }, methods);
  }
}

}  // namespace

void count_rays(Table& table, const Effort& effort) {
  using TriangleCase = RayCase<Triangle>;
  std::vector<Method<TriangleCase>> peers;
  const auto by = [&](const char* peer, bool (*ask)(const Ray&, const Triangle&)) {
    peers.push_back(method<TriangleCase>(
        peer, [ask](const TriangleCase& c) { return ask(c.ray, c.shape) ? Decision::yes : Decision::no; },
        effort.peer_count));
  };
  by("plain_float", plain_float_ray);
  by("plain_double", plain_double_ray);
  subject<Triangle>(table, effort, "ray_triangle", triangle_case, 100'000'000, peers);
  if (effort.wants("ray_triangle")) {
    std::vector<Method<TriangleCase>> methods = ours<Triangle>();
    methods.insert(methods.end(), peers.begin(), peers.end());
    Maker make(effort.generator, Family::touching);
    const std::uint64_t count = effort.count(2'000'000);
    take<TriangleCase>(table, "ray_triangle", "vertex", count, [&] { return vertex_case(make); }, methods);
    take<TriangleCase>(table, "ray_triangle", "edge", count, [&] { return edge_case(make); }, methods);
    take<TriangleCase>(table, "ray_triangle", "grazing", count, [&] { return grazing_case(make); }, methods);
  }
  subject<Sphere>(table, effort, "ray_sphere", ball_case, 2'000'000);
  subject<Box>(table, effort, "ray_box", box_case, 2'000'000);
  subject<Capsule>(table, effort, "ray_capsule", pill_case, 2'000'000);
}

}  // namespace collided::census
