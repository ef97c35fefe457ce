#include "server/world/step/separation_cache.hpp"

#include <utility>

#include "server/geometry/tolerance.hpp"

namespace collided::engine {
namespace {

/// Covers the rounding of one sum of two non-negative numbers.
constexpr double kRoundedUp = 1 + 0x1p-52;
constexpr std::uint64_t kStepsBetweenLooks = 8;
constexpr std::uint64_t kStepsKept = 256;

std::uint64_t key_of(std::uint32_t slot, std::uint32_t partner) {
  if (partner < slot) std::swap(slot, partner);
  return std::uint64_t{partner} << 32 | slot;
}

}  // namespace

SeparationCache::Odometer& SeparationCache::odometer_of(std::uint32_t slot) {
  if (slot >= odometers_.size()) odometers_.resize(slot + 1);
  return odometers_[slot];
}

void SeparationCache::moved(std::uint32_t slot, double at_most_m) {
  Odometer& odometer = odometer_of(slot);
  odometer.gone_m = (odometer.gone_m + at_most_m) * kRoundedUp;
}

void SeparationCache::placed(std::uint32_t slot) {
  Odometer& odometer = odometer_of(slot);
  odometer.gone_m = 0;
  ++odometer.placements;
}

void SeparationCache::clear() { pairs_.clear(); }

const SeparationCache::Pair* SeparationCache::find(std::uint32_t slot, std::uint32_t partner) const {
  const auto found = pairs_.find(key_of(slot, partner));
  return found == pairs_.end() ? nullptr : &found->second;
}

SeparationCache::Pair* SeparationCache::find_or_add(std::uint32_t slot, std::uint32_t partner) {
  const std::uint64_t key = key_of(slot, partner);
  const auto found = pairs_.find(key);
  if (found != pairs_.end()) return &found->second;
  return pairs_.size() < kMost ? &pairs_[key] : nullptr;
}

bool SeparationCache::holds(std::uint32_t slot, std::uint32_t partner) const {
  const Pair* pair = find(slot, partner);
  if (pair == nullptr) return false;
  pair->asked = step_;
  if (partner < slot) std::swap(slot, partner);
  const Odometer now[2] = {odometer(slot), odometer(partner)};
  double gone_m = 0;
  for (int i = 0; i < 2; ++i) {
    if (now[i].placements != pair->placements[i]) return false;
    gone_m += now[i].gone_m - pair->gone_m[i];
  }
  // Covers two differences and their sum, one rounding each. False if anything is infinite.
  return gone_m * (1 + kFewSlack) < pair->gap_m;
}

void SeparationCache::remember(std::uint32_t slot, std::uint32_t partner, double gap_m) {
  Pair* pair = find_or_add(slot, partner);
  if (pair == nullptr) return;
  if (partner < slot) std::swap(slot, partner);
  const Odometer now[2] = {odometer(slot), odometer(partner)};
  for (int i = 0; i < 2; ++i) {
    pair->gone_m[i] = now[i].gone_m;
    pair->placements[i] = now[i].placements;
  }
  pair->gap_m = gap_m;
  pair->asked = step_;
}

bool SeparationCache::is_worth_looking(std::uint32_t slot, std::uint32_t partner) const {
  const Pair* pair = find(slot, partner);
  return pair == nullptr ? pairs_.size() < kMost : step_ >= pair->look_again;
}

void SeparationCache::looked_in_vain(std::uint32_t slot, std::uint32_t partner) {
  if (Pair* pair = find_or_add(slot, partner)) { *pair = {.look_again = step_ + kStepsBetweenLooks, .asked = step_}; }
}

void SeparationCache::end_step() {
  if (++step_ % kStepsKept != 0) return;
  std::erase_if(pairs_, [&](const auto& pair) { return pair.second.asked + kStepsKept < step_; });
}

}  // namespace collided::engine
