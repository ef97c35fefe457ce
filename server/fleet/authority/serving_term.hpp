#pragma once

#include <atomic>
#include <cstdint>
#include <limits>

#include "idl/clocks.hpp"

namespace collided::engine::service {

/// How long this server may publish and answer. Without an authority that is for ever; with one the term is set anew
/// with each confirmation, and whoever writes asks here first.
///
/// threads  any; nobody waits
class ServingTerm {
 public:
  bool is_over() const {
    const std::int64_t until_ns = until_ns_.load();
    // Without an authority no clock is read.
    return until_ns != kForEver && wire_contract::steady_ns() >= until_ns;
  }
  /// Steady clock.
  std::int64_t until_ns() const { return until_ns_.load(); }
  void set(std::int64_t until_ns) { until_ns_.store(until_ns); }
  void end() { until_ns_.store(0); }

 private:
  static constexpr std::int64_t kForEver = std::numeric_limits<std::int64_t>::max();
  std::atomic<std::int64_t> until_ns_{kForEver};
};

}  // namespace collided::engine::service
