#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <utility>
#include <variant>
#include <vector>

#include "server/service/ingest/object_numbers.hpp"
#include "server/service/ingest/publishers.hpp"
#include "server/service/ingest/samples.hpp"

namespace collided::engine::service {

/// One of a publisher's two writers has come alive, or is gone.
struct WriterNews {
  std::uint64_t publisher = 0;
  WriterKind kind = WriterKind::object;
  bool alive = false;  // false: closed, or its lease ran out
};

/// Work for the world's thread, such as a command that changes the world.
using Job = std::function<void()>;
/// An item that the world's thread takes from the inbox.
using Arrival = std::variant<std::unique_ptr<DefinitionSample>, std::unique_ptr<PoseSample>, WriterNews, Job>;

/// Limits on what waits for the world's thread. Beyond them poses are merged, definitions stay with DDS, jobs are
/// refused.
struct InboxLimits {
  std::size_t batches = 512;             // of poses, unmerged
  std::size_t poses = 1 << 20;           // in those batches
  std::size_t own_batches = 8;           // of one publisher, unmerged while others have reached the limits
  std::size_t merged_objects = 200'000;  // of all publishers together
  std::size_t merged_publishers = 1'000;
  std::size_t definition_bytes = std::size_t{256} << 20;  // samples with their encoded shapes
  std::size_t jobs = 64;
};

/// Poses that never reach the world's thread; the counts only grow.
struct InboxCounts {
  std::uint64_t poses_superseded = 0;  // a newer pose of the same object replaced it while it waited
  std::uint64_t poses_dropped = 0;  // merging had no room either: an object or publisher too many; or a malformed batch
};

/// The queue from the listeners to the world's thread. It is taken in rounds: one instant's poses of each publisher, so
/// that a publisher that has sent a hundred instants at once does not keep the others waiting while the world steps
/// through them. Samples of one publisher stay in order; definitions, news and jobs come after everything that arrived
/// before them, and before everything after.
///
/// Definitions and news are never dropped: beyond the limit definitions stay with DDS, which keeps the newest of each
/// object. Poses beyond the limits are merged to the newest of each object, so a slow world skips motion in between
/// while its memory stays bounded. A publisher that has sent little is not merged because others have sent much, until
/// twice the limit waits.
///
/// threads  any may push; one takes
class Inbox {
 public:
  explicit Inbox(const InboxLimits& limits = {}) : limits_(limits) {}

  /// A sample to fill, with the memory of an earlier one if there is one; its old values are still in it.
  std::unique_ptr<PoseSample> spare();
  /// Keeps the sample's memory for a later spare().
  void give_back(std::unique_ptr<PoseSample> sample);

  /// Accepted even beyond the limit: ask has_room_for_definitions() first.
  void push(std::unique_ptr<DefinitionSample> sample);
  /// Merged with waiting ones if the limits are reached.
  void push(std::unique_ptr<PoseSample> sample);
  void push(const WriterNews& news);
  /// False: leave definitions with DDS for now.
  bool has_room_for_definitions() const;
  /// False: too many jobs wait already, and this one is refused.
  [[nodiscard]] bool push_job(Job job);
  /// Accepted even beyond the limit: for jobs of the server itself, of which few wait at a time.
  void push_own_job(Job job);
  /// Makes the waiting take_round(), or else the next one, return at once.
  void wake();

  /// Moves the next round into `arrivals`, which is cleared first; merged poses come once nothing else of their
  /// publisher waits. Waits for something to arrive, at most until the given time; then, or when woken, it returns
  /// nothing.
  void take_round(std::chrono::steady_clock::time_point until, std::vector<Arrival>& arrivals);
  /// Any thread.
  InboxCounts counts() const;

 private:
  /// The newest pose of each object of one publisher. clear() keeps the memory for the next time.
  struct Merged {
    std::uint64_t incarnation = 0;  // of all the poses here
    std::uint64_t sequence = 0;     // the greatest merged
    std::uint64_t definitions_through = 0;
    std::int64_t source_time_ns = 0;  // of the batch merged last that has a time
    std::int64_t received_ns = 0;
    std::uint8_t flags = 0;                  // those about the publisher, not the batch
    NumberIndex index;                       // object number to place
    std::vector<std::uint32_t> numbers;      // object numbers, by place
    std::vector<double> poses;               // kPoseNumbers each, by place
    std::vector<std::uint8_t> teleported;    // 1: a pose merged here was a teleport
    std::vector<std::uint8_t> has_replaced;  // by place: 1: the pose replaced an earlier one
    std::uint32_t replaced = 0;              // poses replaced by newer ones

    void clear();
  };
  /// One publisher's waiting samples, in order; the queue keeps its memory.
  struct PublisherLine {
    struct Waiting {
      std::uint64_t place = 0;  // among all arrivals
      std::unique_ptr<PoseSample> sample;
    };
    std::vector<Waiting> queue;
    std::size_t head = 0;     // the first not taken of the queue
    bool is_merging = false;  // poses were merged since the queue was last empty

    bool empty() const { return head == queue.size(); }
    std::size_t size() const { return queue.size() - head; }
    std::uint64_t first_place() const { return queue[head].place; }
    std::unique_ptr<PoseSample> pop();
  };
  bool must_merge(const PublisherLine& line, std::size_t poses) const;
  void merge(const PoseSample& sample);
  void merge_pose(Merged& merged, const PoseSample& sample, std::size_t index);
  std::unique_ptr<PoseSample> start_slice(std::uint64_t publisher, const Merged& merged, bool teleported);
  void push_in_order(Arrival arrival);
  void take_instants(std::vector<Arrival>& arrivals);
  void take_ordered(std::vector<Arrival>& arrivals);
  void unpack_merged(std::vector<Arrival>& arrivals);
  void unpack(std::uint64_t publisher, Merged& merged, std::vector<Arrival>& arrivals);
  void forget_idle_lines();
  std::unique_ptr<PoseSample> spare_locked();

  InboxLimits limits_;
  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  std::unordered_map<std::uint64_t, PublisherLine> lines_;  // by publisher
  std::vector<PublisherLine*> busy_;                        // those with something in the queue
  /// Definitions, news and jobs, each with its place among all arrivals.
  std::deque<std::pair<std::uint64_t, Arrival>> ordered_;
  std::uint64_t next_place_ = 0;
  std::vector<std::unique_ptr<PoseSample>> spares_;
  std::map<std::uint64_t, Merged> merged_;  // by publisher
  std::size_t merging_lines_ = 0;
  std::size_t merged_count_ = 0;  // objects in merged_
  std::size_t batch_count_ = 0;   // these four: waiting items
  std::size_t pose_count_ = 0;
  std::size_t job_count_ = 0;
  std::size_t definition_bytes_ = 0;
  bool woken_ = false;
  InboxCounts counts_;
};

}  // namespace collided::engine::service
