#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <collided/client.hpp>

/// A robot by its joints: where its links are, and a publisher that moves them.
#pragma GCC visibility push(default)

namespace collided {

/// How a joint moves its child link. revolute and continuous: about the axis, radians. prismatic: along it, metres.
enum class JointKind { fixed, revolute, continuous, prismatic };

/// A joint of a robot, between two of its links.
struct RobotJoint {
  /// The joint follows another one: its position is multiplier * that one's + offset.
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

/// Where a joint is to be.
struct JointValue {
  std::string name;
  double position = 0;  // radians or metres
};

/// The links and joints of a URDF, and its forward kinematics: neither its shapes nor a server.
///
/// source   ROS wiki, "urdf/XML"; REP 103 for units and axes
/// limits   10,000 links; joints of the kinds above
/// threads  any; immutable
class Robot {
 public:
  /// Reads a file of at most 64 MiB. Error bad_input says where and what.
  static Result<Robot> read(const std::string& path);
  /// The same from text, such as ROS's /robot_description.
  ///
  /// source  what messages call it
  static Result<Robot> parse(std::string_view urdf, const std::string& source = "URDF");

  /// As the file names it.
  const std::string& name() const { return name_; }
  /// Names by number. A link comes after its parent.
  const std::vector<std::string>& links() const { return links_; }
  /// By number, in the order of their child links.
  const std::vector<RobotJoint>& joints() const { return joints_; }
  std::optional<std::size_t> find_joint(std::string_view name) const;

  /// Sets positions of joints, and those that follow them. All or nothing: error bad_input for a name that is no
  /// joint's, a joint that is fixed or follows another one, a position that is not finite, and one beyond the joint's
  /// limits or those of one that follows it.
  ///
  /// positions      one a joint; what is not named stays. Grown with zeros where it is shorter
  /// beyond_limits  limits are not checked
  /// returns        warnings as sentences: an angle of more than a turn, which may be meant in degrees
  Result<std::vector<std::string>> set(std::span<const JointValue> values, std::vector<double>& positions,
                                       bool beyond_limits = false) const;
  /// Where a joint puts its child link, in its parent link.
  Pose joint_pose(std::size_t joint, std::span<const double> positions) const;
  /// Where the links are, by number.
  ///
  /// positions  one a joint, radians or metres; those of joints that follow another one are not read
  /// base       of the first link, the root
  /// error      of a position at most 4e-14 times the sum of the lengths on the way to it, for up to 32 joints
  std::vector<Pose> link_poses(std::span<const double> positions, const Pose& base = {}) const;

  /// How far a link leaves its arc.
  struct ChordError {
    double metres = 0;     // of the link's origin
    std::size_t link = 0;  // the one that leaves it farthest
  };
  /// Between two poses the server takes a link along a straight line, while the joints would take it along an arc: how far
  /// the two are apart for a step from one set of positions to another, as found at a quarter, half and three quarters of it.
  ///
  /// from, to  one a joint
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

/// The links of a robot that are objects of the world. Links without a collision shape are none.
struct RobotObjects {
  std::vector<std::size_t> links;  // numbers
  std::vector<std::string> names;  // of the objects, one a link: scene/link
};
/// Finds them. Error refused where there are none.
///
/// scene  that the robot was loaded as; empty: the robot's name
Result<RobotObjects> robot_objects(Client& client, const Robot& robot, const std::string& scene = {});

/// Positions of the same joints, one row a configuration.
struct JointConfigurations {
  std::vector<std::string> joints;  // those that are not named are at 0, or follow
  std::vector<double>
      positions;  // radians or metres; of the first configuration, in the order of the joints, then of the next
};
/// Which objects a robot's links are, and where it stands.
struct RobotPlace {
  std::string scene = {};      // the links' objects are scene/link; empty: the robot's name
  Pose base = {};              // of the root link
  bool beyond_limits = false;  // take positions beyond the joints' limits
};
/// Client::what_if for a robot: whether each configuration of its joints is free. Its links in the world stay where they
/// are. Errors as of Robot::set() and robot_objects(); with one nothing is asked.
Result<WhatIfAnswers> what_if(Client& client, const Robot& robot, const JointConfigurations& configurations,
                              const RobotPlace& place = {}, const WhatIfOptions& options = {});

/// Where a robot stands, and whose objects its links are.
struct PublishedRobotOptions {
  std::string scene = {};                       // the links' objects are scene/link; empty: the robot's name
  Pose base = {};                               // of the root link
  std::vector<JointValue> joints = {};          // where it stands at first; those that are not named are at 0
  bool beyond_limits = false;                   // take positions beyond the joints' limits
  LostPolicy lost_policy = LostPolicy::freeze;  // of the links; remove: they are given back where they stand
};

/// A robot in the world whose links a publisher has claimed, to be moved by the positions of its joints.
///
/// owner    the caller, beside the publisher, which every call is given
/// threads  one call at a time
class PublishedRobot {
 public:
  static constexpr double kChordToWarn_m = 1e-3;

  /// Claims the links of a robot that was loaded as moving (LoadOptions::moving), and places them. Links without a
  /// collision shape are no objects. Error refused where none is in the world, or one cannot be claimed: it stands
  /// still, or another publisher has it; bad_input as of Robot::set().
  static Result<PublishedRobot> claim(Client& client, Publisher& publisher, Robot robot,
                                      const PublishedRobotOptions& options = {});

  /// Moves the links to where the joints put them; the next flush() of the publisher sends it. Errors and warnings as of
  /// Robot::set(); with an error nothing moves. A step in which a link leaves its arc by more than kChordToWarn_m is a warning
  /// too: contacts may be reported that the robot does not have, and others missed. Joints that are not named stay.
  ///
  /// teleport  the links are placed there, and what lies between is not touched
  Result<std::vector<std::string>> set_joints(Publisher& publisher, std::span<const JointValue> values,
                                              bool teleport = false);
  /// Moves the robot as a whole, with its joints as they are.
  Result<void> set_base(Publisher& publisher, const Pose& base);

  const Robot& robot() const { return robot_; }
  /// Number of links that are objects.
  std::size_t object_count() const { return objects_.size(); }
  /// One a joint, radians or metres.
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
