#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "idl/topics.hpp"
#include "server/service/events/frames.hpp"
#include "server/service/events/standing_frames.hpp"

namespace collided::engine::service {

/// Which state of the world a message is about.
struct Stamp {
  std::uint64_t version = 0;
  std::int64_t world_time_ns = 0;
  std::int64_t settled_ns = 0;  // watermark, of frames of events; 0: none
};

/// The part of a Status of collided.idl that changes; its fields are explained there.
struct StatusColumns : wire::StatusColumns {
  Stamp stamp;
  wire_contract::ServerState state = wire_contract::ServerState::starting;
  std::uint64_t last_event_sequence = 0;
  std::int64_t settled_ns = 0;
  std::uint64_t heir_of = 0;
  std::uint64_t told_from = 0;
  std::uint32_t contact_count = 0;
  std::uint64_t contact_hash = 0;
  bool contacts_truncated = false;
  std::string scenes;  // names, one a line
  std::uint64_t static_triangles = 0;
  std::uint32_t object_count = 0;
  std::uint32_t moving_count = 0;
  std::uint64_t poses_applied = 0;
  std::uint64_t poses_dropped = 0;
  std::uint64_t questions_answered = 0;
  std::uint64_t questions_refused = 0;
  std::uint64_t undecided_answers = 0;
};

/// State of the previous primary, for its successor, which repeats events that it may not have published.
struct SpokenBefore {
  std::int64_t heard_ns = 0;  // when it was last received, steady clock; 0: all kept events are repeated
  std::int64_t same_from_ns =
      0;  // world time since when both servers find the same; the other published all before. 0: always
};

/// The interface that the world's thread writes to: DdsEventWriter in the server, a list in tests. Only that thread
/// calls it.
class EventWriter {
 public:
  virtual ~EventWriter() = default;
  /// Stops all writing, for a standby; everything else continues as before.
  virtual void fall_silent() {}
  /// Ends the silence: first writes the events that the previous primary may not have written.
  ///
  /// returns  the number of the first one of contacts; 0: there is none
  virtual std::uint64_t speak(const SpokenBefore&) { return 0; }
  /// The period of the status, longer while it has no reader. A new reader receives the last one at once.
  virtual std::int64_t status_period_ns() const { return wire_contract::kStatusPeriodNs; }
  virtual bool contacts_wanted() const = 0;  // events or contacts have a reader
  virtual bool persisted_wanted() const = 0;
  virtual bool probes_wanted() const = 0;
  /// Writes `began` and `ended` events; at most kMaxEventsPerFrame.
  virtual void write_events(const EventColumns& events, const Stamp& stamp) = 0;
  virtual bool watermarks_wanted() const { return false; }  // watermarks without events have a reader
  /// next_sequence  of the next event
  virtual void write_watermark(std::uint64_t /*next_sequence*/, const Stamp&) {}
  /// Writes `persisted` events, which may be lost.
  virtual void write_persisted(const EventColumns& events, const Stamp& stamp) = 0;
  /// as_of_sequence  the last event that the contacts include
  virtual void write_contacts(const ContactColumns& contacts, const Stamp& stamp, std::uint64_t as_of_sequence) = 0;
  virtual void write_probes(const ProbeColumns& probes, const Stamp& stamp) = 0;
  virtual void write_status(const StatusColumns& status) = 0;
  virtual bool standing_wanted() const { return false; }  // the state of standing questions has a reader
  /// Events of standing questions; at most kMaxEventsPerFrame.
  virtual void write_standing_events(const StandingColumns&, const Stamp&) {}
  virtual void write_standing_state(const StandingStateColumns&, const Stamp&, std::uint64_t /*as_of_sequence*/) {}
  /// Whether write_step() has a reader, which learns after every step up to where each publisher's samples are in the
  /// state.
  virtual bool steps_wanted() const { return false; }
  virtual void write_step(const StatusColumns&) {}
};

}  // namespace collided::engine::service
