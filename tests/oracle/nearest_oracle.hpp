#pragma once

#include <cstdint>
#include <vector>

#include "tests/oracle/meeting_oracle.hpp"

namespace collided::oracle {

/// A question for the nearest of some balls as it is to be answered.
struct OracleNearest {
  double within_m = 0;
  double hysteresis_m = 0;
};

/// From began_ns on that ball, by number, is nearest; -1: none is.
struct NearestStay {
  int who = -1;
  long double began_ns = 0;
};

/// Who is nearest to `about` from when to when, from the poses alone, by halving time until nothing can happen in a half:
/// brute force over all pairs, in long double. Each ball rests before its first instant; the stays end with the first that
/// has no later instant.
///
/// closest_m   receives how near a distance comes to deciding otherwise, if that is less than what it was
/// closest_ns  the same of the time between two changes
std::vector<NearestStay> nearest_stays(const MovingBody& about, const std::vector<MovingBody>& balls,
                                       const OracleNearest& asked, double& closest_m, double& closest_ns);

/// How far apart two balls are at that time, metres; 0 where they touch.
long double distance_at(const MovingBody& a, const MovingBody& b, std::int64_t time_ns);

}  // namespace collided::oracle
