#include "server/service/ingest/publisher_owners.hpp"

#include <fmt/format.h>

#include <bit>

namespace collided::engine::service {

bool PublisherOwners::claim(std::uint64_t publisher, const NumberOwner& owner, std::uint64_t writer) {
  const std::lock_guard lock(mutex_);
  const std::uint64_t participant = owner.participant;
  const auto found = owners_.find(publisher);
  if (found != owners_.end() && found->second.participant == participant) {
    found->second.writers.insert(writer);
    return true;
  }
  if (found != owners_.end() || !may_hold(publisher, owner)) {
    constexpr std::size_t kMostNamed = 8;
    if (forged_.size() < kMostNamed) forged_.insert(publisher);
    refused_.fetch_add(1, std::memory_order_relaxed);
    return false;
  }
  if (const std::optional<Excess> refusal = why_not(owner)) {
    note_refused(publisher, *refusal);
    return false;
  }
  ++number_count_[participant];
  if (!owner.keys_of.empty()) {
    ++count_of_name_[owner.keys_of];
    remember(publisher, owner.keys_of);
  }
  owners_[publisher] = {.participant = participant, .keys_of = owner.keys_of, .writers = {writer}};
  if (refusals_.erase(publisher) > 0) std::erase(refused_order_, publisher);
  return true;
}

/// With mutex_ held, here and below.
std::size_t PublisherOwners::share_of(const NumberOwner& owner) const {
  if (!owner.keys_of.empty()) {
    const auto found = count_of_name_.find(owner.keys_of);
    return found == count_of_name_.end() ? 0 : found->second;
  }
  const auto found = number_count_.find(owner.participant);
  return found == number_count_.end() ? 0 : found->second;
}

std::optional<PublisherOwners::Excess> PublisherOwners::why_not(const NumberOwner& owner) const {
  const auto held = number_count_.find(owner.participant);
  if (held != number_count_.end() && held->second >= kMostOfOne) return Excess::too_many_of_one;
  const std::size_t limit = share_of(owner) < kFew ? kMost : kMost - kReserved;
  return owners_.size() < limit ? std::nullopt : std::optional(Excess::too_many);
}

bool PublisherOwners::may_hold(std::uint64_t publisher, const NumberOwner& owner) const {
  const auto named = name_of_number_.find(publisher);
  return named == name_of_number_.end() || named->second == owner.keys_of;
}

void PublisherOwners::remember(std::uint64_t publisher, const std::string& keys_of) {
  if (!name_of_number_.emplace(publisher, keys_of).second) return;
  std::deque<std::uint64_t>& numbers = numbers_of_name_[keys_of];
  numbers.push_back(publisher);
  if (numbers.size() <= kMostRemembered) return;
  name_of_number_.erase(numbers.front());
  numbers.pop_front();
}

void PublisherOwners::note_refused(std::uint64_t publisher, Excess refusal) {
  constexpr std::size_t kMostRefusals = 256;
  refused_.fetch_add(1, std::memory_order_relaxed);
  ++too_many_;
  if (!refusals_.insert_or_assign(publisher, refusal).second) return;
  refused_order_.push_back(publisher);
  if (refused_order_.size() <= kMostRefusals) return;
  refusals_.erase(refused_order_.front());
  refused_order_.pop_front();
}

void PublisherOwners::release(std::uint64_t publisher, std::uint64_t writer) {
  const std::lock_guard lock(mutex_);
  const auto found = owners_.find(publisher);
  if (found == owners_.end() || found->second.writers.erase(writer) == 0 || !found->second.writers.empty()) return;
  const auto drop_one = [](auto& counts, const auto& key) {
    const auto count = counts.find(key);
    if (count != counts.end() && --count->second == 0) counts.erase(count);
  };
  drop_one(number_count_, found->second.participant);
  if (!found->second.keys_of.empty()) drop_one(count_of_name_, found->second.keys_of);
  owners_.erase(found);
}

std::string PublisherOwners::why_refused(std::uint64_t publisher) const {
  const std::lock_guard lock(mutex_);
  const auto found = refusals_.find(publisher);
  if (found == refusals_.end()) return {};
  if (found->second == Excess::too_many_of_one)
    return fmt::format("its process has {} publishers, the limit of one process", kMostOfOne);
  return fmt::format(
      "{} publishers are there, the limit is {}; the last {} are for processes and keys with fewer than {}",
      owners_.size(), kMost, kReserved, kFew);
}

std::optional<std::uint64_t> PublisherOwners::take_refused() {
  const std::lock_guard lock(mutex_);
  if (refused_order_.empty() || std::bit_width(too_many_) == std::bit_width(too_many_returned_)) return std::nullopt;
  too_many_returned_ = too_many_;
  return refused_order_.back();
}

std::vector<std::uint64_t> PublisherOwners::take_forged() {
  const std::lock_guard lock(mutex_);
  const std::vector<std::uint64_t> forged(forged_.begin(), forged_.end());
  forged_.clear();
  return forged;
}

}  // namespace collided::engine::service
