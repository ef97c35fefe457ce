// Two balls that a publisher each poses at 100 Hz, and whose crossings are told, against the phase between the two.

#include <cmath>
#include <random>

#include "server/world/world.hpp"
#include "tests/oracle/meeting_oracle.hpp"
#include "tests/studies/report/measured/studies.hpp"

namespace collided::report {
using namespace engine;
namespace {

constexpr double kRadius_m = 0.1;
constexpr std::int64_t kStart = 1'000'000'000'000;
constexpr std::int64_t kPeriodNs = 10'000'000;
constexpr int kInstants = 8;

using oracle::MovingBody;

/// Each goes at 100 m/s, head on but for how far they pass each other by; none of the two paths is the other's mirror.
std::pair<MovingBody, MovingBody> crossing(std::mt19937_64& random, std::int64_t phase_ns) {
  std::uniform_real_distribution<double> part(-1, 1);
  const double middle_ns = 4.0 * kPeriodNs + 0.5 * kPeriodNs * (1 + part(random));
  const Vec3 by(0, 0.5 * part(random), 0.1 * part(random));
  const auto body = [&](const Vec3& velocity, const Vec3& offset, std::int64_t phase) {
    MovingBody moving{.form = kRadius_m, .instants = {}};
    for (int i = 0; i < kInstants; ++i) {
      const std::int64_t time_ns = i * kPeriodNs + phase;
      moving.instants.push_back(
          {kStart + time_ns, offset + velocity * (1e-9 * (static_cast<double>(time_ns) - middle_ns))});
    }
    return moving;
  };
  const double slant = 10 * part(random);
  return {body({100, slant, 0}, by, 0), body({-100, slant, 0}, Vec3::Zero(), phase_ns)};
}

/// Whoever has a new pose is swept along its way, while the other stands where it said last.
bool tells_against_last_pose(const MovingBody& a, const MovingBody& b) {
  const auto nearest_m = [](const Vec3& from, const Vec3& to, const Vec3& point) {
    const Vec3 displacement = to - from;
    const double part = std::clamp((point - from).dot(displacement) / displacement.squaredNorm(), 0.0, 1.0);
    return (from + part * displacement - point).norm();
  };
  const MovingBody* const bodies[2] = {&a, &b};
  std::size_t said[2] = {0, 0};
  while (said[0] + 1 < kInstants || said[1] + 1 < kInstants) {
    const auto next_ns = [&](int i) {
      return said[i] + 1 < kInstants ? bodies[i]->instants[said[i] + 1].time_ns : INT64_MAX;
    };
    const int mover = next_ns(0) <= next_ns(1) ? 0 : 1;
    const auto& displacement = bodies[mover]->instants;
    const Vec3& other = bodies[1 - mover]->instants[said[1 - mover]].position;
    if (nearest_m(displacement[said[mover]].position, displacement[said[mover] + 1].position, other) <= 2 * kRadius_m)
      return true;
    ++said[mover];
  }
  return false;
}

bool tells_on_common_time(const MovingBody& a, const MovingBody& b) {
  World world{WorldOptions{}};
  ObjectId ids[2] = {};
  const MovingBody* const bodies[2] = {&a, &b};
  for (int i = 0; i < 2; ++i) {
    ObjectDefinition definition;
    definition.name = i == 0 ? "a" : "b";
    definition.shape.primitives = {Sphere{Vec3::Zero(), kRadius_m}};
    definition.publisher = static_cast<std::uint64_t>(i) + 1;
    definition.pose.position = bodies[i]->instants.front().position;
    ids[i] = std::get<ObjectId>(world.define(definition));
  }
  bool is_told = false;
  const auto step = [&](std::int64_t time_ns) {
    world.step(time_ns, 1, {});
    is_told = is_told || !world.events().empty();
  };
  for (int k = 0; k < kInstants; ++k) {
    for (int i = 0; i < 2; ++i) {
      const oracle::Instant& instant = bodies[i]->instants[static_cast<std::size_t>(k)];
      world.move(ids[i], {.position = instant.position, .rotation = Quat::Identity()}, instant.time_ns, false);
      world.advance(static_cast<std::uint64_t>(i) + 1, instant.time_ns);
      step(instant.time_ns);
    }
  }
  return is_told;
}

}  // namespace

std::vector<Row> study_arrival(const Setting& setting) {
  std::vector<Row> rows;
  for (const double phase_ms : {0.0, 0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 7.0, 9.0}) {
    Row last{.study = "arrival",
             .scene = "two balls at 100 Hz, 200 m/s",
             .series = "against the last pose",
             .label = short_number(phase_ms) + " ms",
             .knob = phase_ms};
    Row common = last;
    common.series = "collided";
    std::mt19937_64 random(setting.seed);
    for (int i = 0; i < setting.count(2'000); ++i) {
      const auto [a, b] = crossing(random, static_cast<std::int64_t>(phase_ms * 1e6));
      double closest_m = 0;
      const bool meets = !oracle::meetings(a, b, closest_m).empty();
      if (closest_m < 1e-9) continue;
      const bool told[2] = {tells_against_last_pose(a, b), tells_on_common_time(a, b)};
      Row* const both[2] = {&last, &common};
      for (int k = 0; k < 2; ++k) {
        ++both[k]->n;
        both[k]->missed += meets && !told[k] ? 1 : 0;
        both[k]->false_hits += !meets && told[k] ? 1 : 0;
      }
    }
    rows.push_back(common);
    rows.push_back(last);
  }
  return rows;
}

}  // namespace collided::report
