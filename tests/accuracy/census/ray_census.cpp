#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/accuracy/census/inputs.hpp"
#include "tests/accuracy/census/peers.hpp"
#include "tests/accuracy/census/ray_inputs.hpp"
#include "tests/accuracy/census/subjects.hpp"

namespace collided::census {
using namespace engine;
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
    return line_meets_triangle<T>(ray.origin, ray.direction, end_of<T>(ray),
                                  Corners<T>{Vec<T>(t.a), Vec<T>(t.b), Vec<T>(t.c)});
  };
  const auto small = [](const GridPoint& p) {
    return std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])}) < (1 << 24);
  };
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
  const auto direction_length = static_cast<std::int64_t>(std::llround(
      std::sqrt(static_cast<double>(ray.direction[0] * ray.direction[0] + ray.direction[1] * ray.direction[1] +
                                    ray.direction[2] * ray.direction[2]))));
  const GridPoint end = ray.origin + (ray.length / direction_length) * ray.direction;
  return at_most(squared_distance<Wide>(ray.origin, end, pill.a, pill.b), reach2);
}

bool meets(const RayInput& ray, const BoxInput& box) {
  LineEnd<Wide> end = end_of<Wide>(ray);
  end.length = end.length * Wide(std::int64_t{1} << box.shift);
  return line_meets_box<Wide>(finer<Wide>(ray.origin, box.shift), ray.direction, end, grid_box<Wide>(box));
}

template <class Shape>
struct RayCase {
  Ray ray;
  Shape shape;
  bool meets = false;
};

template <class Shape, class Input>
RayCase<Shape> ray_case(Maker& make, const std::pair<RayInput, Input>& input) {
  const Placing at = make.placing();
  return {placed(input.first, at), placed(input.second, at), meets(input.first, input.second)};
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
    take<RayCase<Shape>>(
        table, query, name(family), count, [&] { return ray_case<Shape>(make, make_case(make)); }, methods);
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
    take<TriangleCase>(
        table, "ray_triangle", "vertex", count, [&] { return ray_case<Triangle>(make, vertex_case(make)); }, methods);
    take<TriangleCase>(
        table, "ray_triangle", "edge", count, [&] { return ray_case<Triangle>(make, edge_case(make)); }, methods);
    take<TriangleCase>(
        table, "ray_triangle", "grazing", count, [&] { return ray_case<Triangle>(make, grazing_case(make)); }, methods);
  }
  subject<Sphere>(table, effort, "ray_sphere", ball_case, 2'000'000);
  subject<Box>(table, effort, "ray_box", box_case, 2'000'000);
  subject<Capsule>(table, effort, "ray_capsule", pill_case, 2'000'000);
}

}  // namespace collided::census
