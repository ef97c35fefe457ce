#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "client/library/connection/connection.hpp"
#include "client/library/recordings/recorded_loss.hpp"
#include "client/library/recordings/recording_queue.hpp"
#include "collided/recording.hpp"
#include "idl/mcap/output.hpp"
#include "idl/mcap/writer.hpp"
#include "idl/recording/opening_commands.hpp"

namespace collided {

/// Readers of every topic of a namespace, and a thread that writes the samples to a file. The readers slow down no
/// writer: questions are read best-effort, since a stalled reliable reader would block the clients; the writers of all
/// other topics keep only their newest samples and do not block.
struct [[gnu::visibility("hidden")]] Recording::State {
  static Result<std::unique_ptr<State>> start(std::shared_ptr<client::Connection> connection, const std::string& path);
  ~State();

  RecordingCounts counts() const;
  Result<RecordingCounts> finish();
  Result<void> write(const OwnChannel& channel, std::string_view message);
  const std::shared_ptr<client::Connection>& connection() const { return connection_; }

 private:
  State(std::shared_ptr<client::Connection> connection, const std::string& path);
  void wait_until_heard() const;
  // Writes the existing world. Returns why that is not possible; empty: done.
  std::string begin_with_opening();
  // True for a command whose effects are in the opening; it is left out of the file.
  bool is_in_opening(const client::RecordingQueue::Entry& entry);
  // The writing thread.
  void run();
  void note_written();
  void add_own_channels();
  // Options of a reader that puts its samples into the queue.
  template <class T>
  dds::ReaderOptions<T> into(recording::Recorded topic, std::string partition = {});
  // Counts missing samples. The overloads that return bool return false for a sample that is not recorded.
  void hear(const wire::Definition& sample);
  void hear(const wire::PoseBatch& sample);
  bool hear(const wire::Query& sample);
  bool hear(const wire::Reply& sample);
  void hear(const wire::EventFrame& sample);
  void hear(const wire::StandingFrame& sample);
  bool hear(const wire::StandingShard& sample);
  void hear(const wire::Status& sample);
  void note_standing_command(const wire::Query& sample);

  std::shared_ptr<client::Connection> connection_;
  mcap::FileOutput output_;
  mcap::FileWriter writer_;
  client::RecordingQueue queue_;
  std::set<recording::CommandNumber> opening_commands_;  // possibly received as well; used by the writing thread
  std::atomic<bool> stopping_{false};

  mutable std::mutex mutex_;  // guards the members from here to the topics
  client::RecordedLoss loss_;
  client::RecordedLoss standing_loss_;  // of events of standing questions, which are numbered separately
  std::uint64_t epoch_ = 0;             // of the newest status
  std::deque<std::pair<std::uint64_t, std::uint64_t>>
      standing_commands_;  // client and request, without an answer so far
  std::vector<OwnChannel> own_;
  std::size_t own_in_file_ = 0;
  std::array<std::uint64_t, client::RecordingQueue::kChannels> given_{};
  RecordingCounts written_;
  bool finished_ = false;

  dds::Topic<wire::Definition> object_topic_;
  dds::Topic<wire::PoseBatch> pose_topic_;
  dds::Topic<wire::Query> query_topic_;
  dds::Topic<wire::Reply> reply_topic_;
  dds::Topic<wire::EventFrame> event_topic_;
  dds::Topic<wire::ContactShard> contact_topic_;
  dds::Topic<wire::ProbeFrame> probe_topic_;
  dds::Topic<wire::Status> status_topic_, step_topic_;
  dds::Topic<wire::StandingFrame> standing_event_topic_;
  dds::Topic<wire::StandingShard> standing_state_topic_;
  struct Readers;
  std::unique_ptr<Readers> readers_;
  std::thread thread_;
};

}  // namespace collided
