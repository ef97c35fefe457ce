// Where the links of a robot are, against what others have computed or published.

#include <gtest/gtest.h>

#include <charconv>
#include <cmath>
#include <map>
#include <numbers>

#include <collided/robot.hpp>

#include "tests/oracle/exact_data.hpp"
#include "tests/oracle/seed.hpp"

namespace collided {
namespace {

using Real = long double;
using Matrix = Eigen::Matrix<Real, 4, 4>;
using Vector = Eigen::Matrix<Real, 3, 1>;

/// The panda's joints as URDF, one to seven, with a flange; the numbers are those of its published description.
constexpr const char* kPanda = R"(<robot name="panda">
<link name="l0"/><link name="l1"/><link name="l2"/><link name="l3"/><link name="l4"/><link name="l5"/><link name="l6"/>
<link name="l7"/><link name="flange"/>
<joint name="j1" type="revolute"><parent link="l0"/><child link="l1"/><origin rpy="0 0 0" xyz="0 0 0.333"/>
  <axis xyz="0 0 1"/><limit lower="-2.8973" upper="2.8973"/></joint>
<joint name="j2" type="revolute"><parent link="l1"/><child link="l2"/><origin rpy="-1.57079632679489662 0 0"/>
  <axis xyz="0 0 1"/><limit lower="-1.7628" upper="1.7628"/></joint>
<joint name="j3" type="revolute"><parent link="l2"/><child link="l3"/>
  <origin rpy="1.57079632679489662 0 0" xyz="0 -0.316 0"/>
  <axis xyz="0 0 1"/><limit lower="-2.8973" upper="2.8973"/></joint>
<joint name="j4" type="revolute"><parent link="l3"/><child link="l4"/>
  <origin rpy="1.57079632679489662 0 0" xyz="0.0825 0 0"/>
  <axis xyz="0 0 1"/><limit lower="-3.0718" upper="-0.0698"/></joint>
<joint name="j5" type="revolute"><parent link="l4"/><child link="l5"/>
  <origin rpy="-1.57079632679489662 0 0" xyz="-0.0825 0.384 0"/>
  <axis xyz="0 0 1"/><limit lower="-2.8973" upper="2.8973"/></joint>
<joint name="j6" type="revolute"><parent link="l5"/><child link="l6"/><origin rpy="1.57079632679489662 0 0"/>
  <axis xyz="0 0 1"/><limit lower="-0.0175" upper="3.7525"/></joint>
<joint name="j7" type="revolute"><parent link="l6"/><child link="l7"/>
  <origin rpy="1.57079632679489662 0 0" xyz="0.088 0 0"/>
  <axis xyz="0 0 1"/><limit lower="-2.8973" upper="2.8973"/></joint>
<joint name="j8" type="fixed"><parent link="l7"/><child link="flange"/><origin xyz="0 0 0.107"/></joint>
</robot>)";

Robot robot_of(const std::string& urdf) {
  Result<Robot> robot = Robot::parse(urdf);
  EXPECT_TRUE(robot) << robot.error().message;
  return std::move(*robot);
}

/// One row of Denavit and Hartenberg's parameters as Craig has them.
Matrix craig(Real a, Real d, Real alpha, Real theta) {
  const Real ca = std::cos(alpha), sa = std::sin(alpha), ct = std::cos(theta), st = std::sin(theta);
  Matrix matrix;
  matrix << ct, -st, 0, a, st * ca, ct * ca, -sa, -d * sa, st * sa, ct * sa, ca, d * ca, 0, 0, 0, 1;
  return matrix;
}

// The maker publishes the arm by Denavit and Hartenberg's parameters, a description of another kind than URDF's.
TEST(RobotKinematics, ThePandaIsWhereItsMakersParametersPutIt) {
  const Robot robot = robot_of(kPanda);
  constexpr Real kQuarter = std::numbers::pi_v<Real> / 2;
  const std::array<std::array<Real, 3>, 8> table{{{0, 0.333L, 0},
                                                  {0, 0, -kQuarter},
                                                  {0, 0.316L, kQuarter},
                                                  {0.0825L, 0, kQuarter},
                                                  {-0.0825L, 0.384L, -kQuarter},
                                                  {0, 0, kQuarter},
                                                  {0.088L, 0, kQuarter},
                                                  {0, 0.107L, 0}}};
  std::mt19937_64 random = oracle::seeded(20261125);
  double worst_m = 0;
  for (int round = 0; round < 1'000; ++round) {
    std::vector<double> positions(robot.joints().size());
    Matrix expected = Matrix::Identity();
    for (std::size_t row = 0; row < table.size(); ++row) {
      const std::optional<std::size_t> joint = robot.find_joint("j" + std::to_string(row + 1));
      ASSERT_TRUE(joint);
      const RobotJoint& by = robot.joints()[*joint];
      if (by.kind != JointKind::fixed) positions[*joint] = std::uniform_real_distribution(by.lower, by.upper)(random);
    }
    const std::vector<Pose> poses = robot.link_poses(positions);
    for (std::size_t row = 0; row < table.size(); ++row) {
      const std::size_t joint = *robot.find_joint("j" + std::to_string(row + 1));
      expected = expected * craig(table[row][0], table[row][1], table[row][2], positions[joint]);
      const Pose& pose = poses[robot.joints()[joint].child];
      worst_m = std::max(worst_m, (pose.position - expected.block<3, 1>(0, 3).cast<double>()).norm());
      const Eigen::Matrix3d turned = expected.block<3, 3>(0, 0).cast<double>();
      EXPECT_LT((pose.rotation.toRotationMatrix() - turned).norm(), 1e-14);
    }
  }
  std::printf("8,000 poses, at most %.2g m off\n", worst_m);
  EXPECT_LT(worst_m, 3e-15);
}

/// Rodrigues' formula.
Eigen::Matrix<Real, 3, 3> turn(const Vector& axis, Real angle) {
  Eigen::Matrix<Real, 3, 3> cross;
  cross << 0, -axis.z(), axis.y(), axis.z(), 0, -axis.x(), -axis.y(), axis.x(), 0;
  return Eigen::Matrix<Real, 3, 3>::Identity() + std::sin(angle) * cross + (1 - std::cos(angle)) * cross * cross;
}

// Joints of every kind in random trees, each link with some of the others below it.
TEST(RobotKinematics, RandomTreesKeepTheBoundThatIsPromised) {
  std::mt19937_64 random = oracle::seeded(20261126);
  std::uniform_real_distribution<double> any(-1, 1);
  constexpr std::array<const char*, 4> kKinds{"fixed", "revolute", "continuous", "prismatic"};
  double worst = 0;
  for (int round = 0; round < 300; ++round) {
    constexpr int kJoints = 32;
    std::string urdf = "<robot name='tree'><link name='0'/>";
    char text[400];
    std::array<std::array<double, 10>, kJoints> numbers{};  // xyz, rpy, axis, position
    std::array<int, kJoints> parent{}, kind{};
    for (int i = 0; i < kJoints; ++i) {
      for (double& number : numbers[i]) number = 3 * any(random);
      parent[i] = round % 2 == 0 ? i : static_cast<int>(random() % static_cast<unsigned>(i + 1));
      kind[i] = static_cast<int>(random() % 4);
      const auto& n = numbers[i];
      std::snprintf(text, sizeof text,
                    "<link name='%d'/><joint name='j%d' type='%s'><parent link='%d'/><child link='%d'/>"
                    "<origin xyz='%.17g %.17g %.17g' rpy='%.17g %.17g %.17g'/><axis xyz='%.17g %.17g %.17g'/>"
                    "<limit lower='-9' upper='9'/></joint>",
                    i + 1, i, kKinds[kind[i]], parent[i], i + 1, n[0], n[1], n[2], n[3], n[4], n[5], n[6], n[7], n[8]);
      urdf += text;
    }
    const Robot robot = robot_of(urdf + "</robot>");
    std::vector<JointValue> values;
    for (int i = 0; i < kJoints; ++i) {
      if (kind[i] != 0) values.push_back({"j" + std::to_string(i), numbers[i][9]});
    }
    std::vector<double> positions;
    ASSERT_TRUE(robot.set(values, positions));
    const std::vector<Pose> poses = robot.link_poses(positions);
    std::array<Eigen::Matrix<Real, 3, 3>, kJoints + 1> turned;
    std::array<Vector, kJoints + 1> place;
    std::array<Real, kJoints + 1> length{};
    turned[0].setIdentity();
    place[0].setZero();
    for (int i = 0; i < kJoints; ++i) {
      const auto& n = numbers[i];
      const Vector offset(n[0], n[1], n[2]), axis = Vector(n[6], n[7], n[8]).normalized();
      const auto before = turned[parent[i]];
      const Eigen::Matrix<Real, 3, 3> origin =
          before * turn(Vector::UnitZ(), n[5]) * turn(Vector::UnitY(), n[4]) * turn(Vector::UnitX(), n[3]);
      place[i + 1] = place[parent[i]] + before * offset;
      length[i + 1] = length[parent[i]] + offset.norm();
      turned[i + 1] = kind[i] == 1 || kind[i] == 2 ? Eigen::Matrix<Real, 3, 3>(origin * turn(axis, n[9])) : origin;
      if (kind[i] == 3) place[i + 1] += origin * (axis * static_cast<Real>(n[9])), length[i + 1] += std::abs(n[9]);
    }
    for (std::size_t link = 0; link < robot.links().size(); ++link) {
      const auto number = static_cast<std::size_t>(std::stoi(robot.links()[link]));
      if (number == 0) continue;
      const Real off = (poses[link].position.cast<Real>() - place[number]).norm() / length[number];
      worst = std::max(worst, static_cast<double>(off));
    }
  }
  std::printf("9,600 links, at most %.2g of the lengths off\n", worst);
  EXPECT_LT(worst, 4e-14);
}

// A joint that follows another one, by hand: a gripper whose second finger goes the other way.
TEST(RobotKinematics, AJointThatFollowsGoesItsOwnWay) {
  const Robot robot = robot_of(
      "<robot name='gripper'><link name='palm'/><link name='left'/><link name='right'/><link name='tip'/>"
      "<joint name='tip' type='prismatic'><parent link='right'/><child link='tip'/><axis xyz='0 0 1'/>"
      "<limit lower='-1' upper='1'/><mimic joint='close' multiplier='2' offset='0.25'/></joint>"
      "<joint name='open' type='prismatic'><parent link='palm'/><child link='left'/><axis xyz='0 1 0'/>"
      "<limit lower='0' upper='0.5'/></joint>"
      "<joint name='close' type='prismatic'><parent link='palm'/><child link='right'/><axis xyz='0 1 0'/>"
      "<limit lower='-0.5' upper='0'/><mimic joint='open' multiplier='-1'/></joint></robot>");
  std::vector<double> positions;
  const std::vector<JointValue> values{{"open", 0.25}};
  ASSERT_TRUE(robot.set(values, positions));
  const std::vector<Pose> poses = robot.link_poses(positions, {.position = {1, 2, 3}});
  std::map<std::string, Vec3> at;
  for (std::size_t link = 0; link < poses.size(); ++link) at[robot.links()[link]] = poses[link].position;
  EXPECT_EQ(at["palm"], Vec3(1, 2, 3));
  EXPECT_EQ(at["left"], Vec3(1, 2.25, 3));
  EXPECT_EQ(at["right"], Vec3(1, 1.75, 3));
  EXPECT_EQ(at["tip"], Vec3(1, 1.75, 2.75));
}

class RecordedRobot : public testing::Test {
 protected:
  void SetUp() override {
    const std::filesystem::path exact = oracle::exact_data();
    if (exact.empty()) GTEST_SKIP() << "no recorded data; COLLIDED_DATA may name the folder";
    data_ = exact.parent_path();
  }
  static double number(const oracle::Table& table, std::size_t row, const std::string& column) {
    return std::strtod(table.rows.at(row).at(table.column(column)).c_str(), nullptr);
  }
  static Pose pose(const oracle::Table& table, std::size_t row, const std::string& prefix = "") {
    const auto at = [&](const char* column) { return number(table, row, prefix + column); };
    return {{at("x"), at("y"), at("z")}, Quat(at("qw"), at("qx"), at("qy"), at("qz")).normalized()};
  }
  /// The right finger's mesh is turned by half a turn in its link; the poses of the tables are those of meshes.
  static Pose of_mesh(const Pose& link, const std::string& name) {
    if (name != "panda_rightfinger") return link;
    return {link.position, link.rotation * Quat(Eigen::AngleAxisd(3.14159265359, Vec3::UnitZ()))};
  }
  static double apart(const Quat& a, const Quat& b) {
    return std::min((a.coeffs() - b.coeffs()).norm(), (a.coeffs() + b.coeffs()).norm());
  }
  std::filesystem::path data_;
};

// A log of a real arm and the link poses that other software computed from it, written with 7 digits.
TEST_F(RecordedRobot, TheLogOfARealPandaHasThePublishedPoses) {
  const Result<Robot> robot = Robot::read((data_ / "panda_lab" / "panda.urdf").string());
  ASSERT_TRUE(robot) << robot.error().message;
  const oracle::Table log = oracle::read_table(data_ / "panda_lab" / "joints.csv.gz");
  const oracle::Table links = oracle::read_table(data_ / "panda_lab" / "link_poses_50hz.csv.gz");
  ASSERT_GT(links.rows.size(), 10'000U);
  std::map<std::string, std::size_t> row_of_time;
  char text[32];
  for (std::size_t row = 0; row < log.rows.size(); ++row) {
    std::snprintf(text, sizeof text, "%.6f", number(log, row, "t_s"));
    row_of_time.emplace(text, row);
  }
  std::vector<double> positions;
  std::vector<Pose> poses;
  std::string time;
  double worst_m = 0, worst = 0;
  for (std::size_t row = 0; row < links.rows.size(); ++row) {
    if (const std::string& now = links.rows[row].at(links.column("t_s")); now != time) {
      time = now;
      ASSERT_TRUE(row_of_time.contains(time)) << "no row of the log at " << time;
      std::vector<JointValue> values;
      for (int joint = 1; joint <= 7; ++joint)
        values.push_back(
            {"panda_joint" + std::to_string(joint), number(log, row_of_time[time], "q" + std::to_string(joint))});
      const Result<std::vector<std::string>> set = robot->set(values, positions);
      ASSERT_TRUE(set) << set.error().message;
      poses = robot->link_poses(positions);
    }
    const std::string& name = links.rows[row].at(links.column("link"));
    const auto link = std::find(robot->links().begin(), robot->links().end(), name) - robot->links().begin();
    const Pose found = of_mesh(poses.at(static_cast<std::size_t>(link)), name);
    worst_m = std::max(worst_m, (found.position - pose(links, row).position).norm());
    worst = std::max(worst, apart(found.rotation, pose(links, row).rotation));
  }
  std::printf("%zu poses, at most %.2g m and %.2g of a quaternion off\n", links.rows.size(), worst_m, worst);
  EXPECT_LT(worst_m, 1e-7);  // half of the seventh digit in each of three coordinates
  EXPECT_LT(worst, 2e-8);    // and of the eighth in four
}

// 1,400 states of a benchmark of motion planners, and the poses that other software computed for them.
TEST_F(RecordedRobot, StatesOfABenchmarkHaveThePublishedPoses) {
  const Result<Robot> robot = Robot::read((data_ / "mbm_panda" / "panda.urdf").string());
  ASSERT_TRUE(robot) << robot.error().message;
  const oracle::Table states = oracle::read_table(data_ / "mbm_panda" / "states.csv.gz");
  const oracle::Table links = oracle::read_table(data_ / "mbm_panda" / "links.csv.gz");
  ASSERT_EQ(states.rows.size(), 1'400U);
  std::map<std::string, std::vector<Pose>> poses_of;
  for (std::size_t row = 0; row < states.rows.size(); ++row) {
    std::vector<JointValue> values;
    for (int joint = 1; joint <= 7; ++joint) {
      const std::string name = "panda_joint" + std::to_string(joint);
      values.push_back({name, number(states, row, name)});
    }
    std::vector<double> positions;
    const Result<std::vector<std::string>> set = robot->set(values, positions);
    ASSERT_TRUE(set) << set.error().message;
    poses_of[states.rows[row][0] + states.rows[row][1]] = robot->link_poses(positions, pose(states, row, "base_"));
  }
  double worst_m = 0;
  for (std::size_t row = 0; row < links.rows.size(); ++row) {
    const std::string& name = links.rows[row].at(links.column("link"));
    const auto link = std::find(robot->links().begin(), robot->links().end(), name) - robot->links().begin();
    const Pose& found = poses_of.at(links.rows[row][0] + links.rows[row][1]).at(static_cast<std::size_t>(link));
    worst_m = std::max(worst_m, (found.position - pose(links, row).position).norm());
  }
  std::printf("%zu poses, at most %.2g m off\n", links.rows.size(), worst_m);
  // The table's states are rounded to 9 digits, of angles up to 5e-9 rad; seven joints turn what is up to 1 m from them.
  EXPECT_LT(worst_m, 3.5e-8);
}

}  // namespace
}  // namespace collided
