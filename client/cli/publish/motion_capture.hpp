#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <collided/client.hpp>

namespace collided::cli {

/// The meaning of a channel's value.
enum class BvhChannel : std::uint8_t { x_position, y_position, z_position, x_rotation, y_rotation, z_rotation };

/// A joint of the recorded skeleton, or the end of a bone.
struct CapturedJoint {
  std::string name;  // empty for an end site
  int parent = -1;   // index of the parent, which is smaller; -1: none
  Vec3 offset = Vec3::Zero();
  std::vector<BvhChannel> channels;
  std::size_t first_channel = 0;  // index of its first value in a frame
  bool is_end() const { return name.empty(); }
};

/// A motion-capture recording: a tree of joints and, for every frame, a value for each channel. Lengths in the file's
/// unit, angles in degrees.
/// source  Meredith and Maddock, "Motion Capture File Formats Explained", 2001
struct MotionCapture {
  std::vector<CapturedJoint> joints;
  std::size_t channel_count = 0;
  double frame_seconds = 0;
  std::size_t frame_count = 0;
  std::vector<double> values;  // frame_count * channel_count, frame by frame
};

/// Reads a .bvh file of at most 1 GiB, 4,096 joints and 64 levels. Throws Failure with file, line, what and value.
MotionCapture read_bvh(const std::string& path);

/// The same from text; `name` is the file's name in errors.
MotionCapture parse_bvh(std::string_view text, const std::string& name);

/// The pose of every joint in a frame, in the file's coordinates and unit. A joint's offset and its position channels
/// are added; rotations apply in the order of the channels, the first one outermost.
std::vector<Pose> joint_poses(const MotionCapture& bvh, std::size_t frame);

}  // namespace collided::cli
