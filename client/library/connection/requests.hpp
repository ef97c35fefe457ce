#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "client/library/connection/sample_pool.hpp"
#include "client/library/connection/server_pulse.hpp"
#include "client/library/connection/short_spin.hpp"

namespace collided::client {

/// The requests under way. A request's number is its slot plus a count that grows with every use of the slot: a reply
/// finds its slot without a search, and one that comes after its request gave up fits none.
class Requests {
  struct Slot {
    std::mutex mutex;
    std::condition_variable came;
    std::uint64_t request = 0;  // 0: nobody waits
    std::atomic<bool> has_replies{false};
    std::vector<SamplePool<wire::Reply>::Pointer> replies;
    dds::Sample<wire::Query> query;  // its memory stays with the slot
    std::vector<double> numbers;     // the same
    std::vector<double> columns;     // the same
  };

 public:
  static constexpr std::size_t kMost = 1'024;

  /// One request under way; replies to it are dropped once this is gone.
  class Running {
   public:
    Running(Requests& requests, Slot& slot, std::uint64_t number) : requests_(requests), slot_(slot), number_(number) {}
    ~Running() { requests_.end(*this); }
    Running(const Running&) = delete;
    Running& operator=(const Running&) = delete;

    std::uint64_t number() const { return number_; }
    /// Fields keep what an earlier request left: set them all.
    wire::Query& query() { return *slot_.query; }
    /// Of a chunk.
    std::vector<double>& numbers() { return slot_.numbers; }
    std::vector<double>& columns() { return slot_.columns; }
    /// The replies will take their time.
    void sleep_while_waiting() { spins_ = false; }
    /// Replies that came since the last call; waits for one until `deadline`, then none.
    const std::vector<SamplePool<wire::Reply>::Pointer>& wait(Clock::time_point deadline);

   private:
    friend class Requests;
    Requests& requests_;
    Slot& slot_;
    std::uint64_t number_;
    bool spins_ = true;
    std::vector<SamplePool<wire::Reply>::Pointer> taken_;
  };

  /// client  whose replies are taken; others may come with them
  explicit Requests(std::uint64_t client);
  /// Null when kMost requests are under way.
  std::unique_ptr<Running> begin();
  /// For the reply reader's callback: takes everything and wakes whom it concerns.
  void take_replies(const dds::Taker<wire::Reply>& taker);

 private:
  void hand_over(SamplePool<wire::Reply>::Pointer reply);
  void end(Running& running);
  void recycle(std::vector<SamplePool<wire::Reply>::Pointer>& replies);

  std::array<std::atomic<Slot*>, kMost> slots_{};
  std::mutex mutex_;
  std::vector<std::unique_ptr<Slot>> owned_;
  std::vector<std::size_t> free_;
  const std::uint64_t client_;
  std::vector<std::uint64_t> uses_;
  SamplePool<wire::Reply> pool_;
  ShortSpin spin_;
  std::array<SamplePool<wire::Reply>::Pointer, 4> next_;  // the callback's own
};

}  // namespace collided::client
