#include "tests/unit/world/standing_crossings.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace collided::engine {
namespace {

using Form = std::variant<double, Vec3>;

/// The half sizes of a box are drawn from z to x.
Form random_form(std::mt19937_64& random, bool is_box, double size, double low, double high) {
  if (!is_box) return size * drawn(random, low, high);
  return Vec3(size * vector_drawn(random, low, high).reverse());
}

double random_period_ns(std::mt19937_64& random, double slowest_hz, double fastest_hz) {
  return 1e9 / std::exp(drawn(random, std::log(slowest_hz), std::log(fastest_hz)));
}

/// Straight pieces in random directions about the origin, with rests.
class Wandering {
 public:
  /// range_m: largest first coordinate; pull: how much of its position a body's velocity goes back each second.
  Wandering(std::mt19937_64& random, double range_m, double speed, double pull)
      : random_(random), speed_(speed), pull_(pull), at_(vector_drawn(random, -range_m, range_m)) {}
  const Vec3& at() const { return at_; }
  void go_on(double seconds) {
    const Vec3 velocity = vector_drawn(random_, -speed_, speed_) - at_ * pull_;
    if (std::bernoulli_distribution(0.8)(random_)) at_ += velocity * seconds;
  }

 private:
  std::mt19937_64& random_;
  double speed_;
  double pull_;
  Vec3 at_;
};

MovingBody standing_at(const Vec3& at, Form form, std::int64_t until_ns) {
  return {.form = form, .instants = {{kStart, at}, {until_ns, at}}};
}

StandingCrossing region_crossing(std::mt19937_64& random, const CrossingKind& kind) {
  const double speed = std::exp(drawn(random, -3, 5));
  const double size = std::exp(drawn(random, -3, 0));
  const auto flight_of = [&] { return random_flight(random, size, speed, random_period_ns(random, 5, 240)); };
  MovingBody mover{.form = random_form(random, kind.are_boxes, size, 0.2, 1), .instants = {}};
  MovingBody region{.form = random_form(random, kind.are_boxes, size, 0.2, 1), .instants = {}};
  mover.instants = flight_of();
  if (kind.is_carried) region.instants = flight_of();
  else region = standing_at(Vec3::Zero(), region.form, mover.instants.back().time_ns);
  StandingCrossing crossing{.movers = {mover}, .publishers = {0}, .about = region};
  if (kind.is_carried) crossing.about_publisher = 1;
  FenceDefinition fence{
      .name = "standing", .shape = engine::shape_of(region), .carrier = kind.is_carried ? "body1" : ""};
  // The carrier may be anything, since it is not in its own fence; a group of its own keeps contacts out.
  crossing.setting = {.standing = fence, .group = 1};
  return crossing;
}

/// To and fro near the origin, so that bands are crossed more than once.
MovingBody wandering_body(std::mt19937_64& random, bool is_box, double size, double speed) {
  MovingBody body{.form = random_form(random, is_box, size, 0.1, 0.5), .instants = {}};
  const double period_ns = random_period_ns(random, 4, 60);
  Wandering way(random, 3 * size, speed, speed / (4 * size));
  double time_ns = 1'000;
  while (time_ns < 1.2e9 || body.instants.size() < 3) {
    body.instants.push_back({kStart + static_cast<std::int64_t>(time_ns), way.at()});
    const double step_ns = period_ns * drawn(random, 0.7, 1.3);
    time_ns += step_ns;
    way.go_on(1e-9 * step_ns);
  }
  return body;
}

StandingCrossing band_crossing(std::mt19937_64& random, bool are_boxes) {
  const double size = std::exp(drawn(random, -2, 1));
  const double speed = size * std::exp(drawn(random, 0, 3));
  StandingCrossing crossing{.movers = {wandering_body(random, are_boxes, size, speed)}, .publishers = {0}, .about = {}};
  crossing.about = wandering_body(random, are_boxes, size, speed);
  crossing.about_publisher = std::bernoulli_distribution(0.25)(random) ? kStanding : 1;
  if (crossing.about_publisher == kStanding) {
    crossing.about = standing_at(Vec3::Zero(), crossing.about.form, crossing.movers.front().instants.back().time_ns);
  }
  const double band_m = size * drawn(random, 0.2, 2);
  MarginBands margin{.around = "body1", .bands_m = {band_m, band_m / 3, 0}};
  if (std::bernoulli_distribution(0.6)(random)) margin.hysteresis_m = size * drawn(random, 0, 0.5);
  if (std::bernoulli_distribution(0.6)(random)) margin.dwell_ns = static_cast<std::int64_t>(drawn(random, 0, 2e8));
  crossing.setting = {.standing = FenceDefinition{.name = "standing", .only = "body0", .margin = margin},
                      .sends_rests = true};
  return crossing;
}

std::vector<std::int64_t> random_times(std::mt19937_64& random) {
  const double period_ns = drawn(random, 2e7, 1.8e8);
  std::vector<std::int64_t> times;
  for (double time_ns = 1'000; time_ns < 1.2e9 || times.size() < 3; time_ns += period_ns * drawn(random, 0.7, 1.3))
    times.push_back(kStart + static_cast<std::int64_t>(time_ns));
  return times;
}

MovingBody wandering_ball(std::mt19937_64& random, const std::vector<std::int64_t>& times, double size, double speed) {
  MovingBody ball{.form = size * drawn(random, 0.005, 0.05), .instants = {}};
  Wandering way(random, size, speed, speed / (2 * size));
  std::int64_t before_ns = times.front();
  for (const std::int64_t time_ns : times) {
    way.go_on(1e-9 * static_cast<double>(time_ns - before_ns));
    before_ns = time_ns;
    ball.instants.push_back({time_ns, way.at()});
  }
  return ball;
}

/// Balls of several publishers, and which of them is nearest to another one or to a point.
StandingCrossing nearest_crossing(std::mt19937_64& random) {
  const double size = std::exp(drawn(random, 0, 4));
  const double speed = size * std::exp(drawn(random, 0, 2));
  StandingCrossing crossing;
  const std::size_t publishers = std::uniform_int_distribution<std::size_t>(1, 3)(random);
  std::vector<std::vector<std::int64_t>> times;
  for (std::size_t i = 0; i < publishers; ++i) times.push_back(random_times(random));
  const bool is_point = std::bernoulli_distribution(0.3)(random);
  crossing.about = wandering_ball(random, times.front(), size, speed);
  const Vec3 point = is_point ? crossing.about.instants.front().position : Vec3::Zero();
  if (is_point) crossing.about = standing_at(point, 0.0, times.front().back() + 1'000'000'000);
  else crossing.about_publisher = 0;
  const int count = std::uniform_int_distribution<int>(2, 7)(random);
  for (int i = 0; i < count; ++i) {
    crossing.publishers.push_back(std::uniform_int_distribution<std::size_t>(0, publishers - 1)(random));
    crossing.movers.push_back(wandering_ball(random, times[crossing.publishers.back()], size, speed));
  }
  NearestRule rule{.within_m = size * drawn(random, 0.4, 3)};
  if (std::bernoulli_distribution(0.5)(random)) rule.hysteresis_m = size * drawn(random, 0, 0.3);
  FenceDefinition question{.name = "standing", .only = "body*", .nearest = rule};
  question.shape.primitives.emplace_back(Sphere{point, 0});
  if (!is_point) question.carrier = "body" + std::to_string(count);
  crossing.setting = {.standing = question, .sends_firsts = false};
  crossing.setting.is_streamed = crossing.setting.sends_rests = std::bernoulli_distribution(0.25)(random);
  crossing.setting.copies = std::bernoulli_distribution(0.2)(random) ? 2 : 1;
  return crossing;
}

/// The names of the fences that report: the bands of a margin, else the one that was added.
std::vector<std::string> reporting_names(const FenceDefinition& standing) {
  if (!standing.margin) return {standing.name};
  std::vector<std::string> names;
  for (const double within_m : standing.margin->bands_m)
    names.push_back(band_name(standing.name, standing.margin->around, names.size(), within_m));
  return names;
}

}  // namespace

double drawn(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

Vec3 vector_drawn(std::mt19937_64& random, double low, double high) {
  return {drawn(random, low, high), drawn(random, low, high), drawn(random, low, high)};
}

std::vector<Instant> random_flight(std::mt19937_64& random, double size, double speed, double period_ns) {
  const Vec3 summand = vector_drawn(random, -1.2 * size, 1.2 * size);
  const Vec3 velocity = vector_drawn(random, -speed, speed);
  const Vec3 bend = vector_drawn(random, -0.3 * speed, 0.3 * speed);
  // The steps before both bodies have a pose take less than a thousand nanoseconds of the world's own time.
  std::vector<Instant> instants{{kStart + 1'000, summand + velocity * -0.25 + bend * 0.25}};
  double time_ns = 2'000 + drawn(random, 0, period_ns);
  while (time_ns < 0.5e9 || instants.size() < 2) {
    const double s = 1e-9 * time_ns - 0.25;
    instants.push_back({kStart + static_cast<std::int64_t>(time_ns), summand + velocity * s + bend * std::abs(s)});
    time_ns += period_ns * drawn(random, 0.7, 1.3);
  }
  return instants;
}

StandingCrossing random_standing_crossing(std::mt19937_64& random, const CrossingKind& kind) {
  StandingCrossing crossing = kind.rule == StandingRule::region  ? region_crossing(random, kind)
                              : kind.rule == StandingRule::bands ? band_crossing(random, kind.are_boxes)
                                                                 : nearest_crossing(random);
  crossing.rule = kind.rule;
  return crossing;
}

StandingEvents events_of(const StandingCrossing& crossing, std::mt19937_64& random, double step_chance) {
  std::vector<std::pair<std::size_t, MovingBody>> bodies;
  for (std::size_t i = 0; i < crossing.movers.size(); ++i)
    bodies.emplace_back(crossing.publishers[i], crossing.movers[i]);
  if (crossing.about_publisher) bodies.emplace_back(*crossing.about_publisher, crossing.about);
  const std::vector<std::string> names = reporting_names(*crossing.setting.standing);
  StandingEvents all(names.size());
  const Arrivals arrivals(std::move(bodies), crossing.setting);
  arrivals.run(
      arrivals.shuffled(random), random, step_chance, [&](const World& world, const Event& event, const Told& told) {
        EXPECT_EQ(event.of.doubt, Doubt::none);
        const bool is_end = crossing.rule == StandingRule::nearest && event.kind == EventKind::ended;
        if (is_end && event.joins_next) return;  // the `began` of the next nearest follows
        const auto band =
            std::find(names.begin(), names.end(), world.fences()->table().name(slot_of(event.of.b))) - names.begin();
        StandingEvent reported{told};
        reported.mover = is_end ? -1 : std::stoi(world.info(event.of.a)->name.substr(4));
        reported.distance_m = -event.of.contact.depth_m;
        reported.distance_error_m = event.of.contact.depth_error_m;
        all.at(static_cast<std::size_t>(band)).push_back(reported);
      });
  return all;
}

}  // namespace collided::engine
