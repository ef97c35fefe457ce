#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "idl/etcd/lease_store.hpp"

namespace collided::engine::service::test {

/// A store in memory, by a clock of the test's. A call may fail before it does anything, or after: then it is done, and
/// the answer is lost.
class FakeLeaseStore : public etcd::LeaseStore {
 public:
  enum class Fault : std::uint8_t { none, before, after };

  std::int64_t grant(int life_s) override {
    const std::lock_guard lock(mutex_);
    begin();
    leases_[++newest_lease_] = {.life_ns = life_s * kSecondNs, .until_ns = now_ns_ + life_s * kSecondNs};
    return end(newest_lease_);
  }
  bool renew(std::int64_t lease) override {
    const std::lock_guard lock(mutex_);
    begin();
    const auto found = leases_.find(lease);
    if (found != leases_.end()) found->second.until_ns = now_ns_ + found->second.life_ns;
    return end(found != leases_.end());
  }
  void revoke(std::int64_t lease) override {
    const std::lock_guard lock(mutex_);
    begin();
    drop(lease);
    end(true);
  }
  etcd::StoreResult transact(const etcd::StoreTransaction& transaction) override {
    const std::lock_guard lock(mutex_);
    begin();
    etcd::StoreResult result{.is_done = true};
    for (const etcd::StoreCondition& condition : transaction.conditions) result.is_done &= holds(condition);
    for (const etcd::StoreWrite& write : transaction.writes)
      if (result.is_done) keys_[write.key] = {write.value, write.lease, ++newest_revision_};
    for (const std::string& key : transaction.reads) {
      result.values.push_back(keys_.contains(key) ? std::optional(keys_[key].value) : std::nullopt);
      result.revisions.push_back(keys_.contains(key) ? keys_[key].revision : 0);
    }
    return end(result);
  }

  void advance(std::int64_t by_ns) {
    const std::lock_guard lock(mutex_);
    now_ns_ += by_ns;
    expire();
  }
  std::int64_t now_ns() const {
    const std::lock_guard lock(mutex_);
    return now_ns_;
  }
  /// Of the next call; `lasts`: of all until it is set anew.
  void fail(Fault fault, bool lasts = false) {
    const std::lock_guard lock(mutex_);
    fault_ = fault;
    lasts_ = lasts;
  }
  std::optional<std::string> value(const std::string& key) const {
    const std::lock_guard lock(mutex_);
    const auto found = keys_.find(key);
    return found == keys_.end() ? std::nullopt : std::optional(found->second.value);
  }
  void set(const std::string& key, const std::string& value) {
    const std::lock_guard lock(mutex_);
    keys_[key] = {value, 0, ++newest_revision_};
  }
  void clear() {
    const std::lock_guard lock(mutex_);
    keys_.clear();
    leases_.clear();
  }

 private:
  static constexpr std::int64_t kSecondNs = 1'000'000'000;
  struct Key {
    std::string value;
    std::int64_t lease = 0;
    std::int64_t revision = 0;
  };
  struct LeaseLife {
    std::int64_t life_ns = 0;
    std::int64_t until_ns = 0;
  };

  bool holds(const etcd::StoreCondition& condition) const {
    const auto found = keys_.find(condition.key);
    if (condition.is == etcd::StoreCondition::Is::absent) return found == keys_.end();
    if (found == keys_.end()) return false;
    if (condition.is == etcd::StoreCondition::Is::revision) return found->second.revision == condition.revision;
    return condition.is == etcd::StoreCondition::Is::less ? found->second.value < condition.value
                                                          : found->second.value == condition.value;
  }
  void begin() {
    if (fault_ != Fault::before) return;
    if (!lasts_) fault_ = Fault::none;
    throw etcd::StoreError("the store is away");
  }
  template <class T>
  T end(T result) {
    if (fault_ == Fault::none) return result;
    if (!lasts_) fault_ = Fault::none;
    throw etcd::StoreError("the answer is lost");
  }
  void drop(std::int64_t lease) {
    leases_.erase(lease);
    std::erase_if(keys_, [lease](const auto& entry) { return entry.second.lease == lease; });
  }
  void expire() {
    for (auto at = leases_.begin(); at != leases_.end();) {
      const auto here = at++;
      if (here->second.until_ns <= now_ns_) drop(here->first);
    }
  }

  mutable std::mutex mutex_;
  std::int64_t now_ns_ = kSecondNs;
  Fault fault_ = Fault::none;
  bool lasts_ = false;
  std::int64_t newest_lease_ = 0;
  std::int64_t newest_revision_ = 0;
  std::map<std::int64_t, LeaseLife> leases_;
  std::map<std::string, Key> keys_;
};

}  // namespace collided::engine::service::test
