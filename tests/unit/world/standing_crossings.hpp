#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "server/world/fences/fences.hpp"
#include "tests/oracle/meeting_oracle.hpp"
#include "tests/unit/world/common_time_arrivals.hpp"

namespace collided::engine {

double drawn(std::mt19937_64& random, double low, double high);

/// Each coordinate between low and high.
Vec3 vector_drawn(std::mt19937_64& random, double low, double high);

/// Half a second past the origin, with a bend there.
///
/// size       largest coordinate of the position halfway is 1.2 times this, metres
/// speed      largest coordinate of the velocity, m/s
/// period_ns  mean time between two poses
std::vector<Instant> random_flight(std::mt19937_64& random, double size, double speed, double period_ns);

/// What a monitor of the world reports: which objects are in a region, which are within distance bands of an object (with
/// hysteresis and dwell), or which is nearest to an object or a place (with hysteresis).
enum class StandingRule { region, bands, nearest };

struct CrossingKind {
  StandingRule rule = StandingRule::region;
  bool are_boxes = false;   // else balls; the nearest is asked of balls alone
  bool is_carried = false;  // a region moves with an object
};

/// Bodies that cross what a fence, margin or nearest monitors.
struct StandingCrossing {
  StandingRule rule = StandingRule::region;
  std::vector<MovingBody> movers;
  std::vector<std::size_t> publishers;  // of the movers
  MovingBody about;                     // the region, the object with the bands, or the object or place of the nearest
  std::optional<std::size_t> about_publisher = {};  // kStanding: an object that stands still; none: not an object
  Setting setting = {};
};

StandingCrossing random_standing_crossing(std::mt19937_64& random, const CrossingKind& kind);

/// An event of a crossing. mover: which one it is about; -1: for the nearest, that there is none any more.
struct StandingEvent : Told {
  int mover = 0;
  double distance_m = 0;
  double distance_error_m = 0;
  bool operator==(const StandingEvent&) const = default;
};
/// In order, by band; a region and a nearest have one.
using StandingEvents = std::vector<std::vector<StandingEvent>>;

/// Sends the publishers' batches to a world in a random order, with a step after each with that chance.
StandingEvents events_of(const StandingCrossing& crossing, std::mt19937_64& random, double step_chance);

}  // namespace collided::engine
