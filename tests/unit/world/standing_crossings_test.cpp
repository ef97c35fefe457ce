// Generated crossings of fences, margins and nearest, compared with oracles that know only the poses.
#include "tests/unit/world/standing_crossings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "tests/oracle/margin_oracle.hpp"
#include "tests/oracle/nearest_oracle.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine {
namespace {

// No passage is missed, none is invented, and brackets contain the times that the poses imply, whichever body moves.
TEST(FenceCrossings, AreReportedAsTheOracleFindsThem) {
  const int count = oracle::asked("COLLIDED_FENCES", 2'000) / 4;
  for (const bool is_carried : {false, true}) {
    for (const bool boxes : {false, true}) {
      std::mt19937_64 random = oracle::seeded(2701 + (boxes ? 1 : 0) + (is_carried ? 2 : 0));
      oracle::MeetingTally tally;
      for (int i = 0; i < count; ++i) {
        const StandingCrossing crossing = random_standing_crossing(
            random, {.rule = StandingRule::region, .are_boxes = boxes, .is_carried = is_carried});
        const StandingEvents reported = events_of(crossing, random, 0.5);
        for (const StandingEvent& event : reported.front()) EXPECT_EQ(event.mover, 0);
        oracle::compare(crossing.movers.front(), crossing.about, meetings_of(reported.front()), tally);
        ASSERT_EQ(tally.lies(), 0) << "crossing " << i << (boxes ? " of boxes" : " of balls")
                                   << (is_carried ? ", carried: " : ": ") << tally.missed << " missed, "
                                   << tally.invented << " invented, " << tally.wrong_brackets << " wrong brackets";
      }
      std::printf("%s%s=%d stays=%d missed=%d invented=%d wrong_brackets=%d too_near=%d\n", boxes ? "boxes" : "balls",
                  is_carried ? "_carried" : "", count, tally.meetings, tally.missed, tally.invented,
                  tally.wrong_brackets, tally.too_near);
      EXPECT_GT(tally.meetings, count / 5) << "too few of the crossings meet";
      EXPECT_LT(tally.too_near, 10 + count / 100);
    }
  }
}

/// How the reported stays in bands compare with the oracle.
struct BandTally {
  int bands = 0;
  int stays = 0;
  int wrong_count = 0;
  int wrong_brackets = 0;
  int wide_brackets = 0;
  int too_near = 0;  // bands that doubles or whole nanoseconds cannot decide; not compared
};

void compare_band(const StandingCrossing& crossing, std::size_t band, const std::vector<StandingEvent>& reported,
                  BandTally& tally) {
  const MovingBody& mover = crossing.movers.front();
  const MarginBands& margin = *crossing.setting.standing->margin;
  const oracle::OracleBand wanted{.within_m = margin.bands_m[band],
                                  .hysteresis_m = margin.hysteresis_m,
                                  .dwell_in_ns = margin.bands_m[band] == 0 ? 0 : margin.dwell_ns,
                                  .dwell_out_ns = margin.dwell_ns};
  double closest_m = std::numeric_limits<double>::infinity();
  double closest_ns = std::numeric_limits<double>::infinity();
  const std::vector<oracle::BandStay> stays = oracle::band_stays(mover, crossing.about, wanted, closest_m, closest_ns);
  ++tally.bands;
  if (closest_m < 1e-9 || closest_ns < 50) {
    ++tally.too_near;
    return;
  }
  tally.stays += static_cast<int>(stays.size());
  std::vector<mpf_class> turns_ns;
  for (const oracle::BandStay& stay : stays) {
    turns_ns.push_back(stay.began_ns);
    if (stay.ended_ns) turns_ns.push_back(*stay.ended_ns);
  }
  if (turns_ns.size() != reported.size()) {
    ++tally.wrong_count;
    return;
  }
  const std::int64_t first_ns = std::max(mover.instants.front().time_ns, crossing.about.instants.front().time_ns);
  for (std::size_t i = 0; i < reported.size(); ++i) {
    const StandingEvent& event = reported[i];
    // The first stay may have begun before both were known.
    const bool is_from_start = turns_ns[i] <= static_cast<double>(first_ns);
    const bool is_held =
        is_from_start ? event.low_ns <= first_ns : event.low_ns <= turns_ns[i] && turns_ns[i] <= event.high_ns;
    const bool is_kind = event.kind == (i % 2 == 0 ? EventKind::began : EventKind::ended);
    tally.wrong_brackets += is_held && is_kind && event.mover == 0 ? 0 : 1;
    tally.wide_brackets += event.high_ns - event.low_ns > 1'000 ? 1 : 0;
  }
}

// No stay is missed, none is invented, and brackets contain the times that the poses imply, with hysteresis and dwell.
TEST(MarginCrossings, AreReportedAsTheOracleFindsThem) {
  const int count = oracle::asked("COLLIDED_MARGINS", 1'000) / 2;
  for (const bool boxes : {false, true}) {
    std::mt19937_64 random = oracle::seeded(2711 + (boxes ? 1 : 0));
    BandTally tally;
    for (int i = 0; i < count; ++i) {
      const StandingCrossing crossing =
          random_standing_crossing(random, {.rule = StandingRule::bands, .are_boxes = boxes});
      const StandingEvents reported = events_of(crossing, random, 0.5);
      for (std::size_t band = 0; band < reported.size(); ++band) {
        compare_band(crossing, band, reported[band], tally);
        ASSERT_EQ(tally.wrong_count + tally.wrong_brackets, 0)
            << "crossing " << i << (boxes ? " of boxes" : " of balls") << ", band " << band << ": " << tally.wrong_count
            << " stays too many or too few, " << tally.wrong_brackets << " wrong brackets";
      }
    }
    std::printf("%s=%d bands=%d stays=%d wrong=0 wide_brackets=%d too_near=%d\n", boxes ? "boxes" : "balls", count,
                tally.bands, tally.stays, tally.wide_brackets, tally.too_near);
    EXPECT_GT(tally.stays, count / 2) << "too few of the crossings have stays";
    EXPECT_LT(tally.too_near, 10 + count / 50);
  }
}

struct NearestTally {
  int changes = 0;
  int wide_brackets = 0;
  int too_near = 0;  // crossings that doubles or whole nanoseconds cannot decide; not compared
};

std::string text_of(const std::vector<StandingEvent>& reported, const std::vector<oracle::NearestStay>& stays) {
  std::string text = "reported:";
  for (const StandingEvent& one : reported)
    text += " " + std::to_string(one.mover) + "@" + std::to_string(one.low_ns - kStart) + ".." +
            std::to_string(one.high_ns - kStart);
  text += "\ntruth:";
  for (const oracle::NearestStay& stay : stays)
    text += " " + std::to_string(stay.who) + "@" + std::to_string(static_cast<double>(stay.began_ns - kStart));
  return text;
}

void compare_nearest(const StandingCrossing& crossing, const std::vector<StandingEvent>& reported,
                     NearestTally& tally) {
  const NearestRule& rule = *crossing.setting.standing->nearest;
  double closest_m = 1e300;
  double closest_ns = 1e300;
  const std::vector<oracle::NearestStay> stays =
      oracle::nearest_stays(crossing.about, crossing.movers, {rule.within_m, rule.hysteresis_m}, closest_m, closest_ns);
  if (closest_m < 1e-9 || closest_ns < 50) {
    ++tally.too_near;
    return;
  }
  SCOPED_TRACE(text_of(reported, stays));
  // Streamed objects are known only up to a while ago, so the last changes may be missing.
  ASSERT_LE(reported.size(), stays.size());
  ASSERT_TRUE(crossing.setting.is_streamed || reported.size() == stays.size());
  for (std::size_t i = 0; i < reported.size(); ++i) {
    const StandingEvent& event = reported[i];
    const auto truth_ns = stays[i].began_ns;
    ASSERT_EQ(event.mover, stays[i].who) << "change " << i;
    // The first may have been so before all bodies were known.
    if (i == 0 && truth_ns <= static_cast<long double>(kStart + 1'000)) continue;
    ASSERT_LE(static_cast<long double>(event.low_ns), truth_ns + 0.01L) << "change " << i;
    ASSERT_GE(static_cast<long double>(event.high_ns), truth_ns - 0.01L) << "change " << i;
    tally.wide_brackets += event.high_ns - event.low_ns > 1'000 ? 1 : 0;
    if (event.mover < 0) continue;
    const double distance_m = static_cast<double>(
        oracle::distance_at(crossing.about, crossing.movers[static_cast<std::size_t>(event.mover)], event.high_ns));
    EXPECT_LE(std::abs(event.distance_m - distance_m), event.distance_error_m + 1e-15) << "change " << i;
    EXPECT_LE(event.distance_error_m, 1e-9) << "change " << i;
  }
  tally.changes += static_cast<int>(reported.size());
}

// No change is missed, none is invented, and brackets contain the times that the poses imply.
TEST(NearestCrossings, AreReportedAsTheOracleFindsThem) {
  const int count = oracle::asked("COLLIDED_NEAREST", 500);
  std::mt19937_64 random = oracle::seeded(2721);
  NearestTally tally;
  for (int i = 0; i < count; ++i) {
    const StandingCrossing crossing = random_standing_crossing(random, {.rule = StandingRule::nearest});
    compare_nearest(crossing, events_of(crossing, random, 0.5).front(), tally);
    ASSERT_FALSE(testing::Test::HasFailure())
        << "crossing " << i << (crossing.about_publisher ? "" : ", a point")
        << (crossing.setting.is_streamed ? ", streamed" : "") << (crossing.setting.copies > 1 ? ", compound" : "")
        << ", hysteresis " << crossing.setting.standing->nearest->hysteresis_m << ", publishers of "
        << testing::PrintToString(crossing.publishers);
  }
  std::printf("scenes=%d changes=%d wrong=0 wide_brackets=%d too_near=%d\n", count, tally.changes, tally.wide_brackets,
              tally.too_near);
  EXPECT_GT(tally.changes, 2 * count) << "too few changes";
  EXPECT_LT(tally.too_near, 10 + count / 20);
  EXPECT_LT(tally.wide_brackets, 10 + tally.changes / 50);
}

/// Arrival order and steps make no difference: events are equal to the bit.
///
/// kind_of  the kind of the crossing with that number
/// least    so many events are exceeded by all crossings together
template <typename KindOf>
void expect_the_same_in_any_order(std::uint64_t seed, int count, std::size_t least, const KindOf& kind_of) {
  std::mt19937_64 random = oracle::seeded(seed);
  std::size_t events = 0;
  for (int i = 0; i < count; ++i) {
    const StandingCrossing crossing = random_standing_crossing(random, kind_of(i));
    const StandingEvents first = events_of(crossing, random, 1);
    for (const auto& of_band : first) events += of_band.size();
    for (int order = 0; order < 5; ++order) {
      const StandingEvents again = events_of(crossing, random, 0.3);
      ASSERT_EQ(again.size(), first.size());
      for (std::size_t band = 0; band < first.size(); ++band)
        ASSERT_TRUE(first[band] == again[band])
            << "crossing " << i << (crossing.setting.is_streamed ? ", streamed" : "") << "\n"
            << text_of(first[band], {}) << "\n"
            << text_of(again[band], {});
    }
  }
  EXPECT_GT(events, least);
}

TEST(FenceCrossings, AnyArrivalOrderReportsTheSame) {
  expect_the_same_in_any_order(2705, 200, 40, [](int i) {
    return CrossingKind{.rule = StandingRule::region, .are_boxes = i % 2 == 0, .is_carried = true};
  });
}

TEST(MarginCrossings, AnyArrivalOrderReportsTheSame) {
  expect_the_same_in_any_order(
      2715, 100, 100, [](int i) { return CrossingKind{.rule = StandingRule::bands, .are_boxes = i % 2 == 0}; });
}

TEST(NearestCrossings, AnyArrivalOrderReportsTheSame) {
  expect_the_same_in_any_order(2722, 100, 200, [](int) { return CrossingKind{.rule = StandingRule::nearest}; });
}

}  // namespace
}  // namespace collided::engine
