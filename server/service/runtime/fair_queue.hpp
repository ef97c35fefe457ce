#pragma once

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "server/service/runtime/crew.hpp"
#include "server/service/runtime/ring.hpp"

namespace collided::engine::service {

/// The owner and size of a work item.
struct Share {
  std::uint64_t client = 0;
  std::uint64_t owner = 0;  // of the client: owners share evenly, and so do the clients of one; 0: its own
  double cost = 1;          // above 0, in any unit that is the same for all
  std::size_t bytes = 0;    // held while it waits
  bool is_kept = false;     // accepted while any room is left, up to three quarters of it for one owner
  bool is_begun = false;    // part of an accepted request: accepted even if no room is left
};

/// Work of many clients for several threads. Owners with work share the threads evenly by cost, regardless of the
/// number of their clients and of their items: a client with one question overtakes another's thousands. An owner may
/// have as much waiting as is still free, in items and in bytes, so one alone fills at most half of the room, two a
/// third each, and a later one still finds some.
///
/// source   Goyal, Vin, Cheng, "Start-time Fair Queuing", 1996; Choudhury, Hahne, "Dynamic Queue Length Thresholds for
///          Shared-Memory Packet Switches", 1998
/// threads  any
/// memory   only grows, up to `limit` items: none is allocated once as much has waited before
template <class Item>
class FairQueue {
 public:
  explicit FairQueue(std::size_t limit, std::size_t most_bytes = std::numeric_limits<std::size_t>::max())
      : limit_(limit), most_bytes_(most_bytes) {
    flows_.reserve(kFewFlows);
  }

  /// Runs threads of its own that take the items; each is started when work waits and no other is free.
  ///
  /// begin  as for Crew; a shift calls pop() until it returns nothing
  void staff(std::size_t most, std::function<Crew::Shift()> begin) {
    const std::lock_guard lock(mutex_);
    crew_.emplace(most, std::move(begin));
    spare_.store(most, std::memory_order_relaxed);
  }

  /// Adds the server's own work, which precedes all clients' and is not limited: ask has_room_for_own().
  void push_own(Item item) {
    {
      const std::lock_guard lock(mutex_);
      static_cast<void>(has_hands());
      own_.push_back(std::move(item));
      ++own_count_;
    }
    arrived_.notify_one();
  }
  /// False: no room for this owner, or no thread can be started for it; the item is unchanged.
  [[nodiscard]] bool push(const Share& share, Item& item) {
    {
      const std::lock_guard lock(mutex_);
      Flow& flow = flow_of(share.client);
      if ((!share.is_begun && !has_room_for(share, flow)) || !has_hands()) {
        ++refused_;
        return false;
      }
      flow.owner = share.owner;
      const double start = std::max(now_, flow.finish);
      flow.finish = start + share.cost * rivals_of(flow);
      flow.bytes += share.bytes;
      flow.entries.push_back({std::move(item), start, share});
      waiting_.fetch_add(1, std::memory_order_relaxed);
      waiting_bytes_.fetch_add(share.bytes, std::memory_order_relaxed);
      waiting_cost_ += share.cost;
    }
    arrived_.notify_one();
    return true;
  }

  /// Whether push() would accept it now. Items pushed with is_begun after this was true exceed the limit by at most the
  /// number of pushing threads.
  bool has_room_for(const Share& share) {
    const std::lock_guard lock(mutex_);
    const bool has_room = has_room_for(share, flow_of(share.client));
    refused_ += has_room ? 0 : 1;
    return has_room;
  }
  /// Whether clients have any room; without the lock, so a push() may still be refused.
  bool has_room() const {
    return waiting_.load(std::memory_order_relaxed) < limit_ &&
           waiting_bytes_.load(std::memory_order_relaxed) < most_bytes_;
  }
  /// Whether any of the server's own work waits.
  bool has_own() const { return own_count_.load(std::memory_order_relaxed) > 0; }
  /// Whether less of the server's own work waits than the limit allows.
  bool has_room_for_own() const { return own_count_.load(std::memory_order_relaxed) < limit_; }
  std::size_t waiting() const { return waiting_.load(std::memory_order_relaxed); }
  /// Threads that wait in pop(), or are not started yet.
  std::size_t idle() const { return idle_.load(std::memory_order_relaxed) + spare_.load(std::memory_order_relaxed); }
  /// See staff().
  std::size_t most_threads() const { return crew_ ? crew_->most() : 0; }
  std::size_t waiting_bytes() const { return waiting_bytes_.load(std::memory_order_relaxed); }
  double waiting_cost() {
    const std::lock_guard lock(mutex_);
    return waiting_cost_;
  }
  /// How often push() returned false.
  std::uint64_t refused() const { return refused_.load(std::memory_order_relaxed); }

  /// Waits for an item; nothing once the queue is closed and empty.
  std::optional<Item> pop() {
    std::unique_lock lock(mutex_);
    idle_.fetch_add(1, std::memory_order_relaxed);
    arrived_.wait(lock, [&] { return closed_ || !own_.empty() || waiting() > 0; });
    idle_.fetch_sub(1, std::memory_order_relaxed);
    if (!own_.empty()) {
      --own_count_;
      return own_.pop_front();
    }
    if (waiting() == 0) return std::nullopt;
    return pop_fairly();
  }
  /// Ends the waiting in pop(), which still returns the remaining items.
  void close() {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    arrived_.notify_all();
  }
  /// Closes it, and waits until its threads have taken the remaining items.
  void finish() {
    close();
    if (crew_) crew_->join();
  }

 private:
  static constexpr std::size_t kFewFlows = 16;
  static constexpr std::size_t kMostFlows = 4'096;  // client numbers come from outside

  struct Entry {
    Item item{};
    double start = 0;
    Share share{};
  };
  struct Flow {
    std::uint64_t client = 0;
    std::uint64_t owner = 0;
    std::size_t bytes = 0;  // of its entries
    double finish = 0;      // of the last entry: earliest start of the next one
    Ring<Entry> entries;
  };

  /// Whether a thread will take one more item: starts one if all are busy.
  bool has_hands() {
    if (!crew_ || closed_ || waiting() + own_count_ < idle_.load(std::memory_order_relaxed)) return true;
    const bool is_there = crew_->grow();
    spare_.store(crew_->spare(), std::memory_order_relaxed);
    return is_there;
  }

  bool has_room_for(const Share& share, const Flow& own) const {
    std::size_t entries = own.entries.size();
    std::size_t flow_bytes = own.bytes;
    for (const Flow& flow : flows_) {
      if (&flow == &own || share.owner == 0 || flow.owner != share.owner) continue;
      entries += flow.entries.size();
      flow_bytes += flow.bytes;
    }
    const std::size_t waiting = waiting_.load(std::memory_order_relaxed);
    const std::size_t bytes = waiting_bytes_.load(std::memory_order_relaxed);
    const std::size_t free = limit_ - std::min(limit_, waiting);
    const std::size_t free_bytes = most_bytes_ - std::min(most_bytes_, bytes);
    const std::size_t most = share.is_kept ? limit_ - limit_ / 4 : free;
    const std::size_t most_bytes = share.is_kept ? most_bytes_ - most_bytes_ / 4 : free_bytes;
    return free > 0 && free_bytes > 0 && entries < most && flow_bytes < most_bytes;
  }

  /// How many clients of this flow's owner have work, including itself.
  double rivals_of(const Flow& flow) const {
    double rivals = 1;
    if (flow.owner == 0) return rivals;
    for (const Flow& other : flows_) {
      if (&other != &flow && other.owner == flow.owner && !other.entries.empty()) rivals += 1;
    }
    return rivals;
  }

  /// The client's flow. An idle one whose last finish has been reached no longer matters and is given to the next
  /// client.
  Flow& flow_of(std::uint64_t client) {
    Flow* idle = nullptr;
    for (Flow& flow : flows_) {
      if (flow.client == client) return flow;
      if (flow.entries.empty() && (idle == nullptr || flow.finish < idle->finish)) idle = &flow;
    }
    const bool is_past = idle != nullptr && idle->finish <= now_;
    if (idle == nullptr || (!is_past && flows_.size() < kMostFlows)) idle = &flows_.emplace_back();
    idle->client = client;
    idle->finish = now_;
    return *idle;
  }

  /// Takes the entry with the earliest start. Mostly few clients have work at a time, so a linear search is enough.
  Item pop_fairly() {
    Flow* first = nullptr;
    double earliest = std::numeric_limits<double>::infinity();
    for (Flow& flow : flows_) {
      if (flow.entries.empty() || flow.entries.front().start >= earliest) continue;
      earliest = flow.entries.front().start;
      first = &flow;
    }
    Entry entry = first->entries.pop_front();
    waiting_.fetch_sub(1, std::memory_order_relaxed);
    waiting_bytes_.fetch_sub(entry.share.bytes, std::memory_order_relaxed);
    waiting_cost_ -= entry.share.cost;
    first->bytes -= entry.share.bytes;
    now_ = entry.start;
    if (waiting() == 0) {
      // Nothing waits: all clients start equal again.
      for (const Flow& flow : flows_) now_ = std::max(now_, flow.finish);
      waiting_cost_ = 0;
    }
    return std::move(entry.item);
  }

  std::mutex mutex_;
  std::condition_variable arrived_;
  std::vector<Flow> flows_;
  Ring<Item> own_;
  double now_ = 0;                       // virtual time: start of the entry handed out last
  std::atomic<std::size_t> waiting_{0};  // of all flows; read without the lock where it need not be exact
  std::atomic<std::size_t> own_count_{0};
  std::atomic<std::size_t> idle_{0};
  std::atomic<std::size_t> spare_{0};  // of the crew
  std::atomic<std::uint64_t> refused_{0};
  std::atomic<std::size_t> waiting_bytes_{0};
  double waiting_cost_ = 0;
  std::size_t limit_;
  std::size_t most_bytes_;
  bool closed_ = false;
  std::optional<Crew> crew_;
};

}  // namespace collided::engine::service
