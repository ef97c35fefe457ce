#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <unistd.h>

#include "tests/unit/intake/loading.hpp"

namespace collided::engine {
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
  EXPECT_EQ(loaded.report.placed.at(0), "1 joint stands at 0");
}

TEST(IntakeUrdf, WithoutAnSrdfFileLinksNeverMeetAndThatIsSaid) {
  const auto loaded = load("arm.urdf", arm());
  EXPECT_TRUE(loaded.scene.allowed_pairs->is_every_pair());
  EXPECT_EQ(loaded.scene.objects[0].filter.group, 0u) << "groups are the user's";
  EXPECT_NE(loaded.report.warnings.at(0).find("the links never meet each other"), std::string::npos);
}

TEST(IntakeUrdf, AnSrdfFileSaysWhichPairsMayTouch) {
  const std::string path = testing::TempDir() + "arm_" + std::to_string(::getpid()) + ".srdf";
  std::ofstream(path) << R"(<robot name="arm"><disable_collisions link1="base" link2="upper" reason="Adjacent"/>
    <disable_collisions link1="base" link2="nowhere"/></robot>)";
  const auto loaded = load("arm.urdf", arm(), {.srdf = path});
  std::filesystem::remove(path);
  const auto is_allowed = [&](const char* a, const char* b) {
    return loaded.scene.allowed_pairs->contains(find(loaded.scene, a).number, find(loaded.scene, b).number);
  };
  EXPECT_TRUE(is_allowed("arm/base", "arm/upper"));
  EXPECT_FALSE(is_allowed("arm/base", "arm/hand"));
  EXPECT_FALSE(is_allowed("arm/upper", "arm/hand"));
  EXPECT_EQ(loaded.report.warnings.at(0), "1 of 2 pairs in the SRDF file name a link without a collision shape");
}

TEST(IntakeUrdf, MeshesAreFoundFromTheRobotsFolderUpwards) {
  const std::filesystem::path root =
      std::filesystem::path(testing::TempDir()) / ("urdf_" + std::to_string(::getpid())) / "robot_package";
  std::filesystem::create_directories(root / "urdf");
  std::filesystem::create_directories(root / "meshes");
  std::ofstream(root / "meshes/t.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  std::ofstream(root / "urdf/r.urdf") << R"(<robot name="r"><link name="l"><collision><origin xyz="0 0 5"/>
    <geometry><mesh filename="package://robot_package/meshes/t.obj" scale="2 2 -2"/></geometry></collision></link></robot>)";
  LoadReport report;
  const Scene scene = load_scene((root / "urdf/r.urdf").string(), {}, report);
  std::filesystem::remove_all(root.parent_path());
  ASSERT_EQ(scene.objects.size(), 1u);
  const TriangleMesh& mesh = *scene.objects[0].shape.mesh;
  EXPECT_EQ(mesh.vertices[1], Vec3(2, 0, 5));
  EXPECT_EQ(mesh.triangles[0], (TriangleCorners{0, 2, 1}));  // mirrored, so turned
}

TEST(IntakeUrdf, ARobotThatMissesAMeshIsRefusedAsAWhole) {
  EXPECT_EQ(
      complaint(
          "r.urdf",
          R"(<robot name="r"><link name="l"><collision><geometry><mesh filename="package://moveit_resources_panda_description/meshes/collision/link0.stl"/></geometry></collision></link></robot>)"),
      "r.urdf: 1 mesh file is not there, the first is "
      "'package://moveit_resources_panda_description/meshes/collision/link0.stl'; what does not come from a folder has "
      "no "
      "other "
      "files. Nothing was loaded.");
}

// Where packages lie is said by the variables that ROS has for it.
TEST(IntakeUrdf, PackagesAreFoundWhereRosSaysTheyAre) {
  namespace fs = std::filesystem;
  const fs::path root = fs::path(testing::TempDir()) / ("urdf_ros_" + std::to_string(::getpid()));
  fs::create_directories(root / "a/b/c/d/robot");
  fs::create_directories(root / "sources/arm_description/meshes");
  fs::create_directories(root / "prefix/share/arm_description/meshes");
  const char* triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  std::ofstream(root / "sources/arm_description/meshes/t.obj") << triangle;
  std::ofstream(root / "prefix/share/arm_description/meshes/u.obj") << triangle;
  const std::string robot = (root / "a/b/c/d/robot/r.urdf").string();
  const auto write = [&](const std::string& mesh) {
    std::ofstream(robot) << "<robot name='r'><link name='l'><collision><geometry><mesh filename='" << mesh
                         << "'/></geometry></collision></link></robot>";
  };
  LoadOptions options;
  const auto complaint_about = [&](const std::string& mesh) -> std::string {
    write(mesh);
    LoadReport report;
    try {
      load_scene(robot, options, report);
      return "";
    } catch (const LoadError& error) { return error.what(); }
  };
  const std::string in_sources = "package://arm_description/meshes/t.obj";
  EXPECT_EQ(complaint_about(in_sources),
            "r.urdf: 1 mesh file is not there, the first is 'package://arm_description/meshes/t.obj'; looked in the "
            "robot's folder and the 3 above it; say where it is, --package arm_description=DIR, or set "
            "ROS_PACKAGE_PATH, where "
            "the server starts, to the folder that holds it. Nothing was loaded.");
  options.packages = {"arm_description=" + (root / "sources/arm_description").string()};
  EXPECT_EQ(complaint_about(in_sources), "");
  EXPECT_NE(complaint_about("package://other_description/meshes/t.obj"), "") << "it is for that package";
  EXPECT_NE(complaint_about("package://arm_description/../arm_description/meshes/t.obj"), "");
  options.packages = {"arm_description"};
  EXPECT_EQ(complaint_about(in_sources), "package 'arm_description': it is to be NAME=DIR. Nothing was loaded.");
  options.packages = {};
  ::setenv("ROS_PACKAGE_PATH", ("/nowhere:" + (root / "sources").string()).c_str(), 1);
  EXPECT_EQ(complaint_about(in_sources), "");
  ::setenv("ROS_PACKAGE_PATH", (root / "sources/arm_description").string().c_str(), 1);
  EXPECT_EQ(complaint_about(in_sources), "") << "a package's own folder will do";
  const std::string in_prefix = "package://arm_description/meshes/u.obj";
  EXPECT_NE(complaint_about(in_prefix).find("and in ROS_PACKAGE_PATH and AMENT_PREFIX_PATH"), std::string::npos);
  ::setenv("AMENT_PREFIX_PATH", (root / "prefix").string().c_str(), 1);
  EXPECT_EQ(complaint_about(in_prefix), "");
  EXPECT_NE(complaint_about("package://arm_description/../../prefix/share/arm_description/meshes/u.obj"), "");
  EXPECT_NE(complaint_about("package://../sources/arm_description/meshes/t.obj"), "");
  ::unsetenv("ROS_PACKAGE_PATH");
  ::unsetenv("AMENT_PREFIX_PATH");
  fs::remove_all(root);
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

/// A robot of one link with that collision.
std::string one_link(std::string_view collision) {
  return fmt::format(R"(<robot name="r"><link name="l"><collision>{}</collision></link></robot>)", collision);
}

// Roll about x first, then pitch about y, then yaw about z, all of them the parent's axes.
TEST(IntakeUrdf, RollPitchAndYawTurnInTheirOrder) {
  const auto turned = [](std::string_view rpy) {
    const auto loaded =
        load("r.urdf", one_link(fmt::format(R"(<origin rpy="{}"/><geometry><box size="1 1 1"/></geometry>)", rpy)));
    return Vec3(std::get<Box>(loaded.scene.objects.at(0).shape.primitives.at(0)).axes * Vec3(1, 2, 3));
  };
  constexpr const char* kQuarter = "1.5707963267948966";
  EXPECT_LT((turned(fmt::format("{} 0 0", kQuarter)) - Vec3(1, -3, 2)).norm(), 1e-14);
  EXPECT_LT((turned(fmt::format("0 {} 0", kQuarter)) - Vec3(3, 2, -1)).norm(), 1e-14);
  EXPECT_LT((turned(fmt::format("0 0 {}", kQuarter)) - Vec3(-2, 1, 3)).norm(), 1e-14);
  EXPECT_LT((turned(fmt::format("{0} 0 {0}", kQuarter)) - Vec3(3, 1, 2)).norm(), 1e-14);
  EXPECT_LT((turned(fmt::format("{0} {0} 0", kQuarter)) - Vec3(2, -3, -1)).norm(), 1e-14);
  EXPECT_LT((turned(fmt::format("0 {0} {0}", kQuarter)) - Vec3(-2, 3, -1)).norm(), 1e-14);
}

TEST(IntakeUrdf, TurnedJointsPlaceTurnedShapes) {
  constexpr const char* kRobot = R"(<robot name="r"><link name="a"/>
<link name="b"><collision><origin xyz="1 2 3" rpy="1.5707963267948966 0 0"/><geometry><capsule radius="0.5" length="2"/></geometry></collision></link>
<link name="c"><collision><origin xyz="0 5 0" rpy="0 1.5707963267948966 0"/><geometry><cylinder radius="0.25" length="6"/></geometry></collision></link>
<joint name="one" type="fixed"><origin xyz="10 20 30" rpy="0 0 1.5707963267948966"/><parent link="a"/><child link="b"/></joint>
<joint name="two" type="fixed"><origin xyz="1 0 4" rpy="1.5707963267948966 0 0"/><parent link="b"/><child link="c"/></joint></robot>)";
  const auto loaded = load("r.urdf", kRobot);
  const auto placed = [](const SceneObject& link, const Vec3& point) {
    return Vec3(link.pose.position + link.pose.rotation * point);
  };
  const SceneObject& b = find(loaded.scene, "r/b");
  const Capsule capsule = std::get<Capsule>(b.shape.primitives.at(0));
  EXPECT_EQ(capsule.radius_m, 0.5);
  // Its z is the link's -y: ends at (1, 2 -+ 1, 3), then a quarter turn about z and the joint's place.
  EXPECT_LT((placed(b, capsule.a) - Vec3(10 - 3, 20 + 1, 33)).norm(), 1e-14);
  EXPECT_LT((placed(b, capsule.b) - Vec3(10 - 1, 20 + 1, 33)).norm(), 1e-14);
  const SceneObject& c = find(loaded.scene, "r/c");
  const Cylinder rod = std::get<Cylinder>(c.shape.primitives.at(0));
  // In c its axis is x, from (-3, 5, 0) to (3, 5, 0); in b that is (-+3 + 1, 0, 5 + 4); then as above.
  EXPECT_LT((placed(c, rod.a) - Vec3(10, 20 - 2, 39)).norm(), 1e-14);
  EXPECT_LT((placed(c, rod.b) - Vec3(10, 20 + 4, 39)).norm(), 1e-14);
  EXPECT_LT((placed(c, Vec3::Zero()) - Vec3(10, 21, 34)).norm(), 1e-14);
}

// Scaled along its own axes, then turned, then moved; a second mesh of the link keeps its own corners.
TEST(IntakeUrdf, AMeshIsScaledThenTurnedThenMoved) {
  const std::filesystem::path root =
      std::filesystem::path(testing::TempDir()) / ("urdf_" + std::to_string(::getpid())) / "scaled_robot";
  std::filesystem::create_directories(root);
  std::ofstream(root / "t.obj") << "v 1 2 3\nv 4 5 6\nv 7 8 10\nf 2 3 1\n";
  std::ofstream(root / "r.urdf") << R"(<robot name="r"><link name="l">
    <collision><geometry><mesh filename="t.obj"/></geometry></collision>
    <collision><origin xyz="10 20 30" rpy="0 0 1.5707963267948966"/><geometry><mesh filename="t.obj" scale="2 3 5"/></geometry></collision></link></robot>)";
  LoadReport report;
  const Scene scene = load_scene((root / "r.urdf").string(), {}, report);
  std::filesystem::remove_all(root.parent_path());
  const TriangleMesh& mesh = *scene.objects.at(0).shape.mesh;
  EXPECT_EQ(mesh.triangles, (std::vector<TriangleCorners>{{1, 2, 0}, {4, 5, 3}}));
  EXPECT_EQ(mesh.vertices.at(0), Vec3(1, 2, 3));
  EXPECT_LT((mesh.vertices.at(3) - Vec3(10 - 6, 20 + 2, 45)).norm(), 1e-14);
  EXPECT_LT((mesh.vertices.at(5) - Vec3(10 - 24, 20 + 14, 80)).norm(), 1e-14);
}

}  // namespace
}  // namespace collided::engine
