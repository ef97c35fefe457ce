#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "server/exact_phase/distance/closest.hpp"
#include "server/exact_phase/distance/contact.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/oracle/random_shapes.hpp"
#include "tests/studies/report/measure.hpp"
#include "tests/studies/report/measured/pairs.hpp"
#include "tests/studies/report/measured/time_truth.hpp"
#include "tests/studies/report/methods/plain.hpp"

namespace collided::report {
using namespace engine;
namespace {

using oracle::Family;
using oracle::figure;
using oracle::Figure;
using oracle::RandomShapes;
using oracle::Wide;

constexpr Family kPairFamilies[] = {Family::random, Family::needles, Family::far_lattice};

/// Shapes are about a metre large: below a millimetre an error counts in thousandths of that.
constexpr double kLeastTruth = 1e-3;

/// Collects the answers of one cell.
class Tally {
 public:
  Tally(std::string query, std::string pair) : cell_{.query = std::move(query), .pair = std::move(pair)} {}

  void add(const Answer& given, const Truth& truth, double least = kLeastTruth) {
    if (given.undecided || given.yes != truth.yes) {
      ++cell_.wrong;
      return;
    }
    if (!given.yes) return;
    ++cell_.n;
    const Wide off = abs(Wide(given.value) - truth.value);
    // The truth has a hundred digits, and no more is asked of it.
    if (off > abs(truth.value) * Wide(1e-90) + Wide(1e-90)) {
      const Wide floor = std::max(abs(truth.value), Wide(least));
      cell_.worst_error = std::max(cell_.worst_error, static_cast<double>(Wide(off / floor)));
      cell_.worst_ratio =
          std::max(cell_.worst_ratio, given.bound > 0 ? static_cast<double>(Wide(off / Wide(given.bound))) : INFINITY);
    }
    widths_.push_back(given.bound / std::max(static_cast<double>(abs(truth.value)), least));
  }

  PairCell finish() {
    std::sort(widths_.begin(), widths_.end());
    if (!widths_.empty()) cell_.median_width = widths_[widths_.size() / 2];
    return cell_;
  }

 private:
  PairCell cell_;
  std::vector<double> widths_;
};

/// n questions of every family; `ask` says nothing when a question has no truth to compare with, and does not count.
using Ask = std::function<bool(RandomShapes&, Tally&)>;
PairCell cell(const char* query, const char* pair, unsigned long long seed, int n, const Ask& ask) {
  Tally tally(query, pair);
  std::mt19937_64 random(seed);
  for (const Family family : kPairFamilies) {
    RandomShapes shapes(random, family);
    for (int i = 0, tries = 0; i < n && tries < 40 * n; ++tries) i += ask(shapes, tally) ? 1 : 0;
  }
  return tally.finish();
}

template <class S>
Answer ray_answer(const Ray& ray, const S& shape) {
  RayHit hit;
  const ExactResult verdict = cast_ray(ray, shape, hit);
  return {verdict.yes(), hit.distance_m, hit.distance_error_m, verdict.decision == Decision::undecided};
}

template <class Make>
Ask flat_ray(Make make) {
  return [make](RandomShapes& shapes, Tally& tally) {
    const auto shape = make(shapes);
    const Ray ray = shapes.ray(false);
    const auto s = oracle::first_parameter(ray, shape);
    tally.add(ray_answer(ray, shape), s ? Truth{true, Wide(*s) * oracle::length(ray.direction)} : Truth{});
    return s.has_value();
  };
}

template <class Make>
Ask round_ray(Make make) {
  return [make](RandomShapes& shapes, Tally& tally) {
    const auto shape = make(shapes);
    const Ray ray = shapes.ray(false);
    const Figure solid = figure(shape);
    const bool meets = oracle::ray_meets(ray, solid);
    tally.add(ray_answer(ray, shape), meets ? Truth{true, oracle::first_distance(ray, solid)} : Truth{});
    return meets;
  };
}

template <class Make>
Ask nearest(Make make) {
  return [make](RandomShapes& shapes, Tally& tally) {
    const auto shape = make(shapes);
    const Vec3 point = shapes.point();
    const Closest found = closest(point, shape);
    tally.add({true, found.distance_m, found.distance_error_m},
              {true, oracle::distance(figure(Sphere{point, 0}), figure(shape))});
    return true;
  };
}

/// Depth where the cores (the sets without their radii) are apart: radii less distance.
template <class MakeA, class MakeB>
Ask round_depth(MakeA make_a, MakeB make_b) {
  return [make_a, make_b](RandomShapes& shapes, Tally& tally) {
    const auto a = make_a(shapes);
    const auto b = make_b(shapes);
    const Figure fa = figure(a);
    const Figure fb = figure(b);
    const oracle::Rational squared = oracle::squared_distance(fa, fb);
    if (squared == 0) return false;
    const oracle::Rational radii = fa.radius + fb.radius;
    const ExactResult verdict = overlaps(a, b);
    Answer given{verdict.yes(), 0, 0, verdict.decision == Decision::undecided};
    if (verdict.yes()) {
      const Contact found = contact(a, b);
      given.value = found.depth_m;
      given.bound = found.depth_error_m;
    }
    const bool touch = squared <= radii * radii;
    tally.add(given, {touch, Wide(radii) - sqrt(Wide(squared))});
    return touch;
  };
}

/// Depth of flat-sided sets: the least push along the normals of their Minkowski difference.
template <class MakeA, class MakeB>
Ask flat_depth(MakeA make_a, MakeB make_b) {
  return [make_a, make_b](RandomShapes& shapes, Tally& tally) {
    const auto a = make_a(shapes);
    const auto b = make_b(shapes);
    const ExactResult verdict = overlaps(a, b);
    // The yes or no of these pairs is compared with rationals elsewhere (ExactOverlapOracle); here it is the depth.
    if (!verdict.yes()) return false;
    const Contact found = contact(a, b);
    tally.add({true, found.depth_m, found.depth_error_m}, {true, plain_depth(Body<Wide>(a), Body<Wide>(b))});
    return true;
  };
}

template <class S>
Answer time_answer(const MovingSphere& mover, const S& other) {
  TimeBracket bracket;
  const ExactResult verdict = first_contact(mover, other, 0, bracket);
  const double middle = bracket.low + 0.5 * (bracket.high - bracket.low);
  return {verdict.yes(), middle, std::max(bracket.high - middle, middle - bracket.low) + 0x1p-53 * middle,
          verdict.decision == Decision::undecided};
}

MovingSphere mover(RandomShapes& shapes) {
  const Vec3 start = shapes.point();
  return {start, start + 2 * (shapes.point() - start), 0.25 * shapes.size()};
}

template <class Make>
Ask round_time(Make make) {
  return [make](RandomShapes& shapes, Tally& tally) {
    const auto other = make(shapes);
    const MovingSphere moving = mover(shapes);
    const Ray ray{moving.start, moving.end - moving.start};
    // The way must be a double, or the ray is another one.
    if (ray.direction.isZero(0) || ray.origin + ray.direction != moving.end) return false;
    Figure solid = figure(other);
    solid.radius += oracle::Rational(moving.radius_m);
    Truth truth;
    if (oracle::ray_meets(ray, solid)) {
      const Wide time = oracle::first_distance(ray, solid) / oracle::length(ray.direction);
      truth = {time <= 1, time};
    }
    tally.add(time_answer(moving, other), truth, 1);
    return truth.yes;
  };
}

Ask triangle_time() {
  return [](RandomShapes& shapes, Tally& tally) {
    const Triangle other = shapes.triangle();
    const MovingSphere moving = mover(shapes);
    if ((other.b - other.a).cross(other.c - other.a).isZero(0)) return false;
    const Truth truth = time_truth(moving, other);
    tally.add(time_answer(moving, other), truth, 1);
    return truth.yes;
  };
}

/// An upright box: the distance is that of each coordinate.
Ask box_time() {
  return [](RandomShapes& shapes, Tally& tally) {
    Box other = shapes.box();
    other.axes = Mat3::Identity();
    const MovingSphere moving = mover(shapes);
    const V<Wide> start(moving.start);
    const V<Wide> step = V<Wide>(moving.end) - start;
    const Truth truth = first_time([&](const Wide& t) {
      const V<Wide> from = start + step * t - V<Wide>(other.center);
      const auto beyond = [](const Wide& x, double half) { return std::max(Wide(abs(x) - Wide(half)), Wide(0)); };
      const V<Wide> away(beyond(from.x, other.half_m[0]), beyond(from.y, other.half_m[1]),
                         beyond(from.z, other.half_m[2]));
      return Wide(sqrt(away.dot(away)) - Wide(moving.radius_m));
    });
    tally.add(time_answer(moving, other), truth, 1);
    return truth.yes;
  };
}

}  // namespace

std::vector<PairCell> pair_cells(unsigned long long seed, int questions) {
  const auto sphere = [](RandomShapes& s) { return s.sphere(); };
  const auto box = [](RandomShapes& s) { return s.box(); };
  const auto capsule = [](RandomShapes& s) { return s.capsule(); };
  const auto triangle = [](RandomShapes& s) { return s.triangle(); };
  const int few = std::max(2, questions / 8);  // where the truth takes milliseconds
  std::vector<PairCell> cells;
  const auto add = [&](const char* query, const char* pair, int n, const Ask& ask) {
    cells.push_back(cell(query, pair, seed + cells.size(), n, ask));
  };
  add("distance along a ray", "ray-triangle", questions, flat_ray(triangle));
  add("distance along a ray", "ray-sphere", few, round_ray(sphere));
  add("distance along a ray", "ray-box", questions, flat_ray(box));
  add("distance along a ray", "ray-capsule", few, round_ray(capsule));
  add("nearest distance", "point-sphere", questions, nearest(sphere));
  add("nearest distance", "point-box", questions, nearest(box));
  add("nearest distance", "point-capsule", questions, nearest(capsule));
  add("nearest distance", "point-triangle", questions, nearest(triangle));
  add("depth", "sphere-sphere", questions, round_depth(sphere, sphere));
  add("depth", "sphere-box", few, round_depth(sphere, box));
  add("depth", "sphere-capsule", questions, round_depth(sphere, capsule));
  add("depth", "sphere-triangle", questions, round_depth(sphere, triangle));
  add("depth", "box-box", questions, flat_depth(box, box));
  add("depth", "box-capsule", few, round_depth(box, capsule));
  add("depth", "box-triangle", questions, flat_depth(box, triangle));
  add("depth", "capsule-capsule", questions, round_depth(capsule, capsule));
  add("depth", "capsule-triangle", questions, round_depth(capsule, triangle));
  add("depth", "triangle-triangle", questions, flat_depth(triangle, triangle));
  add("time of contact", "moving sphere-sphere", few, round_time(sphere));
  add("time of contact", "moving sphere-box", few, box_time());
  add("time of contact", "moving sphere-capsule", few, round_time(capsule));
  add("time of contact", "moving sphere-triangle", few, triangle_time());
  return cells;
}

}  // namespace collided::report
