#include "client/ros/octomap_message.hpp"

#include <cmath>
#include <cstring>

namespace collided::ros {
namespace {

/// Depth of the tree: it divides a cube of 2^16 cells along each side, centred at the origin, sixteen times.
constexpr int kDepth = 16;
constexpr std::int32_t kHalf = 1 << (kDepth - 1);
/// Blocks at most, 24 bytes each. A byte may stand for four of them.
constexpr std::size_t kMostBlocks = 20'000'000;

struct MapNode {
  int depth = 0;
  VoxelNumber low{};
  std::int32_t side() const { return 1 << (kDepth - depth); }
  MapNode child(unsigned number) const {
    const std::int32_t half = side() / 2;
    return {depth + 1,
            {low[0] + ((number & 1) != 0 ? half : 0), low[1] + ((number & 2) != 0 ? half : 0),
             low[2] + ((number & 4) != 0 ? half : 0)}};
  }
};

/// Walks the stream of a tree; nodes wait in the order in which they were written.
class OctreeStream {
 public:
  explicit OctreeStream(std::span<const std::uint8_t> data) : data_(data) {}

  std::variant<std::vector<VoxelBlock>, std::string> binary() {
    return walk([this](const MapNode& node) { return take_binary(node); });
  }
  std::variant<std::vector<VoxelBlock>, std::string> full() {
    return walk([this](const MapNode& node) { return take_full(node); });
  }

 private:
  template <class Take>
  std::variant<std::vector<VoxelBlock>, std::string> walk(const Take& take) {
    if (data_.empty()) return std::move(blocks_);
    waiting_.push_back({0, {-kHalf, -kHalf, -kHalf}});
    while (!waiting_.empty()) {
      const MapNode node = waiting_.back();
      waiting_.pop_back();
      if (std::string flaw = take(node); !flaw.empty()) return flaw;
      if (blocks_.size() > kMostBlocks) return "more than " + std::to_string(kMostBlocks) + " leaves";
    }
    if (at_ != data_.size()) return std::to_string(data_.size() - at_) + " bytes after the tree";
    return std::move(blocks_);
  }

  std::string take_binary(const MapNode& node) {
    if (data_.size() - at_ < 2) return "the tree breaks off at byte " + std::to_string(at_);
    const unsigned bits = data_[at_] | static_cast<unsigned>(data_[at_ + 1]) << 8;
    at_ += 2;
    for (unsigned child = 8; child-- > 0;) {
      const unsigned state = bits >> (2 * child) & 3;  // 0 unknown, 1 free, 2 occupied, 3 an inner node
      if (state == 0) continue;
      const MapNode place = node.child(child);
      if (state != 3) {
        blocks_.push_back({place.low, place.side(), state == 1 ? VoxelState::free : VoxelState::occupied});
      } else if (place.depth == kDepth) {
        return "a tree of more than " + std::to_string(kDepth) + " levels";
      } else {
        waiting_.push_back(place);
      }
    }
    return {};
  }

  std::string take_full(const MapNode& node) {
    if (data_.size() - at_ < 5) return "the tree breaks off at byte " + std::to_string(at_);
    float odds = 0;
    std::memcpy(&odds, data_.data() + at_, sizeof odds);
    const unsigned children = data_[at_ + 4];
    at_ += 5;
    if (children == 0) {
      blocks_.push_back({node.low, node.side(), odds >= 0 ? VoxelState::occupied : VoxelState::free});
      return std::isfinite(odds) ? "" : "log odds that are not finite";
    }
    if (node.depth == kDepth) return "a tree of more than " + std::to_string(kDepth) + " levels";
    for (unsigned child = 8; child-- > 0;) {
      if ((children >> child & 1) != 0) waiting_.push_back(node.child(child));
    }
    return {};
  }

  std::span<const std::uint8_t> data_;
  std::size_t at_ = 0;
  std::vector<MapNode> waiting_;
  std::vector<VoxelBlock> blocks_;
};

}  // namespace

std::variant<std::vector<VoxelBlock>, std::string> blocks_of(const OctomapMessage& map) {
  if (map.kind != "OcTree") return "a tree of kind '" + map.kind.substr(0, 40) + "', known is OcTree";
  if (!(map.resolution_m >= 1e-6 && map.resolution_m <= 1e6))
    return "a resolution of " + std::to_string(map.resolution_m) + " m, allowed are 1e-6 to 1e6";
  OctreeStream stream(map.data);
  return map.is_binary ? stream.binary() : stream.full();
}

}  // namespace collided::ros
