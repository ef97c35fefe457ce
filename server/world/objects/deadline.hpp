#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>

#include "idl/clocks.hpp"

namespace collided::engine {

/// When a search must end: at an instant, or once its result is no longer wanted. The search checks it at each test, so
/// that no walk runs past it; without a deadline a check costs one comparison.
///
/// cost     reads the clock at every kTestsAReading-th call
/// threads  one
class Deadline {
 public:
  Deadline() = default;
  /// at_ns  steady clock; 0: none
  /// called_off  another thread may set it; null: none
  explicit Deadline(std::int64_t at_ns, const std::atomic<bool>* called_off = nullptr)
      : at_ns_(at_ns), called_off_(called_off) {}

  /// True if the search must end now; then it stays true.
  bool is_over() { return (at_ns_ != 0 || called_off_ != nullptr) && look(); }
  /// True if is_over() was ever true: the search was cut short, so what it has not found is unknown.
  bool was_over() const { return was_over_; }

 private:
  /// A test takes from 0.1 us to some 100 us, a reading of the clock 0.03 us.
  static constexpr std::uint32_t kTestsAReading = 8;

  bool look() {
    if (was_over_ || tests_++ % kTestsAReading != 0) return was_over_;
    return was_over_ = (at_ns_ != 0 && wire_contract::steady_ns() > at_ns_) ||
                       (called_off_ != nullptr && called_off_->load(std::memory_order_relaxed));
  }

  std::int64_t at_ns_ = 0;
  const std::atomic<bool>* called_off_ = nullptr;
  std::uint32_t tests_ = 0;
  bool was_over_ = false;
};

/// How long a search may take: until its deadline, where open questions become undecided, or until it is given up and
/// repeated with more time.
struct SearchTime {
  std::int64_t deadline_ns = 0;                   // steady clock; 0: none
  std::int64_t give_up_ns = 0;                    // steady clock; 0: none
  const std::atomic<bool>* called_off = nullptr;  // when another thread sets it, the deadline counts as over

  Deadline end() const {
    const bool has_both = give_up_ns != 0 && deadline_ns != 0;
    return Deadline(has_both ? std::min(give_up_ns, deadline_ns) : std::max(give_up_ns, deadline_ns), called_off);
  }
  /// True if a search that has just ended unfinished was given up before its deadline.
  bool is_given_up() const {
    return give_up_ns != 0 && (deadline_ns == 0 || wire_contract::steady_ns() <= deadline_ns);
  }
};

}  // namespace collided::engine
