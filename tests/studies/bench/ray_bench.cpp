// Rays, one thread: closest hits alone and in batches, and any hit, beside Embree default, robust, packets, stream and
// occluded, CGAL with exact predicates, Bullet and ODE, in turn in one run. "collided" is what a user gets: whole answers
// of the world, every column filled; alone means one call of answer() a ray. "bare walk" is the index alone, with what it
// tells decided exactly, and "plain tests" the same decided in plain double: what certainty costs. "verdict" is asked
// without hits, as Embree's occluded answers. The note says on what rung of the ladder rays were decided.

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <random>
#include <span>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/exact_phase/arithmetic/precision.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/oracle/plain_ray.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/studies/bench/obj.hpp"
#include "tests/studies/bench/peers/embree_rays.hpp"
#include "tests/studies/bench/peers/ray_peers.hpp"
#include "tests/studies/bench/ray_scenes.hpp"
#include "tests/studies/bench/rows.hpp"
#include "tests/studies/bench/scene_answers.hpp"

namespace collided::bench {
using namespace engine;
namespace {

// ---- ours

/// Every candidate decided exactly, as the product does it.
struct ClosestExactly {
  const Ray& ray;
  double direction_m = ray.direction.norm();
  Answer best{};

  double operator()(std::uint32_t triangle, const Triangle& corners, double limit) {
    RayHit hit;
    if (!cast_ray(ray, corners, hit).yes()) return limit;
    const double s = hit.distance_m / direction_m;
    if (s < best.s) best = {triangle, s};
    return std::min(limit, (hit.distance_m + hit.distance_error_m) / direction_m * (1 + 0x1p-50));
  }
};

/// Every candidate decided in plain double: what the walk alone costs.
struct ClosestPlainly {
  const Ray& ray;
  Answer best{};

  double operator()(std::uint32_t triangle, const Triangle& corners, double limit) {
    const std::optional<double> s = oracle::plain_ray(ray, corners);
    if (!s || *s > limit) return limit;
    if (*s < best.s) best = {triangle, *s};
    return *s;
  }
};

template <class Closest>
Answer shoot(const Bvh& tree, const TriangleMesh& mesh, const Ray& ray, WalkCost& cost) {
  Closest closest{ray};
  tree.walk_ray_nearest(ray, kInfinity, mesh, closest, cost);
  return closest.best;
}

bool meets_any(const Bvh& tree, const TriangleMesh& mesh, const Ray& ray, WalkCost& cost) {
  const auto decide = [&](std::uint32_t, const Triangle& corners, double limit) {
    RayHit hit;
    return cast_ray(ray, corners, hit).yes() ? -1 : limit;
  };
  Triangle corners;
  return tree.meet_ray(ray, kInfinity, mesh, decide, cost, corners) != Bvh::kNoTriangle;
}

/// A whole stretch at once, its walks in turn.
class Batch {
 public:
  void shoot(const Bvh& tree, const TriangleMesh& mesh, std::span<const Ray> rays, Answer* answers) {
    closest_.clear();
    tasks_.clear();
    closest_.reserve(rays.size());
    for (const Ray& ray : rays) {
      closest_.push_back({ray});
      tasks_.push_back({.ray = &ray, .limit = kInfinity, .candidate = closest_.back(), .cost = &cost_});
    }
    tree.walk_rays(tasks_, mesh, Bvh::RayGoal::nearest);
    for (std::size_t i = 0; i < rays.size(); ++i) answers[i] = closest_[i].best;
  }

 private:
  std::vector<ClosestExactly> closest_;
  std::vector<Bvh::RayTask> tasks_;
  WalkCost cost_;
};

// ---- rays; all coordinates are floats, so that both sides get the same question

Vec3 to_float(const Vec3& v) {
  Vec3 rounded;
  for (int axis = 0; axis < 3; ++axis) rounded[axis] = static_cast<double>(static_cast<float>(v[axis]));
  return rounded;
}

Aabb bounds_of(const TriangleMesh& mesh) {
  Aabb bounds;
  for (const Vec3& vertex : mesh.vertices) bounds.extend(vertex);
  return bounds;
}

}  // namespace

double beyond(const TriangleMesh& mesh) {
  const Aabb bounds = bounds_of(mesh);
  return 4 * (bounds.high - bounds.low).norm();
}

namespace {

std::vector<Ray> camera_rays(const TriangleMesh& mesh, int side) {
  const Aabb bounds = bounds_of(mesh);
  const Vec3 center = (bounds.low + bounds.high) / 2;
  const double size = (bounds.high - bounds.low).maxCoeff();
  const Vec3 eye = center + size * Vec3(0.55, -0.75, 0.45);
  const Vec3 forward = (center - eye).normalized();
  const Vec3 right = forward.cross(Vec3::UnitZ()).normalized();
  const Vec3 up = right.cross(forward);
  std::vector<Ray> rays;
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const double x = (column + 0.5) / side - 0.5;
      const double y = (row + 0.5) / side - 0.5;
      rays.push_back({to_float(eye), to_float(forward + x * right + y * up)});
    }
  }
  return rays;
}

/// From points of the surface into its outer half space: what a bounce or an occlusion test asks.
std::vector<Ray> surface_rays(const TriangleMesh& mesh, int count, std::mt19937_64& random) {
  std::vector<Ray> rays;
  const double offset = 1e-4 * (bounds_of(mesh).high - bounds_of(mesh).low).maxCoeff();
  while (static_cast<int>(rays.size()) < count) {
    const Triangle triangle = mesh.triangle(static_cast<std::uint32_t>(random() % mesh.triangles.size()));
    const Vec3 normal = (triangle.b - triangle.a).cross(triangle.c - triangle.a).normalized();
    if (!normal.allFinite()) continue;
    const Vec3 direction = on_sphere(random);
    const Vec3 start = (triangle.a + triangle.b + triangle.c) / 3 + offset * normal;
    rays.push_back({to_float(start), to_float(direction.dot(normal) < 0 ? Vec3(-direction) : direction)});
  }
  return rays;
}

std::vector<Ray> random_rays(const TriangleMesh& mesh, int count, std::mt19937_64& random) {
  const Aabb bounds = bounds_of(mesh);
  std::uniform_real_distribution<double> part(0, 1);
  std::vector<Ray> rays;
  for (int i = 0; i < count; ++i) {
    const double x = part(random);
    const double y = part(random);
    const Vec3 where(x, y, part(random));
    rays.push_back({to_float(bounds.low + where.cwiseProduct(bounds.high - bounds.low)), to_float(on_sphere(random))});
  }
  return rays;
}

std::vector<double> numbers_of(const std::vector<Ray>& rays) {
  std::vector<double> numbers;
  for (const Ray& ray : rays) {
    numbers.insert(numbers.end(), ray.origin.begin(), ray.origin.end());
    numbers.insert(numbers.end(), ray.direction.begin(), ray.direction.end());
    numbers.push_back(ray.length_m);
  }
  return numbers;
}

// ---- the comparison

Answer by_force(const TriangleMesh& mesh, const Ray& ray) {
  Answer best;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const std::optional<double> s = oracle::plain_ray(ray, mesh.triangle(i));
    if (s && *s < best.s) best = {i, *s};
  }
  return best;
}

bool same(const Answer& a, const Answer& b) {
  if (a.triangle == b.triangle) return true;
  return a.triangle != kNone && b.triangle != kNone && std::abs(a.s - b.s) <= 1e-5 * (std::abs(a.s) + std::abs(b.s));
}

/// Of every thousand rays how many triangles were decided in double with its bound, and how many exactly; the rest was
/// decided in floats.
std::string rungs_of(std::size_t rays, const WalkCost& cost, const RungCounts& before) {
  const RungCounts& now = kernel::rungs;
  char text[128];
  const double per = 1000.0 / static_cast<double>(rays);
  std::snprintf(text, sizeof text, "of 1000 rays %.1f nodes, %.1f tests in double, %.3f exact",
                per * static_cast<double>(cost.nodes), per * static_cast<double>(cost.candidates),
                per * static_cast<double>(now.uncertain - before.uncertain + now.sharpened - before.sharpened));
  return text;
}

/// What the indexes cost: ours in the form in which the server builds it (server/service/commands/scene_loading.cpp).
std::string builds_of(const Bvh& tree, const Embree& embree) {
  char text[96];
  std::snprintf(text, sizeof text, "built in %.2f s, form best as the server's; Embree in %.2f s",
                tree.report().build_s, embree.build_s);
  return text;
}

struct Agreement {
  std::size_t equal = 0;
  std::size_t ours_right = 0;  // of the unequal ones that were looked at
  std::size_t looked_at = 0;
};

Agreement compare(const TriangleMesh& mesh, const std::vector<Ray>& rays, const std::vector<Answer>& ours,
                  const std::vector<Answer>& theirs) {
  constexpr std::size_t kMostForced = 50;
  Agreement agreement;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (same(ours[i], theirs[i])) {
      ++agreement.equal;
    } else if (agreement.looked_at < kMostForced) {
      ++agreement.looked_at;
      const Answer truth = by_force(mesh, rays[i]);
      agreement.ours_right += truth.triangle == ours[i].triangle || truth.s == ours[i].s ? 1 : 0;
    }
  }
  return agreement;
}

using MakePeer = std::unique_ptr<RayPeer> (*)(const TriangleMesh&);
const std::vector<MakePeer> kPeers{
#ifdef COLLIDED_BENCH_CGAL
    cgal_ray_peer,
#endif
#ifdef COLLIDED_BENCH_BULLET
    bullet_ray_peer,
#endif
#ifdef COLLIDED_BENCH_ODE
    ode_ray_peer,
#endif
};

constexpr const char* kWorks =
    "closest, camera; closest, surface; closest, anywhere; batch, camera; batch, surface; "
    "batch, anywhere; any, camera; any, surface; any, anywhere";

/// One mesh in all of them, and what is asked of it.
class Bench {
 public:
  Bench(const Options& options, std::string scene, const TriangleMesh& mesh)
      : options_(options),
        scene_(std::move(scene)),
        mesh_(mesh),
        world_(mesh),
        embree_(mesh, RTC_SCENE_FLAG_NONE),
        robust_(mesh, RTC_SCENE_FLAG_ROBUST) {
    // Their rows take minutes in a scene of a million.
    if (options.peers.empty() && (options.quick || mesh.triangles.size() < 400'000)) {
      for (const MakePeer make : kPeers) peers_.push_back(make(mesh));
    }
  }
  void run(const std::string& kind, const std::vector<Ray>& rays);

 private:
  void alone(const std::string& name, const std::vector<Ray>& rays);
  void together(const std::string& name, const std::vector<Ray>& rays);
  void any(const std::string& name, const std::vector<Ray>& rays);
  std::span<const double> question(std::size_t first, std::size_t count) const {
    return std::span(numbers_).subspan(first * kRayNumbers, count * kRayNumbers);
  }
  /// One call, as a user makes it, and a look at what came.
  void answer_whole(std::size_t first, std::size_t count, Answer* to) {
    const Answers& answers = world_.ask(QuestionKind::ray, HitMode::closest, question(first, count), 1);
    const AnswerHit* hit = answers.hits.data();
    for (std::size_t i = 0; i < count; ++i) {
      to[i] = answers.hit_counts[i] > 0 ? Answer{hit->triangle, hit->distance_m / lengths_[first + i]} : Answer{};
      hit += answers.hit_counts[i];
    }
  }
  Work work(const std::string& name, const std::vector<Ray>& rays, const std::string& note) const {
    return {scene_, mesh_.triangles.size(), name, rays.size(), note};
  }

  const Options& options_;
  std::string scene_;
  const TriangleMesh& mesh_;
  SceneAnswers world_;
  const Bvh& tree_ = world_.scene().tree;
  Embree embree_;
  Embree robust_;
  std::vector<std::unique_ptr<RayPeer>> peers_;
  std::vector<Answer> ours_;
  std::vector<double> numbers_;  // of the rays, as questions
  std::vector<double> lengths_;  // of their directions
  std::string rungs_;
};

void Bench::run(const std::string& kind, const std::vector<Ray>& rays) {
  WalkCost cost;
  const RungCounts before = kernel::rungs;
  numbers_ = numbers_of(rays);
  lengths_.clear();
  for (const Ray& ray : rays) lengths_.push_back(ray.direction.norm());
  ours_.clear();
  for (const Ray& ray : rays) ours_.push_back(shoot<ClosestExactly>(tree_, mesh_, ray, cost));
  rungs_ = rungs_of(rays.size(), cost, before);
  if (options_.wants(scene_, "closest, " + kind)) alone("closest, " + kind, rays);
  if (options_.wants(scene_, "batch, " + kind)) together("batch, " + kind, rays);
  if (options_.wants(scene_, "any, " + kind)) any("any, " + kind, rays);
}

void Bench::alone(const std::string& name, const std::vector<Ray>& rays) {
  std::vector<Answer> found(rays.size());
  const auto by = [&](auto ask) {
    return [&rays, &found, ask] {
      for (std::size_t i = 0; i < rays.size(); ++i) found[i] = ask(rays[i]);
    };
  };
  const auto ours = [this](auto* shoot_one) {
    return [this, shoot_one](const Ray& ray) {
      WalkCost unread;
      return shoot_one(tree_, mesh_, ray, unread);
    };
  };
  std::vector<Method> methods{{.name = "collided",
                               .run =
                                   [&] {
                                     for (std::size_t i = 0; i < rays.size(); ++i) answer_whole(i, 1, &found[i]);
                                   },
                               .bytes_each = world_.bytes_a_triangle()}};
  methods.push_back({.name = "collided, bare walk", .run = by(ours(shoot<ClosestExactly>))});
  methods.push_back({.name = "Embree default", .run = by([this](const Ray& ray) { return embree_.shoot(ray); })});
  methods.push_back({.name = "Embree robust", .run = by([this](const Ray& ray) { return robust_.shoot(ray); })});
  methods.push_back({.name = "collided, plain tests", .run = by(ours(shoot<ClosestPlainly>))});
  for (const auto& peer : peers_) {
    methods.push_back({.name = peer->name(),
                       .run = by([this, p = peer.get()](const Ray& ray) {
                         const std::uint32_t triangle = p->nearest(ray);
                         if (triangle == kNone) return Answer{};
                         return Answer{triangle, oracle::plain_ray(ray, mesh_.triangle(triangle)).value_or(kInfinity)};
                       })});
  }
  std::string note = rungs_ + "; " + builds_of(tree_, embree_);
  for (Method& method : methods) {
    if (!options_.takes(method.name)) continue;
    method.run();
    const Agreement agreement = compare(mesh_, rays, ours_, found);
    method.equal = agreement.equal;
    method.of = rays.size();
    if (method.name != "Embree default") continue;
    note += "; of " + std::to_string(agreement.looked_at) + " that Embree answers otherwise force confirms " +
            std::to_string(agreement.ours_right);
  }
  measure(options_, work(name, rays, note), methods);
}

void Bench::together(const std::string& name, const std::vector<Ray>& rays) {
  static constexpr std::size_t kBatch = 8192;
  std::vector<Answer> found(rays.size());
  Batch batch;
  const auto in_batches = [&](auto ask) {
    return [&rays, &found, ask] {
      for (std::size_t begin = 0; begin < rays.size(); begin += kBatch) {
        ask(std::span(rays).subspan(begin, std::min(kBatch, rays.size() - begin)), &found[begin]);
      }
    };
  };
  std::vector<Method> methods{{.name = "collided",
                               .run = in_batches([&](std::span<const Ray> some, Answer* to) {
                                 answer_whole(static_cast<std::size_t>(some.data() - rays.data()), some.size(), to);
                               }),
                               .bytes_each = world_.bytes_a_triangle()}};
  methods.push_back({.name = "collided, bare walk", .run = in_batches([&](std::span<const Ray> some, Answer* to) {
                                                      batch.shoot(tree_, mesh_, some, to);
                                                    })});
  methods.push_back({.name = "Embree packets", .run = in_batches([&](std::span<const Ray> some, Answer* to) {
                                                 embree_.shoot_packets(some, to);
                                               })});
  methods.push_back({.name = "Embree stream", .run = in_batches([&](std::span<const Ray> some, Answer* to) {
                                                embree_.shoot_stream(some, to);
                                              })});
  for (Method& method : methods) {
    method.run();
    for (std::size_t i = 0; i < rays.size(); ++i) method.equal += same(found[i], ours_[i]) ? 1 : 0;
    method.of = rays.size();
  }
  measure(options_, work(name, rays, "8192 a batch"), methods);
}

void Bench::any(const std::string& name, const std::vector<Ray>& rays) {
  std::vector<char> found(rays.size());
  const auto by = [&](auto ask) {
    return [&rays, &found, ask] {
      for (std::size_t i = 0; i < rays.size(); ++i) found[i] = ask(i) ? 1 : 0;
    };
  };
  std::vector<Method> methods{{.name = "collided",
                               .run = by([&](std::size_t i) {
                                 return world_.ask(QuestionKind::ray, HitMode::any, question(i, 1), 1).answers[0] ==
                                        Verdict::hit;
                               }),
                               .bytes_each = world_.bytes_a_triangle()}};
  methods.push_back({.name = "collided, verdict",
                     .run = by([&](std::size_t i) {
                       const std::span<const double> ray = question(i, 1);
                       return world_.ask(QuestionKind::ray, HitMode::any, ray, 1, false).answers[0] == Verdict::hit;
                     })});
  methods.push_back({.name = "collided, bare walk", .run = by([&](std::size_t i) {
                                                      WalkCost unread;
                                                      return meets_any(tree_, mesh_, rays[i], unread);
                                                    })});
  methods.push_back({.name = "Embree occluded", .run = by([&](std::size_t i) { return embree_.occluded(rays[i]); })});
  for (Method& method : methods) {
    method.run();
    for (std::size_t i = 0; i < rays.size(); ++i) method.equal += found[i] == (ours_[i].triangle != kNone) ? 1 : 0;
    method.of = rays.size();
  }
  WalkCost cost;
  const RungCounts before = kernel::rungs;
  for (const Ray& ray : rays) meets_any(tree_, mesh_, ray, cost);
  measure(options_, work(name, rays, rungs_of(rays.size(), cost, before)), methods);
}

/// make: from its own random numbers, so that scenes left out change no other.
template <class Make>
void run_scene(const Options& options, const std::string& name, std::uint64_t seed, Make&& make) {
  if (!options.wants(name, kWorks)) return;
  std::mt19937_64 random(seed);
  TriangleMesh mesh = make(random);
  if (mesh.triangles.empty()) {
    std::printf("%s: not here, left out\n", name.c_str());
    return;
  }
  // Both sides get coordinates that are floats.
  for (Vec3& vertex : mesh.vertices) vertex = to_float(vertex);
  const int side = options.quick ? 128 : 512;
  Bench bench(options, name, mesh);
  bench.run("camera", camera_rays(mesh, side));
  bench.run("surface", surface_rays(mesh, side * side, random));
  bench.run("anywhere", random_rays(mesh, side * side, random));
}

void run_scenes(const Options& options, std::uint64_t seed) {
  using Random = std::mt19937_64;
  const bool quick = options.quick;
  run_scene(options, "bunny", seed, [](Random&) { return read_obj("/usr/share/glmark2/models/bunny.obj"); });
  run_scene(options, "scan", seed, [&](Random&) { return scanned_ball(quick ? 100'000 : 1'100'000, 7); });
  run_scene(options, "terrain", seed, [&](Random&) { return scenes::terrain(quick ? 200 : 707, 1000, 7); });
  run_scene(options, "city", seed, [&](Random& random) { return city(quick ? 50 : 150, random); });
  run_scene(options, "interior", seed, [&](Random& random) { return interior(quick ? 6 : 14, random); });
  run_scene(options, "needles", seed, [&](Random& random) { return needles(quick ? 50'000 : 300'000, random); });
  if (quick || !options.wants("growth", "growth")) return;
  // Four times the triangles each: 100k, 400k, 1.6 M, 6.4 M.
  for (const std::uint32_t cells : {224u, 447u, 894u, 1789u}) {
    run_scene(options, "growth", seed, [&](Random&) { return scenes::terrain(cells, 1000, 7); });
  }
}

}  // namespace
}  // namespace collided::bench

int main(int argc, char** argv) {
  using namespace collided;
  const bench::Options options = bench::read_options(argc, argv);
  std::mt19937_64 random = oracle::seeded(20240607);
  bench::run_scenes(options, random());
  return 0;
}
