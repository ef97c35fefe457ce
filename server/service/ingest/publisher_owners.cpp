#include "server/service/ingest/publisher_owners.hpp"

namespace collided::engine::service {

bool PublisherOwners::claim(std::uint64_t publisher, std::uint64_t participant, std::uint64_t writer) {
  const std::lock_guard lock(mutex_);
  const auto found = owners_.find(publisher);
  if (found != owners_.end() && found->second.participant == participant) {
    found->second.writers.insert(writer);
    return true;
  }
  if (found == owners_.end() && number_count_[participant] < kMostOfOne) {
    ++number_count_[participant];
    owners_[publisher] = {.participant = participant, .writers = {writer}};
    return true;
  }
  constexpr std::size_t kMostNamed = 8;
  if (found != owners_.end() && forged_.size() < kMostNamed) forged_.insert(publisher);
  refused_.fetch_add(1, std::memory_order_relaxed);
  return false;
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
