#include <fmt/format.h>

#include <cmath>

#include "server/intake/limits.hpp"
#include "server/intake/readers/reading.hpp"
#include "server/intake/readers/text_cursor.hpp"

namespace collided::engine {
namespace {

/// Depth of the tree: it divides a cube of 2^16 cells along each side, centred at the origin, sixteen times.
constexpr int kDepth = 16;

/// Reads the occupied cells of an OctoMap as boxes.
/// source    Hornung et al., "OctoMap: an efficient probabilistic 3D mapping framework", 2013; the .bt stream as
///           OctoMap 1.9 writes it: for each inner node two bytes, two bits per child, and after them its inner
///           children
class OctomapReader {
 public:
  explicit OctomapReader(const Reading& reading) : reading_(reading) {}

  Scene read() {
    read_header();
    walk();
    if (map_.shape.primitives.empty()) refuse(reading_, "no occupied cells");
    if (at_ != reading_.bytes.size()) {
      reading_.report.warnings.push_back(
          fmt::format("{} bytes after the tree are not used", reading_.bytes.size() - at_));
    }
    Scene scene;
    scene.objects.push_back(std::move(map_));
    return scene;
  }

 private:
  struct OctreeNode {
    int depth = 0;
    std::int64_t x = 0, y = 0, z = 0;  // its low corner, in cells from the origin
  };

  void read_header() {
    const std::string_view text(reading_.begin(), reading_.bytes.size());
    if (!text.starts_with("# Octomap OcTree binary file")) {
      refuse(reading_, "it does not begin with '# Octomap OcTree binary file'");
    }
    TextCursor cursor(reading_, text, TextCursor::LineEnd::newline_or_comment, false);
    for (;;) {
      if (!cursor.find_word()) refuse(reading_, "the header ends without its data line");
      const std::string_view key = cursor.word();
      if (key == "data") break;
      if (key == "id") {
        if (const std::string_view id = cursor.word(); id != "OcTree")
          cursor.complain(fmt::format("a tree of kind {}; only OcTree is read", in_quotes(id)));
      } else if (key == "res") {
        cell_m_ = cursor.finite_number("resolution");
      } else if (key == "size") {
        reported_nodes_ = cursor.integer("number of nodes");
      } else {
        cursor.complain(fmt::format("{} is no word of the header", in_quotes(key)));
      }
      cursor.next_line();
    }
    cursor.next_line();
    if (!(cell_m_ > 0 && std::isfinite(std::ldexp(cell_m_, kDepth)))) {
      refuse(reading_, fmt::format("resolution {} m, allowed are lengths above 0", cell_m_));
    }
    at_ = static_cast<std::size_t>(cursor.place() - reading_.begin());
  }

  void walk() {
    if (reported_nodes_ == 0) return;
    constexpr std::int64_t kHalf = std::int64_t{1} << (kDepth - 1);
    std::vector<OctreeNode> waiting{{0, -kHalf, -kHalf, -kHalf}};
    while (!waiting.empty()) {
      const OctreeNode node = waiting.back();
      waiting.pop_back();
      if (reading_.bytes.size() - at_ < 2) refuse_byte(reading_, at_, "the tree breaks off");
      const unsigned bits = static_cast<std::uint8_t>(reading_.bytes[at_]) |
                            static_cast<unsigned>(static_cast<std::uint8_t>(reading_.bytes[at_ + 1])) << 8;
      at_ += 2;
      // Children are pushed onto the stack in reverse, so that the first one's branch is read first.
      for (unsigned child = 8; child-- > 0;) {
        const unsigned state = bits >> (2 * child) & 3;  // 0 unknown, 1 free, 2 occupied, 3 an inner node
        if (state >= 2) take_child(node, child, state == 3, waiting);
      }
    }
  }

  void take_child(const OctreeNode& node, unsigned child, bool is_inner, std::vector<OctreeNode>& waiting) {
    const std::int64_t cells = std::int64_t{1} << (kDepth - node.depth - 1);  // its side
    const OctreeNode place{node.depth + 1, node.x + (child & 1 ? cells : 0), node.y + (child & 2 ? cells : 0),
                           node.z + (child & 4 ? cells : 0)};
    if (is_inner) {
      if (place.depth == kDepth) refuse_byte(reading_, at_ - 2, fmt::format("a tree of more than {} levels", kDepth));
      waiting.push_back(place);
      return;
    }
    if (map_.shape.primitives.size() == kMaxCloudPoints) {
      refuse(reading_, fmt::format("more than {} occupied cells, the most that a map may have", kMaxCloudPoints));
    }
    const double half = 0.5 * static_cast<double>(cells);
    const Vec3 middle(static_cast<double>(place.x) + half, static_cast<double>(place.y) + half,
                      static_cast<double>(place.z) + half);
    map_.shape.primitives.push_back(Box{.center = middle * cell_m_, .half_m = Vec3::Constant(half * cell_m_)});
  }

  const Reading& reading_;
  double cell_m_ = 0;
  std::int64_t reported_nodes_ = -1;
  std::size_t at_ = 0;
  SceneObject map_;
};

}  // namespace

Scene read_octomap(const Reading& reading) { return OctomapReader(reading).read(); }

}  // namespace collided::engine
