#include <cmath>
#include <random>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/exact_phase/distance/contact.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/studies/report/measured/studies.hpp"
#include "tests/studies/report/measured/time_truth.hpp"
#include "tests/studies/report/methods/near_walk.hpp"
#include "tests/studies/report/methods/peer_method.hpp"
#include "tests/studies/report/methods/plain.hpp"

namespace collided::report {
using namespace engine;
namespace {

using oracle::Wide;

/// A place in the map: everything is `scale` metres large and `offset` of its own sizes away from the origin.
struct Place {
  double scale;
  double offset;

  Vec3 operator()(const Vec3& p) const { return scale * (p + offset * Vec3(1, 0.7, -0.4)); }
};

Vec3 in_cube(std::mt19937_64& random) {
  std::uniform_real_distribution<double> coordinate(-1, 1);
  const double x = coordinate(random);
  const double y = coordinate(random);
  return {x, y, coordinate(random)};
}

Triangle triangle(std::mt19937_64& random, const Place& place) {
  const Vec3 a = place(in_cube(random));
  const Vec3 b = place(in_cube(random));
  return {a, b, place(in_cube(random))};
}

/// Coordinates after the offset are what is asked about: the truth is that of the doubles as they are.
struct Cases {
  std::vector<Triangle> targets;
  std::vector<Sphere> spheres;
  std::vector<MovingSphere> movers;
};

Cases cases(const Place& place, int count, std::mt19937_64& random) {
  Cases all;
  std::uniform_real_distribution<double> part(0.05, 0.6);
  for (int i = 0; i < count; ++i) {
    const Triangle t = triangle(random, place);
    const double u = part(random);
    const double v = part(random) * (1 - u);
    const Vec3 target = t.a + u * (t.b - t.a) + v * (t.c - t.a);
    const Vec3 origin = place(2 * in_cube(random));
    all.targets.push_back(t);
    all.spheres.push_back({place(in_cube(random)), place.scale * part(random)});
    all.movers.push_back({origin, origin + 1.5 * (target - origin), 0.2 * place.scale * part(random)});
  }
  return all;
}

Truth depth_truth(const Sphere& sphere, const Triangle& t) {
  const Wide apart = sqrt(Wide(oracle::squared_distance(oracle::figure(Sphere{sphere.center, 0}), oracle::figure(t))));
  const Wide depth = Wide(sphere.radius_m) - apart;
  return {depth >= 0, depth};
}

Truth near_truth(const Sphere& sphere, const Triangle& t) {
  return {true, sqrt(Wide(oracle::squared_distance(oracle::figure(Sphere{sphere.center, 0}), oracle::figure(t))))};
}

Answer our_depth(const Sphere& sphere, const Triangle& t) {
  const ExactResult verdict = overlaps(sphere, t);
  if (!verdict.yes()) return {.undecided = verdict.decision == Decision::undecided};
  const Contact found = contact(sphere, t);
  return {true, found.depth_m, found.depth_error_m};
}

template <class T>
Answer plain_depth_answer(const Sphere& sphere, const Triangle& t) {
  const T depth = static_cast<T>(sphere.radius_m) - plain_distance(V<T>(sphere.center), t);
  return {depth >= 0, static_cast<double>(depth)};
}

template <class T>
Answer plain_near_answer(const Sphere& sphere, const Triangle& t) {
  return {true, static_cast<double>(plain_distance(V<T>(sphere.center), t))};
}

Answer our_time(const MovingSphere& mover, const Triangle& t) {
  TimeBracket bracket;
  const ExactResult verdict = first_contact(mover, t, 0, bracket);
  if (!verdict.yes()) return {.undecided = verdict.decision == Decision::undecided};
  const double middle = bracket.low + 0.5 * (bracket.high - bracket.low);
  return {true, middle, std::max(bracket.high - middle, middle - bracket.low) + 0x1p-53 * middle};
}

template <class T>
Answer plain_time_answer(const MovingSphere& mover, const Triangle& t) {
  const auto time = plain_time<T>(V<T>(mover.start), V<T>(mover.end), static_cast<T>(mover.radius_m), t);
  return time ? Answer{true, static_cast<double>(*time)} : Answer{};
}

/// Question i is about target i.
template <class Question, class Ask>
Method method(const std::string& series, const std::vector<Question>& questions, const std::vector<Triangle>& targets,
              Ask ask) {
  return {series, "", kUnknown, [&questions, &targets, ask](std::vector<Answer>& answers) {
            answers.resize(questions.size());
            return timed([&] {
              for (std::size_t i = 0; i < questions.size(); ++i) answers[i] = ask(questions[i], targets[i]);
            });
          }};
}

template <class Question, class Ask>
std::vector<Truth> truths(const std::vector<Question>& questions, const std::vector<Triangle>& targets, Ask ask) {
  std::vector<Truth> result;
  for (std::size_t i = 0; i < questions.size(); ++i) result.push_back(ask(questions[i], targets[i]));
  return result;
}

template <class T>
Answer plain_closest_hit(const TriangleMesh& mesh, const Ray& ray) {
  std::optional<T> first;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle t = mesh.triangle(i);
    const auto s = plain_ray<T>(V<T>(ray.origin), V<T>(ray.direction), V<T>(t.a), V<T>(t.b), V<T>(t.c));
    if (s && (!first || *s < *first)) first = s;
  }
  return first ? Answer{true, static_cast<double>(*first) * ray.direction.stableNorm()} : Answer{};
}

Answer our_closest_hit(const TriangleMesh& mesh, const Ray& ray) {
  Answer best;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    RayHit hit;
    const ExactResult verdict = cast_ray(ray, mesh.triangle(i), hit);
    if (verdict.decision == Decision::undecided) best.undecided = true;
    if (verdict.yes() && (!best.yes || hit.distance_m < best.value)) {
      best = {true, hit.distance_m, hit.distance_error_m, best.undecided};
    }
  }
  return best;
}

Truth closest_truth(const TriangleMesh& mesh, const Ray& ray) {
  std::optional<oracle::Rational> first;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto s = oracle::first_parameter(ray, mesh.triangle(i));
    if (s && (!first || *s < *first)) first = *s;
  }
  return first ? Truth{true, Wide(*first) * oracle::length(ray.direction)} : Truth{};
}

/// Rays from around an icosahedron through it, all triangles tried by everybody; Embree gets them rounded to float.
std::vector<Row> ray_rows(const Setting& setting, const Place& place, int count, std::mt19937_64& random) {
  TriangleMesh mesh = scenes::icosphere(0, 1);
  for (Vec3& v : mesh.vertices) v = place(v);
  PeerProblem problem{"ray", mesh, 6, {}};
  std::vector<Ray> rays;
  std::vector<Truth> truth;
  for (int i = 0; i < count; ++i) {
    const Vec3 origin = place(3 * in_cube(random).normalized());
    const Vec3 direction = place(0.5 * in_cube(random)) - origin;
    if (direction.isZero(0)) continue;
    rays.push_back({origin, direction});
    truth.push_back(closest_truth(mesh, rays.back()));
    problem.numbers.insert(problem.numbers.end(),
                           {origin[0], origin[1], origin[2], direction[0], direction[1], direction[2]});
  }
  const auto asked = [&](const std::string& series, Answer (*ask)(const TriangleMesh&, const Ray&)) {
    return Method{series, "", kUnknown, each(rays, [&, ask](const Ray& ray) { return ask(mesh, ray); })};
  };
  std::vector<Method> methods{asked("ours", our_closest_hit), asked("plain double", plain_closest_hit<double>),
                              asked("plain float", plain_closest_hit<float>)};
  const auto file = problem_file(setting, "extremes");
  write_problem(file, problem);
  Setting few = setting;
  few.quick = true;
  add_peer(methods, few, "peer_embree", "default", file, "Embree", "");
  return measure("extremes", "ray", methods, truth, 0, few.repeats());
}

}  // namespace

std::vector<Row> study_extremes(const Setting& setting) {
  std::mt19937_64 random(setting.seed + 6);
  const int count = setting.quick ? 6 : setting.full ? 200 : 50;
  const int step = setting.quick ? 12 : 3;
  std::vector<Row> rows;
  for (int scale = -12; scale <= 12; scale += step) {
    for (int offset = -1; offset <= 12; offset += setting.quick ? 4 : 1) {
      const Place place{std::pow(10.0, scale), offset < 0 ? 0 : std::pow(10.0, offset)};
      const Cases all = cases(place, count, random);
      const auto run = [&](const std::string& query, const std::vector<Method>& methods,
                           const std::vector<Truth>& truth) {
        for (Row& row : measure("extremes", query, methods, truth, 0, 1)) {
          row.label = short_number(place.offset, 1);
          row.knob = place.scale;
          rows.push_back(row);
        }
      };
      const auto& targets = all.targets;
      for (Row& row : ray_rows(setting, place, count, random)) {
        row.label = short_number(place.offset, 1);
        row.knob = place.scale;
        rows.push_back(row);
      }
      run("sphere overlap",
          {method("ours", all.spheres, targets, our_depth),
           method("plain double", all.spheres, targets, plain_depth_answer<double>),
           method("plain float", all.spheres, targets, plain_depth_answer<float>)},
          truths(all.spheres, targets, depth_truth));
      const auto our_near = [](const Sphere& s, const Triangle& t) { return certified_distance(s.center, t); };
      run("nearest",
          {method("ours", all.spheres, targets, our_near),
           method("plain double", all.spheres, targets, plain_near_answer<double>),
           method("plain float", all.spheres, targets, plain_near_answer<float>)},
          truths(all.spheres, targets, near_truth));
      const std::size_t fewer = std::max<std::size_t>(3, all.movers.size() / 10);
      const std::vector<MovingSphere> movers(all.movers.begin(), all.movers.begin() + fewer);
      run("time of contact",
          {method("ours", movers, targets, our_time),
           method("plain double", movers, targets, plain_time_answer<double>),
           method("plain float", movers, targets, plain_time_answer<float>)},
          truths(movers, targets, time_truth));
    }
  }
  return rows;
}

}  // namespace collided::report
