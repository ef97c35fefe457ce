#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

namespace collided::engine {

/// Result of a search for a gap between two objects that are apart.
struct GapFound {
  std::uint32_t slot = 0;
  std::uint32_t partner = 0;
  double gap_m = 0;
  bool there_is = false;  // they are more than gap_m apart
};

/// Pairs with a known gap, and how far their objects have moved since. Until the gap is used up they cannot have met,
/// and are not tested again. For pairs with expensive tests: meshes.
/// A partner is an object's slot, or a number chosen by the caller for something that does not move.
/// threads  one; while none changes it, several may ask about different pairs
class SeparationCache {
 public:
  static constexpr std::size_t kMost = 100'000;  // pairs; further ones are tested every time

  /// Every point of the object moved by at most this in the step, metres.
  void moved(std::uint32_t slot, double at_most_m);
  /// The object jumped, or the slot holds another one: nothing is known about its pairs.
  void placed(std::uint32_t slot);
  /// Forgets all pairs.
  void clear();

  /// True if the two cannot have met at any moment since they were remembered.
  bool holds(std::uint32_t slot, std::uint32_t partner) const;
  /// Remembers that the two, as they are now, are more than gap_m apart.
  void remember(std::uint32_t slot, std::uint32_t partner, double gap_m);
  /// True if a search for a gap is worth its cost: not soon after one in vain.
  bool is_worth_looking(std::uint32_t slot, std::uint32_t partner) const;
  /// Records that a search found no gap; is_worth_looking() is false for the next few steps.
  void looked_in_vain(std::uint32_t slot, std::uint32_t partner);

  /// Calls remember() or looked_in_vain().
  void note(const GapFound& found) {
    if (found.there_is) remember(found.slot, found.partner, found.gap_m);
    else looked_in_vain(found.slot, found.partner);
  }

  /// Call once per step; forgets pairs that were not looked up for some time.
  void end_step();
  std::size_t size() const { return pairs_.size(); }

 private:
  /// Total distance that an object has moved; the difference of two readings bounds its motion between them.
  struct Odometer {
    double gone_m = 0;  // metres since it was last placed; rounded up
    std::uint32_t placements = 0;
  };
  /// Memory of a pair; arrays hold the lower slot first.
  struct Pair {
    double gap_m = 0;
    double gone_m[2] = {0, 0};
    std::uint32_t placements[2] = {0, 0};
    std::uint64_t look_again = 0;  // first step in which another search is worthwhile
    // Step of the last lookup.
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
