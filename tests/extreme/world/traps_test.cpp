// With floating-point traps on, as some hosts run, a NaN that a filter computes on its way to "not sure" would kill the
// process; rounding upward would break every proof. The engine computes under settings of its own and gives the host's
// back as they were.
#include <gtest/gtest.h>

#include <cfenv>
#include <cstdlib>
#include <fenv.h>

#include "tests/extreme/mixed.hpp"

namespace collided::engine::traps_test {
namespace {

/// Steps and questions over ordinary, touching, degenerate, far, tiny and huge input, all of it accepted.
void whole_life(double scale, double offset) {
  extreme::Stage stage;
  TriangleMesh floor;
  for (const Vec3& corner : {Vec3(-9, -9, 0), Vec3(9, -9, 0), Vec3(0, 9, 0), Vec3(1, 1, 1), Vec3(2, 2, 2)}) {
    floor.vertices.push_back(scale * corner + Vec3::Constant(offset));
  }
  floor.triangles = {{0, 1, 2}, {0, 3, 4}, {3, 3, 3}, {0, 0, 1}};
  stage.load("floor", floor);
  const auto place = [&](double x, double y, double z) -> Vec3 {
    return scale * Vec3(x, y, z) + Vec3::Constant(offset);
  };
  std::vector<ObjectId> movers;
  movers.push_back(stage.ball("ball", place(0, 0, 1), scale));
  movers.push_back(stage.ball("same", place(0, 0, 1), scale));
  movers.push_back(stage.ball("point", place(0, 0, 0), 0));
  movers.push_back(stage.block("box", place(1, 1, 1), scale * Vec3(1, 2, 3)));
  movers.push_back(stage.block("plate", place(1, 1, 1), scale * Vec3(1, 1, 0)));
  movers.push_back(
      stage.add("rod", {.primitives = {Capsule{scale * Vec3(0, 0, -1), scale * Vec3(0, 0, 1), scale}}, .mesh = nullptr},
                extreme::at(place(2, 0, 0), Quat(0.5, 0.5, 0.5, 0.5))));
  TriangleMesh tent;
  tent.vertices = {scale * Vec3(0, 0, 0), scale * Vec3(1, 0, 0), scale * Vec3(0, 1, 0), scale * Vec3(0, 0, 1)};
  tent.triangles = {{0, 1, 2}, {0, 1, 3}, {3, 3, 3}};
  movers.push_back(stage.add("tent", extreme::mesh_shape(tent), extreme::at(place(0, 0, 0))));
  stage.step();
  for (int i = 0; i < 6; ++i) {
    for (std::size_t k = 0; k < movers.size(); ++k) {
      stage.move(movers[k], extreme::at(place(i % 3 - 1.0, static_cast<double>(k % 2), i % 2)), (i + k) % 5 == 0);
    }
    stage.step({.contacts = true, .persisted = true});
  }
  for (const double x : {-2.0, -0.0, 0.0, 1.0}) {
    const Vec3 from = place(x, 0, 5);
    for (const auto mode : {HitMode::closest, HitMode::all}) {
      stage.ray(from, {0, 0, -1}, extreme::kEndless, mode);
      stage.ray(from, {-0.0, 0.0, -scale}, 4 * scale, mode);
      stage.ray(place(-9, x, 0), {1, 0, 0}, extreme::kEndless, mode);
      stage.ray(place(0, 0, x), {1e-300, -1e-300, 1}, 0, mode);
    }
    stage.ask(QuestionKind::sphere, {from.x(), from.y(), from.z(), std::abs(x) * scale});
    stage.ask(QuestionKind::box, {from.x(), from.y(), from.z(), scale, 0, 9 * scale, 1, 0, 0, 0});
    stage.ask(QuestionKind::near, {from.x(), from.y(), from.z(), extreme::kEndless});
    stage.ask(QuestionKind::near, {from.x(), from.y(), from.z(), 0});
  }
}

const double kScales[] = {1, 1e-12, 1e12};
const double kOffsets[] = {0, 1e8, -1e15};

TEST(ExtremeTraps, NoInvalidOperationAndNoDivisionByZero) {
  for (const double scale : kScales) {
    for (const double offset : kOffsets) {
      std::feclearexcept(FE_ALL_EXCEPT);
      whole_life(scale, offset);
      const int raised = std::fetestexcept(FE_INVALID | FE_DIVBYZERO);
      EXPECT_EQ(raised & FE_INVALID, 0) << "invalid operation: scale " << scale << ", offset " << offset;
      EXPECT_EQ(raised & FE_DIVBYZERO, 0) << "division by zero: scale " << scale << ", offset " << offset;
    }
  }
}

// The same with the processor's traps on, in a process of its own: SIGFPE would end it.
TEST(ExtremeTraps, AHostThatTrapsSurvives) {
  EXPECT_EXIT(
      {
        feenableexcept(FE_INVALID | FE_DIVBYZERO);
        for (const double offset : kOffsets) whole_life(1, offset);
        std::_Exit(0);
      },
      testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace collided::engine::traps_test
