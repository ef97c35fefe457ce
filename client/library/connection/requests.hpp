#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "client/library/connection/sample_pool.hpp"
#include "client/library/connection/server_pulse.hpp"
#include "client/library/connection/short_spin.hpp"

namespace collided::client {

/// The requests that wait for replies. A request's number consists of its slot and a count that grows with every use of
/// the slot. A reply therefore finds its slot without a search, and a reply to an abandoned request matches none.
///
/// threads  any
class Requests {
  struct Slot {
    std::mutex mutex;
    std::condition_variable came;
    std::uint64_t request = 0;  // 0: none
    std::atomic<bool> has_replies{false};
    std::vector<SamplePool<wire::Reply>::Pointer> replies;
    dds::Sample<wire::Query> query;  // the slot reuses the memory of these three
    std::vector<double> numbers;
    std::vector<double> columns;
  };

 public:
  static constexpr std::size_t kMost = 1'024;  // requests at a time

  /// A request that waits for replies. After its destruction, replies to it are dropped. For one thread at a time.
  class Running {
   public:
    Running(Requests& requests, Slot& slot, std::uint64_t number) : requests_(requests), slot_(slot), number_(number) {}
    ~Running() { requests_.end(*this); }
    Running(const Running&) = delete;
    Running& operator=(const Running&) = delete;

    std::uint64_t number() const { return number_; }
    /// The sample to send. Set all its fields, which have the values of an earlier request.
    wire::Query& query() { return *slot_.query; }
    /// Memory for the numbers of a chunk, by question and by column.
    std::vector<double>& numbers() { return slot_.numbers; }
    std::vector<double>& columns() { return slot_.columns; }
    /// Makes wait() sleep at once, for replies that take long.
    void sleep_while_waiting() { spins_ = false; }
    /// Returns the replies since the last call. Waits for the first; empty if none comes before `deadline`.
    const std::vector<SamplePool<wire::Reply>::Pointer>& wait(Clock::time_point deadline);

   private:
    friend class Requests;
    Requests& requests_;
    Slot& slot_;
    std::uint64_t number_;
    bool spins_ = true;
    std::vector<SamplePool<wire::Reply>::Pointer> taken_;
  };

  using IsFromServer = std::function<bool(const dds::Sample<wire::Reply>&)>;
  /// client          the client to which replies must be addressed; others in its partition are ignored
  /// is_from_server  true if the server wrote the reply; others are ignored
  Requests(std::uint64_t client, IsFromServer is_from_server);
  /// Begins a request; null if kMost are waiting.
  std::unique_ptr<Running> begin();
  /// For the reply reader's callback: takes all samples and wakes the threads that wait for them.
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
  const IsFromServer is_from_server_;
  std::vector<std::uint64_t> uses_;
  SamplePool<wire::Reply> pool_;
  ShortSpin spin_;
  std::array<SamplePool<wire::Reply>::Pointer, 4> next_;  // used only by the callback
};

}  // namespace collided::client
