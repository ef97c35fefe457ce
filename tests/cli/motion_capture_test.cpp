#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "client/cli/failure.hpp"
#include "client/cli/publish/motion_capture.hpp"
#include "client/cli/publish/walker.hpp"

namespace collided::cli {
namespace {

constexpr const char* kJumps = "/usr/share/assimp/models/BVH/01_01.bvh";

/// A hip, a leg below it and the leg's end; the hip stands at (1, 2, 3) and turns about z by what the frame says.
std::string two_joints(const std::string& motion) {
  return "HIERARCHY\nROOT Hips\n{\n OFFSET 0 0 0\n CHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation "
         "Xrotation\n"
         " JOINT LeftFoot\n {\n  OFFSET 0 -2 0\n  CHANNELS 3 Zrotation Yrotation Xrotation\n"
         "  End Site\n  {\n   OFFSET 0 0 1\n  }\n }\n}\nMOTION\n" +
         motion;
}

std::string refusal(const std::string& text) {
  try {
    parse_bvh(text, "a.bvh");
    return "accepted";
  } catch (const Failure& failure) { return failure.what(); }
}

TEST(MotionCapture, ChildrenTurnWithTheirParents) {
  const MotionCapture bvh =
      parse_bvh(two_joints("Frames: 2\nFrame Time: 0.01\n1 2 3 90 0 0 0 0 0\n1 2 3 0 0 90 0 90 0\n"), "a.bvh");
  ASSERT_EQ(bvh.joints.size(), 3U);
  EXPECT_EQ(bvh.frame_seconds, 0.01);
  // A quarter turn about z takes (0, -2, 0) to (2, 0, 0).
  EXPECT_NEAR((joint_poses(bvh, 0)[1].position - Vec3(3, 2, 3)).norm(), 0, 1e-15);
  EXPECT_NEAR((joint_poses(bvh, 0)[2].position - Vec3(3, 2, 4)).norm(), 0, 1e-15);
  // A quarter turn about x takes (0, -2, 0) to (0, 0, -2); the foot's own quarter turn about y takes (0, 0, 1) to (1, 0, 0).
  EXPECT_NEAR((joint_poses(bvh, 1)[1].position - Vec3(1, 2, 1)).norm(), 0, 1e-15);
  EXPECT_NEAR((joint_poses(bvh, 1)[2].position - Vec3(2, 2, 1)).norm(), 0, 1e-15);
}

// The first channel of a joint is the outermost turn: Z then X is not X then Z.
TEST(MotionCapture, TheFirstChannelIsTheOutermostTurn) {
  const MotionCapture bvh = parse_bvh(two_joints("Frames: 1\nFrame Time: 0.01\n0 0 0 90 0 90 0 0 0\n"), "a.bvh");
  // About x first: (0, -2, 0) to (0, 0, -2); about z it stays.
  EXPECT_NEAR((joint_poses(bvh, 0)[1].position - Vec3(0, 0, -2)).norm(), 0, 1e-15);
}

TEST(MotionCapture, WhatIsWrongIsNamedWithItsLine) {
  EXPECT_EQ(refusal(""), "a.bvh line 1: the file ends where 'HIERARCHY' should stand");
  EXPECT_EQ(refusal("HIERARCHY\nROOT Hips\n{\n OFFSET 0 nan 0\n"),
            "a.bvh line 4: 'nan' where a number of OFFSET should stand");
  EXPECT_EQ(refusal("HIERARCHY\nROOT Hips\n{\n CHANNELS 9 Xposition\n"),
            "a.bvh line 4: 9 channels of one joint, allowed 6");
  EXPECT_EQ(
      refusal("HIERARCHY\nROOT Hips\n{\n CHANNELS 1 Wposition\n"),
      "a.bvh line 4: 'Wposition' is no channel; channels: Xposition Yposition Zposition Xrotation Yrotation Zrotation");
  EXPECT_EQ(refusal(two_joints("Frames: 2\nFrame Time: 0.01\n1 2 3 90 0 0 0 0 0\n")),
            "a.bvh line 20: the file ends where a channel's value should stand");
  EXPECT_EQ(refusal(two_joints("Frames: 1\nFrame Time: 0.01\n1 2 3 90 0 0 0 0 0 7\n")),
            "a.bvh line 19: more values than 1 frames of 9 channels take");
  EXPECT_EQ(refusal(two_joints("Frames: 1\nFrame Time: 0\n")), "a.bvh line 18: frame time 0 must be above 0");
  EXPECT_EQ(refusal(two_joints("Frames: 99999999999\nFrame Time: 0.01\n")),
            "a.bvh line 17: 99999999999 frames, allowed 2");
  std::string deep = "HIERARCHY\nROOT r\n{\n";
  for (int level = 0; level < 100'000; ++level) deep += "JOINT j {\n";
  EXPECT_EQ(refusal(deep), "a.bvh line 67: joints nest deeper than 64");
}

TEST(Walker, BonesAreCapsulesAndFeetAreSpheres) {
  const MotionCapture bvh =
      parse_bvh(two_joints("Frames: 2\nFrame Time: 0.01\n1 2 3 0 0 0 0 0 0\n1 2 3 0 0 0 0 0 0\n"), "a.bvh");
  WalkerOptions options{.name = "walker", .unit_m = 0.5};
  const std::vector<WalkerPart> parts = walker_parts(bvh, options);
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_EQ(parts[0].name, "walker/Hips");
  EXPECT_EQ(std::get<CapsuleShape>(parts[0].shape[0]).b, Vec3(0, -1, 0));
  EXPECT_EQ(parts[1].name, "walker/LeftFoot");
  EXPECT_EQ(std::get<SphereShape>(parts[1].shape[0]).radius_m, 0.12);
  EXPECT_EQ(walker_poses(bvh, parts, options, 1)[1].position, Vec3(0.5, 0, 1.5));
  options.up = 'z';
  const Pose turned = walker_poses(bvh, parts, options, 1)[0];
  EXPECT_EQ(turned.position, Vec3(0.5, -1.5, 1));
  // What the file calls up, the capsule's way from -y, points along z in the world.
  EXPECT_NEAR((turned.rotation * Vec3(0, 1, 0) - Vec3(0, 0, 1)).norm(), 0, 1e-15);
}

struct Jump {
  std::size_t first_frame = 0;
  std::size_t last_frame = 0;
  double peak_m = 0;  // of the lowest foot joint
};

/// Runs of frames in which the spheres at all four foot joints are off the floor y = 0. Frame 0 is an artificial pose.
std::vector<Jump> jumps_of(const MotionCapture& bvh, const WalkerOptions& options) {
  const std::vector<WalkerPart> parts = walker_parts(bvh, options);
  std::vector<Jump> jumps;
  bool airborne = false;
  for (std::size_t frame = 1; frame < bvh.frame_count; ++frame) {
    const std::vector<Pose> poses = walker_poses(bvh, parts, options, frame);
    double lowest_m = std::numeric_limits<double>::infinity();
    for (std::size_t at = 0; at < parts.size(); ++at) {
      const bool foot =
          std::holds_alternative<SphereShape>(parts[at].shape[0]) && parts[at].name.find("Foot") != std::string::npos;
      const bool toe = parts[at].name.find("ToeBase") != std::string::npos;
      if (foot || toe) lowest_m = std::min(lowest_m, poses[at].position.y());
    }
    const bool off = lowest_m > options.foot_radius_m;
    if (off && !airborne) jumps.push_back({frame, frame, lowest_m});
    if (off) jumps.back() = {jumps.back().first_frame, frame, std::max(jumps.back().peak_m, lowest_m)};
    airborne = off;
  }
  return jumps;
}

TEST(Walker, TheRecordedPersonJumpsTenTimes) {
  if (!std::filesystem::exists(kJumps)) GTEST_SKIP() << kJumps << " comes with the package assimp-testmodels";
  const MotionCapture bvh = read_bvh(kJumps);
  EXPECT_EQ(bvh.frame_count, 2752U);
  WalkerOptions options{.name = "walker", .unit_m = 0.056444};
  for (const double radius_m : {0.11, 0.12, 0.13, 0.14, 0.15, 0.16}) {
    options.foot_radius_m = radius_m;
    EXPECT_EQ(jumps_of(bvh, options).size(), 10U) << radius_m;
  }
}

std::filesystem::path data_folder() {
  const char* folder = std::getenv("COLLIDED_DATA");
  if (folder != nullptr) return folder;
  return std::filesystem::path(__FILE__).parent_path().parent_path().parent_path().parent_path() / "shared" / "data";
}

// Frames and heights of each jump as another program's importer gives them.
TEST(Walker, EveryJumpIsWhereAnotherReaderSeesIt) {
  std::ifstream expected(data_folder() / "debian_house" / "expected_jumps_01_01.csv");
  if (!expected || !std::filesystem::exists(kJumps)) GTEST_SKIP() << "needs the recorded data";
  const std::vector<Jump> jumps = jumps_of(read_bvh(kJumps), {.name = "walker", .unit_m = 0.056444});
  std::string line;
  std::getline(expected, line);
  std::size_t row = 0;
  while (std::getline(expected, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream cells(line);
    std::size_t number = 0;
    Jump jump;
    cells >> number >> jump.first_frame >> jump.last_frame >> jump.peak_m;
    ASSERT_LT(row, jumps.size());
    EXPECT_EQ(jumps[row].first_frame, jump.first_frame) << row;
    EXPECT_EQ(jumps[row].last_frame, jump.last_frame) << row;
    EXPECT_NEAR(jumps[row].peak_m, jump.peak_m, 5e-5) << row;  // four decimals in the file
    ++row;
  }
  EXPECT_EQ(row, 10U);
}

}  // namespace
}  // namespace collided::cli
