#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

#include "idl/mcap/reader.hpp"
#include "idl/mcap/writer.hpp"
#include "idl/recording/recorded_topics.hpp"

namespace collided::mcap {
namespace {

std::vector<std::byte> bytes_of(const std::string& text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

/// A file in memory that takes so many bytes.
class Memory : public Output {
 public:
  explicit Memory(std::size_t room = ~std::size_t{0}) : room_(room) {}
  bool append(std::span<const std::byte> bytes) override {
    if (bytes.size() > room_ - file.size()) return false;
    file.insert(file.end(), bytes.begin(), bytes.end());
    return true;
  }
  const std::string& problem() const override { return problem_; }
  std::vector<std::byte> file;

 private:
  std::size_t room_;
  std::string problem_ = "full";
};

std::vector<ChannelDescription> two_channels() {
  return {{"a/object", "cdr", "T", "omgidl", "struct T {};", {{"key", "value"}}},
          {"a/pose", "cdr", "U", "omgidl", "struct U {};", {}}};
}

/// `chunks` chunks of two messages each.
void write_chunks(FileWriter& writer, std::uint64_t chunks) {
  for (std::uint64_t i = 0; i < chunks; ++i) {
    writer.write(1, 100 + i, 90 + i, bytes_of("first " + std::to_string(i)));
    writer.write(2, 200 + i, 190 + i, bytes_of("second " + std::to_string(i)));
    writer.flush();
  }
}

std::string text_of(const Message& message) {
  return {reinterpret_cast<const char*>(message.data.data()), message.data.size()};
}

TEST(Mcap, WhatWasWrittenIsRead) {
  Memory memory;
  FileWriter writer(memory, "test", two_channels());
  write_chunks(writer, 3);
  writer.metadata("recording", {{"opening", "yes"}});
  EXPECT_TRUE(writer.close());
  const Contents contents = read(memory.file);
  EXPECT_TRUE(contents.is_mcap);
  EXPECT_TRUE(contents.complete);
  EXPECT_EQ(contents.damage, "");
  ASSERT_EQ(contents.messages.size(), 6U);
  EXPECT_EQ(text_of(contents.messages[4]), "first 2");
  EXPECT_EQ(contents.messages[4].head.channel, 1);
  EXPECT_EQ(contents.messages[4].head.number, 2U);
  EXPECT_EQ(contents.messages[4].head.log_time, 102U);
  EXPECT_EQ(contents.messages[4].head.publish_time, 92U);
  EXPECT_EQ(contents.channels.at(1).topic, "a/object");
  EXPECT_EQ(contents.channels.at(1).metadata.at("key"), "value");
  EXPECT_EQ(contents.schemas.at(contents.channels.at(2).schema).text, "struct U {};");
  EXPECT_EQ(contents.metadata.at("recording").at("opening"), "yes");
}

// Whatever byte a killed writer stopped at: every whole chunk is there, no message is made up.
TEST(Mcap, AFileThatBreaksOffIsReadUpToItsLastChunk) {
  Memory memory;
  FileWriter writer(memory, "test", two_channels());
  std::vector<std::size_t> chunk_ends;
  for (std::uint64_t i = 0; i < 3; ++i) {
    write_chunks(writer, 1);
    // The chunk ends before its two indexes, of 9 + 2 + 4 + 16 bytes each.
    chunk_ends.push_back(memory.file.size() - 2 * 31);
  }
  writer.close();
  for (std::size_t size = 0; size < memory.file.size(); ++size) {
    const Contents contents = read(std::span<const std::byte>(memory.file).first(size));
    const auto whole = static_cast<std::size_t>(
        std::count_if(chunk_ends.begin(), chunk_ends.end(), [&](std::size_t end) { return end <= size; }));
    ASSERT_EQ(contents.messages.size(), 2 * whole) << "cut at " << size;
    ASSERT_FALSE(contents.complete) << "cut at " << size;
    ASSERT_EQ(contents.damage.empty(), !contents.is_mcap) << "cut at " << size;
  }
}

TEST(Mcap, AChunkWithAWrongByteIsLeftOutAndSaid) {
  Memory memory;
  FileWriter writer(memory, "test", two_channels());
  write_chunks(writer, 3);
  writer.close();
  const std::string wanted = "first 1";
  const auto at = std::search(memory.file.begin(), memory.file.end(), std::as_bytes(std::span(wanted)).begin(),
                              std::as_bytes(std::span(wanted)).end());
  ASSERT_NE(at, memory.file.end());
  *at ^= std::byte{1};
  const Contents contents = read(memory.file);
  EXPECT_EQ(contents.bad_chunks, 1U);
  EXPECT_EQ(contents.messages.size(), 4U);
  EXPECT_TRUE(contents.complete);
}

// A disk that fills up in the middle of a chunk: that chunk is not there, all before it is, and the end still fits.
TEST(Mcap, AFullOutputLeavesAGoodFile) {
  Memory all;
  FileWriter whole(all, "test", two_channels());
  write_chunks(whole, 1);
  const std::size_t after_one = all.file.size();
  for (const std::size_t room : {after_one + 40, after_one + 4'000}) {
    Memory memory(room);
    FileWriter writer(memory, "test", two_channels());
    write_chunks(writer, 1);
    writer.write(1, 300, 300, std::vector<std::byte>(10'000));
    writer.flush();
    EXPECT_TRUE(writer.failed());
    write_chunks(writer, 1);
    EXPECT_FALSE(writer.close());
    EXPECT_EQ(writer.messages(), 5U);
    EXPECT_EQ(writer.messages_written(), 2U);
    const Contents contents = read(memory.file);
    EXPECT_EQ(contents.messages.size(), 2U);
    EXPECT_EQ(contents.complete, room > after_one + 40) << "the end needs some hundred bytes";
  }
}

// Where a channel is described only when it is used: it is in no file without a message of it, and before the chunk with the
// first one, so that a file that breaks off has it too.
TEST(Mcap, AChannelThatIsThereOnlyWhenUsed) {
  std::vector<ChannelDescription> channels = two_channels();
  channels.insert(channels.begin() + 1, {"a/fence", "cdr", "V", "omgidl", "struct V {};", {}, true});
  const auto topics = [&](bool is_used, bool is_closed) {
    Memory memory;
    FileWriter writer(memory, "test", channels);
    writer.write(1, 100, 90, bytes_of("first"));
    writer.flush();
    writer.write(3, 101, 91, bytes_of("third"));
    if (is_used) writer.write(2, 102, 92, bytes_of("second"));
    const std::uint16_t own = writer.add_channel({"/own", "json", "W", "jsonschema", "{}", {}, true});
    if (is_used) writer.write(own, 103, 93, bytes_of("own"));
    writer.flush();
    if (is_closed) { EXPECT_TRUE(writer.close()); }
    const Contents contents = read(memory.file);
    EXPECT_EQ(contents.lost_messages, 0U);
    EXPECT_EQ(contents.messages.size(), is_used ? 4U : 2U);
    std::string all;
    for (const auto& [number, channel] : contents.channels) {
      EXPECT_EQ(contents.schemas.count(channel.schema), 1U);
      all += std::to_string(number) + " " + channel.topic + " ";
    }
    return all;
  };
  for (const bool is_closed : {false, true}) {
    EXPECT_EQ(topics(false, is_closed), "1 a/object 3 a/pose ");
    EXPECT_EQ(topics(true, is_closed), "1 a/object 2 a/fence 3 a/pose 4 /own ");
  }
}

TEST(Mcap, OtherBytesAreNoMcap) {
  EXPECT_FALSE(read({}).is_mcap);
  EXPECT_FALSE(read(bytes_of("t,name,x,y,z\n")).is_mcap);
}

TEST(Mcap, ChannelsOfANamespaceAreToldApart) {
  Memory memory;
  FileWriter writer(memory, recording::library_name(), recording::channels_of("hall/a"));
  for (const recording::RecordedTopic& topic : recording::kRecordedTopics)
    writer.write(static_cast<std::uint16_t>(topic.what), 1, 1, {});
  writer.close();
  const Contents contents = read(memory.file);
  ASSERT_EQ(contents.channels.size(), recording::kRecordedTopics.size());
  for (const recording::RecordedTopic& topic : recording::kRecordedTopics) {
    const auto number = static_cast<std::uint16_t>(topic.what);
    EXPECT_EQ(recording::recorded_topic(contents.channels.at(number), contents), topic.what);
  }
  // Another's channel may have a name like one of ours: what is in it says its schema, and how, its encoding.
  Contents others = contents;
  for (auto& [number, schema] : others.schemas) schema.name = "other::" + schema.name;
  Contents none = contents;
  none.schemas.clear();
  for (const auto& [number, channel] : contents.channels) {
    auto renamed = channel, encoded = channel;
    renamed.topic += "s";
    encoded.encoding = "json";
    EXPECT_EQ(recording::recorded_topic(channel, others), std::nullopt) << channel.topic;
    EXPECT_EQ(recording::recorded_topic(channel, none), std::nullopt) << channel.topic;
    EXPECT_EQ(recording::recorded_topic(renamed, contents), std::nullopt) << channel.topic;
    EXPECT_EQ(recording::recorded_topic(encoded, contents), std::nullopt) << channel.topic;
  }
  EXPECT_EQ(contents.channels.at(1).topic, "hall/a/object_v2");
  EXPECT_NE(contents.schemas.at(1).text.find("@final struct Definition"), std::string::npos);
}

}  // namespace
}  // namespace collided::mcap
