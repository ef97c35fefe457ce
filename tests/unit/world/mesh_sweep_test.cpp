// Sweeps over a mesh, beside the first contact with every triangle.
#include <gtest/gtest.h>

#include <random>

#include "server/intake/mesh/sphere_mesh.hpp"
#include "server/world/objects/indexed_mesh.hpp"
#include "server/world/objects/swept_object.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::engine {
namespace {

constexpr double kWidth = 1e-6;

/// The slow twin: every part of the mover with every triangle, over the whole motion.
struct EveryPart {
  bool yes = false;
  bool undecided = false;
  TimeBracket bracket{1, 1};

  EveryPart(const ObjectInfo& mover, const BodyMotion& motion, const TriangleMesh& mesh) {
    const BodyMotion rest = BodyMotion::resting({});
    const auto meet = [&](const PartMotion& part) {
      for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        TimeBracket found;
        const ExactResult verdict = first_contact(part, PartMotion(mesh.triangle(i), rest), {}, kWidth, found);
        undecided = undecided || verdict.decision == Decision::undecided;
        if (!verdict.yes()) continue;
        yes = true;
        bracket = {std::min(bracket.low, found.low), std::min(bracket.high, found.high)};
      }
    };
    for (const Primitive& own : mover.primitives) meet(PartMotion(part_of(own), motion));
    for (std::uint32_t i = 0; mover.mesh && i < mover.mesh->mesh->triangles.size(); ++i)
      meet(PartMotion(mover.mesh->mesh->triangle(i), motion));
  }
};

TEST(MeshSweep, FindsTheFirstContactOfAllTriangles) {
  std::mt19937_64 random = oracle::seeded(20261203);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto any = [&] { return uniform(random); };
  const auto one = [](const Primitive& primitive) { return Shape{.primitives = {primitive}, .mesh = nullptr}; };
  const Shape ball_mesh{.primitives = {},
                        .mesh = std::make_shared<const TriangleMesh>(latitude_longitude_sphere(0.3, 6, 4))};
  const Shape movers[] = {one(Sphere{Vec3::Zero(), 0.3}), one(Sphere{{0.1, 0, 0}, 0.02}),
                          one(Box{.center = Vec3::Zero(), .half_m = {0.1, 0.2, 0.15}}),
                          one(Capsule{{0, 0, -0.2}, {0, 0, 0.2}, 0.1}), ball_mesh};
  int touching = 0;
  int free = 0;
  for (int round = 0; round < 60; ++round) {
    StaticScene scene;
    scene.mesh = round % 3 == 0   ? scenes::degenerate(80, random())
                 : round % 3 == 1 ? scenes::terrain(10, 3, random())
                                  : latitude_longitude_sphere(1, 14, 9);
    scene.tree = Bvh::build(scene.mesh);
    const ObjectInfo mover = without_world(movers[round % 5]);
    const double x = 1.5 * any(), y = 1.5 * any(), dx = any(), dy = any(), dz = any();
    const Vec3 from(x, y, 1.8);
    const Quat turned = round % 2 == 0 ? Quat::Identity() : Quat(1, 0.3 * dx, 0.3 * dy, 0.3 * dz).normalized();
    const BodyMotion motion(frame_of({.position = from, .rotation = Quat::Identity()}),
                            frame_of({.position = from + Vec3(dx, dy, -2.5 + dz), .rotation = turned}));
    const EveryPart twin(mover, motion, scene.mesh);
    SweptContact found;
    WalkCost cost;
    sweep(SweptBody(mover, motion), SweptBody(scene), {.width = kWidth}, cost, found);
    if (twin.undecided || found.undecided) continue;
    ASSERT_EQ(found.yes, twin.yes) << round;
    (twin.yes ? touching : free) += 1;
    if (!twin.yes) continue;
    // The two brackets hold one truth.
    EXPECT_LE(found.bracket.low, twin.bracket.high) << round;
    EXPECT_LE(twin.bracket.low, found.bracket.high) << round;
    EXPECT_NEAR(found.bracket.high, twin.bracket.high, 4 * kWidth) << round;
  }
  EXPECT_GT(touching, 20);
  EXPECT_GT(free, 4);
}

}  // namespace
}  // namespace collided::engine
