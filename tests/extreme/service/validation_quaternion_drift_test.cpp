// A body that turns by multiplying quaternions drifts off the unit sphere: taken as it is, the matrix swells the body;
// normalised in silence at any size, four random numbers become a rotation.
#include <gtest/gtest.h>

#include "server/service/questions/validation.hpp"
#include "tests/extreme/worlds.hpp"

namespace collided::engine::validation_quaternion_drift_test {
namespace {

std::variant<Pose, Refusal> checked(const Quat& q) {
  const double numbers[7] = {0, 0, 0, q.w(), q.x(), q.y(), q.z()};
  return service::checked_pose(numbers);
}

/// How far the matrix is from a rotation.
double swelling(const Pose& pose) {
  const Mat3 r = frame_of(pose).rotation;
  return (r.transpose() * r - Mat3::Identity()).cwiseAbs().maxCoeff();
}

TEST(ExtremeQuaternionDrift, AMillionTurnsInDoubleAreTaken) {
  const Quat turn = Quat(Eigen::AngleAxisd(0.001, Vec3(1, 2, 3).normalized()));
  Quat q = Quat::Identity();
  for (int i = 0; i < 1'000'000; ++i) q = turn * q;
  EXPECT_NE(q.norm(), 1) << "the scene must be worth testing";
  const auto pose = checked(q);
  ASSERT_TRUE(std::holds_alternative<Pose>(pose));
  EXPECT_LE(swelling(std::get<Pose>(pose)), 2e-15);
}

// In single precision a few thousand turns are what 1e-6 allows; beyond, the publisher is told, with the norm.
TEST(ExtremeQuaternionDrift, InSinglePrecisionTheRefusalComesInTime) {
  Eigen::Quaternionf q = Eigen::Quaternionf::Identity();
  const Eigen::Quaternionf turn(Eigen::AngleAxisf(0.5f, Eigen::Vector3f(1, 2, 3).normalized()));
  bool refused = false;
  for (int i = 0; i < 10'000'000 && !refused; ++i) {
    q = turn * q;
    const auto pose = checked(q.cast<double>());
    refused = std::holds_alternative<Refusal>(pose);
    if (!refused && i % 1'000 == 0) { ASSERT_LE(swelling(std::get<Pose>(pose)), 2e-15) << i; }
  }
  ASSERT_TRUE(refused);
  EXPECT_GT(std::abs(q.cast<double>().norm() - 1), 1e-6);
}

TEST(ExtremeQuaternionDrift, TheBorderIsAtOneMillionth) {
  const Quat unit = Quat(0.5, 0.5, 0.5, 0.5);
  for (const double factor : {1 + 0.999e-6, 1 - 0.999e-6}) {
    const auto pose = checked(Quat(Eigen::Vector4d(unit.coeffs() * factor)));
    ASSERT_TRUE(std::holds_alternative<Pose>(pose)) << factor;
    EXPECT_LE(swelling(std::get<Pose>(pose)), 2e-15) << "divided by its norm";
  }
  for (const double factor : {1 + 1.001e-6, 1 - 1.001e-6, 0.0, 2.0}) {
    EXPECT_TRUE(std::holds_alternative<Refusal>(checked(Quat(Eigen::Vector4d(unit.coeffs() * factor))))) << factor;
  }
}

// The two names of one rotation place every point the same, to the bit.
TEST(ExtremeQuaternionDrift, MinusQIsQ) {
  const Quat q = Quat(0.3, -0.5, 0.7, 0.4).normalized();
  const Frame plus = frame_of({.position = {1, 2, 3}, .rotation = q});
  const Frame minus = frame_of({.position = {1, 2, 3}, .rotation = Quat(-q.w(), -q.x(), -q.y(), -q.z())});
  EXPECT_EQ(plus.rotation, minus.rotation);
}

// A box that has turned a million times touches where a fresh one does, to some roundings.
TEST(ExtremeQuaternionDrift, ContactsDoNotDrift) {
  const Quat turn(Eigen::AngleAxisd(0.001, Vec3::UnitZ()));
  Quat q = Quat::Identity();
  for (int i = 0; i < 1'000'000; ++i) q = turn * q;
  extreme::Stage stage;
  const Pose pose = std::get<Pose>(checked(q));
  const Vec3 along = frame_of(pose).rotation.col(0);
  const ObjectId box = stage.add("box", extreme::box_shape({1, 1, 1}), pose);
  stage.ball("near", along * (2 - 1e-14), 1);
  stage.ball("apart", -along * (2 + 1e-14), 1);
  stage.step();
  ASSERT_EQ(stage.world.contacts().size(), 1u);
  EXPECT_EQ(stage.world.contacts()[0].a, box);
  EXPECT_EQ(stage.world.info(stage.world.contacts()[0].b)->name, "near");
}

}  // namespace
}  // namespace collided::engine::validation_quaternion_drift_test
