#include "server/service/events/dds_event_writer.hpp"

#include <unistd.h>

#include <algorithm>

#include "idl/columns.hpp"
#include "server/service/runtime/clock.hpp"

namespace collided::engine::service {
namespace {

/// Tracks the number of matched readers, so that messages without a reader need not be made.
dds::WriterOptions counting(std::atomic<std::uint32_t>& readers) {
  return {.matched = [&readers](std::uint32_t count) { readers.store(count); }};
}

/// As many whole lines as fit into `room` bytes, then "..." if some do not.
std::string fitting_lines(const std::string& lines, std::size_t room) {
  if (lines.size() < room) return lines;
  const std::size_t end = lines.rfind('\n', room - 5);
  return (end == std::string::npos ? std::string() : lines.substr(0, end + 1)) + "...";
}

}  // namespace

DdsEventWriter::DdsEventWriter(const dds::Participant& participant, const Identity& identity, FlightRecorder* flight,
                               const Place& place)
    : flight_(flight),
      place_(place),
      event_topic_(participant, identity.name_space),
      persisted_topic_(participant, identity.name_space, wire_contract::kPersistedTopic),
      watermark_topic_(participant, identity.name_space, wire_contract::kWatermarkTopic),
      contact_topic_(participant, identity.name_space),
      standing_event_topic_(participant, identity.name_space),
      standing_state_topic_(participant, identity.name_space),
      probe_topic_(participant, identity.name_space),
      status_topic_(participant, identity.name_space),
      step_topic_(participant, identity.name_space, wire_contract::kStepTopic),
      event_writer_(event_topic_, counting(event_readers_)),
      persisted_writer_(persisted_topic_, counting(persisted_readers_)),
      watermark_writer_(watermark_topic_, counting(watermark_readers_)),
      contact_writer_(contact_topic_, counting(contact_readers_)),
      standing_event_writer_(standing_event_topic_),
      standing_state_writer_(standing_state_topic_, counting(standing_readers_)),
      probe_writer_(probe_topic_, counting(probe_readers_)),
      status_writer_(status_topic_, counting(status_readers_)),
      step_writer_(step_topic_, counting(step_readers_)) {
  frame_->server = shard_->server = probes_->server = identity.server;
  standing_frame_->server = standing_shard_->server = identity.server;
  status_->server = step_->server = identity.server;
  set_epoch(identity.epoch);
  status_->pid = static_cast<std::uint32_t>(getpid());
  // Both fit: options allow 64 letters for the namespace.
  static_cast<void>(dds::set_text(status_->namespace_name, identity.name_space));
  static_cast<void>(dds::set_text(status_->server_version, identity.version));
}

void DdsEventWriter::fall_silent() {
  const std::lock_guard lock(status_mutex_);
  is_silent_ = true;
}

void DdsEventWriter::set_epoch(std::uint64_t epoch) {
  const std::lock_guard lock(status_mutex_);
  frame_->epoch = shard_->epoch = probes_->epoch = epoch;
  standing_frame_->epoch = standing_shard_->epoch = epoch;
  status_->epoch = step_->epoch = epoch;
}

template <class T>
void DdsEventWriter::note(recording::Recorded topic, const T& sample) {
  if (flight_) flight_->note(topic, sample);
}

/// A full reader or a failed write must not stop the world; a subscriber that misses a sample sees the gap in the
/// sequence.
template <class T>
void DdsEventWriter::write(dds::Writer<T>& writer, const T& sample) {
  if (is_quiet()) return;
  try {
    static_cast<void>(writer.write(sample));
  } catch (const dds::DdsError&) {}
}

template <class Frame, class Columns>
void DdsEventWriter::write_frame(dds::Writer<Frame>& writer, Frame& frame, const Columns& events, const Stamp& stamp) {
  frame.first_sequence = events.first_sequence;
  frame.version = stamp.version;
  frame.world_time_ns = stamp.world_time_ns;
  if constexpr (requires { frame.settled_ns; }) frame.settled_ns = stamp.settled_ns;
  wire::lend(events, frame);
  write(writer, frame);
}

/// Call this once before related messages are kept or written: the place may end between them.
void DdsEventWriter::note_lapse() {
  if (lapsed_ns_ == 0 && !place_.may_publish()) lapsed_ns_ = std::max<std::int64_t>(1, place_.may_publish_until_ns());
}

std::uint64_t DdsEventWriter::speak(const SpokenBefore& before) {
  is_silent_ = false;
  lapsed_ns_ = 0;
  note_lapse();
  // Kept messages stay kept until the place is confirmed again.
  if (is_quiet()) return 0;
  std::uint64_t first = 0;
  untold_.tell_all(before, [&](const auto& frame) {
    write_frame(event_writer_, *frame_, frame.events, {.version = 0, .world_time_ns = frame.stamp.world_time_ns});
    if (first == 0) first = frame.events.first_sequence;
  });
  untold_standing_.tell_all(before, [&](const auto& frame) {
    write_frame(standing_event_writer_, *standing_frame_, frame.events,
                {.version = 0, .world_time_ns = frame.stamp.world_time_ns});
  });
  return first;
}

void DdsEventWriter::write_events(const EventColumns& events, const Stamp& stamp) {
  note_lapse();
  if (is_quiet()) untold_.keep(events, stamp, steady_ns());
  write_frame(event_writer_, *frame_, events, stamp);
  note(recording::Recorded::event, *frame_);
}

void DdsEventWriter::write_watermark(std::uint64_t next_sequence, const Stamp& stamp) {
  note_lapse();
  EventColumns no_events;
  no_events.first_sequence = next_sequence;
  write_frame(watermark_writer_, *frame_, no_events, stamp);
}

void DdsEventWriter::write_persisted(const EventColumns& events, const Stamp& stamp) {
  note_lapse();
  write_frame(persisted_writer_, *frame_, events, stamp);
}

void DdsEventWriter::write_contacts(const ContactColumns& contacts, const Stamp& stamp, std::uint64_t as_of_sequence) {
  note_lapse();
  shard_->shard = contacts.shard;
  shard_->version = stamp.version;
  shard_->as_of_sequence = as_of_sequence;
  wire::lend<wire::ContactShardColumns>(contacts, *shard_);
  note(recording::Recorded::contact, *shard_);
  write(contact_writer_, *shard_);
}

void DdsEventWriter::write_standing_events(const StandingColumns& events, const Stamp& stamp) {
  note_lapse();
  if (is_quiet()) untold_standing_.keep(events, stamp, steady_ns());
  write_frame(standing_event_writer_, *standing_frame_, events, stamp);
  note(recording::Recorded::standing_event, *standing_frame_);
}

void DdsEventWriter::write_standing_state(const StandingStateColumns& state, const Stamp& stamp,
                                          std::uint64_t as_of_sequence) {
  note_lapse();
  wire::StandingShard& shard = *standing_shard_;
  shard.shard = state.shard;
  shard.version = stamp.version;
  shard.as_of_sequence = as_of_sequence;
  shard.world_time_ns = stamp.world_time_ns;
  shard.state = static_cast<std::uint8_t>(state.state);
  shard.count = state.count;
  shard.hash = state.hash;
  wire::lend<wire::StandingShardColumns>(state, shard);
  // A recording does not contain this before the first event.
  if (as_of_sequence > 0) note(recording::Recorded::standing_state, shard);
  write(standing_state_writer_, shard);
}

void DdsEventWriter::write_probes(const ProbeColumns& probes, const Stamp& stamp) {
  note_lapse();
  probes_->version = stamp.version;
  probes_->world_time_ns = stamp.world_time_ns;
  wire::lend<wire::ProbeFrameColumns>(probes, *probes_);
  note(recording::Recorded::probe, *probes_);
  write(probe_writer_, *probes_);
}

void DdsEventWriter::write_status(const StatusColumns& status) {
  note_lapse();
  const std::lock_guard lock(status_mutex_);
  said_ = status;
  said_ns_ = repeated_ns_ = steady_ns();
  status_->version = status.stamp.version;
  status_->world_time_ns = status.stamp.world_time_ns;
  status_->last_event_sequence = status.last_event_sequence;
  status_->settled_ns = status.settled_ns;
  status_->heir_of = status.heir_of;
  status_->told_from = status.told_from;
  status_->contact_count = status.contact_count;
  status_->contact_hash = status.contact_hash;
  status_->contacts_truncated = status.contacts_truncated ? 1 : 0;
  status_->state = static_cast<std::uint8_t>(status.state);
  static_cast<void>(dds::set_text(status_->scenes, fitting_lines(status.scenes, sizeof status_->scenes)));
  status_->static_triangles = status.static_triangles;
  status_->object_count = status.object_count;
  status_->moving_count = status.moving_count;
  status_->poses_applied = status.poses_applied;
  status_->poses_dropped = status.poses_dropped;
  status_->questions_answered = status.questions_answered;
  status_->questions_refused = status.questions_refused;
  status_->undecided_answers = status.undecided_answers;
  wire::lend(said_, *status_);
  note(recording::Recorded::status, *status_);
  write(status_writer_, *status_);
}

std::int64_t DdsEventWriter::repeat_status(std::int64_t now_ns, wire_contract::ServerState state) {
  constexpr std::int64_t kUnreadNs = 5 * wire_contract::kStatusPeriodNs;
  const std::int64_t late_ns = status_period_ns() * 3 / 2;
  const std::lock_guard lock(status_mutex_);
  if (status_readers_.load() == 0) return now_ns + kUnreadNs;
  if (said_ns_ == 0 || is_quiet() || !place_.may_publish()) return now_ns + wire_contract::kStatusPeriodNs;
  const std::int64_t due_ns = std::max(said_ns_ + late_ns, repeated_ns_ + wire_contract::kStatusPeriodNs);
  if (now_ns < due_ns) return due_ns;
  repeated_ns_ = now_ns;
  if (said_.state != wire_contract::ServerState::stopping) status_->state = static_cast<std::uint8_t>(state);
  said_.publishers.push_back(wire_contract::kPublisherBusyWorld);
  said_.applied_sequences.push_back(0);
  said_.silent_ns.push_back(now_ns - said_ns_);
  said_.publisher_states.push_back(static_cast<std::uint8_t>(wire_contract::PublisherState::alive));
  said_.publisher_names.push_back(0);
  wire::lend(said_, *status_);
  write(status_writer_, *status_);
  for (auto* column : {&said_.publishers, &said_.applied_sequences}) column->pop_back();
  said_.silent_ns.pop_back();
  for (auto* column : {&said_.publisher_states, &said_.publisher_names}) column->pop_back();
  return now_ns + wire_contract::kStatusPeriodNs;
}

void DdsEventWriter::write_step(const StatusColumns& status) {
  note_lapse();
  step_->version = status.stamp.version;
  step_->world_time_ns = status.stamp.world_time_ns;
  wire::lend(status, *step_);
  note(recording::Recorded::step, *step_);
  if (step_readers_.load() > 0) write(step_writer_, *step_);
}

void DdsEventWriter::leave() {
  note_lapse();
  if (is_quiet()) return;
  constexpr std::int64_t kPatienceNs = 500'000'000;
  event_writer_.wait_for_acknowledgements(kPatienceNs);
  contact_writer_.wait_for_acknowledgements(kPatienceNs);
  standing_event_writer_.wait_for_acknowledgements(kPatienceNs);
  standing_state_writer_.wait_for_acknowledgements(kPatienceNs);
  status_writer_.dispose(*status_);
  status_writer_.wait_for_acknowledgements(kPatienceNs);
}

}  // namespace collided::engine::service
