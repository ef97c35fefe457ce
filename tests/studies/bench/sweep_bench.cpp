// First contact of movers with a terrain of 70,000 triangles, and with a sphere of 1.1 million as fine as a scan, one
// thread: how long a way takes, and whether 1,000 poses of it agree. No peer: of the libraries here those that cast boxes stop at a fixed number of steps, or go straight only.

#include <algorithm>
#include <random>

#include "server/intake/mesh/sphere_mesh.hpp"
#include "server/world/objects/indexed_mesh.hpp"
#include "server/world/objects/scene_touch.hpp"
#include "server/world/objects/swept_object.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/studies/bench/clock.hpp"
#include "tests/studies/bench/rows.hpp"

namespace collided::bench {
using namespace engine;
namespace {

constexpr std::size_t kWays = 1000;

struct Case {
  std::string name;
  Shape shape;
  bool turns = false;
  double reach_m = 0;  // of a ball or what is like one
};

StaticScene scene_of(TriangleMesh mesh) {
  StaticScene scene;
  scene.mesh = std::move(mesh);
  scene.parts = {{.name = "scene",
                  .first_triangle = 0,
                  .triangle_count = static_cast<std::uint32_t>(scene.mesh.triangles.size())}};
  scene.part_objects = {1};
  scene.tree = Bvh::build(scene.mesh);
  return scene;
}

std::vector<Case> cases() {
  const Box box{.center = Vec3::Zero(), .half_m = {0.1, 0.2, 0.15}};
  const auto one = [](const Primitive& primitive) { return Shape{.primitives = {primitive}, .mesh = nullptr}; };
  const auto cube = std::make_shared<const TriangleMesh>(scenes::box(box.half_m));
  return {{"sphere", one(Sphere{Vec3::Zero(), 0.1})},
          {"box", one(box)},
          {"box turning", one(box), true},
          {"cylinder turning", one(Cylinder{{0, 0, -0.2}, {0, 0, 0.2}, 0.1}), true},
          {"mesh of 12 turning", {.primitives = {}, .mesh = cube}, true}};
}

/// From above the ground to anywhere near it, some metres on.
std::vector<BodyMotion> motions(bool turn, std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto any = [&] { return uniform(random); };
  std::vector<BodyMotion> made;
  for (std::size_t i = 0; i < kWays; ++i) {
    const double x = 40 * any(), y = 40 * any();
    const Vec3 from(x, y, 6 + 2 * any());
    const double dx = 5 * any(), dy = 5 * any();
    const Vec3 to = from + Vec3(dx, dy, -6 + 4 * any());
    const double w = any(), p = any(), q = any();
    const Quat other = Quat(w, p, q, any()).normalized();
    made.emplace_back(frame_of({from, Quat::Identity()}), frame_of({to, turn ? other : Quat(Quat::Identity())}));
  }
  return made;
}

/// Movers over a sphere of radius 1, a tenth as large as it and less.
std::vector<Case> cases_over_ball() {
  const auto ball = [](double radius_m) {
    return Shape{.primitives = {Sphere{Vec3::Zero(), radius_m}}, .mesh = nullptr};
  };
  const auto mesh = std::make_shared<const TriangleMesh>(latitude_longitude_sphere(0.1, 64, 33));
  return {{"ball of 2 %", ball(0.02), false, 0.02},
          {"ball of 10 %", ball(0.1), false, 0.1},
          {"mesh of 4,096", {.primitives = {}, .mesh = mesh}, false, 0.1}};
}

/// From a little off the sphere, a fifth of its diameter on, mostly into it.
std::vector<BodyMotion> motions_over_ball(double reach_m, std::mt19937_64& random) {
  std::normal_distribution<double> part;
  const auto any_direction = [&] {
    const double x = part(random), y = part(random);
    return Vec3(x, y, part(random)).normalized();
  };
  std::uniform_real_distribution<double> off(0, 0.1);
  std::vector<BodyMotion> made;
  for (std::size_t i = 0; i < kWays; ++i) {
    const Vec3 out = any_direction();
    const Vec3 from = out * (1 + reach_m + off(random));
    const Vec3 to = from + 0.4 * (any_direction() - out).normalized();
    made.emplace_back(frame_of({from, Quat::Identity()}), frame_of({to, Quat::Identity()}));
  }
  return made;
}

/// Whether poses of the way say the same: none touches before the bracket, and that at its end does.
bool agrees(const ObjectInfo& mover, const BodyMotion& motion, const StaticScene& scene, const SweptContact& found) {
  const auto touches = [&](double t) {
    const Frame frame = motion.at(t);
    bool yes = false;
    WalkCost cost;
    const auto every = [](std::uint32_t) { return true; };
    const auto meet = [&](const auto& own) {
      visit_scene(scene, bounds(own), cost, every, [&](std::uint32_t, std::uint32_t, const Triangle& corners) {
        yes = yes || overlaps(own, corners).yes();
        return !yes;
      });
    };
    for (const Primitive& primitive : mover.primitives) {
      std::visit([&](const auto& own) { meet(place(frame, own)); }, primitive);
    }
    for (std::uint32_t i = 0; mover.mesh && i < mover.mesh->mesh->triangles.size(); ++i) {
      meet(place(frame, mover.mesh->mesh->triangle(i)));
    }
    return yes;
  };
  if (found.undecided || (found.yes && !touches(found.bracket.high))) return false;
  const double clear = found.yes ? found.bracket.low : 1;
  for (int sample = 0; sample <= 1000 * clear; ++sample) {
    if ((!found.yes || found.bracket.high > 0) && touches(sample / 1000.0)) return false;
  }
  return true;
}

/// Poses of each compare_every-th way are tested.
void run(const Options& options, const char* name, const Case& one, const std::vector<BodyMotion>& motion,
         const StaticScene& scene, std::size_t compare_every) {
  const ObjectInfo mover = without_world(one.shape);
  const SweptBody ground(scene);
  std::vector<double> spent_us;
  std::size_t hits = 0, equal = 0, compared = 0, tests = 0;
  for (std::size_t i = 0; i < kWays; ++i) {
    SweptContact touch;
    WalkCost cost;
    const double start = thread_seconds();
    sweep(SweptBody(mover, motion[i]), ground, {}, cost, touch);
    spent_us.push_back((thread_seconds() - start) * 1e6);
    hits += touch.yes;
    tests += touch.exact_tests;
    if (i % compare_every != 0) continue;
    ++compared;
    equal += agrees(mover, motion[i], scene, touch);
  }
  std::sort(spent_us.begin(), spent_us.end());
  char note[160];
  std::snprintf(note, sizeof note, "%zu of %zu touch; median %.1f us, p99 %.1f us, %.1f tests", hits, kWays,
                spent_us[kWays / 2], spent_us[kWays * 99 / 100], static_cast<double>(tests) / kWays);
  std::vector<Method> methods{{.name = "collided",
                               .run =
                                   [&] {
                                     for (const BodyMotion& on : motion) {
                                       SweptContact touch;
                                       WalkCost cost;
                                       sweep(SweptBody(mover, on), ground, {}, cost, touch);
                                     }
                                   },
                               .equal = equal,
                               .of = compared}};
  measure(options, {name, scene.mesh.triangles.size(), one.name + " sweep", kWays, note}, methods);
}

}  // namespace
}  // namespace collided::bench

int main(int argc, char** argv) {
  using namespace collided::engine;
  using namespace collided;
  const bench::Options options = bench::read_options(argc, argv);
  std::mt19937_64 random = oracle::seeded(20261122);
  const StaticScene terrain = bench::scene_of(scenes::terrain(187, 100, 7));
  for (const bench::Case& one : bench::cases()) {
    const std::vector<BodyMotion> motion = bench::motions(one.turns, random);
    if (options.wants("terrain", one.name)) bench::run(options, "terrain", one, motion, terrain, 10);
  }
  if (options.quick) return 0;
  const StaticScene ball = bench::scene_of(latitude_longitude_sphere(1, 1050, 525));
  for (const bench::Case& one : bench::cases_over_ball()) {
    const std::vector<BodyMotion> motion = bench::motions_over_ball(one.reach_m, random);
    if (options.wants("fine ball", one.name)) bench::run(options, "fine ball", one, motion, ball, 200);
  }
  return 0;
}
