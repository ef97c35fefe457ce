#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <collided/voxels.hpp>

namespace collided::ros {

/// octomap_msgs/Octomap, untrusted.
struct OctomapMessage {
  std::string frame;
  std::int64_t stamp_ns = 0;
  bool is_binary = false;
  std::string kind;  // of the tree: OcTree
  double resolution_m = 0;
  std::span<const std::uint8_t> data;
};

/// The leaves that the map knows, in cells of its resolution, or the message's fault.
///
/// source  Hornung et al., "OctoMap: an efficient probabilistic 3D mapping framework", 2013; the streams as OctoMap 1.9
///         writes them. Binary: two bytes for each inner node, two bits a child, and after them its inner children.
///         Full: for each node its log odds as a float and a byte with its existing children, depth first
std::variant<std::vector<VoxelBlock>, std::string> blocks_of(const OctomapMessage& map);

}  // namespace collided::ros
