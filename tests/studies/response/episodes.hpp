#pragma once

#include <cstdint>
#include <vector>

#include "tests/studies/response/line.hpp"
#include "tests/studies/response/tolerance.hpp"

namespace collided::response {

/// Counts contacts with a declared hysteresis: one ends when its gap is above `hysteresis` times the largest coordinate at
/// hand, and begins when it is at most half of that, so that jitter of an ulp to either side of touching is one contact. With
/// a hysteresis of 0 a contact is what has a gap of 0 or less, and jitter is counted.
class Episodes {
 public:
  explicit Episodes(double hysteresis = kHysteresis) : hysteresis_(hysteresis) {}

  /// Forgets everything.
  void restart();
  void observe(const Line& line, const Motion& motion);
  std::uint64_t began() const { return began_; }
  std::uint64_t ended() const { return ended_; }

 private:
  double hysteresis_;
  std::vector<char> open_;
  std::uint64_t began_ = 0;
  std::uint64_t ended_ = 0;
};

}  // namespace collided::response
