#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <collided/client.hpp>

/// A robot moved by its joints: forward kinematics, and its links as published objects.
#pragma GCC visibility push(default)

namespace collided {

/// How a joint moves its child link. revolute and continuous: about the axis, radians. prismatic: along it, metres.
enum class JointKind { fixed, revolute, continuous, prismatic };

/// A joint of a robot, between two of its links.
struct RobotJoint {
  /// The joint follows another one: position = multiplier * other position + offset.
  struct Mimic {
    std::size_t joint = 0;  // number of the other one
    double multiplier = 1;
    double offset = 0;  // radians or metres
  };
  std::string name;
  JointKind kind = JointKind::fixed;
  std::size_t parent = 0;  // numbers of the links
  std::size_t child = 0;
  Pose origin = {};                                         // of the child's frame in the parent's, with the joint at 0
  Vec3 axis = Vec3::UnitX();                                // unit, in the child's frame
  double lower = -std::numeric_limits<double>::infinity();  // radians or metres; infinite: no limit
  double upper = std::numeric_limits<double>::infinity();
  std::optional<Mimic> mimic = {};
};

/// The target position of a joint.
struct JointValue {
  std::string name;
  double position = 0;  // radians or metres
};

/// The links and joints of a URDF, and its forward kinematics. It has no shapes and needs no server.
///
/// source   ROS wiki, "urdf/XML"; REP 103 for units and axes
/// limits   10,000 links; joints of the kinds above
/// threads  any; immutable
class Robot {
 public:
  /// Reads a file of at most 64 MiB. Error bad_input states the place and the fault.
  static Result<Robot> read(const std::string& path);
  /// Parses a text, such as ROS's /robot_description.
  ///
  /// source  its name in messages
  static Result<Robot> parse(std::string_view urdf, const std::string& source = "URDF");

  /// The robot's name in the file.
  const std::string& name() const { return name_; }
  /// Names of the links; the index is the link's number. A link comes after its parent.
  const std::vector<std::string>& links() const { return links_; }
  /// The joints; the index is the joint's number. They are in the order of their child links.
  const std::vector<RobotJoint>& joints() const { return joints_; }
  /// Returns the number of the joint of that name; nothing if there is none.
  std::optional<std::size_t> find_joint(std::string_view name) const;

  /// Sets positions of joints and of those that follow them, all or none. Error bad_input for an unknown joint, a joint
  /// that is fixed or follows another one, a position that is not finite, and a position beyond the limits of the joint
  /// or of a follower.
  ///
  /// positions      one per joint; joints that are not named keep theirs. Extended with zeros if shorter
  /// beyond_limits  do not check limits
  /// returns        warnings as sentences: an angle of more than a turn, which may be meant in degrees
  Result<std::vector<std::string>> set(std::span<const JointValue> values, std::vector<double>& positions,
                                       bool beyond_limits = false) const;
  /// Returns the pose of a joint's child link in its parent link.
  Pose joint_pose(std::size_t joint, std::span<const double> positions) const;
  /// Returns the poses of all links, by number.
  ///
  /// positions  one per joint, radians or metres; those of following joints are ignored
  /// base       pose of the first link, the root
  /// error      of a position: at most 4e-14 times the sum of the lengths from the root to it, for up to 32 joints
  std::vector<Pose> link_poses(std::span<const double> positions, const Pose& base = {}) const;

  /// Deviation of a link from its arc.
  struct ChordError {
    double metres = 0;     // of the link's origin
    std::size_t link = 0;  // the link with the largest deviation
  };
  /// Returns the deviation between the straight line along which the server moves a link and the arc that the joints
  /// describe, for a step between two sets of positions. It is evaluated at a quarter, half and three quarters of the
  /// step.
  ///
  /// from, to  positions, one per joint
  ChordError chord_error(std::span<const double> from, std::span<const double> to) const;

 private:
  friend class RobotReader;
  double position_of(std::size_t joint, std::span<const double> positions) const;
  std::optional<Error> fault(const JointValue& value) const;
  std::optional<Error> beyond(std::size_t joint, double position) const;

  std::string name_;
  std::vector<std::string> links_;
  std::vector<RobotJoint> joints_;
};

/// The links of a robot that are objects in the world. Links without a collision shape are not.
struct RobotObjects {
  std::vector<std::size_t> links;  // numbers
  std::vector<std::string> names;  // of the objects, one per link: scene/link
};
/// Finds the objects of a robot's links. Error refused if there are none.
///
/// scene  the scene as which the robot was loaded; empty: the robot's name
Result<RobotObjects> robot_objects(Client& client, const Robot& robot, const std::string& scene = {});

/// Positions of the same joints in many configurations.
struct JointConfigurations {
  std::vector<std::string> joints;  // joints that are not named are at 0, or follow others
  std::vector<double>
      positions;  // radians or metres; of the first configuration, in the order of the joints, then of the next
};
/// The objects of a robot's links, and its base pose.
struct RobotPlace {
  std::string scene = {};      // the links' objects are scene/link; empty: the robot's name
  Pose base = {};              // of the root link
  bool beyond_limits = false;  // accept positions beyond the joints' limits
};
/// Client::what_if for a robot: tests whether each configuration of its joints is free. Its links in the world do not
/// move. Errors are those of Robot::set() and robot_objects(); after one of them no question is sent.
Result<WhatIfAnswers> what_if(Client& client, const Robot& robot, const JointConfigurations& configurations,
                              const RobotPlace& place = {}, const WhatIfOptions& options = {});

/// The scene, the initial position and the loss policy of a published robot.
struct PublishedRobotOptions {
  std::string scene = {};                       // the links' objects are scene/link; empty: the robot's name
  Pose base = {};                               // of the root link
  std::vector<JointValue> joints = {};          // initial positions; joints that are not named are at 0
  bool beyond_limits = false;                   // accept positions beyond the joints' limits
  LostPolicy lost_policy = LostPolicy::freeze;  // of the links; remove: they are released where they stand
};

/// A robot in the world whose links a publisher has claimed, and moves by joint positions.
///
/// owner    the caller; every call takes the publisher
/// threads  one call at a time
class PublishedRobot {
 public:
  static constexpr double kChordToWarn_m = 1e-3;

  /// Claims the links of a robot that was loaded as moving (LoadOptions::moving), and places them. Links without a
  /// collision shape are not objects. Error refused if no link is in the world, or if one cannot be claimed because it
  /// is static or has another publisher; bad_input as for Robot::set().
  static Result<PublishedRobot> claim(Client& client, Publisher& publisher, Robot robot,
                                      const PublishedRobotOptions& options = {});

  /// Moves the links to the given joint positions; the publisher's next flush() sends them. Joints that are not named
  /// keep theirs. Errors and warnings as for Robot::set(); after an error nothing moves. It also warns if a link
  /// deviates from its arc by more than kChordToWarn_m: false contacts may then be reported and true ones missed.
  ///
  /// teleport  the links jump there; the path in between is not tested
  Result<std::vector<std::string>> set_joints(Publisher& publisher, std::span<const JointValue> values,
                                              bool teleport = false);
  /// Moves the whole robot without moving its joints.
  Result<void> set_base(Publisher& publisher, const Pose& base);

  const Robot& robot() const { return robot_; }
  /// Number of links that are objects.
  std::size_t object_count() const { return objects_.size(); }
  /// Positions, one per joint, radians or metres.
  std::span<const double> positions() const { return positions_; }

 private:
  struct ClaimedLink {
    std::size_t link = 0;
    Publisher::Object object = 0;
  };
  PublishedRobot(Robot robot, const PublishedRobotOptions& options);
  Result<void> move_links(Publisher& publisher, bool teleport);

  Robot robot_;
  PublishedRobotOptions options_;
  std::vector<double> positions_;
  std::vector<ClaimedLink> objects_;
};

}  // namespace collided

#pragma GCC visibility pop
