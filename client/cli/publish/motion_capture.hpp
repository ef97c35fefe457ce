#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <collided/client.hpp>

namespace collided::cli {

enum class BvhChannel : std::uint8_t { x_position, y_position, z_position, x_rotation, y_rotation, z_rotation };

struct CapturedJoint {
  std::string name;  // empty for an end site
  int parent = -1;   // comes before its children
  Vec3 offset = Vec3::Zero();
  std::vector<BvhChannel> channels;
  std::size_t first_channel = 0;
  bool is_end() const { return name.empty(); }
};

/// A motion-capture recording: a tree of joints and, for every frame, a value for each channel. Lengths in the file's unit,
/// angles in degrees.
/// source  Meredith and Maddock, "Motion Capture File Formats Explained", 2001
struct MotionCapture {
  std::vector<CapturedJoint> joints;
  std::size_t channel_count = 0;
  double frame_seconds = 0;
  std::size_t frame_count = 0;
  std::vector<double> values;  // frame_count * channel_count
};

/// Reads a .bvh file; at most 1 GiB, 4,096 joints, 64 levels. Throws Failure: file, line, what, value.
MotionCapture read_bvh(const std::string& path);

/// The same from text; `name` stands for the file in refusals.
MotionCapture parse_bvh(std::string_view text, const std::string& name);

/// Pose of every joint in the file's frame and unit: offset and position channels add up, rotations apply in the order of the
/// channels, the first outermost.
std::vector<Pose> joint_poses(const MotionCapture& bvh, std::size_t frame);

}  // namespace collided::cli
