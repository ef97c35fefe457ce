// Floors of many bodies: whoever slides over the edges between them feels one floor.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/extreme/worlds.hpp"

namespace collided::engine::inner_edge_test {
namespace {

constexpr double kDepth = 0x1p-7;

/// The mover's contacts, each with the normal that points down, out of the mover.
void expect_floor(const World& world, ObjectId mover, const Vec3& down, double slack, std::size_t& seen) {
  for (const OpenContact& open : world.contacts()) {
    if (open.a != mover && open.b != mover) continue;
    const Vec3 normal = open.a == mover ? open.surface.normal : Vec3(-open.surface.normal);
    ASSERT_LE((normal - down).norm(), slack) << normal.transpose();
    // The depth is that of the floor, whose bodies are flush.
    ASSERT_LE(std::abs(open.surface.depth_m - kDepth), open.surface.depth_error_m + slack) << open.surface.depth_m;
    ASSERT_LE(open.surface.depth_error_m, 1e-9) << "a bound that tells nothing";
    // The contact itself stays the shortest way out of the two.
    ASSERT_LE(open.contact.depth_m - open.contact.depth_error_m, open.surface.depth_m + open.surface.depth_error_m);
    ++seen;
  }
}

struct Floor {
  Quat turn = Quat::Identity();
  Vec3 origin = Vec3::Zero();
  Pose at(const Vec3& local) const { return {.position = origin + turn * local, .rotation = turn}; }
};

/// Slides the mover, kDepth deep in the floor, along lines that cross edges and corners; the floor's top is z = 0.
void slide(extreme::Stage& stage, const Floor& floor, ObjectId mover, double height, double slack) {
  std::size_t seen = 0;
  std::size_t most = 0;
  for (const double slant : {0.0, 0.3, 1.0}) {
    for (double x = -3; x <= 3; x += 0x1p-5) {
      stage.move(mover, floor.at({x, x * slant, height - kDepth}), x == -3);
      const std::vector<Event> events = stage.step({.contacts = true, .persisted = true});
      const std::size_t before = seen;
      expect_floor(stage.world, mover, floor.turn * Vec3(0, 0, -1), slack, seen);
      if (testing::Test::HasFatalFailure()) FAIL() << "x " << x << " slant " << slant;
      most = std::max(most, seen - before);
      for (const Event& event : events) {
        // Who is met and left within a step is told as at the first contact, which has no depth.
        if (!extreme::open_pairs(stage.world).contains({event.of.a, event.of.b})) continue;
        ASSERT_LE(std::abs(event.of.surface.depth_m - kDepth), event.of.surface.depth_error_m + slack)
            << "events tell the same";
      }
    }
  }
  EXPECT_GT(most, 1u) << "more than one body at a time";
}

/// Whether the mover or the floor's bodies were there first, whose contacts then name them first.
template <class AddFloor>
void slide(const Floor& floor, const Shape& shape, double height, double slack, const AddFloor& add_floor) {
  for (const bool mover_first : {false, true}) {
    SCOPED_TRACE(mover_first ? "the mover was there first" : "the floor was there first");
    extreme::Stage stage;
    if (!mover_first) add_floor(stage, floor);
    const ObjectId mover = stage.add("mover", shape, floor.at({-3, -3, height - kDepth}));
    if (mover_first) add_floor(stage, floor);
    slide(stage, floor, mover, height, slack);
  }
}

void add_boxes(extreme::Stage& stage, const Floor& floor) {
  for (int x = -5; x < 5; ++x) {
    for (int y = -5; y < 5; ++y) {
      stage.add("tile" + std::to_string(x) + "," + std::to_string(y), extreme::box_shape({0.5, 0.5, 0.25}),
                floor.at({x + 0.5, y + 0.5, -0.25}), false);
    }
  }
}

Shape cube() { return extreme::box_shape({0.375, 0.375, 0.25}); }

TEST(ExtremeInnerEdge, ABallRollsOverNeighbouringBoxes) { slide({}, extreme::ball_shape(0.5), 0.5, 1e-15, add_boxes); }

TEST(ExtremeInnerEdge, ABoxSlidesOverNeighbouringBoxes) { slide({}, cube(), 0.25, 1e-15, add_boxes); }

TEST(ExtremeInnerEdge, SoTheyDoOnATurnedFloorFarOut) {
  const Floor floor{Quat(0.9, 0.1, -0.3, 0.2).normalized(), {1000, -300, 20}};
  slide(floor, extreme::ball_shape(0.5), 0.5, 1e-11, add_boxes);
  slide(floor, cube(), 0.25, 1e-11, add_boxes);
}

/// One part of the scene a tile of two triangles.
void load_tiles(extreme::Stage& stage, const Floor&) {
  Scene scene;
  scene.name = "floor";
  for (int x = -5; x < 5; ++x) {
    for (int y = -5; y < 5; ++y) {
      const auto v = static_cast<std::uint32_t>(scene.mesh.vertices.size());
      for (const auto& [i, k] : {std::pair(0, 0), std::pair(1, 0), std::pair(1, 1), std::pair(0, 1)}) {
        scene.mesh.vertices.push_back(Vec3(x + i, y + k, 0));
      }
      scene.parts.push_back({.name = "tile" + std::to_string(v), .first_triangle = v / 2, .triangle_count = 2});
      scene.mesh.triangles.push_back({v, v + 1, v + 2});
      scene.mesh.triangles.push_back({v, v + 2, v + 3});
    }
  }
  auto indexed = World::index_scene(scene, {.threads = 1, .progress = {}, .cancelled = {}});
  ASSERT_TRUE(std::holds_alternative<std::uint32_t>(stage.world.add_scene(indexed)));
}

TEST(ExtremeInnerEdge, TheyFeelOneFloorOfManyMeshParts) {
  slide({}, extreme::ball_shape(0.5), 0.5, 1e-14, load_tiles);
  slide({}, cube(), 0.25, 1e-14, load_tiles);
}

TEST(ExtremeInnerEdge, WallsAndStepsKeepTheirNormals) {
  extreme::Stage stage;
  stage.add("ground", {.primitives = {HalfSpace{{0, 0, 0}, {0, 0, 1}}}, .mesh = nullptr}, {}, false);
  stage.add("step", extreme::box_shape({1, 1, 0.0625}), extreme::at({1.5, 0, 0.0625}), false);
  const ObjectId ball = stage.ball("ball", {0.25, 0, 0.5 - kDepth}, 0.5);
  stage.step();
  ASSERT_EQ(stage.world.contacts().size(), 2u);
  for (const OpenContact& open : stage.world.contacts()) {
    const Vec3 normal = open.a == ball ? open.surface.normal : Vec3(-open.surface.normal);
    const ObjectInfo& other = *stage.world.info(open.a == ball ? open.b : open.a);
    if (other.name == "ground") {
      EXPECT_EQ(normal, Vec3(0, 0, -1));
    } else {
      EXPECT_GT(normal.x(), 0.5) << "the edge of a step stays an edge";
    }
  }
}

}  // namespace
}  // namespace collided::engine::inner_edge_test
