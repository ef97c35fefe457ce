#pragma once

#include <condition_variable>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>

#include "client/library/connection/connection.hpp"
#include "client/library/publishing/unacknowledged_poses.hpp"

namespace collided::client {

/// Publishes recorded samples, with a new publisher for each recorded one. Samples get new numbers, since some may be
/// missing from the recording, and so do publishers, since the recorded ones may be alive.
///
/// threads  one calls; statuses of the server arrive on another
class ReplayedPublishers {
 public:
  explicit ReplayedPublishers(Connection& connection);
  /// Removes the objects from the world.
  ~ReplayedPublishers();

  /// Registers a publisher whose samples are due soon, without waiting until the server has discovered it.
  void expect(std::uint64_t recorded, std::uint64_t incarnation);
  /// Waits until the server's readers are matched with all publishers, for a limited time; publish() waits for the
  /// rest.
  void wait_until_read();
  /// Publishes a sample. False if it is a repetition or from an earlier life of its publisher. Throws dds::DdsError.
  bool publish(wire::Definition& definition);
  /// log_time        distinguishes different samples with the same number
  /// source_time_ns  of the poses, since 1970
  bool publish(wire::PoseBatch& batch, std::uint64_t log_time, std::int64_t source_time_ns);
  /// Makes a publisher silent, like the recorded one.
  void lose(std::uint64_t recorded);
  /// Asserts the publishers' liveliness. Call it at least five times a second.
  void keep_alive();
  /// Waits until the server has applied everything published and has noticed every loss; false after `wait`.
  bool wait_applied(std::chrono::nanoseconds wait);
  /// Asks the server why it refuses one of the publishers; empty: it refuses none, or does not answer.
  std::string why_refused() const;

 private:
  struct Publisher {
    Publisher(const ReplayedPublishers& owner, std::uint64_t recorded_incarnation);
    const std::uint64_t number;
    const std::uint64_t incarnation;
    const std::uint64_t recorded_incarnation;
    std::uint64_t sequence = 0;
    std::uint64_t definitions_through = 0;
    std::map<std::uint32_t, std::uint64_t> defined;  // recorded sequence, by object number
    std::set<std::uint32_t> objects;                 // numbers of objects in the world
    std::uint64_t posed = 0, posed_at = 0;           // recorded sequence and time of the newest batch
    UnacknowledgedPoses unacknowledged;
    bool was_read = false;   // the server's readers were matched
    bool is_listed = false;  // the server has listed it
    dds::Writer<wire::Definition> object_writer;
    dds::Writer<wire::PoseBatch> pose_writer;
  };
  static bool is_read(const Publisher& publisher);
  static void remove_objects(Publisher& publisher);
  static void wait_until_heard(Publisher& publisher, Clock::time_point deadline);
  bool wait_for_room(Publisher& publisher);
  Publisher* meet(std::uint64_t recorded, std::uint64_t incarnation);
  void leave(Publisher& publisher);
  void hear(const wire::Status& status);
  bool all_applied() const;

  Connection& connection_;
  dds::Topic<wire::Definition> object_topic_;
  dds::Topic<wire::PoseBatch> pose_topic_;
  dds::Topic<wire::Status> step_topic_;
  std::map<std::uint64_t, std::unique_ptr<Publisher>> publishers_;  // by the recorded number
  std::set<std::uint64_t> leaving_;  // numbers of publishers whose loss the server has not noticed yet

  mutable std::mutex mutex_;
  std::condition_variable came_;
  std::map<std::uint64_t, std::uint64_t> applied_;  // by number
  std::set<std::uint64_t> lost_;
  std::set<std::uint64_t> listed_;
  int observer_ = 0;
  std::unique_ptr<dds::Reader<wire::Status>> step_reader_;
};

}  // namespace collided::client
