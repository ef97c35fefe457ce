#pragma once

#include <gmpxx.h>

#include <array>
#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <variant>
#include <vector>

#include "server/geometry/vector.hpp"

namespace collided::oracle {
using namespace engine;

/// Where a body's centre is at that time; between two instants it goes straight.
struct Instant {
  std::int64_t time_ns = 0;
  Vec3 position = Vec3::Zero();
};

/// A ball (radius_m) or an upright box (half_m) that only translates.
struct MovingBody {
  std::variant<double, Vec3> form;  // radius, or half sizes
  std::vector<Instant> instants;    // in order; it exists from the first to the last
};

/// Closed: the two touch from begin_ns to end_ns. To 400 bits.
struct Meeting {
  mpf_class begin_ns;
  mpf_class end_ns;
};

/// The body's centre at that time, metres.
std::array<mpq_class, 3> position_at(const MovingBody& body, std::int64_t time_ns);

/// The instants of both bodies, clamped to the time in which both exist, nanoseconds.
std::set<std::int64_t> common_instants(const MovingBody& a, const MovingBody& b);

/// All times at which two bodies of one form touch, from their poses alone. Slow: it solves linear and quadratic equations
/// in rationals for each interval between two instants.
///
/// closest_m  receives how near they come to touching without doing so, or to parting without doing so, metres. Doubles
///            cannot decide pairs below 1e-9
std::vector<Meeting> meetings(const MovingBody& a, const MovingBody& b, double& closest_m);

/// Whole nanoseconds that contain a change.
struct Bracket {
  std::int64_t low_ns = 0;
  std::int64_t high_ns = 0;
};

/// A contact as it was reported. It has no end while it holds.
struct ToldMeeting {
  Bracket began;
  std::optional<Bracket> ended;
};

/// How the reported contacts of pairs compare with their poses.
struct MeetingTally {
  int pairs = 0;
  int meetings = 0;
  int missed = 0;
  int invented = 0;
  int wrong_brackets = 0;
  int too_near = 0;  // pairs that doubles cannot decide; not compared

  int lies() const { return missed + invented + wrong_brackets; }
};

/// Compares the reported contacts of a pair up to the end of both bodies' poses. A contact that holds at the first pose of
/// both may have any reported beginning before it.
void compare(const MovingBody& a, const MovingBody& b, std::span<const ToldMeeting> told, MeetingTally& tally);

}  // namespace collided::oracle
