#include "collided/robot.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "client/library/connection/errors.hpp"

namespace collided {
namespace {

using client::bad_input;
using client::words;

bool is_angle(JointKind kind) { return kind == JointKind::revolute || kind == JointKind::continuous; }

const char* unit_of(JointKind kind) { return is_angle(kind) ? " rad" : " m"; }

/// The pose of the joint's child frame, relative to that frame at position 0.
Pose motion_of(const RobotJoint& joint, double position) {
  if (is_angle(joint.kind)) return {Vec3::Zero(), Quat(Eigen::AngleAxisd(position, joint.axis))};
  if (joint.kind == JointKind::prismatic) return {position * joint.axis, Quat::Identity()};
  return {};
}

Pose product(const Pose& parent, const Pose& child) {
  return {parent.position + parent.rotation * child.position, (parent.rotation * child.rotation).normalized()};
}

std::string list_of(const std::vector<RobotJoint>& joints) {
  constexpr std::size_t kMost = 12;
  std::string text;
  std::size_t count = 0;
  for (const RobotJoint& joint : joints) {
    if (joint.kind == JointKind::fixed || joint.mimic) continue;
    if (++count <= kMost) text += (count == 1 ? "" : ", ") + joint.name;
  }
  if (count > kMost) text += " and " + std::to_string(count - kMost) + " more";
  return count == 0 ? "no joint of the robot moves" : "joints that can be set: " + text;
}

/// A warning for an angle of more than a turn, which may be in degrees; empty for others.
std::string degrees_doubt(const RobotJoint& joint, double position) {
  if (!is_angle(joint.kind) || !(std::abs(position) > 2 * std::numbers::pi)) return {};
  const double meant_rad = std::round(1e3 * position * std::numbers::pi / 180) / 1e3;  // three digits suffice
  return words(std::round(position * 180 / std::numbers::pi)) + " degrees; if degrees were meant, " + words(meant_rad) +
         " rad";
}

}  // namespace

std::optional<std::size_t> Robot::find_joint(std::string_view name) const {
  const auto found =
      std::find_if(joints_.begin(), joints_.end(), [&](const RobotJoint& joint) { return joint.name == name; });
  return found == joints_.end() ? std::nullopt : std::optional(static_cast<std::size_t>(found - joints_.begin()));
}

double Robot::position_of(std::size_t joint, std::span<const double> positions) const {
  // A chain of following joints is finite: the reader refuses cycles.
  double multiplier = 1, offset = 0;
  while (joints_[joint].mimic) {
    const RobotJoint::Mimic& mimic = *joints_[joint].mimic;
    offset += multiplier * mimic.offset;
    multiplier *= mimic.multiplier;
    joint = mimic.joint;
  }
  return multiplier * (joint < positions.size() ? positions[joint] : 0) + offset;
}

std::optional<Error> Robot::fault(const JointValue& value) const {
  const std::string where = "joint '" + value.name + "': ";
  const std::optional<std::size_t> found = find_joint(value.name);
  if (!found) return bad_input("robot '" + name_ + "' has no joint '" + value.name + "'", list_of(joints_));
  const RobotJoint& joint = joints_[*found];
  if (joint.kind == JointKind::fixed) return bad_input(where + "it is fixed", list_of(joints_));
  if (joint.mimic) {
    return bad_input(where + "it follows joint '" + joints_[joint.mimic->joint].name + "'", "set that one");
  }
  if (!std::isfinite(value.position)) return bad_input(where + "its position is " + words(value.position));
  return std::nullopt;
}

std::optional<Error> Robot::beyond(std::size_t number, double position) const {
  const RobotJoint& joint = joints_[number];
  if (position >= joint.lower && position <= joint.upper) return std::nullopt;
  const std::string doubt = degrees_doubt(joint, position);
  return bad_input("joint '" + joint.name + "': " + words(position) + unit_of(joint.kind) +
                       " is beyond its limits, allowed " + words(joint.lower) + " to " + words(joint.upper),
                   doubt.empty() ? "the robot stays as it was" : doubt);
}

Result<std::vector<std::string>> Robot::set(std::span<const JointValue> values, std::vector<double>& positions,
                                            bool beyond_limits) const {
  std::vector<std::string> warnings;
  std::vector<double> next = positions;
  next.resize(std::max(next.size(), joints_.size()));
  std::vector<bool> is_set(joints_.size());
  for (const JointValue& value : values) {
    if (auto error = fault(value)) return *error;
    const std::size_t joint = *find_joint(value.name);
    next[joint] = value.position;
    is_set[joint] = true;
  }
  for (std::size_t joint = 0; joint < joints_.size(); ++joint) {
    std::size_t leader = joint;
    while (joints_[leader].mimic) leader = joints_[leader].mimic->joint;
    if (joints_[joint].kind == JointKind::fixed || !is_set[leader]) continue;
    next[joint] = position_of(joint, next);
    if (!beyond_limits) {
      if (auto error = beyond(joint, next[joint])) return *error;
    }
    if (const std::string doubt = degrees_doubt(joints_[joint], next[joint]); !doubt.empty())
      warnings.push_back("joint '" + joints_[joint].name + "': " + words(next[joint]) + " rad is more than a turn, " +
                         doubt);
  }
  positions = std::move(next);
  return warnings;
}

Pose Robot::joint_pose(std::size_t joint, std::span<const double> positions) const {
  return product(joints_[joint].origin, motion_of(joints_[joint], position_of(joint, positions)));
}

std::vector<Pose> Robot::link_poses(std::span<const double> positions, const Pose& base) const {
  std::vector<Pose> poses(links_.size());
  if (!poses.empty()) poses.front() = base;
  for (std::size_t joint = 0; joint < joints_.size(); ++joint) {
    const RobotJoint& by = joints_[joint];
    poses[by.child] = product(poses[by.parent], joint_pose(joint, positions));
  }
  return poses;
}

Robot::ChordError Robot::chord_error(std::span<const double> from, std::span<const double> to) const {
  const std::vector<Pose> first = link_poses(from);
  const std::vector<Pose> last = link_poses(to);
  ChordError most;
  std::vector<double> between(joints_.size());
  for (const double share : {0.25, 0.5, 0.75}) {
    for (std::size_t i = 0; i < between.size(); ++i) between[i] = from[i] + share * (to[i] - from[i]);
    const std::vector<Pose> poses = link_poses(between);
    for (std::size_t link = 0; link < poses.size(); ++link) {
      const Vec3 straight = first[link].position + share * (last[link].position - first[link].position);
      const double metres = (poses[link].position - straight).norm();
      if (metres > most.metres) most = {metres, link};
    }
  }
  return most;
}

}  // namespace collided
