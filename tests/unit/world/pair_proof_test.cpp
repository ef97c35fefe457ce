// Which answers have a proof: all that touch over flat and ball-like shapes, to the last bit; few are missing elsewhere.
#include <gtest/gtest.h>

#include "server/world/query/pair_report.hpp"
#include "tests/extreme/worlds.hpp"
#include "tests/oracle/random_shapes.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/unit/exact/certified.hpp"

namespace collided::engine {
namespace {

constexpr int kKinds = 8;
/// Flat facets and balls: decided by rationals, and proved by them.
bool is_polytope(int kind) { return kind <= 2 || kind >= 6; }

Shape shape_of(int kind, oracle::RandomShapes& random) {
  switch (kind) {
    case 0: return {.primitives = {random.sphere()}, .mesh = nullptr};
    case 1: return {.primitives = {random.box()}, .mesh = nullptr};
    case 2: return {.primitives = {random.capsule()}, .mesh = nullptr};
    case 3: return {.primitives = {random.cylinder()}, .mesh = nullptr};
    case 4: return {.primitives = {random.cone()}, .mesh = nullptr};
    case 5: return {.primitives = {random.ellipsoid()}, .mesh = nullptr};
    case 6: return {.primitives = {random.hull()}, .mesh = nullptr};
    default: break;
  }
  const Triangle t = random.triangle();
  TriangleMesh mesh;
  mesh.vertices = {t.a, t.b, t.c};
  mesh.triangles = {{0, 1, 2}};
  return extreme::mesh_shape(std::move(mesh));
}

struct Count {
  int asked = 0;
  int proved = 0;
};

class PairProofs : public ::testing::TestWithParam<oracle::Family> {};

TEST_P(PairProofs, AreThereForWhatRationalsCanSay) {
  std::mt19937_64 generator = oracle::seeded(9);
  oracle::RandomShapes random(generator, GetParam());
  Count flat_touching;
  Count round_touching;
  Count apart;
  for (int round = 0; round < 25; ++round) {
    for (int i = 0; i < kKinds; ++i) {
      for (int j = i; j < kKinds; ++j) {
        extreme::Stage stage;
        const ObjectId a = stage.add("a", shape_of(i, random), extreme::at(Vec3::Zero()));
        const ObjectId b = stage.add("b", shape_of(j, random), extreme::at(Vec3::Zero()));
        stage.step();
        const PairReport report = report_pair(*stage.world.newest(), a, b, {.certificate = true});
        if (report.touches == Decision::undecided) continue;
        const bool touches = report.touches == Decision::yes;
        Count& count = !touches ? apart : is_polytope(i) && is_polytope(j) ? flat_touching : round_touching;
        ++count.asked;
        count.proved += report.proof ? 1 : 0;
        EXPECT_NE(report.proof.has_value(), !report.no_proof.empty()) << "a proof or the reason";
        if (report.proof) {
          ASSERT_EQ(report.proof->touches, touches);
          Certificate certificate = certified(*report.proof);
          ASSERT_TRUE(proves(certificate))
              << "kinds " << i << " and " << j << ": the client's judge, with its own arithmetic";
          certificate.touches = !touches;
          ASSERT_FALSE(proves(certificate)) << "the other answer";
        }
      }
    }
  }
  std::printf("%s: touching %d of %d flat, %d of %d round; apart %d of %d have a proof\n", oracle::name(GetParam()),
              flat_touching.proved, flat_touching.asked, round_touching.proved, round_touching.asked, apart.proved,
              apart.asked);
  // Corners of a turned box in tenths are no doubles, and a ball that just touches one makes numbers beyond their range.
  const double least = GetParam() == oracle::Family::tenths ? 0.95 : 1;
  EXPECT_GE(flat_touching.proved, flat_touching.asked * least);
  EXPECT_GE(round_touching.proved, round_touching.asked * 0.8);
  EXPECT_GE(apart.proved, apart.asked * 0.9);
}

INSTANTIATE_TEST_SUITE_P(Families, PairProofs, ::testing::ValuesIn(oracle::kFamiliesOfUsualSize),
                         [](const auto& family) { return std::string(oracle::name(family.param)); });

// Two combs that interlock: no plane parts them as wholes, 64 pairs of teeth have one each.
TEST(PairProof, OfCombsThatInterlock) {
  extreme::Stage stage;
  TriangleMesh teeth;
  for (std::uint32_t i = 0; i < 8; ++i) {
    teeth.vertices.insert(teeth.vertices.end(), {{1.0 * i, 0, 0}, {1.0 * i, 1, 0}, {1.0 * i, 0, 1}});
    teeth.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  const ObjectId a = stage.add("a", extreme::mesh_shape(teeth), extreme::at(Vec3::Zero()));
  const ObjectId b = stage.add("b", extreme::mesh_shape(teeth), extreme::at({0.5, 0, 0}));
  stage.step();
  const PairReport report = report_pair(*stage.world.newest(), a, b, {.certificate = true});
  ASSERT_EQ(report.touches, Decision::no);
  ASSERT_TRUE(report.proof) << report.no_proof;
  EXPECT_GT(report.proof->steps.size(), 8u);
  EXPECT_TRUE(proves(certified(*report.proof)));
  EXPECT_NEAR(report.separation.distance_m, 0.5, report.separation.error_m);
}

}  // namespace
}  // namespace collided::engine
