#include "client/library/connection/errors.hpp"
#include "collided/robot.hpp"

namespace collided {

PublishedRobot::PublishedRobot(Robot robot, const PublishedRobotOptions& options)
    : robot_(std::move(robot)), options_(options), positions_(robot_.joints().size()) {}

Result<PublishedRobot> PublishedRobot::claim(Client& client, Publisher& publisher, Robot robot,
                                             const PublishedRobotOptions& options) {
  PublishedRobot made(std::move(robot), options);
  const Result<RobotObjects> objects = robot_objects(client, made.robot_, options.scene);
  if (!objects) return objects.error();
  const Result<std::vector<std::string>> set = made.robot_.set(options.joints, made.positions_, options.beyond_limits);
  if (!set) return set.error();
  const std::vector<Pose> poses = made.robot_.link_poses(made.positions_, options.base);
  for (std::size_t i = 0; i < objects->links.size(); ++i) {
    const std::size_t link = objects->links[i];
    const Result<Publisher::Object> object = publisher.claim(objects->names[i], poses[link], options.lost_policy);
    if (!object) return object.error();
    made.objects_.push_back({link, *object});
  }
  if (const Result<void> applied = publisher.wait_applied(std::chrono::seconds(5)); !applied) return applied.error();
  return made;
}

Result<std::vector<std::string>> PublishedRobot::set_joints(Publisher& publisher, std::span<const JointValue> values,
                                                            bool teleport) {
  const std::vector<double> before = positions_;
  Result<std::vector<std::string>> warnings = robot_.set(values, positions_, options_.beyond_limits);
  if (!warnings) return warnings;
  const Robot::ChordError chord = teleport ? Robot::ChordError() : robot_.chord_error(before, positions_);
  if (chord.metres > kChordToWarn_m) {
    warnings->push_back("link '" + robot_.links()[chord.link] + "' leaves its arc by up to " +
                        client::words(chord.metres) +
                        " m, since it is swept in a straight line; smaller steps keep closer");
  }
  if (const Result<void> moved = move_links(publisher, teleport); !moved) return moved.error();
  return warnings;
}

Result<void> PublishedRobot::set_base(Publisher& publisher, const Pose& base) {
  options_.base = base;
  return move_links(publisher, false);
}

Result<void> PublishedRobot::move_links(Publisher& publisher, bool teleport) {
  const std::vector<Pose> poses = robot_.link_poses(positions_, options_.base);
  for (const ClaimedLink& link : objects_) {
    if (Result<void> moved = publisher.move(link.object, poses[link.link], teleport); !moved) return moved;
  }
  return {};
}

}  // namespace collided
