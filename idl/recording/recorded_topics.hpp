#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "idl/mcap/reader.hpp"
#include "idl/mcap/writer.hpp"
#include "idl/topics.hpp"

/// The contents of a recording: each topic of a namespace is a channel of an MCAP file. Its messages are the CDR bytes
/// of cdr.hpp, its schema is the text of collided.idl. `collide record` and the server's flight recorder write it.
namespace collided::recording {

/// A recorded topic; the value is its channel's number in files written here.
enum class Recorded : std::uint16_t {
  object = 1,
  pose,
  query,
  reply,
  event,
  contact,
  probe,
  status,
  step,
  standing_event,
  standing_state
};

/// One row of the table of recorded topics.
struct RecordedTopic {
  Recorded what;
  const wire_contract::TopicQos& row;
  const char* type;                // its name in collided.idl
  bool is_only_when_used = false;  // a file without messages of it has no such channel
};

inline constexpr std::array<RecordedTopic, 11> kRecordedTopics{{
    {Recorded::object, wire_contract::kObjectTopic, "collided::wire_v2::Definition"},
    {Recorded::pose, wire_contract::kPoseTopic, "collided::wire_v2::PoseBatch"},
    {Recorded::query, wire_contract::kQueryTopic, "collided::wire_v2::Query"},
    {Recorded::reply, wire_contract::kReplyTopic, "collided::wire_v2::Reply"},
    {Recorded::event, wire_contract::kEventTopic, "collided::wire_v2::EventFrame"},
    {Recorded::contact, wire_contract::kContactTopic, "collided::wire_v2::ContactShard"},
    {Recorded::probe, wire_contract::kProbeTopic, "collided::wire_v2::ProbeFrame"},
    {Recorded::status, wire_contract::kStatusTopic, "collided::wire_v2::Status"},
    {Recorded::step, wire_contract::kStepTopic, "collided::wire_v2::Status"},
    {Recorded::standing_event, wire_contract::kStandingEventTopic, "collided::wire_v2::StandingFrame", true},
    {Recorded::standing_state, wire_contract::kStandingStateTopic, "collided::wire_v2::StandingShard", true},
}};

/// The channels of a namespace, in the order of kRecordedTopics.
std::vector<mcap::ChannelDescription> channels_of(std::string_view name_space);

/// The topic of a file's channel, identified by the end of the channel's name and by its schema's name; nothing for
/// other channels.
std::optional<Recorded> recorded_topic(const mcap::Channel& channel, const mcap::Contents& contents);

/// The name of this program as a file's writer: "collided 0.2.0".
std::string library_name();

}  // namespace collided::recording
