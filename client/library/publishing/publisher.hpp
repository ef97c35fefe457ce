#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "client/library/connection/connection.hpp"
#include "client/library/publishing/published_objects.hpp"
#include "client/library/publishing/unacknowledged_poses.hpp"

namespace collided {

/// The messages of one publisher: definitions and pose batches, numbered together. Only the user's calls assert that it
/// is alive, so that a publisher whose user thread hangs counts as lost. After a pause longer than the lease, and for a
/// new server, it defines everything again before it continues.
///
/// threads  any; one mutex
struct [[gnu::visibility("hidden")]] Publisher::State {
  static Result<std::unique_ptr<State>> start(std::shared_ptr<client::Connection> connection, const std::string& name,
                                              const PublishOptions& options);
  ~State();

  /// enters  it was outside, at this pose at the last flush, and enters the world with the next flush
  Result<Object> add(const ObjectOptions& options, bool enters = false);
  Result<Object> claim(const ObjectOptions& options);
  Result<void> remove(Object object);
  Result<void> reshape(Object object, const Shape& shape);
  Result<void> move(Object object, const Pose& pose, bool teleport);
  Result<FlushReport> flush(std::chrono::nanoseconds source_time);
  void stream();
  /// From now on sends each instant even without objects, since some may enter (add() with `enters`).
  void announce();
  Result<void> keep_alive(std::chrono::nanoseconds source_time);
  Result<void> wait_applied(std::chrono::nanoseconds timeout);
  Result<PublisherReport> report(std::chrono::nanoseconds timeout);

 private:
  State(std::shared_ptr<client::Connection> connection, const std::string& name, const PublishOptions& options);
  std::optional<Error> object_fault(const ObjectOptions& options) const;
  Result<Object> define(const ObjectOptions& options, std::vector<std::uint8_t> shape, bool enters);
  std::string busy_hint() const;
  std::chrono::nanoseconds patience(client::Clock::time_point deadline) const;
  Result<void> ask_for_left_out(client::Clock::time_point deadline);
  std::optional<Error> why_not_known(client::Clock::time_point deadline);
  Error unknown(Object object) const;

  // Asserts liveliness. If the server has dropped this publisher or lacks messages, defines everything again.
  std::optional<Error> say_alive();
  std::optional<Error> assert_liveliness();
  bool is_forgotten() const;
  bool is_lost() const;
  void note_loss();
  bool is_asked_again();
  bool is_behind() const;
  bool is_applied() const;
  bool has_room();
  std::optional<Error> define_all();
  std::optional<Error> write_definition(std::uint32_t number, const client::PublishedObject& object, bool removed);
  std::optional<Error> write_batch(std::span<const std::uint32_t> numbers, std::uint8_t flags, std::int64_t time_ns);
  void fill_batch(std::uint8_t flags, std::int64_t time_ns);
  std::optional<Error> write_gap();
  std::optional<Error> write_made_definition();
  std::optional<Error> write_instant(std::int64_t time_ns, bool is_only_alive);
  std::optional<Error> say_time(std::int64_t time_ns);
  std::optional<Error> send_waiting(std::int64_t time_ns);
  void note_written();

  std::shared_ptr<client::Connection> connection_;
  std::uint64_t publisher_;
  std::uint64_t incarnation_;
  std::chrono::nanoseconds lease_;
  std::chrono::nanoseconds gap_;
  // A move() or a wait this soon after the last assertion of liveliness does not repeat it.
  std::chrono::nanoseconds word_period_;
  std::mutex mutex_;
  client::PublishedObjects objects_;
  std::vector<std::uint32_t> entering_;  // numbers of the objects that enter with the next instant
  std::uint64_t sequence_ = 0;
  std::uint64_t definitions_through_ = 0;
  std::uint64_t found_in_world_through_ = 0;  // definitions up to here are in the world, as confirmed by the server
  std::uint64_t defined_all_at_ = 0;          // sequence number at which everything was last defined again
  std::uint64_t server_ = 0;
  std::uint64_t outages_ = 0;  // the server's outages when everything was last defined again
  std::string lost_;           // the loss that the next flush() reports
  bool was_asked_ = false;     // the newest examined status requests to define everything again
  bool is_streamed_ = false;
  bool is_announced_ = false;
  bool has_own_clock_ = false;  // the last flush had no time, so the library's clock counts
  client::Clock::time_point last_instant_;
  client::UnacknowledgedPoses unacknowledged_;
  client::Clock::time_point last_word_;  // when both writers last asserted liveliness
  client::Clock::time_point last_sample_;
  client::Clock::time_point defined_all_;
  dds::Sample<wire::Definition> definition_;
  dds::Sample<wire::PoseBatch> batch_;
  std::vector<double> poses_, pose_columns_;
  dds::Topic<wire::Definition> object_topic_;
  dds::Topic<wire::PoseBatch> pose_topic_;
  dds::Writer<wire::Definition> object_writer_;
  dds::Writer<wire::PoseBatch> pose_writer_;
};

}  // namespace collided
