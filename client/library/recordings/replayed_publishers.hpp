#pragma once

#include <condition_variable>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <set>

#include "client/library/connection/connection.hpp"
#include "client/library/publishing/unacknowledged_poses.hpp"

namespace collided::client {

/// Publishes recorded samples as publishers of its own, one for each that was recorded, numbered anew: some samples may be
/// missing from the recording, and its publishers may be alive.
///
/// threads  one calls; the server's word comes on another
class ReplayedPublishers {
 public:
  explicit ReplayedPublishers(Connection& connection);
  /// Takes its objects out of the world.
  ~ReplayedPublishers();

  /// True: published; false: said before, or of a publisher's earlier life. Throws dds::DdsError.
  bool publish(wire::Definition& definition);
  /// log_time  tells samples of one number apart that are not the same; source_time_ns  since 1970
  bool publish(wire::PoseBatch& batch, std::uint64_t log_time, std::int64_t source_time_ns);
  /// Lets a publisher fall silent, as the recorded one did.
  void lose(std::uint64_t recorded);
  /// At least five times a second.
  void keep_alive();
  /// Until the server's state has all that was published and lacks whom was lost; false after `wait`.
  bool wait_applied(std::chrono::nanoseconds wait);

 private:
  struct Publisher {
    Publisher(const ReplayedPublishers& owner, std::uint64_t recorded_incarnation);
    const std::uint64_t number;
    const std::uint64_t incarnation;
    const std::uint64_t recorded_incarnation;
    std::uint64_t sequence = 0;
    std::uint64_t definitions_through = 0;
    std::map<std::uint32_t, std::uint64_t> defined;  // recorded sequence, by object number
    std::set<std::uint32_t> objects;                 // that are there
    std::uint64_t posed = 0, posed_at = 0;           // recorded sequence and time of the newest batch
    UnacknowledgedPoses unacknowledged;
    dds::Writer<wire::Definition> object_writer;
    dds::Writer<wire::PoseBatch> pose_writer;
  };
  Publisher* meet(std::uint64_t recorded, std::uint64_t incarnation);
  void leave(Publisher& publisher);
  void hear(const wire::Status& status);
  bool all_applied() const;

  Connection& connection_;
  dds::Topic<wire::Definition> object_topic_;
  dds::Topic<wire::PoseBatch> pose_topic_;
  dds::Topic<wire::Status> step_topic_;
  std::map<std::uint64_t, std::unique_ptr<Publisher>> publishers_;  // by the recorded number
  std::set<std::uint64_t> leaving_;                                 // numbers that the server must still lose

  mutable std::mutex mutex_;
  std::condition_variable came_;
  std::map<std::uint64_t, std::uint64_t> applied_;  // by number
  std::set<std::uint64_t> lost_;
  std::set<std::uint64_t> listed_;
  int observer_ = 0;
  std::unique_ptr<dds::Reader<wire::Status>> step_reader_;
};

}  // namespace collided::client
