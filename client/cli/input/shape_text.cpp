#include "client/cli/input/shape_text.hpp"

#include <cmath>

#include <numbers>

#include <fmt/format.h>

#include "client/cli/failure.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/input/question.hpp"
#include "client/cli/output/suggest.hpp"
#include "client/cli/output/readable.hpp"

namespace collided::cli {
namespace {

void need_count(std::string_view kind, const std::vector<double>& numbers, std::size_t count,
                std::string_view meaning) {
  if (numbers.size() != count)
    throw bad_use(fmt::format("a {} takes {}: {}; {} given", kind, count, meaning, numbers.size()));
}

}  // namespace

ShapePart make_shape(std::string_view kind, const std::vector<double>& numbers) {
  if (kind == "plane") {
    if (numbers.empty()) return HalfSpaceShape{};
    need_count(kind, numbers, 3, "a normal, out of what is solid");
    return HalfSpaceShape{.normal = Vec3(numbers[0], numbers[1], numbers[2])};
  }
  for (const double number : numbers) {
    const bool fits = number >= 0 && std::isfinite(number);
    if (!fits) throw bad_use(fmt::format("{} {}: must be finite and not below 0", kind, format_number(number)));
  }
  if (kind == "sphere") {
    need_count(kind, numbers, 1, "radius");
    return SphereShape{.radius_m = numbers[0]};
  }
  if (kind == "box") {
    need_count(kind, numbers, 3, "full lengths along x, y, z");
    return BoxShape{.half_m = Vec3(numbers[0], numbers[1], numbers[2]) / 2};
  }
  if (kind == "capsule") {
    need_count(kind, numbers, 2, "radius and length between the centres");
    return CapsuleShape{.a = {0, 0, -numbers[1] / 2}, .b = {0, 0, numbers[1] / 2}, .radius_m = numbers[0]};
  }
  if (kind == "cylinder") {
    need_count(kind, numbers, 2, "radius and length");
    return CylinderShape{.a = {0, 0, -numbers[1] / 2}, .b = {0, 0, numbers[1] / 2}, .radius_m = numbers[0]};
  }
  if (kind == "cone") {
    need_count(kind, numbers, 2, "radius of the base and height");
    return ConeShape{.apex = {0, 0, numbers[1] / 2}, .base = {0, 0, -numbers[1] / 2}, .radius_m = numbers[0]};
  }
  if (kind == "ellipsoid") {
    need_count(kind, numbers, 3, "full lengths along x, y, z");
    return EllipsoidShape{.half_m = Vec3(numbers[0], numbers[1], numbers[2]) / 2};
  }
  throw bad_use(fmt::format("no shape '{}'{}", kind,
                            did_you_mean(kind, {"sphere", "box", "capsule", "cylinder", "cone", "ellipsoid", "plane",
                                                "points", "polyline", "heights"})),
                kShapeForms);
}

ShapePart parse_shape(std::string_view text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos)
    throw bad_use(fmt::format("shape '{}' has no ':'", text), "write sphere:0.1, box:0.4,0.4,0.4 or capsule:0.05,0.3");
  return make_shape(text.substr(0, colon), parse_numbers({std::string(text.substr(colon + 1))}, Measure::length));
}

std::string angle_warning(std::string_view option, const std::string& angles) {
  if (angles.empty() || angles.find_first_of("dr°") != std::string::npos) return {};
  const Vec3 radians = parse_vector(angles, Measure::angle);
  const double largest = radians.cwiseAbs().maxCoeff();
  constexpr double kTurn = 2 * std::numbers::pi;
  if (!(largest > kTurn)) return {};
  return fmt::format("{}: {} radians is {} turns; degrees are written {}deg", option, format_number(largest),
                     readable_number(largest / kTurn, 0.1), format_number(largest));
}

Pose parse_pose(const std::string& at, const std::string& rpy, const std::string& quat) {
  if (!rpy.empty() && !quat.empty()) throw bad_use("--rpy and --quat exclude each other");
  Pose pose;
  if (!at.empty()) pose.position = parse_vector(at, Measure::length);
  if (!rpy.empty()) pose.rotation = from_roll_pitch_yaw(parse_vector(rpy, Measure::angle));
  if (!quat.empty()) {
    const std::vector<double> q = parse_numbers({quat});
    if (q.size() != 4) throw bad_use("--quat takes 4 numbers, w first");
    pose.rotation = unit_quaternion(q[0], q[1], q[2], q[3]);
  }
  return pose;
}

}  // namespace collided::cli
