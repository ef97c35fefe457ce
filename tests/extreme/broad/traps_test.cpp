// A host may run with floating-point traps on: a NaN or a division by zero that an index computes for lanes and triangles
// that do not count would kill it.
#include <gtest/gtest.h>

#include <cfenv>
#include <cstdlib>
#include <fenv.h>

#include "tests/extreme/broad/candidates.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::engine::traps_test {
namespace {

constexpr double kEndless = std::numeric_limits<double>::infinity();
constexpr double kTiniest = 0x1p-1074;

std::vector<Ray> rays_of(double scale, double offset) {
  std::vector<Ray> rays;
  for (const double x : {-2.0, -0.5, -0.0, 0.0, 0.25, 1.0}) {
    const Vec3 from = scale * Vec3(x, 0, 5) + Vec3::Constant(offset);
    for (const Vec3& along :
         {Vec3(0, 0, -1), Vec3(-0.0, 0, -kTiniest), Vec3(1, 0, 0), Vec3(1e-300, -1e300, 1), Vec3(1, 1, -1)}) {
      for (const double length : {kEndless, 0.0, 4 * scale}) rays.push_back({from, along, length});
    }
  }
  return rays;
}

std::size_t walk_everything(const TriangleMesh& mesh, double scale, double offset) {
  const Bvh tree = Bvh::build(mesh, {.threads = 1, .progress = {}, .cancelled = {}});
  std::vector<Aabb> boxes;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) boxes.push_back(bounds(mesh.triangle(i)));
  const Grid grid = extreme::grid_of(boxes);
  std::size_t seen = extreme::count_pairs(grid);
  for (const Ray& ray : rays_of(scale, offset)) {
    seen += extreme::along_ray(tree, ray).size();
    seen += extreme::along_ray(grid, ray, ray.length_m).size();
    for (const double reach : {0.0, scale}) {
      seen += extreme::near_point(grid, ray.origin, reach).size();
      seen += extreme::in_box(tree, extreme::cube(ray.origin, reach)).size();
      seen += extreme::in_box(grid, extreme::cube(ray.origin, reach)).size();
    }
  }
  return seen;
}

/// Triangles of all kinds, edge-on and without area among them.
TriangleMesh mixed(double scale, double offset) {
  TriangleMesh mesh = scenes::degenerate(300, 7);
  scenes::append(mesh, scenes::box({0.5, 0.5, 0.5}));
  for (Vec3& vertex : mesh.vertices) vertex = scale * vertex + Vec3::Constant(offset);
  return mesh;
}

constexpr double kScales[] = {1, 1e-12, 1e12, 1e-200, 1e200};
constexpr double kOffsets[] = {0, 1e8, -1e15};

TEST(ExtremeBroadTraps, NoInvalidOperationAndNoDivisionByZero) {
  for (const double scale : kScales) {
    for (const double offset : kOffsets) {
      const TriangleMesh mesh = mixed(scale, offset);
      std::feclearexcept(FE_ALL_EXCEPT);
      EXPECT_GT(walk_everything(mesh, scale, offset), 0u);
      const int raised = std::fetestexcept(FE_INVALID | FE_DIVBYZERO);
      EXPECT_EQ(raised & FE_INVALID, 0) << "invalid operation: scale " << scale << ", offset " << offset;
      EXPECT_EQ(raised & FE_DIVBYZERO, 0) << "division by zero: scale " << scale << ", offset " << offset;
    }
  }
}

// The same with the processor's traps on, in a process of its own: SIGFPE would end it.
TEST(ExtremeBroadTraps, AHostThatTrapsSurvives) {
  EXPECT_EXIT(
      {
        feenableexcept(FE_INVALID | FE_DIVBYZERO);
        for (const double scale : kScales) walk_everything(mixed(scale, 0), scale, 0);
        std::_Exit(0);
      },
      testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace collided::engine::traps_test
