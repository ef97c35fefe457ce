#pragma once

#include <optional>
#include <vector>

#include "tests/oracle/meeting_oracle.hpp"

namespace collided::oracle {

/// The times at which two bodies of one form are at most within_m apart, going straight from pose to pose. The squared
/// distance is a quadratic in time as long as the nearest features stay the same; its coefficients are rationals, its
/// roots have 400 bits.
///
/// closest_m  receives how near the distance comes to within_m at a bend or a least distance without crossing there, if
///            that is less than its value before. Doubles cannot decide pairs below 1e-9
std::vector<Meeting> times_within(const MovingBody& a, const MovingBody& b, const mpq_class& within_m,
                                  double& closest_m);

/// A band as its margin has it.
struct OracleBand {
  double within_m = 0;
  double hysteresis_m = 0;
  std::int64_t dwell_in_ns = 0;
  std::int64_t dwell_out_ns = 0;
};

/// A stay in a band as an event pair should report it. The end is missing if it is unknown at the end of the poses.
struct BandStay {
  mpf_class began_ns;
  std::optional<mpf_class> ended_ns;
};

/// All stays by the definition of hysteresis and dwell: in at within_m, out beyond within_m + hysteresis_m, and either
/// only if it lasts for its dwell.
///
/// closest_ns  receives how near a time between two changes comes to a dwell, if that is less than its value before
std::vector<BandStay> band_stays(const MovingBody& a, const MovingBody& b, const OracleBand& band, double& closest_m,
                                 double& closest_ns);

}  // namespace collided::oracle
