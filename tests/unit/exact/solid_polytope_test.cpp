#include "server/exact_phase/solid/solid_polytope.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <random>

#include "tests/oracle/seed.hpp"
#include "tests/oracle/tree_and_truth.hpp"

namespace collided::engine {
namespace {

using oracle::RationalPoint;
using Polygon = std::vector<RationalPoint>;

RationalPoint mean(const Polygon& points) {
  RationalPoint sum;
  for (const RationalPoint& point : points) {
    for (int axis = 0; axis < 3; ++axis) sum[axis] += point[axis];
  }
  for (mpq_class& coordinate : sum) coordinate /= static_cast<unsigned long>(points.size());
  return sum;
}

/// What of a polygon is not beyond the face's plane.
Polygon clipped(const Polygon& polygon, const Triangle& face) {
  Polygon left;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const RationalPoint& here = polygon[i];
    const RationalPoint& then = polygon[(i + 1) % polygon.size()];
    const mpq_class high = oracle::height(face, here), next = oracle::height(face, then);
    if (high <= 0) left.push_back(here);
    if (sgn(high) * sgn(next) >= 0) continue;
    const mpq_class share = high / (high - next);
    RationalPoint between;
    for (int axis = 0; axis < 3; ++axis) between[axis] = here[axis] + share * (then[axis] - here[axis]);
    left.push_back(between);
  }
  return left;
}

/// Whether the triangle has a point within all faces: the mean of what is left of it lies in its inner part.
bool reaches_inside(const Triangle& triangle, const TriangleMesh& polytope) {
  Polygon left{oracle::rational(triangle.a), oracle::rational(triangle.b), oracle::rational(triangle.c)};
  for (std::uint32_t i = 0; i < polytope.triangles.size() && !left.empty(); ++i)
    left = clipped(left, polytope.triangle(i));
  if (left.empty()) return false;
  const RationalPoint middle = mean(left);
  for (std::uint32_t i = 0; i < polytope.triangles.size(); ++i) {
    if (oracle::height(polytope.triangle(i), middle) >= 0) return false;
  }
  return true;
}

/// The surface parts inside from outside: a body crosses where a part of it lies within, else one point says it all.
PolytopeSide true_side(const oracle::TreeAndTruth& solid, const TriangleMesh& polytope, std::mt19937_64& random) {
  for (std::uint32_t i = 0; i < solid.shared->triangles.size(); ++i) {
    if (reaches_inside(solid.shared->triangle(i), polytope)) return PolytopeSide::crosses;
  }
  Polygon corners;
  for (const Vec3& vertex : polytope.vertices) corners.push_back(oracle::rational(vertex));
  return solid.oracle.side(mean(corners), random) == SolidSide::in ? PolytopeSide::in : PolytopeSide::out;
}

/// Facing outward; nothing where the four lie in one plane.
std::optional<TriangleMesh> tetrahedron_mesh(const std::array<Vec3, 4>& corners) {
  TriangleMesh mesh;
  mesh.vertices.assign(corners.begin(), corners.end());
  const int turn = sgn(oracle::height({corners[0], corners[1], corners[2]}, oracle::rational(corners[3])));
  if (turn == 0) return std::nullopt;
  mesh.triangles = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
  if (turn > 0) {
    for (TriangleCorners& face : mesh.triangles) std::swap(face[1], face[2]);
  }
  return mesh;
}

TEST(ExactSolidPolytope, KnowsBoxesAboutABox) {
  const oracle::TreeAndTruth box(scenes::box({1, 1, 1}));
  const auto of = [&](const Vec3& half_m, const Vec3& center) {
    return polytope_side(*box.tree, scenes::box(half_m, center));
  };
  EXPECT_EQ(of({0.5, 0.5, 0.5}, {0, 0, 0}), PolytopeSide::in);
  EXPECT_EQ(of({0.5, 0.5, 0.5}, {0.5, 0.5, 0.5}), PolytopeSide::in) << "in a corner";
  EXPECT_EQ(of({1, 1, 1}, {0, 0, 0}), PolytopeSide::in) << "the box itself";
  EXPECT_EQ(of({1, 1, 1}, {2, 0, 0}), PolytopeSide::out) << "face to face";
  EXPECT_EQ(of({1, 1, 1}, {2, 2, 2}), PolytopeSide::out) << "corner to corner";
  EXPECT_EQ(of({1, 1, 1}, {3, 3, 3}), PolytopeSide::out);
  EXPECT_EQ(of({2, 2, 2}, {0, 0, 0}), PolytopeSide::crosses) << "around it";
  EXPECT_EQ(of({0.5, 0.5, 0.5}, {0x1.0000000000002p-1, 0, 0}), PolytopeSide::crosses) << "2^-52 beyond the face";
  EXPECT_EQ(of({0.5, 0.5, 0.5}, {0x1.7ffffffffffffp+0, 0, 0}), PolytopeSide::crosses) << "2^-52 within it";
}

// No face of the body meets the surface, and no corner of the surface lies within the body.
TEST(ExactSolidPolytope, CrossesWhatHasItsCornersInTheFaces) {
  const auto inner = tetrahedron_mesh({Vec3(1, 1, 1), Vec3(1, -1, -1), Vec3(-1, 1, -1), Vec3(-1, -1, 1)});
  const oracle::TreeAndTruth solid(*inner);
  EXPECT_EQ(polytope_side(*solid.tree, scenes::box({1, 1, 1})), PolytopeSide::crosses);
}

TEST(ExactSolidPolytope, KnowsACavity) {
  const oracle::TreeAndTruth solid(oracle::with_cavity());
  const auto of = [&](const Vec3& half_m, const Vec3& center) {
    return polytope_side(*solid.tree, scenes::box(half_m, center));
  };
  EXPECT_EQ(of({0.25, 0.5, 0.25}, {0, 0, 0}), PolytopeSide::out) << "fills the cavity";
  EXPECT_EQ(of({0.5, 0.75, 0.5}, {0, 0, 0}), PolytopeSide::crosses) << "has the cavity in it";
  EXPECT_EQ(of({0.25, 0.5, 0.25}, {0.5, 0, 0}), PolytopeSide::in) << "beside it";
}

TEST(ExactSolidPolytope, SidesAreThoseOfRationals) {
  std::mt19937_64 random = oracle::seeded(66);
  const char* asked = std::getenv("COLLIDED_SOLID_POLYTOPES");
  const int count = asked != nullptr ? std::atoi(asked) : 120;
  std::uniform_real_distribution<double> any(-1, 1);
  std::map<PolytopeSide, int> seen;
  for (const TriangleMesh& mesh : {scenes::box({1, 1, 1}), oracle::with_cavity(), scenes::icosphere(1, 1),
                                   scenes::rough_sphere(1, random), scenes::icosphere(1, 1e-200)}) {
    const oracle::TreeAndTruth solid(mesh);
    ASSERT_TRUE(solid.tree);
    double reach = 0;
    for (const Vec3& vertex : mesh.vertices) reach = std::max(reach, vertex.cwiseAbs().maxCoeff());
    const auto point = [&]() -> Vec3 {
      const Triangle t = mesh.triangle(static_cast<std::uint32_t>(random() % mesh.triangles.size()));
      switch (random() % 5) {
        case 0: return t.a;
        case 1: return (t.a + t.b) / 2;
        case 2: return t.a / 2 + t.b / 4 + t.c / 4;
        case 3: return t.a / 2;
        default: return 1.5 * reach * Vec3(any(random), any(random), any(random));
      }
    };
    for (int i = 0; i < count; ++i) {
      std::optional<TriangleMesh> polytope;
      switch (random() % 4) {
        case 0: polytope = scenes::box(point().cwiseAbs() / 2 + Vec3::Constant(reach / 64), point()); break;
        case 1: polytope = scenes::icosphere(0, reach * (1 + any(random)) / 4 + reach / 1024, point()); break;
        default: polytope = tetrahedron_mesh({point(), point(), point(), point()});
      }
      if (!polytope) continue;
      const PolytopeSide told = polytope_side(*solid.tree, *polytope);
      ASSERT_EQ(told, true_side(solid, *polytope, random)) << "body " << i << " of a mesh of " << mesh.triangles.size();
      ++seen[told];
    }
  }
  for (const PolytopeSide side : {PolytopeSide::in, PolytopeSide::out, PolytopeSide::crosses})
    EXPECT_GT(seen[side], 20);
}

}  // namespace
}  // namespace collided::engine
