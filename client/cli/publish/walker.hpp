#pragma once

#include <memory>
#include <string>
#include <vector>

#include "client/cli/publish/motion_capture.hpp"
#include "client/cli/publish/source.hpp"

namespace collided::cli {

struct WalkerOptions {
  std::string name;  // objects are called name/joint
  double unit_m = 1;
  double foot_radius_m = 0.12;
  double bone_radius_m = 0.05;
  char up = 'y';            // 'z': (x, y, z) of the file becomes (x, -z, y)
  std::uint32_t group = 0;  // 0: one made from the name
  ObjectTexts objects = {};
};

/// One object of a recorded person: the bones from a joint to its children as capsules, or a foot's sphere.
struct WalkerPart {
  std::string name;
  std::size_t joint = 0;
  Shape shape;
};

/// A capsule for every bone that has a length; LeftFoot, LeftToeBase, RightFoot and RightToeBase are spheres. A joint without
/// such a bone is a sphere of the bones' radius.
std::vector<WalkerPart> walker_parts(const MotionCapture& bvh, const WalkerOptions& options);

/// Where the parts are in a frame, in metres and with the chosen axis up.
std::vector<Pose> walker_poses(const MotionCapture& bvh, const std::vector<WalkerPart>& parts,
                               const WalkerOptions& options, std::size_t frame);

/// A recording as a publisher, without its frame 0: recordings begin with an artificial pose. All parts share a group.
std::unique_ptr<Source> make_walker(MotionCapture bvh, const WalkerOptions& options);

}  // namespace collided::cli
