#include "client/library/recordings/recorded_items.hpp"

#include <algorithm>
#include <charconv>
#include <optional>
#include <stdexcept>

namespace collided::client {
namespace {

/// Largest file to read, since it is held in memory.
constexpr std::uint64_t kMostFileBytes = std::uint64_t{4} << 30;

/// The number of messages at the file's beginning that are its opening; nothing if not stated.
std::optional<std::uint64_t> opening_messages(const mcap::Contents& contents) {
  const auto entries = contents.metadata.find("recording");
  std::uint64_t count = 0;
  if (entries == contents.metadata.end()) return std::nullopt;
  const auto found = entries->second.find("opening_messages");
  if (found != entries->second.end())
    std::from_chars(found->second.data(), found->second.data() + found->second.size(), count);
  return count;
}

bool is_of_first_wire(const mcap::Contents& contents) {
  return std::any_of(contents.schemas.begin(), contents.schemas.end(),
                     [](const auto& schema) { return schema.second.name.starts_with("collided::wire::"); });
}

void sort_into(RecordedItems& recorded, const mcap::Contents& contents) {
  std::uint64_t left = opening_messages(contents).value_or(0);
  for (const mcap::Message& message : contents.messages) {
    const mcap::Channel& channel = contents.channels.at(message.head.channel);
    const auto topic = recording::recorded_topic(channel, contents);
    const auto schema = contents.schemas.find(channel.schema);
    if (topic) recorded.items.push_back({*topic, message.head.log_time, message.data, left > 0});
    else if (schema != contents.schemas.end())
      recorded.own.push_back({schema->second.name, message.head.log_time, message.data});
    left -= left > 0 ? 1 : 0;
  }
  std::ranges::stable_sort(recorded.items, [](const RecordedItem& a, const RecordedItem& b) {
    return a.opening != b.opening ? a.opening : a.log_time < b.log_time;
  });
  std::ranges::stable_sort(recorded.own, {}, &RecordedOwnMessage::log_time);
}

}  // namespace

std::vector<std::byte> read_recording(const std::string& path) { return mcap::read_file(path, kMostFileBytes); }

RecordedItems read_items(std::vector<std::byte> bytes, const std::string& name, const char* consequence) {
  RecordedItems recorded;
  recorded.bytes = std::move(bytes);
  const mcap::Contents contents = mcap::read(recorded.bytes);
  if (!contents.is_mcap) throw std::runtime_error(name + ": is no MCAP file. " + consequence);
  const auto say = [&](std::uint64_t count, const char* what) {
    if (count > 0) recorded.warnings.push_back(name + ": " + std::to_string(count) + what);
  };
  if (!contents.damage.empty()) recorded.warnings.push_back(name + ": " + contents.damage);
  say(contents.bad_chunks, " chunks are damaged; left out");
  say(contents.compressed_chunks, " chunks are compressed, which is not read here; left out");
  say(contents.lost_messages, " messages are of no known channel; left out");
  recorded.has_opening = opening_messages(contents).has_value();
  sort_into(recorded, contents);
  if (recorded.items.empty() && is_of_first_wire(contents)) {
    throw std::runtime_error(name + ": was recorded by an earlier version, whose messages were laid out differently. " +
                             consequence);
  }
  if (recorded.items.empty()) throw std::runtime_error(name + ": holds nothing of a collision server. " + consequence);
  return recorded;
}

}  // namespace collided::client
