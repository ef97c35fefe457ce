// Posed pairs of every kind, as they fall and brought to where they touch, up to a million kilometres out: each yes and no is
// that of the numbers given, and each distance and depth within its bound of theirs. The truth is a walk in 100 digits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "tests/extreme/world/given_pairs.hpp"
#include "tests/oracle/wide_gap.hpp"

namespace collided::engine::placed_pairs_test {
namespace {

using oracle::PosedPart;
using oracle::Wide;

constexpr double kFarMetres[] = {0, 1e3, 1e6, 1e9};

int pairs_asked() {
  const char* asked = std::getenv("COLLIDED_PAIRS");
  return asked != nullptr ? std::atoi(asked) : 1000;
}

class ExtremePlacedPairs : public GivenPairs {
 protected:
  /// What the truth says to all answers.
  struct Tally {
    int touching = 0;
    int apart = 0;
    int wrong = 0;
    int undecided = 0;
    int violated = 0;
    int unknown = 0;
  };

  static bool is_plane(const GivenSample& sample) { return sample.name == kEndless; }
  GivenSample any_kind(int kind) {
    if (kind < kKinds) return solid_sample(kind);
    return solid(kEndless, HalfSpace{point(1), point(1)});
  }

  /// Where doubles hold the truth's own digits a bound may be nothing: what 100 digits round is none of its business.
  static bool is_within(const Wide& truth, double value, double error) {
    return abs(truth - Wide(value)) <= Wide(error) + Wide("1e-60");
  }

  void judge_distance(const PosedPart& a, const PosedPart& b, const Separation& told, Tally& tally) {
    const Wide low = Wide(told.distance_m) - Wide(told.error_m) - Wide("1e-60");
    const Wide high = Wide(told.distance_m) + Wide(told.error_m) + Wide("1e-60");
    const oracle::WideInterval truth = oracle::wide_distance(a, b, low, high);
    if (truth.low > high || truth.high < low) {
      ++tally.violated;
    } else if (truth.low < low || truth.high > high) {
      ++tally.unknown;
    }
  }

  /// The told direction parts them within the bound, and no other that is tried does with less.
  void judge_depth(const PosedPart& a, const PosedPart& b, const Contact& told, Tally& tally) {
    bool holds = is_within(oracle::wide_push(a, b, told.normal), told.depth_m, told.depth_error_m);
    const Wide least = Wide(told.depth_m) - Wide(told.depth_error_m) - Wide("1e-60");
    for (const double away : {1e-6, 1e-3, 0.1, 10.0}) {
      holds = holds && oracle::wide_push(a, b, told.normal + away * point(1)) >= least;
    }
    tally.violated += holds ? 0 : 1;
  }

  void judge_on_plane(const PosedPart& solid, const PosedPart& plane, const PairReport& report, Tally& tally) {
    const Wide height = oracle::wide_height(solid, plane);
    const bool touches = height <= 0;
    ++(touches ? tally.touching : tally.apart);
    if ((report.touches == Decision::yes) != touches) {
      ++tally.wrong;
    } else if (touches) {
      tally.violated += is_within(-height, report.contact.depth_m, report.contact.depth_error_m) ? 0 : 1;
    } else {
      tally.violated += is_within(height, report.separation.distance_m, report.separation.error_m) ? 0 : 1;
    }
  }

  void judge(const PosedPart& a, const PosedPart& b, const PairReport& report, Tally& tally) {
    const oracle::WideVerdict verdict = oracle::wide_verdict(a, b);
    if (verdict == oracle::WideVerdict::unknown) {
      ++tally.unknown;
      return;
    }
    const bool touches = verdict == oracle::WideVerdict::meet;
    ++(touches ? tally.touching : tally.apart);
    if ((report.touches == Decision::yes) != touches) {
      ++tally.wrong;
    } else if (touches) {
      judge_depth(a, b, report.contact, tally);
    } else {
      judge_distance(a, b, report.separation, tally);
    }
  }
};

TEST_F(ExtremePlacedPairs, NoAnswerIsWrongAndNoBoundIsBroken) {
  Tally all;
  const int pairs = pairs_asked();
  constexpr int kAll = kKinds + 1;
  for (int i = 0; i < pairs; ++i) {
    // The second is never a half-space: two of them have no distance.
    const GivenSample a = any_kind(i % kAll);
    const GivenSample b = any_kind(i / kAll % kKinds);
    const double far_m = kFarMetres[i / (kAll * kKinds) % std::size(kFarMetres)];
    const Pose a_pose = pose(far_m);
    Pose b_pose = pose(far_m);
    const bool is_brought = any(0, 1) < 0.5;
    if (is_brought) bring_together(a, a_pose, b, b_pose);
    const PairReport report = Pair(a, a_pose, b, b_pose).report;
    const Tally before = all;
    all.undecided += report.touches == Decision::undecided;
    if (is_plane(a)) {
      judge_on_plane({b.part, b_pose}, {a.part, a_pose}, report, all);
    } else {
      judge({a.part, a_pose}, {b.part, b_pose}, report, all);
    }
    const bool is_fine =
        all.wrong == before.wrong && all.violated == before.violated && all.undecided == before.undecided;
    EXPECT_TRUE(is_fine) << a.name << " and " << b.name << ", case " << i << " at " << far_m << " m, "
                         << (is_brought ? "brought together" : "as it fell") << ": touches "
                         << static_cast<int>(report.touches) << ", depth " << report.contact.depth_m << " +- "
                         << report.contact.depth_error_m << ", distance " << report.separation.distance_m << " +- "
                         << report.separation.error_m << ", normal " << report.contact.normal.transpose()
                         << ", which parts them by "
                         << (is_plane(a)
                                 ? Wide(0)
                                 : oracle::wide_push({a.part, a_pose}, {b.part, b_pose}, report.contact.normal));
  }
  std::printf("%d pairs: %d touching, %d apart; %d wrong, %d undecided, %d bounds violated; no truth found for %d\n",
              pairs, all.touching, all.apart, all.wrong, all.undecided, all.violated, all.unknown);
  EXPECT_GT(all.touching, pairs / 4);
  EXPECT_GT(all.apart, pairs / 4);
  EXPECT_LE(all.unknown, pairs / 200);
}

}  // namespace
}  // namespace collided::engine::placed_pairs_test
