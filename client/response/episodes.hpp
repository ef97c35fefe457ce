#pragma once

#include <cstdint>
#include <vector>

#include "client/response/line.hpp"
#include "client/response/tolerance.hpp"

namespace collided::response {

/// Counts contacts with a declared hysteresis: one begins when its gap is 0 or less and ends when the gap is above
/// `hysteresis` times the largest coordinate at hand, so that jitter of an ulp to either side of touching is one contact.
class Episodes {
 public:
  explicit Episodes(double hysteresis = kHysteresis) : hysteresis_(hysteresis) {}

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
