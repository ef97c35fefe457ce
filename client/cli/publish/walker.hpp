#pragma once

#include <memory>
#include <string>
#include <vector>

#include "client/cli/publish/motion_capture.hpp"
#include "client/cli/publish/source.hpp"

namespace collided::cli {

/// How to turn a recorded person into objects.
struct WalkerOptions {
  std::string name;   // the objects' names are name/joint
  double unit_m = 1;  // length of the file's unit
  double foot_radius_m = 0.12;
  double bone_radius_m = 0.05;
  char up = 'y';            // 'z': (x, y, z) of the file becomes (x, -z, y)
  std::uint32_t group = 0;  // 0: a number made from the name
  ObjectTexts objects = {};
};

/// One object of a recorded person: the bones from a joint to its children as capsules, or the sphere of a foot.
struct WalkerPart {
  std::string name;
  std::size_t joint = 0;
  Shape shape;
};

/// The objects of a person: a capsule for every bone that has a length, and spheres for LeftFoot, LeftToeBase,
/// RightFoot and RightToeBase. A joint without such a bone is a sphere of the bones' radius.
std::vector<WalkerPart> walker_parts(const MotionCapture& bvh, const WalkerOptions& options);

/// The poses of the parts in a frame, in metres and with z up.
std::vector<Pose> walker_poses(const MotionCapture& bvh, const std::vector<WalkerPart>& parts,
                               const WalkerOptions& options, std::size_t frame);

/// A source that plays a recording from frame 1 on, since frame 0 is an artificial pose. All parts share a group.
std::unique_ptr<MotionSource> make_walker(MotionCapture bvh, const WalkerOptions& options);

}  // namespace collided::cli
