#include "client/ros/bridge.hpp"

#include <algorithm>

namespace collided::ros {
namespace {

// Clocks of machines in one laboratory differ by less; a stamp farther ahead comes from a different clock.
constexpr std::int64_t kMostAheadNs = 500'000'000;

}  // namespace

void Bridge::take(const RosTransform& transform, std::int64_t now_ns) {
  ++counts_.transforms;
  std::int64_t stamp_ns = transform.stamp_ns;
  if (transform.is_static) stamp_ns = kAlways;
  const bool is_unstamped = stamp_ns <= 0;
  const bool is_ahead = !transform.is_static && stamp_ns > now_ns + kMostAheadNs;
  if (is_unstamped || is_ahead) stamp_ns = now_ns;
  counts_.unstamped += is_unstamped ? 1 : 0;
  counts_.ahead += is_ahead ? 1 : 0;
  switch (frames_.set(transform.parent, transform.child, stamp_ns, transform.pose)) {
    case FrameTree::TransformFate::yes: break;
    case FrameTree::TransformFate::unnamed: ++counts_.unnamed; break;
    case FrameTree::TransformFate::bad: ++counts_.bad; break;
    case FrameTree::TransformFate::loop: ++counts_.loops; break;
    case FrameTree::TransformFate::late: ++counts_.late; break;
    case FrameTree::TransformFate::full: ++counts_.full; break;
  }
}

void Bridge::take(const RosJoints& joints, std::int64_t now_ns) {
  const bool has_positions = joints.positions.size() >= joints.names.size();
  counts_.robotless += robot_ ? 0 : 1;
  counts_.joints += robot_ && !has_positions ? 1 : 0;
  if (!robot_ || !has_positions) return;
  std::vector<JointValue> values;
  bool is_whole = true;
  for (std::size_t i = 0; i < joints.names.size(); ++i) {
    const std::optional<std::size_t> joint = robot_->find_joint(joints.names[i]);
    is_whole = is_whole && joint.has_value();
    if (!joint) continue;
    // Publishers also name joints that mimic others; the positions of those are computed.
    const RobotJoint& found = robot_->joints()[*joint];
    if (found.kind != JointKind::fixed && !found.mimic) values.push_back({joints.names[i], joints.positions[i]});
  }
  // A robot that reports a joint beyond its limit is accepted all the same.
  const bool is_set = static_cast<bool>(robot_->set(values, positions_, true));
  counts_.joints += is_set && is_whole ? 0 : 1;
  if (!is_set) return;
  for (std::size_t joint = 0; joint < robot_->joints().size(); ++joint) {
    const RobotJoint& by = robot_->joints()[joint];
    if (by.kind == JointKind::fixed) continue;
    take({.parent = robot_->links()[by.parent],
          .child = robot_->links()[by.child],
          .stamp_ns = joints.stamp_ns,
          .pose = robot_->joint_pose(joint, positions_)},
         now_ns);
  }
}

Result<void> Bridge::take_robot(const std::string& urdf) {
  Result<Robot> robot = Robot::parse(urdf, "/robot_description");
  if (!robot) return robot.error();
  robot_ = std::move(*robot);
  positions_.assign(robot_->joints().size(), 0);
  for (std::size_t joint = 0; joint < robot_->joints().size(); ++joint) {
    const RobotJoint& by = robot_->joints()[joint];
    if (by.kind != JointKind::fixed) continue;
    take({.parent = robot_->links()[by.parent],
          .child = robot_->links()[by.child],
          .pose = robot_->joint_pose(joint, positions_),
          .is_static = true},
         0);
  }
  return {};
}

}  // namespace collided::ros
