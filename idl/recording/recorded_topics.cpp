#include "idl/recording/recorded_topics.hpp"

#include "idl/idl_text.hpp"

namespace collided::recording {

std::vector<mcap::ChannelDescription> channels_of(std::string_view name_space) {
  std::vector<mcap::ChannelDescription> channels;
  for (const RecordedTopic& topic : kRecordedTopics) {
    channels.push_back({.topic = wire_contract::topic_name(name_space, topic.row),
                        .encoding = "cdr",
                        .schema_name = topic.type,
                        .schema_encoding = "omgidl",
                        .schema = kIdlText,
                        .metadata = {},
                        .is_only_when_used = topic.is_only_when_used});
  }
  return channels;
}

std::optional<Recorded> recorded_topic(const mcap::Channel& channel, const mcap::Contents& contents) {
  const auto schema = contents.schemas.find(channel.schema);
  if (schema == contents.schemas.end() || channel.encoding != "cdr") return std::nullopt;
  for (const RecordedTopic& topic : kRecordedTopics) {
    if (schema->second.name == topic.type && channel.topic.ends_with(std::string("/") + topic.row.suffix))
      return topic.what;
  }
  return std::nullopt;
}

std::string library_name() { return "collided " COLLIDED_VERSION; }

}  // namespace collided::recording
