#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

namespace collided::engine {

/// Pairs that were found a gap apart, and how far their objects have gone since: until the gap is used up they cannot
/// have met, and are not tested again. For pairs whose test is dear: meshes.
/// A partner is an object's slot, or a number of the caller's for what does not move.
/// One thread.
class SeparationCache {
 public:
  static constexpr std::size_t kMost = 100'000;  // pairs; more are tested as if nothing were known

  /// Every point of the object went at most so far in this step, metres.
  void moved(std::uint32_t slot, double at_most_m);
  /// The object is somewhere else, or another one.
  void placed(std::uint32_t slot);
  /// Nothing is known any more.
  void clear();

  /// Whether the two cannot have met since they were remembered, at any moment.
  bool holds(std::uint32_t slot, std::uint32_t partner) const;
  /// The two are more than gap_m apart as they are now.
  void remember(std::uint32_t slot, std::uint32_t partner, double gap_m);
  /// Whether it is worth looking for a gap: not where it was in vain a moment ago.
  bool is_worth_looking(std::uint32_t slot, std::uint32_t partner) const;
  void looked_in_vain(std::uint32_t slot, std::uint32_t partner);

  /// Once a step; forgets pairs that nobody asked for in a while.
  void end_step();
  std::size_t size() const { return pairs_.size(); }

 private:
  struct Odometer {
    double gone_m = 0;             // since placed; rounded up
    std::uint32_t placements = 0;
  };
  struct Pair {
    double gap_m = 0;
    double gone_m[2] = {0, 0};
    std::uint32_t placements[2] = {0, 0};
    std::uint64_t look_again = 0;  // step
    mutable std::uint64_t asked = 0;
  };

  Odometer odometer(std::uint32_t partner) const {
    return partner < odometers_.size() ? odometers_[partner] : Odometer{};
  }
  Odometer& odometer_of(std::uint32_t slot);
  const Pair* find(std::uint32_t slot, std::uint32_t partner) const;
  Pair* find_or_add(std::uint32_t slot, std::uint32_t partner);

  std::vector<Odometer> odometers_;  // by slot
  std::unordered_map<std::uint64_t, Pair> pairs_;
  std::uint64_t step_ = 0;
};

}  // namespace collided::engine
