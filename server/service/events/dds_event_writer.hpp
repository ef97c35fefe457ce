#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>

#include "idl/dds.hpp"
#include "server/service/events/event_writer.hpp"
#include "server/service/events/untold_events.hpp"
#include "server/service/recording/flight_recorder.hpp"
#include "server/service/runtime/place.hpp"

namespace collided::engine::service {

/// The identity of this server, in everything that it writes.
struct Identity {
  std::uint64_t server = 0;  // random, one per process
  std::uint64_t epoch = 0;   // at its start; see Epoch
  std::string name_space;
  std::string version;
};

/// Writes events, contacts, probes and status to DDS. A write that fails or finds a reader full is not reported: the
/// world must not stop for it, and subscribers see the gap in the sequence.
///
/// threads  the world's, except for repeat_status()
class DdsEventWriter : public EventWriter {
 public:
  /// flight  records everything written except persisted contacts; null: none
  /// place   once it may not publish any more, nothing is written before speak() is called
  DdsEventWriter(const dds::Participant& participant, const Identity& identity, FlightRecorder* flight,
                 const Place& place);

  void fall_silent() override;
  std::uint64_t speak(const SpokenBefore& before) override;
  /// Sets the epoch of all further messages.
  void set_epoch(std::uint64_t epoch);
  /// Since when it writes nothing because its place ended, steady clock; 0: it writes, or is silent for another reason.
  std::int64_t lapsed_ns() const { return is_silent_.load() ? 0 : lapsed_ns_.load(); }
  bool contacts_wanted() const override { return event_readers_.load() > 0 || contact_readers_.load() > 0; }
  bool persisted_wanted() const override { return persisted_readers_.load() > 0; }
  bool watermarks_wanted() const override { return watermark_readers_.load() > 0 && !is_quiet(); }
  bool probes_wanted() const override { return probe_readers_.load() > 0; }
  void write_events(const EventColumns& events, const Stamp& stamp) override;
  void write_watermark(std::uint64_t next_sequence, const Stamp& stamp) override;
  void write_persisted(const EventColumns& events, const Stamp& stamp) override;
  void write_contacts(const ContactColumns& contacts, const Stamp& stamp, std::uint64_t as_of_sequence) override;
  void write_probes(const ProbeColumns& probes, const Stamp& stamp) override;
  void write_status(const StatusColumns& status) override;
  std::int64_t status_period_ns() const override {
    return (status_readers_.load() > 0 ? 1 : 2) * wire_contract::kStatusPeriodNs;
  }
  /// Writes the newest status again, with how long the world has been busy, if the world's thread has written none for
  /// half a period longer than usual. Any thread.
  ///
  /// state    current; a server that has announced its stop stays in that state
  /// returns  when to call it again, steady clock
  std::int64_t repeat_status(std::int64_t now_ns, wire_contract::ServerState state);
  bool standing_wanted() const override { return standing_readers_.load() > 0; }
  void write_standing_events(const StandingColumns& events, const Stamp& stamp) override;
  void write_standing_state(const StandingStateColumns& state, const Stamp& stamp,
                            std::uint64_t as_of_sequence) override;
  bool steps_wanted() const override { return flight_ != nullptr || step_readers_.load() > 0; }
  void write_step(const StatusColumns& status) override;

  /// Call this last: clients learn that the server has left rather than gone silent.
  void leave();

 private:
  void note_lapse();
  bool is_quiet() const { return is_silent_.load() || lapsed_ns_.load() != 0; }
  template <class Frame, class Columns>
  void write_frame(dds::Writer<Frame>& writer, Frame& frame, const Columns& events, const Stamp& stamp);
  template <class T>
  void note(recording::Recorded topic, const T& sample);
  template <class T>
  void write(dds::Writer<T>& writer, const T& sample);

  FlightRecorder* const flight_;
  const Place& place_;
  std::atomic<bool> is_silent_{false};
  std::atomic<std::int64_t> lapsed_ns_{0};  // see lapsed_ns()
  UntoldEvents<EventColumns> untold_;       // while it is silent
  UntoldEvents<StandingColumns> untold_standing_;
  dds::Topic<wire::EventFrame> event_topic_, persisted_topic_, watermark_topic_;
  dds::Topic<wire::ContactShard> contact_topic_;
  dds::Topic<wire::StandingFrame> standing_event_topic_;
  dds::Topic<wire::StandingShard> standing_state_topic_;
  dds::Topic<wire::ProbeFrame> probe_topic_;
  dds::Topic<wire::Status> status_topic_, step_topic_;
  std::atomic<std::uint32_t> event_readers_{0}, contact_readers_{0}, persisted_readers_{0}, probe_readers_{0},
      watermark_readers_{0};
  std::atomic<std::uint32_t> step_readers_{0}, standing_readers_{0}, status_readers_{0};
  dds::Writer<wire::EventFrame> event_writer_, persisted_writer_, watermark_writer_;
  dds::Writer<wire::ContactShard> contact_writer_;
  dds::Writer<wire::StandingFrame> standing_event_writer_;
  dds::Writer<wire::StandingShard> standing_state_writer_;
  dds::Writer<wire::ProbeFrame> probe_writer_;
  dds::Writer<wire::Status> status_writer_, step_writer_;
  dds::Sample<wire::EventFrame> frame_;
  dds::Sample<wire::ContactShard> shard_;
  dds::Sample<wire::StandingFrame> standing_frame_;
  dds::Sample<wire::StandingShard> standing_shard_;
  dds::Sample<wire::ProbeFrame> probes_;
  dds::Sample<wire::Status> step_;

  // Statuses are written one after the other, and none once fall_silent() has returned.
  std::mutex status_mutex_;  // guards the next four
  dds::Sample<wire::Status> status_;
  StatusColumns said_;            // its columns of publishers
  std::int64_t said_ns_ = 0;      // when the world's thread wrote it, steady clock; 0: not yet
  std::int64_t repeated_ns_ = 0;  // when it was written last
};

}  // namespace collided::engine::service
