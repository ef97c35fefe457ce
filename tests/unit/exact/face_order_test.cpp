#include "server/exact_phase/solid/face_order.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <random>

#include "tests/oracle/seed.hpp"
#include "tests/oracle/tree_and_truth.hpp"

namespace collided::engine {
namespace {

using oracle::RationalPoint;

struct ShownFace {
  std::uint32_t triangle;
  std::vector<Vec3> outline;
};

std::vector<ShownFace> shown(const SolidTree& tree, const Vec3& eye) {
  std::vector<ShownFace> faces;
  show_front_to_back(tree, eye, [&](const SolidFace& face) {
    faces.push_back({face.triangle, {face.outline.begin(), face.outline.end()}});
    return true;
  });
  return faces;
}

double area(const std::vector<Vec3>& outline) {
  Vec3 twice = Vec3::Zero();
  for (std::size_t i = 2; i < outline.size(); ++i)
    twice += (outline[i - 1] - outline[0]).cross(outline[i] - outline[0]);
  return twice.norm() / 2;
}

TEST(ExactFaceOrder, ShowsTheWholeSurfaceOnce) {
  std::mt19937_64 random = oracle::seeded(67);
  for (const TriangleMesh& mesh :
       {scenes::box({1, 1, 1}), oracle::with_cavity(), scenes::icosphere(3, 1), scenes::rough_sphere(2, random)}) {
    const oracle::TreeAndTruth solid(mesh, true);
    ASSERT_TRUE(solid.tree);
    const std::vector<ShownFace> faces = shown(*solid.tree, {3, 1, 2});
    EXPECT_EQ(faces.size(), solid.tree->report().fragments);
    std::vector<double> areas(mesh.triangles.size());
    for (const ShownFace& face : faces) areas[face.triangle] += area(face.outline);
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      const Triangle t = mesh.triangle(i);
      const double whole = area({t.a, t.b, t.c});
      ASSERT_NEAR(areas[i], whole, 1e-12 * whole);
    }
  }
}

TEST(ExactFaceOrder, EndsWhenToldTo) {
  const oracle::TreeAndTruth solid(scenes::icosphere(2, 1), true);
  int count = 0;
  show_front_to_back(*solid.tree, {3, 0, 0}, [&](const SolidFace&) { return ++count < 5; });
  EXPECT_EQ(count, 5);
}

/// Where along a ray from `eye` it passes the triangle, as a share of `way`; nothing where it does not pass through the
/// triangle's inner part.
std::optional<mpq_class> passed(const Triangle& t, const Vec3& eye, const Vec3& way) {
  const RationalPoint from = oracle::rational(eye), along = oracle::rational(way);
  RationalPoint to;
  for (int axis = 0; axis < 3; ++axis) to[axis] = from[axis] + along[axis];
  const mpq_class high = oracle::height(t, from), low = oracle::height(t, to);
  if (high == low) return std::nullopt;
  const mpq_class share = high / (high - low);
  if (share <= 0) return std::nullopt;
  RationalPoint at;
  for (int axis = 0; axis < 3; ++axis) at[axis] = from[axis] + share * along[axis];
  // Seen along the axis that the triangle faces most.
  const Vec3 normal = (t.b - t.a).cross(t.c - t.a);
  int skip = 0;
  normal.cwiseAbs().maxCoeff(&skip);
  const int x = (skip + 1) % 3, y = (skip + 2) % 3;
  int signs[3];
  const Vec3* const corners[] = {&t.a, &t.b, &t.c};
  for (int k = 0; k < 3; ++k) {
    const RationalPoint u = oracle::rational(*corners[k]), v = oracle::rational(*corners[(k + 1) % 3]);
    signs[k] = sgn(mpq_class((v[x] - u[x]) * (at[y] - u[y]) - (v[y] - u[y]) * (at[x] - u[x])));
  }
  if (signs[0] == 0 || signs[1] != signs[0] || signs[2] != signs[0]) return std::nullopt;
  return share;
}

/// How far inside a piece's outline the ray passes its plane, as a share of its size; negative: outside.
double margin(const ShownFace& face, const Triangle& t, const Vec3& eye, const Vec3& way) {
  const Vec3 normal = (t.b - t.a).cross(t.c - t.a).normalized();
  const Vec3 at = eye + way * (normal.dot(t.a - eye) / normal.dot(way));
  double least = std::numeric_limits<double>::infinity(), size = 0;
  for (std::size_t i = 0; i < face.outline.size(); ++i) {
    const Vec3& u = face.outline[i];
    const Vec3& v = face.outline[(i + 1) % face.outline.size()];
    size = std::max(size, (u - t.a).norm());
    if (u == v) continue;
    least = std::min(least, normal.cross(v - u).normalized().dot(at - u));
  }
  return least / std::max(size, (t.b - t.a).norm());
}

// A ray passes pieces in the order in which they were shown.
TEST(ExactFaceOrder, IsThatOfRaysFromTheEye) {
  std::mt19937_64 random = oracle::seeded(68);
  const char* asked = std::getenv("COLLIDED_SOLID_EYES");
  const int eyes = asked != nullptr ? std::atoi(asked) : 12;
  std::uniform_real_distribution<double> any(-2, 2);
  int passes = 0, deep = 0;
  for (const TriangleMesh& mesh :
       {scenes::box({1, 1, 1}), oracle::with_cavity(), scenes::icosphere(2, 1), scenes::rough_sphere(2, random)}) {
    const oracle::TreeAndTruth solid(mesh, true);
    ASSERT_TRUE(solid.tree);
    for (int i = 0; i < eyes; ++i) {
      const std::uint32_t near = static_cast<std::uint32_t>(random() % mesh.triangles.size());
      const Triangle t = mesh.triangle(near);
      const Vec3 eye = i % 3 == 0   ? Vec3(t.a * 2 - t.b)  // in a triangle's plane
                       : i % 3 == 1 ? Vec3(t.a / 4 + t.b / 4)
                                    : Vec3(any(random), any(random), any(random));
      const std::vector<ShownFace> faces = shown(*solid.tree, eye);
      for (int ray = 0; ray < 12; ++ray) {
        const Vec3 way(any(random), any(random), any(random));
        std::vector<std::optional<mpq_class>> shares(mesh.triangles.size());
        for (std::uint32_t k = 0; k < mesh.triangles.size(); ++k) shares[k] = passed(mesh.triangle(k), eye, way);
        std::optional<mpq_class> last;
        int in_row = 0;
        for (const ShownFace& face : faces) {
          const auto& share = shares[face.triangle];
          if (!share || margin(face, mesh.triangle(face.triangle), eye, way) < 1e-9) continue;
          ASSERT_TRUE(!last || *last <= *share) << "eye " << eye.transpose() << ", way " << way.transpose();
          last = share;
          ++passes;
          ++in_row;
        }
        deep += in_row > 1 ? 1 : 0;
        const auto all =
            static_cast<int>(std::count_if(shares.begin(), shares.end(), [](const auto& s) { return !!s; }));
        ASSERT_LE(in_row, all) << "a triangle passed twice";
      }
    }
  }
  EXPECT_GT(passes, 300);
  EXPECT_GT(deep, 100) << "rays with an order to check";
}

}  // namespace
}  // namespace collided::engine
