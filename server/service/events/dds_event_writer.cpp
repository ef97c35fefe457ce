#include "server/service/events/dds_event_writer.hpp"

#include <unistd.h>

#include <algorithm>

#include "idl/columns.hpp"
#include "server/service/runtime/clock.hpp"

namespace collided::engine::service {
namespace {

/// Keeps the number of matched readers, so that what nothing reads need not be made.
dds::WriterOptions counting(std::atomic<std::uint32_t>& readers) {
  return {.matched = [&readers](std::uint32_t count) { readers.store(count); }};
}

/// As many whole lines as fit into `room` bytes, then "..." where some do not.
std::string fitting_lines(const std::string& lines, std::size_t room) {
  if (lines.size() < room) return lines;
  const std::size_t end = lines.rfind('\n', room - 5);
  return (end == std::string::npos ? std::string() : lines.substr(0, end + 1)) + "...";
}

}  // namespace

DdsEventWriter::DdsEventWriter(const dds::Participant& participant, const Identity& identity, FlightRecorder* flight,
                               const ServingTerm& term)
    : flight_(flight),
      term_(term),
      event_topic_(participant, identity.name_space),
      persisted_topic_(participant, identity.name_space, wire_contract::kPersistedTopic),
      fence_event_topic_(participant, identity.name_space, wire_contract::kFenceEventTopic),
      contact_topic_(participant, identity.name_space),
      fence_state_topic_(participant, identity.name_space, wire_contract::kFenceStateTopic),
      probe_topic_(participant, identity.name_space),
      status_topic_(participant, identity.name_space),
      step_topic_(participant, identity.name_space, wire_contract::kStepTopic),
      fence_status_topic_(participant, identity.name_space, wire_contract::kFenceStatusTopic),
      event_writer_(event_topic_, counting(event_readers_)),
      persisted_writer_(persisted_topic_, counting(persisted_readers_)),
      fence_event_writer_(fence_event_topic_),
      contact_writer_(contact_topic_, counting(contact_readers_)),
      fence_state_writer_(fence_state_topic_),
      probe_writer_(probe_topic_, counting(probe_readers_)),
      status_writer_(status_topic_),
      step_writer_(step_topic_, counting(step_readers_)),
      fence_status_writer_(fence_status_topic_, counting(fence_status_readers_)) {
  frame_->server = shard_->server = probes_->server = identity.server;
  for (wire::Status* status : {&*status_, &*step_, &*fence_status_}) status->server = identity.server;
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
  status_->epoch = step_->epoch = fence_status_->epoch = epoch;
}

template <class T>
void DdsEventWriter::note(recording::Recorded topic, const T& sample) {
  if (flight_) flight_->note(topic, sample);
}

template <class T>
void DdsEventWriter::note_fences(recording::Recorded topic, const T& sample) {
  is_flight_of_fences_ = flight_ != nullptr;
  note(topic, sample);
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

void DdsEventWriter::write_frame(dds::Writer<wire::EventFrame>& writer, const EventColumns& events,
                                 const Stamp& stamp) {
  frame_->first_sequence = events.first_sequence;
  frame_->version = stamp.version;
  frame_->world_time_ns = stamp.world_time_ns;
  wire::lend<wire::EventFrameColumns>(events, *frame_);
  write(writer, *frame_);
}

/// To be called once before all that belongs together is kept or written: the term may end between the two.
void DdsEventWriter::note_lapse() {
  if (lapsed_ns_ == 0 && term_.is_over()) lapsed_ns_ = std::max<std::int64_t>(1, term_.until_ns());
}

std::uint64_t DdsEventWriter::speak(const SpokenBefore& before) {
  is_silent_ = false;
  lapsed_ns_ = 0;
  note_lapse();
  // What was kept stays so until the term goes on.
  if (is_quiet()) return 0;
  std::uint64_t first = 0;
  untold_.tell_all(before, [&](const UntoldEvents::UntoldFrame& frame) {
    const Stamp again{.version = 0, .world_time_ns = frame.stamp.world_time_ns};
    write_frame(frame.is_of_fences ? fence_event_writer_ : event_writer_, frame.events, again);
    if (first == 0 && !frame.is_of_fences) first = frame.events.first_sequence;
  });
  return first;
}

void DdsEventWriter::write_events(const EventColumns& events, const Stamp& stamp) {
  note_lapse();
  if (is_quiet()) untold_.keep(events, stamp, false, steady_ns());
  write_frame(event_writer_, events, stamp);
  note(recording::Recorded::event, *frame_);
}

void DdsEventWriter::write_persisted(const EventColumns& events, const Stamp& stamp) {
  note_lapse();
  write_frame(persisted_writer_, events, stamp);
}

void DdsEventWriter::write_fence_events(const EventColumns& events, const Stamp& stamp) {
  note_lapse();
  if (is_quiet()) untold_.keep(events, stamp, true, steady_ns());
  write_frame(fence_event_writer_, events, stamp);
  note_fences(recording::Recorded::fence_event, *frame_);
}

void DdsEventWriter::fill_shard(const ContactColumns& contacts, const Stamp& stamp, std::uint64_t as_of_sequence) {
  note_lapse();
  shard_->shard = contacts.shard;
  shard_->version = stamp.version;
  shard_->as_of_sequence = as_of_sequence;
  wire::lend<wire::ContactShardColumns>(contacts, *shard_);
}

void DdsEventWriter::write_contacts(const ContactColumns& contacts, const Stamp& stamp, std::uint64_t as_of_sequence) {
  fill_shard(contacts, stamp, as_of_sequence);
  note(recording::Recorded::contact, *shard_);
  write(contact_writer_, *shard_);
}

void DdsEventWriter::write_fence_state(const ContactColumns& inside, const Stamp& stamp, std::uint64_t as_of_sequence) {
  fill_shard(inside, stamp, as_of_sequence);
  note_fences(recording::Recorded::fence_state, *shard_);
  write(fence_state_writer_, *shard_);
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

void DdsEventWriter::repeat_status(std::int64_t now_ns, wire_contract::ServerState state) {
  constexpr std::int64_t kLateNs = wire_contract::kStatusPeriodNs * 3 / 2;
  const std::lock_guard lock(status_mutex_);
  if (said_ns_ == 0 || is_quiet() || term_.is_over()) return;
  if (now_ns - said_ns_ < kLateNs || now_ns - repeated_ns_ < wire_contract::kStatusPeriodNs) return;
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
}

void DdsEventWriter::write_fence_status(const StatusColumns& status) {
  note_lapse();
  fence_status_->version = status.stamp.version;
  fence_status_->world_time_ns = status.stamp.world_time_ns;
  fence_status_->last_event_sequence = status.last_event_sequence;
  fence_status_->contact_count = status.contact_count;
  fence_status_->contact_hash = status.contact_hash;
  fence_status_->state = static_cast<std::uint8_t>(status.state);
  if (is_flight_of_fences_) note(recording::Recorded::fence_status, *fence_status_);
  write(fence_status_writer_, *fence_status_);
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
  fence_event_writer_.wait_for_acknowledgements(kPatienceNs);
  fence_state_writer_.wait_for_acknowledgements(kPatienceNs);
  status_writer_.dispose(*status_);
  status_writer_.wait_for_acknowledgements(kPatienceNs);
}

}  // namespace collided::engine::service
