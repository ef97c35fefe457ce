// Two meshes that share a corner, an edge or a face touch without any triangle crossing another, and the one's corner
// may lie in the other's edge.
#include <gtest/gtest.h>

#include "tests/extreme/worlds.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::engine::mesh_neighbours_test {
namespace {

/// A unit cube of twelve triangles beside another: one contact if `touching`, as mover against mover, against static
/// triangles and against a box.
void expect_contact(const Vec3& offset, bool touching) {
  const TriangleMesh cube = scenes::box({0.5, 0.5, 0.5});
  for (int kind = 0; kind < 3; ++kind) {
    extreme::Stage stage;
    if (kind == 0) stage.add("fixed", extreme::mesh_shape(cube), extreme::at({0, 0, 0}));
    if (kind == 1) stage.load("fixed", cube);
    if (kind == 2) stage.block("fixed", {0, 0, 0}, {0.5, 0.5, 0.5});
    stage.add("mesh", extreme::mesh_shape(cube), extreme::at(offset));
    stage.step();
    ASSERT_EQ(stage.world.contacts().size(), touching ? 1u : 0u) << offset.transpose() << " kind " << kind;
    if (touching) { ASSERT_NEAR(stage.world.contacts()[0].contact.normal.norm(), 1, 1e-14); }
  }
}

TEST(ExtremeMeshNeighbours, CornerEdgeAndFace) {
  const double summand = std::nextafter(1, 2);
  expect_contact({1, 0, 0}, true);
  expect_contact({summand, 0, 0}, false);
  expect_contact({1, 1, 0}, true);
  expect_contact({1, summand, 0}, false);
  expect_contact({1, 1, 1}, true);
  expect_contact({1, 1, summand}, false);
  expect_contact({-1, -1, -1}, true);
  expect_contact({-1, -1, -summand}, false);
}

TEST(ExtremeMeshNeighbours, CornerInEdgeAndCornerInFace) {
  expect_contact({1, 0.5, 0.25}, true);
  expect_contact({1, 1, 0.5}, true);
  expect_contact({0.25, 0.125, 1}, true);
  expect_contact({0.25, 0.125, std::nextafter(1, 2)}, false);
}

TEST(ExtremeMeshNeighbours, OnItselfAndThroughItself) {
  expect_contact({0, 0, 0}, true);
  expect_contact({0.5, 0.5, 0.5}, true);
  expect_contact({0x1p-52, 0, 0}, true);
}

// A surface is a surface: a small mesh within a large one touches nothing, a small one within a box does.
TEST(ExtremeMeshNeighbours, MeshesAreSurfacesAndBoxesAreSolid) {
  extreme::Stage stage;
  stage.add("hollow", extreme::mesh_shape(scenes::box({5, 5, 5})), extreme::at({0, 0, 0}));
  stage.add("core", extreme::mesh_shape(scenes::box({1, 1, 1})), extreme::at({0, 0, 0}));
  stage.block("solid", {100, 0, 0}, {5, 5, 5});
  stage.add("inside", extreme::mesh_shape(scenes::box({1, 1, 1})), extreme::at({100, 0, 0}));
  stage.step();
  ASSERT_EQ(stage.world.contacts().size(), 1u);
  EXPECT_EQ(stage.world.info(stage.world.contacts()[0].a)->name, "solid");
}

}  // namespace
}  // namespace collided::engine::mesh_neighbours_test
