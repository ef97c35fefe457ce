// Posed cylinders, cones and ellipsoids that touch, or miss, something by less than their placing rounds: yes and no are
// those for the shape and the pose that were given. The truth comes from a search in 100 digits.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

#include "server/exact_phase/exactly.hpp"
#include "tests/extreme/world/given_pairs.hpp"
#include "tests/oracle/wide_gap.hpp"

namespace collided::engine::given_round_test {
namespace {

using oracle::WideVerdict;

int pairs_asked() {
  const char* asked = std::getenv("COLLIDED_PAIRS");
  return asked != nullptr ? std::atoi(asked) : 240;
}

class ExtremeGivenRound : public GivenPairs {};

TEST_F(ExtremeGivenRound, APairIsDecidedForTheShapesAndPosesGiven) {
  int touching = 0, apart = 0, unknown = 0, otherwise_as_placed = 0;
  const int pairs = pairs_asked();
  for (int i = 0; i < pairs; ++i) {
    const GivenSample a = solid_sample(i % kRound);
    const GivenSample b = solid_sample(i / kRound % kKinds);
    const Pose a_pose = pose(std::pow(10.0, 3.0 * (i / (kRound * kKinds) % 4)) - 1);
    Pose b_pose = pose(a_pose.position[0]);
    bring_together(a, a_pose, b, b_pose);
    const WideVerdict verdict = oracle::wide_verdict({a.part, a_pose}, {b.part, b_pose});
    if (verdict == WideVerdict::unknown) {
      ++unknown;
      continue;
    }
    const bool truth = verdict == WideVerdict::meet;
    const Pair pair(a, a_pose, b, b_pose);
    (truth ? touching : apart) += 1;
    const std::string what = a.name + " and " + b.name + ", case " + std::to_string(i);
    EXPECT_EQ(pair.report.touches == Decision::yes, truth) << what;
    EXPECT_NE(pair.report.touches, Decision::undecided) << what;
    EXPECT_EQ(pair.stage.world.contacts().size(), truth ? 1U : 0U) << what << ": the step says otherwise";
    const auto placed = [](const ConvexPart& part, const Pose& pose) {
      return std::visit([&](const auto& own) -> ConvexPart { return place(frame_of(pose), own); }, part);
    };
    otherwise_as_placed += overlaps(placed(a.part, a_pose), placed(b.part, b_pose)).yes() != truth ? 1 : 0;
  }
  std::printf("%d pairs: %d touching, %d apart, %d of them decided otherwise as placed; no truth found for %d\n", pairs,
              touching, apart, otherwise_as_placed, unknown);
  EXPECT_GT(touching, pairs / 8);
  EXPECT_GT(apart, pairs / 8);
  EXPECT_LE(unknown, pairs / 50);
  EXPECT_GT(otherwise_as_placed, pairs / 20) << "the cases would pass without the given numbers";
}

}  // namespace
}  // namespace collided::engine::given_round_test
