#include "tests/simulation/recording_event_writer.hpp"

namespace collided::simulation {
using namespace engine;

void RecordingEventWriter::check(const service::EventColumns& events, std::size_t i) {
  const std::uint64_t sequence = events.first_sequence + i;
  const auto say = [&](const char* what) { violation_("event " + std::to_string(sequence) + ' ' + what); };
  if (sequence != last_sequence_ + 1) say("does not follow the one before");
  last_sequence_ = sequence;
  const std::pair pair(events.a[i], events.b[i]);
  if (!(pair.first < pair.second)) say("names its pair the wrong way round");
  const double low_s = events.bracket_lows[i];
  const double high_s = events.bracket_highs[i];
  // A clock of another epoch counts from its first batch, which may have been under way for longer than those after it.
  constexpr double kLongestWay_s = 0.06;
  // Ahead of the server's by a lease when it starts, then put right from one end to the other, and 2 % too fast for 5 s.
  constexpr double kMostAhead_s = 2e-9 * wire_contract::kPublisherLeaseNs + 0.1;
  if (!(low_s >= high_s && high_s >= -kMostAhead_s - 2 * kLongestWay_s)) say("has a bracket out of order");
  if (events.kinds[i] == static_cast<std::uint8_t>(EventKind::began)) {
    if (!open_.emplace(pair, events.episodes[i]).second) say("begins what holds");
    if (events.episodes[i] != sequence) say("does not begin its own episode");
    return;
  }
  const auto found = open_.find(pair);
  if (found == open_.end()) return say("ends what does not hold");
  if (found->second != events.episodes[i]) say("ends another episode");
  if (events.reasons[i] == static_cast<std::uint8_t>(EndReason::none)) say("ends without a reason");
  open_.erase(found);
}

void RecordingEventWriter::write_events(const service::EventColumns& events, const service::Stamp& stamp) {
  for (std::size_t i = 0; i < events.size(); ++i) check(events, i);
  if (voice_ == Voice::is_silent) untold_.keep(events, stamp, now_ns_);
  else write_frame(events, stamp, false);
}

std::uint64_t RecordingEventWriter::speak(const service::SpokenBefore& before) {
  voice_ = Voice::speaks;
  std::uint64_t first = 0;
  untold_.tell_all(before, [&](const auto& frame) {
    write_frame(frame.events, frame.stamp, true);
    if (first == 0) first = frame.events.first_sequence;
  });
  return first;
}

template <class Columns>
void RecordingEventWriter::put_columns(const Columns& columns) {
  Columns::for_each([&](auto, auto column, std::uint32_t) { payload_.put(columns.*column); });
}

void RecordingEventWriter::write_frame(const service::EventColumns& events, const service::Stamp& stamp,
                                       bool is_again) {
  payload_.put(epoch_);
  payload_.put(stamp.world_time_ns);
  payload_.put(static_cast<std::uint8_t>(is_again));
  payload_.put(is_again ? std::int64_t{0} : stamp.settled_ns);
  payload_.put(events.first_sequence);
  put_columns(events);
  payload_.send(voice_ == Voice::is_expected ? Kind::expected : Kind::frame, now_ns_, to_);
}

void RecordingEventWriter::write_contacts(const service::ContactColumns& contacts, const service::Stamp&,
                                          std::uint64_t as_of_sequence) {
  if (voice_ != Voice::speaks) return;
  payload_.put(epoch_);
  payload_.put(as_of_sequence);
  payload_.put(contacts.shard);
  put_columns(contacts);
  payload_.send(Kind::shard, now_ns_, to_);
}

void RecordingEventWriter::write_status(const service::StatusColumns& status) {
  if (status.last_event_sequence != last_sequence_) violation_("a bookmark that does not name the last event");
  if (status.contact_count != open_.size()) violation_("a bookmark that counts other contacts than events left open");
  if (voice_ != Voice::speaks) return;
  payload_.put(epoch_);
  payload_.put(status.last_event_sequence);
  payload_.put(status.contact_count);
  payload_.put(status.contact_hash);
  payload_.put(static_cast<std::uint8_t>(status.state));
  payload_.put(status.settled_ns);
  payload_.send(Kind::bookmark, now_ns_, to_);
}

}  // namespace collided::simulation
