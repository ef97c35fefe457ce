// Robots and positions that cannot be meant, and what is said of them.

#include <gtest/gtest.h>

#include <limits>

#include <collided/robot.hpp>

namespace collided {
namespace {

std::string joint(const std::string& name, const std::string& type, const std::string& parent, const std::string& child,
                  const std::string& more = "<limit lower='-2' upper='2'/>") {
  return "<joint name='" + name + "' type='" + type + "'><parent link='" + parent + "'/><child link='" + child + "'/>" +
         more + "</joint>";
}
std::string links(int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += "<link name='l" + std::to_string(i) + "'/>";
  return text;
}
std::string refusal(const std::string& inside) {
  const Result<Robot> robot = Robot::parse("<robot name='r'>" + inside + "</robot>", "r.urdf");
  return robot ? "it was read" : robot.error().message;
}
Robot two_joints() {
  Result<Robot> robot = Robot::parse("<robot name='r'>" + links(4) + joint("shoulder", "revolute", "l0", "l1") +
                                     joint("wheel", "continuous", "l1", "l2", "") +
                                     joint("finger", "prismatic", "l2", "l3",
                                           "<limit lower='0' upper='0.1'/><mimic joint='shoulder' multiplier='0.1'/>") +
                                     "</robot>");
  EXPECT_TRUE(robot) << robot.error().message;
  return std::move(*robot);
}
Error fault_of(const std::vector<JointValue>& values) {
  std::vector<double> positions{0.5, 0.25};
  const std::vector<double> before = positions;
  const Result<std::vector<std::string>> set = two_joints().set(values, positions);
  EXPECT_FALSE(set) << "it was taken";
  EXPECT_EQ(positions, before) << "all or nothing";
  return set ? Error{} : set.error();
}

TEST(BadRobot, EachIsToldApart) {
  EXPECT_EQ(Robot::parse("<robot><link", "r.urdf").error().code, ErrorCode::bad_input);
  EXPECT_EQ(Robot::parse("<sdf/>", "r.urdf").error().message, "r.urdf: no <robot> in it");
  EXPECT_EQ(Robot::read("/nowhere/r.urdf").error().message, "/nowhere/r.urdf: it cannot be read");
  EXPECT_EQ(refusal(""), "r.urdf: it has no link");
  EXPECT_EQ(refusal(links(1) + links(1)), "r.urdf: two links have the name 'l0'");
  EXPECT_EQ(refusal(links(2) + joint("j", "floating", "l0", "l1")),
            "r.urdf: joint 'j': its type is 'floating'; allowed: fixed, revolute, continuous, prismatic");
  EXPECT_EQ(refusal(links(2) + joint("j", "fixed", "l0", "l7")),
            "r.urdf: joint 'j': it names the link 'l7', which is not there");
  EXPECT_EQ(refusal(links(3) + joint("j", "fixed", "l0", "l1") + joint("k", "fixed", "l2", "l1")),
            "r.urdf: link 'l1' is the child of two joints");
  EXPECT_EQ(refusal(links(3) + joint("j", "fixed", "l0", "l1") + joint("j", "fixed", "l1", "l2")),
            "r.urdf: two joints have the name 'j'");
  EXPECT_EQ(refusal(links(3) + joint("j", "fixed", "l1", "l2") + joint("k", "fixed", "l2", "l1")),
            "r.urdf: its joints form a ring");
  EXPECT_EQ(refusal(links(2)), "r.urdf: links 'l0' and 'l1' have no parent both; a robot has one root");
  EXPECT_EQ(refusal(links(2) + joint("j", "revolute", "l0", "l1", "")),
            "r.urdf: joint 'j': it has no <limit>, which this type of joint needs");
  EXPECT_EQ(refusal(links(2) + joint("j", "revolute", "l0", "l1", "<limit lower='1' upper='-1'/>")),
            "r.urdf: joint 'j': its lower limit is above the upper one");
  EXPECT_EQ(refusal(links(2) + joint("j", "continuous", "l0", "l1", "<axis xyz='0 0 0'/>")),
            "r.urdf: joint 'j': its axis has no direction");
  EXPECT_EQ(refusal(links(2) + joint("j", "fixed", "l0", "l1", "<origin xyz='0 nan 0'/>")),
            "r.urdf: joint 'j': origin xyz: '0 nan 0' is not numbers");
  EXPECT_EQ(refusal(links(2) + joint("j", "fixed", "l0", "l1", "<origin xyz='0 1'/>")),
            "r.urdf: joint 'j': origin xyz: '0 1' has 2 numbers, 3 are needed");
  const std::string limit = "<limit lower='-1' upper='1'/>";
  EXPECT_EQ(refusal(links(2) + joint("j", "revolute", "l0", "l1", limit + "<mimic joint='k'/>")),
            "r.urdf: joint 'j': it follows 'k', which is no joint");
  EXPECT_EQ(refusal(links(3) + joint("j", "revolute", "l0", "l1", limit + "<mimic joint='k'/>") +
                    joint("k", "revolute", "l1", "l2", limit + "<mimic joint='j'/>")),
            "r.urdf: joint 'j': the joints that it follows form a ring");
}

TEST(BadJoint, UnknownFixedAndFollowingOnesAreRefusedWithThoseThatCanBeSet) {
  EXPECT_EQ(fault_of({{"sholder", 1}}).message, "robot 'r' has no joint 'sholder'");
  EXPECT_EQ(fault_of({{"sholder", 1}}).hint, "joints that can be set: shoulder, wheel");
  EXPECT_EQ(fault_of({{"shoulder", 0.5}, {"finger", 0.05}}).message, "joint 'finger': it follows joint 'shoulder'");
  EXPECT_EQ(fault_of({{"wheel", std::numeric_limits<double>::quiet_NaN()}}).message,
            "joint 'wheel': its position is nan");
}

TEST(BadJoint, LimitsAreCheckedAlsoOfWhatFollows) {
  EXPECT_EQ(fault_of({{"wheel", 1}, {"shoulder", 2.5}}).message,
            "joint 'shoulder': 2.5 rad is beyond its limits, allowed -2 to 2");
  EXPECT_EQ(fault_of({{"shoulder", 1.5}}).message,
            "joint 'finger': 0.15000000000000002 m is beyond its limits, allowed 0 to 0.1");
  std::vector<double> positions;
  const std::vector<JointValue> far{{"shoulder", 2.5}};
  EXPECT_TRUE(two_joints().set(far, positions, true));
  EXPECT_EQ(positions[*two_joints().find_joint("shoulder")], 2.5);
}

TEST(BadJoint, AnAngleOfMoreThanATurnMayBeMeantInDegrees) {
  EXPECT_EQ(fault_of({{"shoulder", 90}}).hint, "5157 degrees; if degrees were meant, 1.571 rad");
  std::vector<double> positions;
  const std::vector<JointValue> turned{{"wheel", -90}};
  const Result<std::vector<std::string>> set = two_joints().set(turned, positions);
  ASSERT_TRUE(set);
  EXPECT_EQ(*set, std::vector<std::string>{
                      "joint 'wheel': -90 rad is more than a turn, -5157 degrees; if degrees were meant, -1.571 rad"});
  EXPECT_EQ(positions[*two_joints().find_joint("wheel")], -90) << "a wheel may have gone round";
}

}  // namespace
}  // namespace collided
