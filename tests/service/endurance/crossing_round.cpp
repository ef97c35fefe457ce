#include "tests/service/endurance/crossing_round.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

namespace collided::testing_support {
using namespace engine;
namespace {

constexpr std::int64_t kLongNs = CrossingRound::kLongNs;
// A flush for each body: what more would measure is how many samples a network carries.
constexpr double kMostStreamedHz = 20;
constexpr double kLane_m = 400;

class RoundMaker {
 public:
  RoundMaker(std::uint64_t seed, std::size_t lanes) : random_(seed), lanes_(lanes) {}

  CrossingRound make() {
    round_.publishers.resize(2 + random_() % 4);
    for (CrossingPublisher& publisher : round_.publishers) {
      publisher.streamed = chance(0.25);
      publisher.rate_hz = std::exp(in(0, std::log(publisher.streamed ? kMostStreamedHz : 240.0)));
    }
    for (std::size_t lane = 0; lane < lanes_; ++lane) add_lane(lane);
    for (std::size_t p = 0; p < round_.publishers.size(); ++p) {
      if (round_.publishers[p].streamed) pose_streamed(p);
      else pose_framed(p);
      delay(round_.publishers[p].flushes);
    }
    return std::move(round_);
  }

 private:
  /// Straight with a bend in the middle, where the pair comes near.
  struct Way {
    Vec3 near, velocity, bend;
    std::int64_t near_ns = 0;
    Vec3 at(std::int64_t time_ns) const {
      const double s = 1e-9 * static_cast<double>(time_ns - near_ns);
      return near + velocity * s + bend * std::abs(s);
    }
  };

  double in(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  bool chance(double probability) { return std::bernoulli_distribution(probability)(random_); }
  Vec3 vector(double size) {
    const double x = in(-size, size);
    const double y = in(-size, size);
    return {x, y, in(-size, size)};
  }

  void add_lane(std::size_t lane) {
    // The scene that a server has of its own stands about the origin.
    const Vec3 middle(kLane_m * static_cast<double>(1 + lane % 10), kLane_m * static_cast<double>(lane / 10 % 10),
                      kLane_m * static_cast<double>(lane / 100));
    const double size = std::exp(in(-3, 0));
    const double speed = std::exp(in(-3, 4.5));
    const auto near_ns = static_cast<std::int64_t>(in(0.3, 0.7) * static_cast<double>(kLongNs));
    const bool boxes = chance(0.5);
    const std::size_t first = random_() % round_.publishers.size();
    // Mostly of two publishers.
    const std::size_t second =
        chance(0.2) ? first : (first + 1 + random_() % (round_.publishers.size() - 1)) % round_.publishers.size();
    for (const std::size_t publisher : {first, second}) {
      CrossingBody body{.publisher = publisher, .moving = {}};
      if (boxes) {
        const double x = in(0.2, 1);
        const double y = in(0.2, 1);
        body.moving.form = Vec3(size * Vec3(x, y, in(0.2, 1)));
      } else {
        body.moving.form = size * in(0.2, 1);
      }
      round_.bodies.push_back(std::move(body));
      const Vec3 near = middle + vector(1.2 * size);
      const Vec3 velocity = vector(speed);
      // Between the poses of a slow publisher a sharp bend would be cut off far from the other.
      motions_.push_back(
          {near, velocity, vector(std::min(0.3 * speed, size * round_.publishers[publisher].rate_hz)), near_ns});
    }
  }

  /// Ascending, the first at 0 and the last at the end.
  std::vector<std::int64_t> stamps(double rate_hz) {
    const double period_ns = 1e9 / rate_hz;
    std::vector<std::int64_t> all{0};
    for (double time_ns = 1'000 + in(0, period_ns); time_ns < static_cast<double>(kLongNs) - 1'000;
         time_ns += period_ns * in(0.7, 1.3)) {
      all.push_back(static_cast<std::int64_t>(time_ns));
    }
    all.push_back(kLongNs);
    return all;
  }

  /// A flush says where all is: who is left out has rested.
  void pose_framed(std::size_t publisher) {
    for (const std::int64_t stamp_ns : stamps(round_.publishers[publisher].rate_hz)) {
      CrossingFlush flush{.stamp_ns = stamp_ns, .sent_ns = 0, .poses = {}};
      for (std::size_t i = 0; i < round_.bodies.size(); ++i) {
        if (round_.bodies[i].publisher != publisher) continue;
        auto& instants = round_.bodies[i].moving.instants;
        const bool is_left_out = stamp_ns > 0 && stamp_ns < kLongNs && chance(0.05);
        const Vec3 at = is_left_out ? instants.back().position : motions_[i].at(stamp_ns);
        if (!is_left_out) flush.poses.emplace_back(i, at);
        instants.push_back({stamp_ns, at});
      }
      round_.publishers[publisher].flushes.push_back(std::move(flush));
    }
  }

  void pose_streamed(std::size_t publisher) {
    std::map<std::int64_t, CrossingFlush> by_time;
    for (std::size_t i = 0; i < round_.bodies.size(); ++i) {
      if (round_.bodies[i].publisher != publisher) continue;
      auto& instants = round_.bodies[i].moving.instants;
      for (const std::int64_t stamp_ns : stamps(round_.publishers[publisher].rate_hz)) {
        if (!instants.empty() && stamp_ns - instants.back().time_ns > kStreamedGapNs) {
          instants.push_back({stamp_ns - kStreamedGapNs, instants.back().position});
        }
        instants.push_back({stamp_ns, motions_[i].at(stamp_ns)});
        by_time[stamp_ns].poses.emplace_back(i, instants.back().position);
      }
    }
    for (auto& [stamp_ns, flush] : by_time) {
      flush.stamp_ns = stamp_ns;
      round_.publishers[publisher].flushes.push_back(std::move(flush));
    }
  }

  /// Mostly at once, sometimes so late that many of the others' come before it.
  void delay(std::vector<CrossingFlush>& flushes) {
    std::int64_t sent_ns = 0;
    for (CrossingFlush& flush : flushes) {
      const double kind = in(0, 1);
      const double longest_ms = kind < 0.7 ? 3 : kind < 0.98 ? 40 : 200;
      flush.sent_ns = sent_ns = std::max(sent_ns, flush.stamp_ns + static_cast<std::int64_t>(1e6 * in(0, longest_ms)));
    }
  }

  std::mt19937_64 random_;
  std::size_t lanes_;
  CrossingRound round_;
  std::vector<Way> motions_;
};

}  // namespace

CrossingRound crossing_round(std::uint64_t seed, std::size_t lanes) { return RoundMaker(seed, lanes).make(); }

}  // namespace collided::testing_support
