#pragma once

#include <gmpxx.h>

#include <cstdint>
#include <optional>
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

/// All times at which two bodies of one form touch, from their poses alone: slow, by linear and quadratic equations in
/// rationals, each piece of time between two instants by itself. closest_m: how near they come in all to touching without
/// doing so, or to parting without: what is below 1e-9 is too near for doubles to be held to.
std::vector<Meeting> meetings(const MovingBody& a, const MovingBody& b, double& closest_m);

/// Whole nanoseconds that contain a change.
struct Bracket {
  std::int64_t low_ns = 0;
  std::int64_t high_ns = 0;
};

/// A contact as somebody was told it; without an end: it holds.
struct ToldMeeting {
  Bracket began;
  std::optional<Bracket> ended;
};

/// How what was told of pairs compares with their poses.
struct MeetingTally {
  int pairs = 0;
  int meetings = 0;
  int missed = 0;
  int invented = 0;
  int wrong_brackets = 0;
  int too_near = 0;  // pairs that doubles cannot be held to; not compared

  int lies() const { return missed + invented + wrong_brackets; }
};

/// Compares what was told of a pair up to the end of both bodies' poses. A contact that holds at the first pose of both may
/// have been told with any beginning before it.
void compare(const MovingBody& a, const MovingBody& b, std::span<const ToldMeeting> told, MeetingTally& tally);

}  // namespace collided::oracle
