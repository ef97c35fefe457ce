// Generated motions of two objects through bands, beside the oracle in rationals, for every order of arrival.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "server/world/fences/fences.hpp"
#include "server/world/world.hpp"
#include "tests/oracle/margin_oracle.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/unit/world/common_time_arrivals.hpp"

namespace collided::engine {
namespace {

/// As many as are asked for by that variable of the environment, for the long form of a test; else the given number.
int margins_asked(int fallback) {
  const char* text = std::getenv("COLLIDED_MARGINS");
  return text != nullptr ? std::atoi(text) : fallback;
}

/// Two objects, the bands between them, and how they are published.
struct BandCrossing {
  MovingBody mover;
  MovingBody about;
  MarginBands margin;
  bool is_about_fixed = false;
};

double between(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

Vec3 vector_within(std::mt19937_64& random, double size) {
  return {between(random, -size, size), between(random, -size, size), between(random, -size, size)};
}

/// To and fro near the origin, so that bands are crossed more than once.
std::vector<Instant> wandering(std::mt19937_64& random, double size, double speed) {
  const double period_ns = 1e9 / std::exp(between(random, std::log(4.0), std::log(60.0)));
  std::vector<Instant> instants;
  Vec3 at = vector_within(random, 3 * size);
  double time_ns = 1'000;
  while (time_ns < 1.2e9 || instants.size() < 3) {
    instants.push_back({kStart + static_cast<std::int64_t>(time_ns), at});
    const double step_ns = period_ns * between(random, 0.7, 1.3);
    time_ns += step_ns;
    const Vec3 velocity = vector_within(random, speed) - at * (speed / (4 * size));
    if (std::bernoulli_distribution(0.8)(random)) at += velocity * (1e-9 * step_ns);
  }
  return instants;
}

std::variant<double, Vec3> form_of(std::mt19937_64& random, bool boxes, double size) {
  if (!boxes) return size * between(random, 0.1, 0.5);
  return Vec3(size * between(random, 0.1, 0.5), size * between(random, 0.1, 0.5), size * between(random, 0.1, 0.5));
}

BandCrossing random_band_crossing(std::mt19937_64& random, bool boxes) {
  const double size = std::exp(between(random, -2, 1));
  const double speed = size * std::exp(between(random, 0, 3));
  BandCrossing crossing;
  crossing.mover = {.form = form_of(random, boxes, size), .instants = wandering(random, size, speed)};
  crossing.about = {.form = form_of(random, boxes, size), .instants = wandering(random, size, speed)};
  crossing.is_about_fixed = std::bernoulli_distribution(0.25)(random);
  if (crossing.is_about_fixed) {
    crossing.about.instants = {{kStart, Vec3::Zero()}, {crossing.mover.instants.back().time_ns, Vec3::Zero()}};
  }
  const double band_m = size * between(random, 0.2, 2);
  crossing.margin = {.around = "about", .bands_m = {band_m, band_m / 3, 0}};
  if (std::bernoulli_distribution(0.6)(random)) crossing.margin.hysteresis_m = size * between(random, 0, 0.5);
  if (std::bernoulli_distribution(0.6)(random))
    crossing.margin.dwell_ns = static_cast<std::int64_t>(between(random, 0, 2e8));
  return crossing;
}

/// What was told of one band.
using BandStory = std::vector<Told>;

/// A world with the two objects of two publishers, and the margin.
class OneMargin {
 public:
  explicit OneMargin(const BandCrossing& crossing) : crossing_(crossing), told_(crossing.margin.bands_m.size()) {
    ids_[0] = define("mover", crossing.mover, 1, true);
    ids_[1] = define("about", crossing.about, crossing.is_about_fixed ? 0 : 2, !crossing.is_about_fixed);
    EXPECT_TRUE(std::holds_alternative<ObjectId>(
        world_.add_fence({.name = "margin", .only = "mover", .margin = crossing.margin})));
    step();
  }

  /// Publishers' batches in a random order; steps come with that chance after each, and where an object would move
  /// twice.
  std::vector<BandStory> tell(std::mt19937_64& random, double step_chance) {
    std::vector<std::size_t> order(crossing_.mover.instants.size(), 0);
    if (!crossing_.is_about_fixed) order.insert(order.end(), crossing_.about.instants.size(), 1);
    std::shuffle(order.begin(), order.end(), random);
    std::size_t next[2] = {0, 0};
    for (const std::size_t who : order) {
      const MovingBody& body = who == 0 ? crossing_.mover : crossing_.about;
      if (world_.has_moved(ids_[who])) step();
      const Instant& instant = body.instants[next[who]++];
      const ObjectId ids[] = {ids_[who]};
      const Pose poses[] = {{.position = instant.position}};
      bool moved[1];
      world_.move(ids, poses, instant.time_ns, false, moved);
      world_.advance(who + 1, instant.time_ns);
      if (std::bernoulli_distribution(step_chance)(random)) step();
    }
    step();
    return told_;
  }

 private:
  ObjectId define(const std::string& name, const MovingBody& body, std::uint64_t publisher, bool moving) {
    ObjectDefinition definition;
    definition.name = name;
    definition.shape = shape_of(body);
    definition.publisher = publisher;
    definition.moving = moving;
    definition.pose.position = body.instants.front().position;
    return std::get<ObjectId>(world_.define(definition));
  }

  void step() {
    EXPECT_TRUE(world_.step(++now_ns_, 1, {}));
    const auto time = [&](double seconds_ago) { return now_ns_ - std::llround(seconds_ago * 1e9); };
    for (const Event& event : world_.fences()->events()) {
      EXPECT_EQ(event.of.a, ids_[0]);
      EXPECT_EQ(event.sequence, ++last_sequence_);
      Told told{.kind = event.kind,
                .reason = event.reason,
                .low_ns = time(event.bracket_low_s),
                .high_ns = time(event.bracket_high_s)};
      told.depth_bits =
          std::bit_cast<std::uint64_t>(event.of.contact.depth_m) + (event.of.doubt != Doubt::none ? 1 : 0);
      for (int k = 0; k < 3; ++k) {
        told.velocity_bits[static_cast<std::size_t>(k)] =
            std::bit_cast<std::uint64_t>(event.relative_velocity[k] + 0.0);
      }
      told_[band_of(event.of.b)].push_back(told);
      is_any_in_doubt_ = is_any_in_doubt_ || event.of.doubt != Doubt::none;
    }
  }

  std::size_t band_of(ObjectId band) const {
    for (std::size_t i = 0; i < told_.size(); ++i) {
      if (world_.fences()->name(band) == band_name("margin", "about", i, crossing_.margin.bands_m[i])) return i;
    }
    ADD_FAILURE() << "an event of no band";
    return 0;
  }

  const BandCrossing& crossing_;
  World world_{WorldOptions{}};
  ObjectId ids_[2] = {0, 0};
  std::int64_t now_ns_ = kStart;
  std::uint64_t last_sequence_ = 0;
  std::vector<BandStory> told_;

 public:
  bool is_any_in_doubt_ = false;
};

/// How what was told of bands compares with the oracle.
struct BandTally {
  int bands = 0;
  int stays = 0;
  int wrong_count = 0;
  int wrong_brackets = 0;
  int wide_brackets = 0;
  int too_near = 0;  // bands that doubles or whole nanoseconds cannot be held to; not compared

  bool lies() const { return wrong_count + wrong_brackets > 0; }
};

/// The first stay may have begun before both were known.
bool holds(const Told& told, const mpf_class& truth_ns, std::int64_t first_ns) {
  if (truth_ns <= static_cast<double>(first_ns)) return told.low_ns <= first_ns;
  return told.low_ns <= truth_ns && truth_ns <= told.high_ns;
}

void compare(const BandCrossing& crossing, std::size_t band, const BandStory& story, BandTally& tally) {
  const bool is_contact = crossing.margin.bands_m[band] == 0;
  const oracle::OracleBand wanted{.within_m = crossing.margin.bands_m[band],
                                  .hysteresis_m = crossing.margin.hysteresis_m,
                                  .dwell_in_ns = is_contact ? 0 : crossing.margin.dwell_ns,
                                  .dwell_out_ns = crossing.margin.dwell_ns};
  double closest_m = std::numeric_limits<double>::infinity();
  double closest_ns = std::numeric_limits<double>::infinity();
  const std::vector<oracle::BandStay> stays =
      oracle::band_stays(crossing.mover, crossing.about, wanted, closest_m, closest_ns);
  ++tally.bands;
  if (closest_m < 1e-9 || closest_ns < 50) {
    ++tally.too_near;
    return;
  }
  tally.stays += static_cast<int>(stays.size());
  std::size_t events = 0;
  for (const oracle::BandStay& stay : stays) events += stay.ended_ns ? 2 : 1;
  if (events != story.size()) {
    ++tally.wrong_count;
    return;
  }
  const std::int64_t first_ns =
      std::max(crossing.mover.instants.front().time_ns, crossing.about.instants.front().time_ns);
  for (std::size_t i = 0; i < story.size(); ++i) {
    const oracle::BandStay& stay = stays[i / 2];
    const bool is_right = story[i].kind == (i % 2 == 0 ? EventKind::began : EventKind::ended) &&
                          holds(story[i], i % 2 == 0 ? stay.began_ns : *stay.ended_ns, first_ns);
    tally.wrong_brackets += is_right ? 0 : 1;
    tally.wide_brackets += story[i].high_ns - story[i].low_ns > 1'000 ? 1 : 0;
  }
}

// No stay is missed, none is invented, and brackets contain what the poses say, with hysteresis and dwell.
TEST(MarginCrossings, AreToldAsTheOracleFindsThem) {
  const int count = margins_asked(1'000) / 2;
  for (const bool boxes : {false, true}) {
    std::mt19937_64 random = oracle::seeded(2711 + (boxes ? 1 : 0));
    BandTally tally;
    for (int i = 0; i < count; ++i) {
      const BandCrossing crossing = random_band_crossing(random, boxes);
      OneMargin world(crossing);
      const std::vector<BandStory> told = world.tell(random, 0.5);
      EXPECT_FALSE(world.is_any_in_doubt_) << "crossing " << i;
      for (std::size_t band = 0; band < told.size(); ++band) {
        compare(crossing, band, told[band], tally);
        ASSERT_FALSE(tally.lies()) << "crossing " << i << (boxes ? " of boxes" : " of balls") << ", band " << band
                                   << ": " << tally.wrong_count << " stays too many or too few, "
                                   << tally.wrong_brackets << " brackets beside the truth";
      }
    }
    std::printf("%s=%d bands=%d stays=%d wrong=0 wide_brackets=%d too_near=%d\n", boxes ? "boxes" : "balls", count,
                tally.bands, tally.stays, tally.wide_brackets, tally.too_near);
    EXPECT_GT(tally.stays, count / 2) << "crossings must be worth it";
    EXPECT_LT(tally.too_near, 10 + count / 50);
  }
}

// Arrival order and steps do not show: events are equal to the bit.
TEST(MarginCrossings, AnyArrivalOrderTellsTheSame) {
  std::mt19937_64 random = oracle::seeded(2715);
  std::size_t events = 0;
  for (int i = 0; i < 100; ++i) {
    const BandCrossing crossing = random_band_crossing(random, i % 2 == 0);
    const std::vector<BandStory> first = OneMargin(crossing).tell(random, 1);
    for (const BandStory& story : first) events += story.size();
    for (int order = 0; order < 5; ++order) ASSERT_EQ(first, OneMargin(crossing).tell(random, 0.3)) << "crossing " << i;
  }
  EXPECT_GT(events, 100u);
}

}  // namespace
}  // namespace collided::engine
