// Every pair of kinds in random poses: decided, alike in either order, and one in a thousand proved to the client's judge.
#include <gtest/gtest.h>

#include <cstdlib>

#include "server/exact_phase/part.hpp"
#include "server/world/query/pair_report.hpp"
#include "tests/extreme/worlds.hpp"
#include "tests/oracle/random_shapes.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/unit/exact/certified.hpp"

namespace collided::engine::pair_poses_test {
namespace {

constexpr const char* kNames[] = {"sphere", "box", "capsule", "cylinder", "cone", "ellipsoid", "hull", "triangle"};
constexpr std::size_t kKinds = 8;
constexpr std::size_t kShapes = 200;
constexpr long kProofEvery = 1000;

long pose_count() {
  const char* asked = std::getenv("COLLIDED_POSES");
  return asked != nullptr ? std::atol(asked) : 5000;
}

ConvexPart random_part(std::size_t kind, oracle::RandomShapes& random) {
  switch (kind) {
    case 0: return Primitive(random.sphere());
    case 1: return Primitive(random.box());
    case 2: return Primitive(random.capsule());
    case 3: return Primitive(random.cylinder());
    case 4: return Primitive(random.cone());
    case 5: return Primitive(random.ellipsoid());
    case 6: return Primitive(random.hull());
    default: return random.triangle();
  }
}

class Poses {
 public:
  explicit Poses(std::mt19937_64& generator) : generator_(generator) {
    oracle::RandomShapes random(generator, oracle::Family::random);
    for (std::size_t kind = 0; kind < kKinds; ++kind) {
      for (std::size_t i = 0; i < kShapes; ++i) shapes_[kind].push_back(random_part(kind, random));
    }
  }

  ConvexPart next(std::size_t kind) {
    const Quat turn = Quat(any(), any(), any(), any()).normalized();
    const double x = any(), y = any();
    const Frame frame = frame_of(Pose{.position = Vec3(x, y, any()), .rotation = turn});
    const ConvexPart& own = shapes_[kind][generator_() % kShapes];
    if (const auto* triangle = std::get_if<Triangle>(&own)) return place(frame, *triangle);
    return place(frame, std::get<Primitive>(own));
  }

 private:
  double any() { return uniform_(generator_); }
  std::mt19937_64& generator_;
  std::uniform_real_distribution<double> uniform_{-1, 1};
  std::vector<ConvexPart> shapes_[kKinds];
};

/// The part as an object that has been placed already: a hull by its placed vertices.
Shape standing(const ConvexPart& part) {
  if (const auto* t = std::get_if<Triangle>(&part)) {
    TriangleMesh mesh;
    mesh.vertices = {t->a, t->b, t->c};
    mesh.triangles = {{0, 1, 2}};
    return extreme::mesh_shape(std::move(mesh));
  }
  Primitive primitive = std::get<Primitive>(part);
  if (auto* hull = std::get_if<Hull>(&primitive)) {
    TriangleMesh mesh = *hull->mesh;
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) mesh.vertices[i] = vertex_of(*hull, i);
    *hull = {.mesh = extreme::shared_mesh(std::move(mesh))};
  }
  return {.primitives = {primitive}, .mesh = nullptr};
}

void expect_proof(const ConvexPart& a, const ConvexPart& b, Decision decided) {
  extreme::Stage stage;
  const ObjectId first = stage.add("a", standing(a), extreme::at(Vec3::Zero()));
  const ObjectId second = stage.add("b", standing(b), extreme::at(Vec3::Zero()));
  stage.step();
  const PairReport report = report_pair(*stage.world.newest(), first, second, {.certificate = true});
  ASSERT_EQ(report.touches, decided);
  ASSERT_TRUE(report.proof) << report.no_proof;
  ASSERT_EQ(report.proof->touches, decided == Decision::yes);
  ASSERT_TRUE(proves(certified(*report.proof)));
}

TEST(ExactPairPoses, AreDecidedAlikeInEitherOrderAndProved) {
  std::mt19937_64 generator = oracle::seeded(46);
  Poses poses(generator);
  long touching = 0;
  long proved = 0;
  for (std::size_t i = 0; i < kKinds; ++i) {
    for (std::size_t j = i; j < kKinds; ++j) {
      for (long n = 0; n < pose_count(); ++n) {
        const ConvexPart a = poses.next(i);
        const ConvexPart b = poses.next(j);
        const Decision decided = overlaps(a, b).decision;
        ASSERT_NE(decided, Decision::undecided) << kNames[i] << " " << kNames[j] << " pose " << n;
        ASSERT_EQ(decided, overlaps(b, a).decision) << kNames[i] << " " << kNames[j] << " pose " << n;
        touching += decided == Decision::yes ? 1 : 0;
        if (n % kProofEvery != 0) continue;
        expect_proof(a, b, decided);
        if (testing::Test::HasFatalFailure()) FAIL() << kNames[i] << " " << kNames[j] << " pose " << n;
        ++proved;
      }
    }
  }
  std::printf("%ld poses of each of 36 pairs, %ld touching, %ld proved\n", pose_count(), touching, proved);
  EXPECT_GT(touching, pose_count());
}

}  // namespace
}  // namespace collided::engine::pair_poses_test
