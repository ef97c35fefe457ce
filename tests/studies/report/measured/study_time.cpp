#include <cmath>
#include <random>

#include "server/exact_phase/motion/time_of_contact.hpp"
#include "tests/oracle/random_shapes.hpp"
#include "tests/studies/report/measured/studies.hpp"
#include "tests/studies/report/measured/time_truth.hpp"
#include "tests/studies/report/methods/peer_method.hpp"
#include "tests/studies/report/methods/plain.hpp"

namespace collided::report {
using namespace engine;
namespace {

using oracle::Wide;

struct Motion {
  MovingSphere mover;
  Triangle triangle;
};

template <class T>
Answer plain(const Motion& m) {
  const auto time = plain_time<T>(V<T>(m.mover.start), V<T>(m.mover.end), static_cast<T>(m.mover.radius_m), m.triangle);
  return time ? Answer{true, static_cast<double>(*time)} : Answer{};
}

Answer decided(const Motion& m, double width) {
  TimeBracket bracket;
  const ExactResult verdict = first_contact(m.mover, m.triangle, width, bracket);
  if (verdict.decision == Decision::undecided) return {.undecided = true};
  if (!verdict.yes()) return {};
  // The middle is rounded once; its bound is the half width and that rounding.
  const double middle = bracket.low + 0.5 * (bracket.high - bracket.low);
  return {true, middle, std::max(bracket.high - middle, middle - bracket.low) + 0x1p-53 * middle};
}

std::vector<Motion> motions(int count, std::mt19937_64& random) {
  std::vector<Motion> result;
  for (int i = 0; i < count; ++i) {
    oracle::RandomShapes shapes(random, i % 2 == 0 ? oracle::Family::random : oracle::Family::needles);
    const Triangle t = shapes.triangle();
    const Vec3 start = 2 * shapes.point();
    result.push_back({{start, start + 2 * (shapes.point() - start), 0.1 * shapes.size()}, t});
  }
  return result;
}

}  // namespace

std::vector<Row> study_time(const Setting& setting) {
  std::mt19937_64 random(setting.seed + 3);
  const std::vector<Motion> questions = motions(setting.count(800), random);
  std::vector<Truth> truth;
  PeerProblem problem{"time", {}, 16, {}};
  for (const Motion& m : questions) {
    truth.push_back(time_truth(m.mover, m.triangle));
    for (const Vec3& v : {m.mover.start, m.mover.end})
      problem.numbers.insert(problem.numbers.end(), {v[0], v[1], v[2]});
    problem.numbers.push_back(m.mover.radius_m);
    for (const Vec3& v : {m.triangle.a, m.triangle.b, m.triangle.c}) {
      problem.numbers.insert(problem.numbers.end(), {v[0], v[1], v[2]});
    }
  }
  std::vector<Method> methods{{"ours: uncertified", "float", kUnknown, each(questions, plain<float>)},
                              {"ours: uncertified", "double", kUnknown, each(questions, plain<double>)}};
  for (const double width : {1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14, 0.0}) {
    if (setting.quick && width != 0 && width != 1e-2 && width != 1e-8) continue;
    methods.push_back({"ours: width asked", "width " + short_number(width, 1), width,
                       each(questions, [width](const Motion& m) { return decided(m, width); })});
  }
  const auto file = problem_file(setting, "time");
  write_problem(file, problem);
  add_peer(methods, setting, "peer_bullet_float", "", file, "Bullet 3.24", "float");
  add_peer(methods, setting, "peer_bullet_double", "", file, "Bullet 3.24", "double");
  // Absolute, in steps: an extent of 2^53 makes the least divisor 1.
  return measure("time", "spheres moving past random triangles, half of them needles", methods, truth, 0x1p53,
                 setting.repeats());
}

}  // namespace collided::report
