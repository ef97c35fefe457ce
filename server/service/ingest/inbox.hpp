#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <variant>
#include <vector>

#include "server/service/ingest/object_numbers.hpp"
#include "server/service/ingest/publishers.hpp"
#include "server/service/ingest/samples.hpp"

namespace collided::engine::service {

/// A sign of life or its end from one writer of a publisher.
struct WriterNews {
  std::uint64_t publisher = 0;
  WriterKind kind = WriterKind::object;
  bool alive = false;
};

using Job = std::function<void()>;
using Arrival = std::variant<std::unique_ptr<DefinitionSample>, std::unique_ptr<PoseSample>, WriterNews, Job>;

struct InboxLimits {
  std::size_t batches = 512;    // of poses, waiting as they came
  std::size_t poses = 1 << 20;  // in those batches
  std::size_t merged_objects = 200'000;
  std::size_t merged_publishers = 1'000;
  std::size_t definition_bytes = std::size_t{256} << 20;
  std::size_t jobs = 64;
};

struct InboxCounts {
  std::uint64_t poses_superseded = 0;  // a newer one of the same object took its place while it waited
  std::uint64_t poses_dropped = 0;     // no room even so: one number or publisher too many, or a malformed batch
};

/// From the listeners to the world's thread, in order of arrival. Definitions and news are never dropped (beyond the
/// limit definitions stay with DDS, which keeps the newest of each object); poses beyond the limits are merged, the
/// newest of each object staying, so that a slow world skips ways and never ends.
///
/// threads  any pushes; one drains
class Inbox {
 public:
  explicit Inbox(const InboxLimits& limits = {}) : limits_(limits) {}

  /// An empty sample with room in its vectors, from earlier ones.
  std::unique_ptr<PoseSample> spare();
  void give_back(std::unique_ptr<PoseSample> sample);

  void push(std::unique_ptr<DefinitionSample> sample);
  void push(std::unique_ptr<PoseSample> sample);
  void push(const WriterNews& news);
  /// False: leave definitions where they are for now.
  bool has_room_for_definitions() const;
  /// False: too many jobs wait already.
  [[nodiscard]] bool push_job(Job job);
  void wake();

  /// Takes over all that waits; returns at the latest at the given time, or when woken.
  void drain(std::chrono::steady_clock::time_point until, std::vector<Arrival>& arrivals);
  InboxCounts counts() const;

 private:
  /// The newest pose of each object of a publisher; its memory serves the next time.
  struct Merged {
    std::uint64_t incarnation = 0;
    std::uint64_t sequence = 0;
    std::uint64_t definitions_through = 0;
    std::int64_t source_time_ns = 0;
    std::int64_t received_ns = 0;
    NumberIndex index;
    std::vector<std::uint32_t> numbers;
    std::vector<double> poses;
    std::vector<std::uint8_t> teleported;

    void clear();
  };
  void merge(const PoseSample& sample);
  void merge_pose(Merged& merged, const PoseSample& sample, std::size_t index);
  std::unique_ptr<PoseSample> start_slice(std::uint64_t publisher, const Merged& merged, bool teleported);
  void unpack_merged(std::vector<Arrival>& arrivals);
  std::unique_ptr<PoseSample> spare_locked();

  InboxLimits limits_;
  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  std::vector<Arrival> arrivals_;
  std::vector<std::unique_ptr<PoseSample>> spares_;
  std::map<std::uint64_t, Merged> merged_;  // by publisher
  bool merging_ = false;                    // since the last drain
  std::size_t merged_count_ = 0;
  std::size_t batch_count_ = 0;
  std::size_t pose_count_ = 0;
  std::size_t job_count_ = 0;
  std::size_t definition_bytes_ = 0;
  bool woken_ = false;
  InboxCounts counts_;
};

}  // namespace collided::engine::service
