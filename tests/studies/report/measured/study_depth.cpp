#include <random>

#include "server/exact_phase/arithmetic/precision.hpp"
#include "server/exact_phase/distance/contact.hpp"
#include "server/exact_phase/exactly.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "tests/oracle/random_shapes.hpp"
#include "tests/studies/report/measured/studies.hpp"
#include "tests/studies/report/methods/peer_method.hpp"
#include "tests/studies/report/methods/plain.hpp"

namespace collided::report {
using namespace engine;
namespace {

using oracle::Family;
using oracle::RandomShapes;
using oracle::Wide;

template <class A, class B>
struct Pair {
  A a;
  B b;
};

template <class A, class B>
Answer decided(const Pair<A, B>& pair) {
  const ExactResult verdict = overlaps(pair.a, pair.b);
  if (verdict.decision == Decision::undecided) return {.undecided = true};
  if (!verdict.yes()) return {};
  const Contact found = contact(pair.a, pair.b);
  return {true, found.depth_m, found.depth_error_m};
}

template <class T>
Answer plain(const Pair<Sphere, Triangle>& pair) {
  const T depth = static_cast<T>(pair.a.radius_m) - plain_distance(V<T>(pair.a.center), pair.b);
  return {depth >= 0, static_cast<double>(depth)};
}

template <class T, class B>
Answer plain(const Pair<Box, B>& pair) {
  const T depth = plain_depth(Body<T>(pair.a), Body<T>(pair.b));
  return {depth >= 0, static_cast<double>(depth)};
}

/// A sphere's centre off the triangle: radius minus the distance, which is the root of a rational.
Truth truth_of(const Pair<Sphere, Triangle>& pair) {
  const Wide apart =
      sqrt(Wide(oracle::squared_distance(oracle::figure(Sphere{pair.a.center, 0}), oracle::figure(pair.b))));
  const Wide depth = Wide(pair.a.radius_m) - apart;
  return {depth >= 0, depth};
}

/// The least push along the normals of the Minkowski difference, in a hundred digits.
template <class B>
Truth truth_of(const Pair<Box, B>& pair) {
  const Wide depth = plain_depth(Body<Wide>(pair.a), Body<Wide>(pair.b));
  return {depth >= 0, depth};
}

void append(std::vector<double>& numbers, const Sphere& s) {
  numbers.insert(numbers.end(), {s.center[0], s.center[1], s.center[2], s.radius_m});
}
void append(std::vector<double>& numbers, const Triangle& t) {
  for (const Vec3& v : {t.a, t.b, t.c}) numbers.insert(numbers.end(), {v[0], v[1], v[2]});
}
void append(std::vector<double>& numbers, const Box& b) {
  numbers.insert(numbers.end(), b.center.data(), b.center.data() + 3);
  numbers.insert(numbers.end(), b.axes.data(), b.axes.data() + 9);
  numbers.insert(numbers.end(), b.half_m.data(), b.half_m.data() + 3);
}

template <class A, class B>
std::vector<Method> our_methods(const std::vector<Pair<A, B>>& pairs, const Setting& setting) {
  const auto with = [&](const std::string& series, const std::string& label, const Precision& precision, double knob) {
    return Method{series, label, knob, each(pairs, [precision](const Pair<A, B>& pair) {
                    const PrecisionScope scope(precision);
                    return decided(pair);
                  })};
  };
  std::vector<Method> methods{
      {"ours: uncertified", "float", kUnknown, each(pairs, [](const auto& pair) { return plain<float>(pair); })},
      {"ours: uncertified", "double", kUnknown, each(pairs, [](const auto& pair) { return plain<double>(pair); })}};
  methods.push_back(with("ours: certified", "bounded double", {.highest = Level::filter}, kUnknown));
  methods.push_back(with("ours: certified", "exact on doubt", {}, kUnknown));
  for (const double asked : asked_errors(setting.quick)) {
    methods.push_back(with("ours: error asked", short_number(asked, 1), {.error_asked_m = asked}, asked));
  }
  return methods;
}

template <class A, class B>
std::vector<Row> run(const Setting& setting, const std::string& study, const std::string& scene,
                     const std::vector<Pair<A, B>>& pairs, const std::string& kind) {
  std::vector<Truth> truth;
  PeerProblem problem{kind, {}, 0, {}};
  for (const Pair<A, B>& pair : pairs) {
    truth.push_back(truth_of(pair));
    append(problem.numbers, pair.a);
    append(problem.numbers, pair.b);
    if (problem.numbers_each == 0) problem.numbers_each = problem.numbers.size();
  }
  std::vector<Method> methods = our_methods(pairs, setting);
  const auto file = problem_file(setting, study);
  write_problem(file, problem);
  add_peer(methods, setting, "peer_bullet_float", "", file, "Bullet 3.24", "float");
  add_peer(methods, setting, "peer_bullet_double", "", file, "Bullet 3.24", "double");
  add_peer(methods, setting, "peer_fcl", "", file, "FCL 0.7 (libccd)", "double");
  return measure(study, scene, methods, truth, 1, setting.repeats());
}

void add(std::vector<Row>& rows, const std::vector<Row>& more) { rows.insert(rows.end(), more.begin(), more.end()); }

}  // namespace

std::vector<Row> study_depth(const Setting& setting) {
  std::mt19937_64 random(setting.seed + 1);
  const int count = setting.count(2000);
  std::vector<Row> rows;
  std::vector<Pair<Sphere, Triangle>> spheres;
  std::vector<Pair<Box, Triangle>> boxes;
  std::vector<Pair<Box, Box>> pairs;
  // Half at random, half with sizes down to a millionth.
  for (int i = 0; i < count; ++i) {
    RandomShapes shapes(random, i % 2 == 0 ? Family::random : Family::needles);
    spheres.push_back({shapes.sphere(), shapes.triangle()});
    RandomShapes tame(random, Family::random);
    boxes.push_back({tame.box(), shapes.triangle()});
    pairs.push_back({tame.box(), tame.box()});
  }
  add(rows, run(setting, "sphere_overlap", "random spheres and triangles in [-1, 1]^3, half of them needles", spheres,
                "sphere_triangle"));
  add(rows, run(setting, "box_overlap", "random turned boxes and triangles in [-1, 1]^3, half of them needles", boxes,
                "box_triangle"));
  add(rows, run(setting, "pair_depth", "random turned boxes in [-1, 1]^3", pairs, "box_box"));
  return rows;
}

}  // namespace collided::report
