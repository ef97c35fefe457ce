#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace collided::engine::service {

/// A histogram of durations with eight steps to each doubling, so a quantile read from it is at most an eighth too
/// high. Counts only grow: the quantile of a span of time comes from the difference of two readings.
///
/// threads  any may add, any may read; no lock, no allocation
class DurationCounts {
 public:
  static constexpr std::int64_t kLongest_ns = (std::int64_t{1} << 40) - 1;  // 18 minutes; longer ones count as this

  void add(std::int64_t ns) { counts_[bucket_of(ns)].fetch_add(1, std::memory_order_relaxed); }

  /// Calls visit(longest duration of the step in ns, count) for each step that is not empty, shortest first.
  template <class Visit>
  void for_each(Visit&& visit) const {
    for (std::size_t bucket = 0; bucket < counts_.size(); ++bucket) {
      if (const std::uint64_t count = counts_[bucket].load(std::memory_order_relaxed)) visit(longest_ns(bucket), count);
    }
  }

  /// The step of a duration; those below kSteps have one each.
  static std::size_t bucket_of(std::int64_t ns) {
    const auto value = static_cast<std::uint64_t>(std::clamp<std::int64_t>(ns, 0, kLongest_ns));
    if (value < kSteps) return value;
    const auto shift = static_cast<std::size_t>(std::bit_width(value)) - kStepBits - 1;
    return kSteps * shift + (value >> shift);
  }
  /// Longest duration that falls into the step.
  static std::int64_t longest_ns(std::size_t bucket) {
    if (bucket < 2 * kSteps) return static_cast<std::int64_t>(bucket);
    const std::size_t shift = bucket / kSteps - 1;
    return static_cast<std::int64_t>((std::uint64_t{bucket % kSteps + kSteps + 1} << shift) - 1);
  }

 private:
  static constexpr std::size_t kStepBits = 3;
  static constexpr std::size_t kSteps = 1 << kStepBits;
  static constexpr std::size_t kBuckets = kSteps * (40 - kStepBits + 1);
  std::array<std::atomic<std::uint64_t>, kBuckets> counts_{};
};

}  // namespace collided::engine::service
