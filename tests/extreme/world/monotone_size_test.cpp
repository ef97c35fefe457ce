// What a ball or box holds, a larger one holds too: each shape has its own formulas for faces, edges and corners, and
// between two of them a larger radius may fall into a gap.
#include <gtest/gtest.h>

#include "tests/extreme/mixed.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::monotone_size_test {
namespace {

std::set<ObjectId> met(const Answers& answers) {
  std::set<ObjectId> all;
  for (const AnswerHit& hit : answers.hits) all.insert(hit.object);
  return all;
}

class ExtremeMonotoneSize : public testing::TestWithParam<extreme::Ground> {
 protected:
  std::mt19937_64 random = oracle::seeded(471);
  extreme::Mixer mixer{random, GetParam()};
  extreme::Stage stage;
  void SetUp() override { extreme::build(stage, mixer.cast(60)); }

  /// Half sizes on a dyadic ladder with the steps around each rung.
  static std::vector<double> ladder() {
    std::vector<double> sizes{0, 0x1p-1074, 0x1p-500};
    for (double size = 0x1p-6; size <= 16; size += size < 0.5 ? size : 0.25) {
      sizes.insert(sizes.end(), {std::nextafter(size, 0), size, std::nextafter(size, 99)});
    }
    sizes.insert(sizes.end(), {1e6, 1e150, 1e290});
    return sizes;
  }
};

TEST_P(ExtremeMonotoneSize, ALargerBallNeverLosesAnOverlap) {
  for (int i = 0; i < 25; ++i) {
    const Vec3 center = mixer.point(5);
    std::set<ObjectId> before;
    for (const double radius : ladder()) {
      const auto now = met(stage.ask(QuestionKind::sphere, {center.x(), center.y(), center.z(), radius}));
      ASSERT_TRUE(std::includes(now.begin(), now.end(), before.begin(), before.end())) << radius;
      // Within a distance and overlapping a ball of it are one question.
      ASSERT_EQ(met(stage.ask(QuestionKind::near, {center.x(), center.y(), center.z(), radius})), now) << radius;
      before = now;
    }
    EXPECT_EQ(before.size(), 61u) << "60 bodies and the scene";
  }
}

TEST_P(ExtremeMonotoneSize, ALargerBoxNeverLosesAnOverlap) {
  for (int i = 0; i < 25; ++i) {
    const Vec3 center = mixer.point(5);
    const Quat turn = i % 2 == 0 ? Quat(Quat::Identity()) : Quat(0.5, 0.5, 0.5, 0.5);
    std::set<ObjectId> before;
    for (const double half : ladder()) {
      const auto now = met(stage.ask(QuestionKind::box, {center.x(), center.y(), center.z(), half, half, half, turn.w(),
                                                         turn.x(), turn.y(), turn.z()}));
      ASSERT_TRUE(std::includes(now.begin(), now.end(), before.begin(), before.end())) << half;
      // The ball within the box meets nothing that the box does not.
      const auto ball = met(stage.ask(QuestionKind::sphere, {center.x(), center.y(), center.z(), half}));
      ASSERT_TRUE(std::includes(now.begin(), now.end(), ball.begin(), ball.end())) << half;
      before = now;
    }
    EXPECT_EQ(before.size(), 61u);
  }
}

INSTANTIATE_TEST_SUITE_P(Grounds, ExtremeMonotoneSize, testing::ValuesIn(extreme::kGrounds));

}  // namespace
}  // namespace collided::engine::monotone_size_test
