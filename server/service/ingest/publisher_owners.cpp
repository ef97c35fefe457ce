#include "server/service/ingest/publisher_owners.hpp"

namespace collided::engine::service {

bool PublisherOwners::claim(std::uint64_t publisher, const NumberOwner& owner, std::uint64_t writer) {
  const std::lock_guard lock(mutex_);
  const std::uint64_t participant = owner.participant;
  const auto found = owners_.find(publisher);
  if (found != owners_.end() && found->second.participant == participant) {
    found->second.writers.insert(writer);
    return true;
  }
  const bool is_free = found == owners_.end() && may_hold(publisher, owner);
  if (is_free && number_count_[participant] < kMostOfOne) {
    ++number_count_[participant];
    if (!owner.keys_of.empty()) remember(publisher, owner.keys_of);
    owners_[publisher] = {.participant = participant, .writers = {writer}};
    return true;
  }
  constexpr std::size_t kMostNamed = 8;
  if (!is_free && forged_.size() < kMostNamed) forged_.insert(publisher);
  refused_.fetch_add(1, std::memory_order_relaxed);
  return false;
}

/// With mutex_ held, here and below.
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

void PublisherOwners::release(std::uint64_t publisher, std::uint64_t writer) {
  const std::lock_guard lock(mutex_);
  const auto found = owners_.find(publisher);
  if (found == owners_.end() || found->second.writers.erase(writer) == 0 || !found->second.writers.empty()) return;
  const auto count = number_count_.find(found->second.participant);
  if (--count->second == 0) number_count_.erase(count);
  owners_.erase(found);
}

std::vector<std::uint64_t> PublisherOwners::take_forged() {
  const std::lock_guard lock(mutex_);
  const std::vector<std::uint64_t> forged(forged_.begin(), forged_.end());
  forged_.clear();
  return forged;
}

}  // namespace collided::engine::service
