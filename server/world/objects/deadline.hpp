#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>

#include "idl/clocks.hpp"

namespace collided::engine {

/// When a search has to end: at an instant, or once nobody waits for its result any more. The search asks at each of its tests, so that no walk runs on after its time; without a
/// deadline that costs one comparison.
///
/// cost     reads the clock at every kTestsAReading-th call
/// threads  one
class Deadline {
 public:
  Deadline() = default;
  /// at_ns  steady clock; 0: none
  /// called_off  another thread may set it; null: nobody does
  explicit Deadline(std::int64_t at_ns, const std::atomic<bool>* called_off = nullptr)
      : at_ns_(at_ns), called_off_(called_off) {}

  /// Whether the search has to end now; once true, always.
  bool is_over() { return (at_ns_ != 0 || called_off_ != nullptr) && look(); }
  /// Whether is_over() was ever true: the search was cut short, and what it has not found is unknown.
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

/// How long a search may take: until its deadline, with what is open then undecided, or until it is given up, to be made
/// anew with more time.
struct SearchTime {
  std::int64_t deadline_ns = 0;                   // steady clock; 0: none
  std::int64_t give_up_ns = 0;                    // likewise
  const std::atomic<bool>* called_off = nullptr;  // once set by another thread, as if the deadline were over

  Deadline end() const {
    const bool has_both = give_up_ns != 0 && deadline_ns != 0;
    return Deadline(has_both ? std::min(give_up_ns, deadline_ns) : std::max(give_up_ns, deadline_ns), called_off);
  }
  /// Whether a search that has just ended unfinished was given up, and its deadline is not over.
  bool is_given_up() const {
    return give_up_ns != 0 && (deadline_ns == 0 || wire_contract::steady_ns() <= deadline_ns);
  }
};

}  // namespace collided::engine
