// The coarse tests of the homework: an object's bounding sphere against the cube's faces and against another's. B16, B17
#include <gtest/gtest.h>

#include <cmath>

#include "server/exact_phase/distance/half_space.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/oracle/simple_prototype.hpp"
#include "tests/studies/homework/study.hpp"

namespace collided::homework {
using namespace engine;
namespace {

constexpr double kHalfCube_m = 8;

/// Centre to face: of the cube's six faces, whether the nearest is nearer than the radius. Asked from inside.
bool coarse_meets_face(const Sphere& ball) { return kHalfCube_m - ball.center.cwiseAbs().maxCoeff() < ball.radius_m; }

// B16: inside, the coarse test is the engine's answer about the ground behind each face, but for a touch, which the engine
// counts and `<` does not. Outside, the cube is a solid. All on a lattice, so that touches come by themselves.
TEST(HomeworkCoarse, ASphereMeetsAFaceOfTheCubeWhereItsCentreIsNearerThanItsRadius) {
  std::mt19937_64 random = oracle::seeded(16);
  std::uniform_int_distribution<int> inside(-8, 8), outside(-16, 16), size(0, 6);
  int met = 0, touched = 0, met_outside = 0;
  for (int i = 0; i < 50'000; ++i) {
    const Sphere ball{Vec3(inside(random), inside(random), inside(random)), static_cast<double>(size(random))};
    bool meets = false;
    for (int axis = 0; axis < 3; ++axis) {
      for (const double side : {-1.0, 1.0}) {
        const HalfSpace ground{side * kHalfCube_m * Vec3::Unit(axis), -side * Vec3::Unit(axis)};
        meets = meets || overlaps(ground, ball).yes();
      }
    }
    const bool touches = kHalfCube_m - ball.center.cwiseAbs().maxCoeff() == ball.radius_m;
    ASSERT_EQ(meets, coarse_meets_face(ball) || touches) << ball.center.transpose() << " " << ball.radius_m;
    met += meets ? 1 : 0;
    touched += touches ? 1 : 0;
    const Sphere other{Vec3(outside(random), outside(random), outside(random)), ball.radius_m};
    const Vec3 beyond = (other.center.cwiseAbs().array() - kHalfCube_m).max(0);
    const bool overlaps_cube = beyond.squaredNorm() <= other.radius_m * other.radius_m;
    ASSERT_EQ(overlaps(other, Box{Vec3::Zero(), Mat3::Identity(), Vec3::Constant(kHalfCube_m)}).yes(), overlaps_cube);
    met_outside += overlaps_cube ? 1 : 0;
  }
  EXPECT_GT(met, 5'000);
  EXPECT_GT(touched, 1'000);
  EXPECT_GT(met_outside, 5'000);
}

// B17: no two objects whose polygons meet have centres as far apart as their radii together.
TEST(HomeworkCoarse, NoPairThatMeetsIsLostByTheBoundingSpheres) {
  const Recording recording = record({.objects = 30, .polygons = 64, .relative_size = 0.4, .frames = 6, .seed = 17});
  std::size_t meeting = 0, candidates = 0;
  for (const std::vector<Pose>& poses : recording.poses) {
    for (std::uint32_t a = 0; a < recording.objects(); ++a) {
      for (std::uint32_t b = a + 1; b < recording.objects(); ++b) {
        const bool is_candidate =
            (poses[a].position - poses[b].position).norm() < recording.mesh(a).radius_m + recording.mesh(b).radius_m;
        candidates += is_candidate ? 1 : 0;
        if (!meet_exactly(recording, poses, a, b)) continue;
        ++meeting;
        ASSERT_TRUE(is_candidate) << a << " and " << b;
      }
    }
  }
  EXPECT_GT(meeting, 20u);
  EXPECT_GT(candidates, meeting);
}

// B17: `<` is the homework's; spheres that only touch are met for the engine and not for the prototype.
TEST(HomeworkCoarse, ATouchIsNoCandidateOfThePrototypeAndIsAContactOfTheEngine) {
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->vertices = {{0, 0, 1}, {1, 0, 0}, {-1, 0, 0}, {0, 0, -1}, {0, 1, 0}};
  mesh->triangles = {{0, 1, 4}, {0, 4, 2}, {3, 4, 1}, {3, 2, 4}};
  const Vec3 up(0, 0, 2);
  for (const double nearer : {0.0, 0x1p-40}) {
    oracle::SimplePrototype prototype;
    for (int i = 0; i < 2; ++i) prototype.add(mesh);
    prototype.move(0, frame_of({.position = Vec3::Zero()}));
    prototype.move(1, frame_of({.position = up - nearer * Vec3::UnitZ()}));
    prototype.collide();
    EXPECT_EQ(prototype.object_candidates(), nearer == 0 ? 0u : 1u);
  }
  EXPECT_TRUE(overlaps(Sphere{Vec3::Zero(), 1}, Sphere{up, 1}).yes());
  const Triangle top = mesh->triangle(0), bottom = mesh->triangle(2);
  EXPECT_TRUE(overlaps(top, Triangle{bottom.a + up, bottom.b + up, bottom.c + up}).yes());
}

}  // namespace
}  // namespace collided::homework
