#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/exact_phase/given/given_gap.hpp"

namespace collided::engine {

/// Distance bands about all objects of a name, as a definition of a fence has them: it is told which objects come within
/// each band. The bands descend; the last one is 0, contact.
struct MarginBands {
  std::string around = {};           // name glob of the objects that have the bands
  std::vector<double> bands_m = {};  // metres
  double hysteresis_m = 0;           // an object within a band leaves it beyond the band plus this
  std::int64_t dwell_ns = 0;         // it must be within, or beyond, for so long; but contact begins at once

  static constexpr std::size_t kMost = 8;  // bands
  static constexpr std::int64_t kLongestDwellNs = 3'600'000'000'000;
};

/// Why such bands cannot be; empty: they can.
std::string refusal_of(const MarginBands& margin);

/// One band of a margin, which all objects that have it share.
struct BandRule {
  std::string margin = {};  // its name
  std::string around = {};  // name glob of the objects that have the bands; of fixed ones, of those that they look at
  double within_m = 0;
  double hysteresis_m = 0;
  std::int64_t dwell_in_ns = 0;
  std::int64_t dwell_out_ns = 0;

  GapLimit comes_in() const { return {within_m, 0}; }
  GapLimit stays_in() const { return {within_m, hysteresis_m}; }
  /// Beyond this distance nothing of it matters, metres.
  double reach_m() const { return stays_in().high_m(); }
  bool operator==(const BandRule&) const = default;
};

}  // namespace collided::engine
