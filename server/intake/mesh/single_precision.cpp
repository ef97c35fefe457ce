#include "server/intake/mesh/single_precision.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "server/geometry/aabb.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine {
namespace {

/// Fewer coordinates than this may all be on the grid of floats by chance.
constexpr std::uint64_t kLeastCoordinates = 12;

/// Distance from |value| to the next larger single-precision number.
double float_step(double value) {
  return std::ldexp(1.0, std::ilogb(value) - (std::numeric_limits<float>::digits - 1));
}

/// The least power of two from which on floats are farther apart than kCoarseGrid_m: testing whether a coordinate is
/// far then takes one comparison, instead of two calls of the C library for its own step.
double least_far(double unit_m) {
  double value = std::numeric_limits<double>::min();
  while (value < std::numeric_limits<float>::max() && !(float_step(value) * unit_m > kCoarseGrid_m)) value *= 2;
  return value;
}

struct Evidence {
  explicit Evidence(double unit_m) : least_far_(least_far(unit_m)) {}

  std::uint64_t far_count = 0;
  std::uint64_t float_count = 0;
  std::uint64_t telling_count = 0;  // coordinates on the grid of floats that are not whole numbers
  double largest = 0;

  void weigh(double value) {
    if (!(std::abs(value) >= least_far_ && std::abs(value) < std::numeric_limits<float>::max())) return;
    ++far_count;
    largest = std::max(largest, std::abs(value));
    if (static_cast<double>(static_cast<float>(value)) == value) {
      ++float_count;
      telling_count += std::trunc(value) != value || float_step(value) > 1 ? 1 : 0;
    }
  }

 private:
  double least_far_;
};

}  // namespace

std::string single_precision_warning(const TriangleMesh& mesh, double unit_m) {
  Evidence evidence(unit_m);
  Aabb box;
  for (const Vec3& vertex : mesh.vertices) {
    box.extend(vertex);
    for (int axis = 0; axis < 3; ++axis) { evidence.weigh(vertex[axis]); }
  }
  if (evidence.far_count < kLeastCoordinates || evidence.telling_count == 0 ||
      evidence.float_count * 100 < evidence.far_count * 99) {
    return {};
  }
  const Vec3 origin = ((box.low / 2 + box.high / 2) / 1000).array().round() * 1000;
  return fmt::format(
      "{} of {} far coordinates are single-precision numbers: this file was written in single precision at {:.2g} m; "
      "distances below {:.2g} m mean nothing there; write it in double or with the origin at {:.0f},{:.0f},{:.0f}",
      evidence.float_count, evidence.far_count, evidence.largest * unit_m, float_step(evidence.largest) * unit_m,
      origin[0], origin[1], origin[2]);
}

}  // namespace collided::engine
