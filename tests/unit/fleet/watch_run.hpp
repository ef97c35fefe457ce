#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "idl/etcd/etcd_watch.hpp"

namespace collided::testing_support {

/// A watch on a thread of its own, and what it has called.
class WatchRun {
 public:
  WatchRun(etcd::EtcdAddress address, etcd::StoreWatch asked, std::int64_t patience_ns = 300'000'000) {
    asked.changed = [this](const etcd::StoreChange& change) {
      const std::lock_guard lock(mutex_);
      texts_.push_back(change.key + '=' + change.value.value_or("gone") + '@' + std::to_string(change.revision));
    };
    asked.is_over = [this] { return is_over_.load(); };
    asked.problem = [this](const std::string& problem) {
      const std::lock_guard lock(mutex_);
      problems_.push_back(problem);
    };
    thread_ = std::thread([this, address = std::move(address), asked = std::move(asked), patience_ns] {
      end_ = etcd::watch(address, patience_ns, asked);
      has_ended_ = true;
    });
  }
  ~WatchRun() {
    is_over_ = true;
    thread_.join();
  }
  std::vector<std::string> texts() const {
    const std::lock_guard lock(mutex_);
    return texts_;
  }
  std::vector<std::string> problems() const {
    const std::lock_guard lock(mutex_);
    return problems_;
  }
  bool has_ended() const { return has_ended_.load(); }
  etcd::WatchEnd end() const { return end_; }
  /// How long it takes to end.
  std::chrono::nanoseconds stop() {
    const auto began = std::chrono::steady_clock::now();
    is_over_ = true;
    while (!has_ended_) std::this_thread::yield();
    return std::chrono::steady_clock::now() - began;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<std::string> texts_;
  std::vector<std::string> problems_;
  std::atomic<bool> is_over_{false};
  std::atomic<bool> has_ended_{false};
  etcd::WatchEnd end_ = etcd::WatchEnd::over;
  std::thread thread_;
};

}  // namespace collided::testing_support
