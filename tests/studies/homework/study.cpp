#include "tests/studies/homework/study.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <set>
#include <stdexcept>

#include "server/geometry/aabb.hpp"
#include "tests/oracle/exact_oracle.hpp"
#include "tests/oracle/moeller.hpp"
#include "tests/studies/bench/clock.hpp"

namespace collided::homework {
using namespace engine;
namespace {

constexpr std::size_t kLeastRepeats = 20;
constexpr double kDenseObjects =
    50;  // beyond these the size shrinks, so that the share of the cube that is filled stays
constexpr double kHomeworkSize = 0.2;

double size_for(double objects) {
  return objects <= kDenseObjects ? kHomeworkSize : kHomeworkSize * std::cbrt(kDenseObjects / objects);
}

double quantile(const std::vector<double>& sorted, double share) {
  const auto at = static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1) + 0.5);
  return sorted[at];
}

/// The frames forth and back, so that none is far from the one before; the answers are kept of the way forth.
class Run {
 public:
  Run(const Recording& recording, Method& method) : recording_(recording), method_(method) {}

  /// False as soon as a frame takes longer than most_s.
  bool measure(double enough_s, double most_s) {
    const std::size_t count = recording_.poses.size();
    double spent_s = 0;
    for (std::size_t i = 0; i < count; ++i) {
      take(i, spent_s);
      if (seconds.back() > most_s) return false;
      pairs.push_back(method_.pairs());
      candidates += static_cast<double>(method_.candidates()) / static_cast<double>(count);
      if (const auto polygons = method_.polygon_pairs()) {
        polygon_pairs = std::max(polygon_pairs, 0.0) + static_cast<double>(*polygons) / static_cast<double>(count);
      }
    }
    for (std::size_t round = 0; spent_s < enough_s && round < 10; ++round) {
      for (std::size_t i = 0; i < count; ++i) take(round % 2 == 0 ? count - 1 - i : i, spent_s);
    }
    std::sort(seconds.begin(), seconds.end());
    return true;
  }

  std::vector<double> seconds;
  std::vector<ObjectPairs> pairs;
  double candidates = 0;
  double polygon_pairs = -1;

 private:
  void take(std::size_t number, double& spent_s) {
    const double start = bench::thread_seconds();
    method_.frame(recording_.poses[number]);
    seconds.push_back(bench::thread_seconds() - start);
    spent_s += seconds.back();
  }

  const Recording& recording_;
  Method& method_;
};

class Study {
 public:
  explicit Study(const StudyOptions& options) : options_(options) {}

  void sweep(Sweep sweep) {
    std::set<std::size_t> left_out;
    for (const double x : places_of(sweep, options_.quick)) {
      const Problem problem = problem_at(sweep, x, options_.seed, options_.quick);
      const Recording recording = record(problem);
      std::vector<ObjectPairs> first;
      for (std::size_t m = 0; m < options_.methods.size(); ++m) {
        if (left_out.contains(m)) continue;
        const std::unique_ptr<Method> method = options_.methods[m](recording);
        Point point;
        point.sweep = sweep;
        point.x = x;
        point.problem = problem;
        point.polygons = recording.polygons;
        if (!method || !measure(recording, *method, first, point)) {
          if (m == 0) return;  // nothing to compare the others with
          left_out.insert(m);
          continue;
        }
        print(point);
        points.push_back(point);
      }
    }
  }

  std::vector<Point> points;

 private:
  /// False where a frame takes too long.
  bool measure(const Recording& recording, Method& method, std::vector<ObjectPairs>& first, Point& point) const {
    Run run(recording, method);
    if (!run.measure(options_.quick ? 0 : 0.2, options_.quick ? 0.05 : 2)) return false;
    if (first.empty()) first = run.pairs;
    point.method = method.name();
    point.repeats = run.seconds.size();
    if (point.repeats < kLeastRepeats) throw std::logic_error("too few repeats");
    point.mean_us =
        1e6 * std::accumulate(run.seconds.begin(), run.seconds.end(), 0.0) / static_cast<double>(point.repeats);
    point.median_us = 1e6 * quantile(run.seconds, 0.5);
    point.p95_us = 1e6 * quantile(run.seconds, 0.95);
    point.candidates = run.candidates;
    point.polygon_pairs = run.polygon_pairs;
    for (std::size_t f = 0; f < first.size(); ++f) {
      const Judgement judgement = judge(recording, recording.poses[f], first[f], run.pairs[f]);
      point.wrong += judgement.wrong;
      point.first_wrong += judgement.first_wrong;
      ObjectPairs common;
      std::set_intersection(first[f].begin(), first[f].end(), run.pairs[f].begin(), run.pairs[f].end(),
                            std::back_inserter(common));
      point.pairs_equal += common.size();
      point.contacts += static_cast<double>(run.pairs[f].size()) / static_cast<double>(first.size());
    }
    return true;
  }

  static void print(const Point& p) {
    std::printf(
        "%-9s %8g  %-24s median %11.1f us  p95 %11.1f us  contacts %10.2f  candidates %10.1f  wrong %zu (first %zu)\n",
        name(p.sweep), p.x, p.method.c_str(), p.median_us, p.p95_us, p.contacts, p.candidates, p.wrong, p.first_wrong);
    std::fflush(stdout);
  }

  const StudyOptions& options_;
};

}  // namespace

std::vector<double> places_of(Sweep sweep, bool quick) {
  switch (sweep) {
    case Sweep::objects:
      if (quick) return {2, 10, 50};
      return {1, 2, 5, 10, 20, 30, 40, 50, 100, 300, 1'000, 3'000, 10'000, 30'000, 100'000};
    case Sweep::polygons:
      if (quick) return {16, 64, 256};
      return {16, 64, 256, 1'024, 4'096, 16'384, 100'000};
    case Sweep::size: break;
  }
  if (quick) return {0.05, 0.2, 0.5};
  return {0.05, 0.075, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5};
}

Problem problem_at(Sweep sweep, double x, std::uint64_t seed, bool quick) {
  Problem problem;
  problem.seed = seed;
  if (sweep == Sweep::objects) {
    problem.objects = static_cast<std::size_t>(x);
    problem.relative_size = size_for(x);
  }
  if (sweep == Sweep::polygons) problem.polygons = static_cast<std::size_t>(x);
  if (sweep == Sweep::size) problem.relative_size = x;
  // Contacts of few spheres are rare: many frames tell how rare.
  if (!quick && problem.objects <= 1'000) problem.frames = problem.objects <= 50 ? 192 : 48;
  return problem;
}

const char* name(Sweep sweep) {
  static constexpr const char* kNames[] = {"objects", "polygons", "size"};
  return kNames[static_cast<int>(sweep)];
}

bool meet_exactly(const Recording& recording, const std::vector<Pose>& poses, std::uint32_t a, std::uint32_t b) {
  using Exact = oracle::Moeller<oracle::Rational>;
  const Exact meet;
  const Frame of_a = frame_of(poses[a]), of_b = frame_of(poses[b]);
  const TriangleMesh& mesh_a = *recording.mesh(a).mesh;
  const TriangleMesh& mesh_b = *recording.mesh(b).mesh;
  std::vector<std::pair<Aabb, Triangle>> sorted;
  double widest = 0;
  for (std::uint32_t i = 0; i < mesh_a.triangles.size(); ++i) {
    const Triangle t = place(of_a, mesh_a.triangle(i));
    sorted.emplace_back(bounds(t), t);
    widest = std::max(widest, sorted.back().first.high[0] - sorted.back().first.low[0]);
  }
  const auto by_low = [](const auto& p, double x) { return p.first.low[0] < x; };
  std::sort(sorted.begin(), sorted.end(), [](const auto& p, const auto& q) { return p.first.low[0] < q.first.low[0]; });
  for (std::uint32_t j = 0; j < mesh_b.triangles.size(); ++j) {
    const Triangle t = place(of_b, mesh_b.triangle(j));
    const Aabb box = bounds(t);
    for (auto near = std::lower_bound(sorted.begin(), sorted.end(), box.low[0] - 1.001 * widest, by_low);
         near != sorted.end() && near->first.low[0] <= box.high[0]; ++near) {
      if (overlaps(near->first, box) && meet(Exact::corners(near->second), Exact::corners(t))) return true;
    }
  }
  return false;
}

Judgement judge(const Recording& recording, const std::vector<Pose>& poses, const ObjectPairs& first,
                const ObjectPairs& other) {
  ObjectPairs differ;
  std::set_symmetric_difference(first.begin(), first.end(), other.begin(), other.end(), std::back_inserter(differ));
  Judgement judgement;
  for (const auto& pair : differ) {
    const bool first_says = std::binary_search(first.begin(), first.end(), pair);
    ++(meet_exactly(recording, poses, pair[0], pair[1]) == first_says ? judgement.wrong : judgement.first_wrong);
  }
  return judgement;
}

std::vector<Point> run_study(const StudyOptions& options) {
  Study study(options);
  for (const Sweep sweep : kSweeps) study.sweep(sweep);
  return std::move(study.points);
}

Slope slope_of(const std::vector<Point>& points, Sweep sweep, const std::string& method, double low, double high) {
  std::vector<double> x, y;
  for (const Point& point : points) {
    if (point.sweep != sweep || point.method != method || point.x < low || point.x > high) continue;
    x.push_back(sweep == Sweep::polygons ? static_cast<double>(point.polygons) : point.x);
    y.push_back(point.mean_us);
  }
  return fit(x, y);
}

std::vector<std::string> methods_of(const std::vector<Point>& points) {
  std::vector<std::string> names;
  for (const Point& point : points) {
    if (std::find(names.begin(), names.end(), point.method) == names.end()) names.push_back(point.method);
  }
  return names;
}

}  // namespace collided::homework
