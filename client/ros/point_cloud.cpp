#include "client/ros/point_cloud.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace collided::ros {
namespace {

/// Bytes of a number of each datatype; 0: there is none.
constexpr std::array<std::uint32_t, 9> kNumberBytes{0, 1, 1, 2, 2, 4, 4, 4, 8};

template <class Number>
double number_at(const std::uint8_t* bytes, bool is_swapped) {
  std::array<std::uint8_t, sizeof(Number)> own;
  std::copy_n(bytes, sizeof(Number), own.begin());
  if (is_swapped) std::reverse(own.begin(), own.end());
  return static_cast<double>(std::bit_cast<Number>(own));
}

using Read = double (*)(const std::uint8_t*, bool);
constexpr std::array<Read, 9> kReads{nullptr,
                                     number_at<std::int8_t>,
                                     number_at<std::uint8_t>,
                                     number_at<std::int16_t>,
                                     number_at<std::uint16_t>,
                                     number_at<std::int32_t>,
                                     number_at<std::uint32_t>,
                                     number_at<float>,
                                     number_at<double>};

std::string flaw_of_axis(const CloudMessage& cloud, const CloudField& field) {
  const std::string where = "field " + field.name;
  if (field.datatype >= kNumberBytes.size() || field.datatype == 0)
    return where + " has datatype " + std::to_string(field.datatype) + ", known are 1 to 8";
  if (field.count > 1) return where + " has " + std::to_string(field.count) + " numbers, wanted is one";
  if (std::uint64_t{field.offset} + kNumberBytes[field.datatype] > cloud.point_step)
    return where + " ends at byte " + std::to_string(std::uint64_t{field.offset} + kNumberBytes[field.datatype]) +
           " of a point of " + std::to_string(cloud.point_step);
  return {};
}

std::string flaw_of_sizes(const CloudMessage& cloud) {
  const std::uint64_t row_bytes = std::uint64_t{cloud.width} * cloud.point_step;
  if (cloud.height > 1 && cloud.row_step < row_bytes)
    return "rows of " + std::to_string(cloud.row_step) + " bytes for " + std::to_string(cloud.width) + " points of " +
           std::to_string(cloud.point_step);
  if (cloud.height == 0 || cloud.width == 0) return {};
  const std::uint64_t needed = std::uint64_t{cloud.height - 1} * cloud.row_step + row_bytes;
  if (needed > cloud.data.size())
    return std::to_string(cloud.data.size()) + " bytes of data, " + std::to_string(needed) + " are needed";
  return {};
}

}  // namespace

std::variant<std::vector<double>, std::string> points_of(const CloudMessage& cloud) {
  std::array<const CloudField*, 3> axes{};
  constexpr std::array<const char*, 3> kNames{"x", "y", "z"};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto found = std::find_if(cloud.fields.begin(), cloud.fields.end(),
                                    [&](const CloudField& field) { return field.name == kNames[axis]; });
    if (found == cloud.fields.end()) return std::string("no field ") + kNames[axis];
    if (std::string flaw = flaw_of_axis(cloud, *found); !flaw.empty()) return flaw;
    axes[axis] = &*found;
  }
  if (std::string flaw = flaw_of_sizes(cloud); !flaw.empty()) return flaw;
  const bool is_swapped = cloud.is_bigendian != (std::endian::native == std::endian::big);
  std::vector<double> points;
  if (cloud.height == 0 || cloud.width == 0) return points;
  // Bytes bound the request: a point without bytes was refused with its fields.
  points.reserve(3 * std::size_t{cloud.height} * cloud.width);
  for (std::size_t row = 0; row < cloud.height; ++row) {
    const std::uint8_t* point = cloud.data.data() + row * cloud.row_step;
    for (std::size_t column = 0; column < cloud.width; ++column, point += cloud.point_step) {
      for (const CloudField* axis : axes) points.push_back(kReads[axis->datatype](point + axis->offset, is_swapped));
    }
  }
  return points;
}

}  // namespace collided::ros
