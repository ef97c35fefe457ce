#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <numbers>

#include "tests/unit/intake_loading.hpp"

namespace collided {
namespace {

using test::complaint;
using test::load;

std::string arm(std::string_view joint = "") {
  return fmt::format(
      R"(<?xml version="1.0"?><robot name="arm">
<link name="base"><collision><geometry><box size="2 4 6"/></geometry></collision></link>
<link name="upper"><collision><origin xyz="0 0 1"/><geometry><cylinder radius="0.1" length="2"/></geometry></collision>
  <collision><geometry><sphere radius="0.2"/></geometry></collision></link>
<link name="tool"/>
<link name="hand"><collision><geometry><sphere radius="0.05"/></geometry></collision></link>
<joint name="shoulder" type="revolute"><origin xyz="1 0 0" rpy="0 0 {}"/><parent link="base"/><child link="upper"/></joint>
<joint name="wrist" type="fixed"><origin xyz="2 0 0"/><parent link="upper"/><child link="tool"/></joint>
<joint name="grip" type="fixed"><origin xyz="0 0 3"/><parent link="tool"/><child link="hand"/></joint>{}
</robot>)",
      std::numbers::pi / 2, joint);
}

const SceneObject& find(const Scene& scene, const std::string& name) {
  for (const SceneObject& object : scene.objects) {
    if (object.name == name) return object;
  }
  ADD_FAILURE() << name;
  return scene.objects.at(0);
}

TEST(IntakeUrdf, LinksStandWhereTheirJointsAtZeroPutThem) {
  const auto loaded = load("arm.urdf", arm());
  ASSERT_EQ(loaded.scene.objects.size(), 3u);
  EXPECT_EQ(std::get<Box>(find(loaded.scene, "arm/base").shape.primitives[0]).half_m, Vec3(1, 2, 3));
  const SceneObject& upper = find(loaded.scene, "arm/upper");
  EXPECT_EQ(upper.pose.position, Vec3(1, 0, 0));
  const Cylinder rod = std::get<Cylinder>(upper.shape.primitives[0]);
  EXPECT_EQ(rod.a, Vec3(0, 0, 0));
  EXPECT_EQ(rod.b, Vec3(0, 0, 2));
  EXPECT_EQ(upper.shape.primitives.size(), 2u);
  // Two along the turned x axis, then three up.
  EXPECT_NEAR((find(loaded.scene, "arm/hand").pose.position - Vec3(1, 2, 3)).norm(), 0, 1e-15);
  EXPECT_EQ(loaded.report.placed.at(0), "1 joints stand at 0");
}

TEST(IntakeUrdf, WithoutAnSrdfFileLinksNeverMeetAndThatIsSaid) {
  const auto loaded = load("arm.urdf", arm());
  EXPECT_FALSE(may_meet(loaded.scene.objects[0].filter, loaded.scene.objects[1].filter));
  EXPECT_TRUE(may_meet(loaded.scene.objects[0].filter, Filter{}));
  EXPECT_NE(loaded.report.warnings.at(0).find("the links never meet each other"), std::string::npos);
}

TEST(IntakeUrdf, AnSrdfFileSaysWhichPairsMayTouch) {
  const std::string path = testing::TempDir() + "arm.srdf";
  std::ofstream(path) << R"(<robot name="arm"><disable_collisions link1="base" link2="upper" reason="Adjacent"/>
    <disable_collisions link1="base" link2="nowhere"/></robot>)";
  const auto loaded = load("arm.urdf", arm(), {.srdf = path});
  std::filesystem::remove(path);
  const auto filter = [&](const char* name) { return find(loaded.scene, name).filter; };
  EXPECT_FALSE(may_meet(filter("arm/base"), filter("arm/upper")));
  EXPECT_TRUE(may_meet(filter("arm/base"), filter("arm/hand")));
  EXPECT_TRUE(may_meet(filter("arm/upper"), filter("arm/hand")));
  for (const SceneObject& link : loaded.scene.objects) EXPECT_TRUE(may_meet(link.filter, Filter{}));
  EXPECT_EQ(loaded.report.warnings.at(0), "1 of 2 pairs in the SRDF file name a link without a collision shape");
}

TEST(IntakeUrdf, MeshesAreFoundFromTheRobotsFolderUpwards) {
  const std::filesystem::path root = std::filesystem::path(testing::TempDir()) / "robot_package";
  std::filesystem::create_directories(root / "urdf");
  std::filesystem::create_directories(root / "meshes");
  std::ofstream(root / "meshes/t.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  std::ofstream(root / "urdf/r.urdf") << R"(<robot name="r"><link name="l"><collision><origin xyz="0 0 5"/>
    <geometry><mesh filename="package://robot_package/meshes/t.obj" scale="2 2 -2"/></geometry></collision></link></robot>)";
  LoadReport report;
  const Scene scene = load_scene((root / "urdf/r.urdf").string(), {}, report);
  std::filesystem::remove_all(root);
  ASSERT_EQ(scene.objects.size(), 1u);
  const TriangleMesh& mesh = *scene.objects[0].shape.mesh;
  EXPECT_EQ(mesh.vertices[1], Vec3(2, 0, 5));
  EXPECT_EQ(mesh.triangles[0], (TriangleCorners{0, 2, 1}));  // mirrored, so turned
}

TEST(IntakeUrdf, ARobotThatMissesAMeshIsRefusedAsAWhole) {
  EXPECT_EQ(
      complaint(
          "r.urdf",
          R"(<robot name="r"><link name="l"><collision><geometry><mesh filename="package://p/a.stl"/></geometry></collision></link></robot>)"),
      "r.urdf: 1 mesh files are not there, the first is 'package://p/a.stl'. Nothing was loaded.");
}

TEST(IntakeUrdf, ComplaintsSayWhat) {
  EXPECT_EQ(
      complaint("r.urdf", arm(R"(<joint name="ring" type="fixed"><parent link="hand"/><child link="base"/></joint>)")),
      "r.urdf: its joints form a ring. Nothing was loaded.");
  EXPECT_EQ(
      complaint("r.urdf", arm(R"(<joint name="two" type="fixed"><parent link="base"/><child link="hand"/></joint>)")),
      "r.urdf: link 'hand' is the child of two joints. Nothing was loaded.");
  EXPECT_EQ(
      complaint("r.urdf", arm(R"(<joint name="lost" type="fixed"><parent link="base"/><child link="leg"/></joint>)")),
      "r.urdf: joint 'lost' names the link 'leg', which is not there. Nothing was loaded.");
  EXPECT_EQ(
      complaint(
          "r.urdf",
          R"(<robot name="r"><link name="l"><collision><geometry><sphere radius="-1"/></geometry></collision></link></robot>)"),
      "r.urdf: <sphere> radius is -1 m, allowed are lengths above 0. Nothing was loaded.");
  EXPECT_EQ(
      complaint(
          "r.urdf",
          R"(<robot name="r"><link name="l"><collision><geometry><plane/></geometry></collision></link></robot>)"),
      "r.urdf: a collision geometry 'plane'; read are box, sphere, cylinder, capsule and mesh. Nothing was loaded.");
  EXPECT_NE(complaint("r.urdf", "<robot><link").find("r.urdf: byte "), std::string::npos);
  EXPECT_EQ(
      complaint(
          "r.urdf",
          R"(<robot name="r"><link name="l"><collision><origin xyz="1 2 a"/><geometry><sphere radius="1"/></geometry></collision></link></robot>)"),
      "r.urdf: attribute xyz '1 2 a': line 1: number 'a' is not a number. Nothing was loaded.");
}

}  // namespace
}  // namespace collided
