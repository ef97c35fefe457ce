// What other programs of ROS send as clouds and maps, and what becomes of it: PointCloud2 and Octomap, into cells.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <span>

#include "client/ros/octomap_message.hpp"
#include "client/ros/point_cloud.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace {

using namespace collided;
using namespace collided::ros;

/// Numbers and texts from the front of an input, and what is left of it; zeros where it is over.
class Input {
 public:
  explicit Input(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
  template <class Number>
  Number number() {
    Number value{};
    const std::size_t count = std::min(sizeof value, bytes_.size());
    if (count > 0) std::memcpy(&value, bytes_.data(), count);
    bytes_ = bytes_.subspan(count);
    return value;
  }
  std::string text() {
    const std::size_t wanted = number<std::uint8_t>();
    const std::size_t length = std::min(wanted, bytes_.size());
    std::string made(reinterpret_cast<const char*>(bytes_.data()), length);
    bytes_ = bytes_.subspan(length);
    return made;
  }
  std::span<const std::uint8_t> rest() const { return bytes_; }

 private:
  std::span<const std::uint8_t> bytes_;
};

VoxelGrid grid() {
  const VoxelOptions options{.cell_m = 0.5, .unknown = UnknownCells::undecided, .reach_m = 100, .most_blocks = 64};
  return std::move(*VoxelGrid::make(options));
}

void take_cloud(Input input) {
  CloudMessage cloud;
  cloud.height = input.number<std::uint32_t>();
  cloud.width = input.number<std::uint32_t>();
  cloud.point_step = input.number<std::uint32_t>();
  cloud.row_step = input.number<std::uint32_t>();
  cloud.is_bigendian = input.number<std::uint8_t>() % 2 == 1;
  const std::size_t fields = input.number<std::uint8_t>() % 8;
  for (std::size_t i = 0; i < fields; ++i) {
    CloudField field{.name = input.text()};
    field.offset = input.number<std::uint32_t>();
    field.datatype = input.number<std::uint8_t>();
    field.count = input.number<std::uint32_t>();
    cloud.fields.push_back(std::move(field));
  }
  cloud.data = input.rest();
  const auto points = points_of(cloud);
  const auto* taken = std::get_if<std::vector<double>>(&points);
  fuzz::require(taken != nullptr || !std::get<std::string>(points).empty(), "points or what is wrong");
  if (taken == nullptr) return;
  fuzz::require(taken->size() == 3 * std::size_t{cloud.height} * cloud.width, "each point once");
  fuzz::require(taken->size() <= 3 * cloud.data.size(), "no more points than bytes");
  VoxelGrid cells = grid();
  const VoxelScan scan = cells.insert(std::span<const double>(*taken), Vec3(0.1, 0.2, 0.3), std::chrono::seconds(1));
  fuzz::require(3 * (scan.points + scan.refused + scan.far + scan.dropped) == taken->size(), "each point counts once");
  fuzz::require(scan.occupied <= scan.points && cells.block_count() <= 64, "limits are kept");
  fuzz::require(cells.occupied_count() == scan.occupied, "a cell with points is occupied");
}

void take_map(Input input) {
  OctomapMessage map;
  map.is_binary = input.number<std::uint8_t>() % 2 == 1;
  map.resolution_m = input.number<double>();
  map.kind = input.text();
  map.data = input.rest();
  const auto blocks = blocks_of(map);
  const auto* taken = std::get_if<std::vector<VoxelBlock>>(&blocks);
  fuzz::require(taken != nullptr || !std::get<std::string>(blocks).empty(), "blocks or what is wrong");
  if (taken == nullptr) return;
  fuzz::require(taken->size() <= 4 * map.data.size(), "no more leaves than two bits each");
  for (const VoxelBlock& block : *taken) {
    fuzz::require(block.side >= 1 && block.side <= 65'536, "sides are those of a tree of 16 levels");
    for (const std::int32_t low : block.low)
      fuzz::require(low >= -32'768 && low + block.side <= 32'768, "a leaf is within the tree");
  }
  VoxelGrid cells = grid();
  const VoxelScan scan = cells.assign(*taken, std::chrono::seconds(1));
  fuzz::require(scan.points == taken->size() && scan.refused == 0, "the grid takes each leaf");
  fuzz::require(cells.block_count() <= 64, "limits are kept");
  // Leaves do not overlap, so that each cell is set once.
  fuzz::require(cells.occupied_count() == scan.occupied, "an occupied leaf's cells are occupied");
}

template <class Number>
void put(std::string& to, Number value) {
  to.append(reinterpret_cast<const char*>(&value), sizeof value);
}
void put_text(std::string& to, const std::string& text) { to += static_cast<char>(text.size()) + text; }

std::string cloud_seed(std::uint8_t datatype, std::uint32_t number_bytes, std::uint8_t is_bigendian) {
  std::string made(1, '\0');
  for (const std::uint32_t size : {2U, 3U, 4 * number_bytes, 12 * number_bytes + 4}) put(made, size);
  put(made, is_bigendian);
  put(made, std::uint8_t{4});
  for (std::uint32_t i = 0; i < 4; ++i) {
    put_text(made, std::array{"x", "y", "z", "intensity"}[i]);
    put(made, i * number_bytes);
    put(made, datatype);
    put(made, std::uint32_t{1});
  }
  for (std::uint32_t i = 0; i < 2 * (12 * number_bytes + 4); ++i) made += static_cast<char>(0x3d + i % 5);
  return made;
}

std::string map_seed(bool is_binary, const std::string& data) {
  std::string made(1, '\1');
  put(made, static_cast<std::uint8_t>(is_binary));
  put(made, 0.05);
  put_text(made, "OcTree");
  return made + data;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input({data, size});
  if (input.number<std::uint8_t>() % 2 == 0) take_cloud(input);
  else take_map(input);
  return 0;
}

std::vector<std::string> fuzz_seeds() {
  using namespace std::string_literals;
  // Full: a node of odds 0.5 with two children, of which one has a child.
  const std::string node = "\0\0\0\x3f"s, free_node = "\0\0\0\xbf"s;
  return {cloud_seed(7, 4, 0),
          cloud_seed(8, 8, 1),
          cloud_seed(3, 2, 0),
          cloud_seed(1, 1, 1),
          map_seed(true, "\x02\xc0\x08\x00"s),
          map_seed(true, "\xff\xff\x0a\x00\x02\x02\x10\x20\x03\x00\x02\x00"s),
          map_seed(false, node + "\x03"s + node + "\x10"s + node + "\x00"s + free_node + "\x00"s)};
}
