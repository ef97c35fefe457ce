#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

#include "idl/dds.hpp"
#include "server/service/runtime/work_queue.hpp"

namespace collided::engine::service {

/// What a command did to the world, as the command that does it again elsewhere.
struct WorldChange {
  std::string text;  // JSON
  std::vector<std::byte> blob;
};

/// Tells the servers that follow this one what its commands do: in order, each once, numbered without a gap. Costs nothing
/// while nobody follows.
///
/// threads  any; writing is done on a thread of its own, so that a slow follower delays nobody
class ChangeFeed {
 public:
  ChangeFeed(const dds::Participant& participant, std::uint64_t server, const std::string& name_space);
  ~ChangeFeed();
  ChangeFeed(const ChangeFeed&) = delete;
  ChangeFeed& operator=(const ChangeFeed&) = delete;

  bool is_followed() const { return writer_.matched_readers() > 0; }
  /// This server has taken another's place, of whose changes it has carried out so many: the next one follows on those, for
  /// whoever followed that one.
  void continue_from(std::uint64_t sequence);
  /// A change that was made, in the order of the calls. More than kMostWaiting that a follower does not take are dropped,
  /// which it sees by the numbers.
  void tell(WorldChange change);
  /// All that is kept, to one follower, as of the calls of tell() before.
  void tell_all(std::uint64_t follower, std::uint64_t fetch, std::vector<WorldChange> kept);

 private:
  static constexpr std::size_t kMostWaiting = 4'096;  // of those to all followers
  struct FeedMessage {
    std::uint64_t follower = 0;  // 0: all of them
    std::uint64_t fetch = 0;
    std::uint64_t sequence_number = 0;
    std::uint64_t left = 0;
    WorldChange change;
  };
  void write(const FeedMessage& message);

  dds::Topic<wire::Change> topic_;
  dds::Writer<wire::Change> writer_;
  dds::Sample<wire::Change> sample_;  // of the thread
  std::atomic<bool> is_over_{false};
  std::mutex mutex_;  // numbers and queues in one
  std::uint64_t last_sequence_ = 0;
  std::atomic<std::size_t> waiting_{0};  // of those to all followers; what is kept is sent whole, however much it is
  WorkQueue<FeedMessage> messages_;
};

}  // namespace collided::engine::service
