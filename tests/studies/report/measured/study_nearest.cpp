#include <algorithm>
#include <cmath>
#include <random>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/exact_phase/arithmetic/precision.hpp"
#include "server/exact_phase/distance/closest.hpp"
#include "server/exact_phase/exactly.hpp"
#include "tests/studies/report/measured/studies.hpp"
#include "tests/studies/report/methods/near_walk.hpp"
#include "tests/studies/report/methods/peer_method.hpp"
#include "tests/studies/report/methods/plain.hpp"

namespace collided::report {
using namespace engine;
namespace {

using oracle::Wide;

/// By force: rationals for every triangle that plain double finds within a hair of the nearest.
Truth truth_of(const TriangleMesh& mesh, const Vec3& point) {
  std::vector<double> distances(mesh.triangles.size());
  double least = INFINITY;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle t = mesh.triangle(i);
    // No triangle is nearer than its first corner less its longest edge from there.
    const double reach = std::sqrt(std::max((t.b - t.a).squaredNorm(), (t.c - t.a).squaredNorm()));
    const double lower = (point - t.a).norm() - reach;
    distances[i] = lower > least * (1 + 1e-6) + 1e-9 ? INFINITY : plain_distance(V<double>(point), t);
    least = std::min(least, distances[i]);
  }
  std::optional<oracle::Rational> nearest;
  const oracle::Figure asked = oracle::figure(Sphere{point, 0});
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    if (distances[i] > least * (1 + 1e-6) + 1e-9) continue;
    const oracle::Rational squared = oracle::squared_distance(asked, oracle::figure(mesh.triangle(i)));
    if (!nearest || squared < *nearest) nearest = squared;
  }
  return {true, sqrt(Wide(*nearest))};
}

template <class T>
Answer plain_answer(const Vec3& point, const Triangle& t) {
  return {true, static_cast<double>(plain_distance(V<T>(point), t)), 0};
}

Answer exact_answer(const Vec3& point, const Triangle& t) {
  const Closest found = exactly::closest(point, t);
  return {true, found.distance_m, found.distance_error_m};
}

Answer without_bound(Answer answer) {
  answer.bound = kUnknown;
  return answer;
}

}  // namespace

Answer certified_distance(const Vec3& point, const Triangle& t) {
  const Closest found = closest(point, t);
  return {true, found.distance_m, found.distance_error_m};
}

Answer nearest_in(const Bvh& tree, const TriangleMesh& mesh, const Vec3& point, DistanceTo distance) {
  Answer best;
  const auto look = [&](std::uint32_t triangle, double limit_m2) {
    const Answer found = distance(point, mesh.triangle(triangle));
    if (!best.yes || found.value < best.value) best = found;
    const double reach = (best.value + best.bound) * (1 + 0x1p-50);
    return std::min(limit_m2, reach * reach * (1 + 0x1p-50));
  };
  WalkCost cost;
  tree.walk_near(point, INFINITY, 0, look, cost);
  return best;
}

std::vector<Vec3> points_around(const TriangleMesh& mesh, int count, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> power(-6, 0);
  std::vector<Vec3> points;
  const double size = extent(mesh);
  for (int i = 0; i < count; ++i) {
    const Triangle t = mesh.triangle(static_cast<std::uint32_t>(random() % mesh.triangles.size()));
    const double x = normal(random);
    const double y = normal(random);
    const Vec3 away = Vec3(x, y, normal(random)).normalized();
    const Vec3 point = (t.a + t.b + t.c) / 3 + size * std::pow(10.0, power(random)) * away;
    points.push_back(point.cast<float>().cast<double>());
  }
  return points;
}

std::vector<Row> study_nearest(const Setting& setting) {
  std::mt19937_64 random(setting.seed + 2);
  const NamedMesh scene = report_mesh(setting.quick);
  const Bvh tree = Bvh::build(scene.mesh);
  const std::vector<Vec3> points = points_around(scene.mesh, setting.count(2000), random);
  std::vector<Truth> truth;
  PeerProblem problem{"nearest", scene.mesh, 3, {}};
  for (const Vec3& p : points) {
    truth.push_back(truth_of(scene.mesh, p));
    problem.numbers.insert(problem.numbers.end(), {p[0], p[1], p[2]});
  }
  const auto method = [&](const std::string& series, const std::string& label, DistanceTo distance, bool bounded,
                          const Precision& precision = {}, double knob = kUnknown) {
    return Method{series, label, knob, each(points, [&, distance, bounded, precision](const Vec3& point) {
                    const PrecisionScope scope(precision);
                    const Answer found = nearest_in(tree, scene.mesh, point, distance);
                    return bounded ? found : without_bound(found);
                  })};
  };
  std::vector<Method> methods{
      method("ours: uncertified", "float", plain_answer<float>, false),
      method("ours: uncertified", "double", plain_answer<double>, false),
      method("ours: certified", "bounded double", certified_distance, true, {.highest = Level::filter}),
      method("ours: certified", "exact on doubt", certified_distance, true),
      method("ours: certified", "rationals always", exact_answer, true)};
  for (const double asked : asked_errors(setting.quick)) {
    methods.push_back(
        method("ours: error asked", short_number(asked, 1), certified_distance, true, {.error_asked_m = asked}, asked));
  }
  const auto file = problem_file(setting, "nearest");
  write_problem(file, problem);
  add_peer(methods, setting, "peer_cgal", "", file, "CGAL 5.5", "exact predicates");
  return measure("nearest", scene.name, methods, truth, extent(scene.mesh), setting.repeats());
}

}  // namespace collided::report
