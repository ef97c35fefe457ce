#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <vector>

#include "idl/mcap/reader.hpp"
#include "idl/mcap/writer.hpp"

namespace collided::mcap {
namespace {

/// A file in memory that takes pieces of so many bytes at most.
class Pieces : public Output {
 public:
  explicit Pieces(std::size_t most_bytes = 1 << 20) : most_bytes_(most_bytes) {}
  bool append(std::span<const std::byte> bytes) override {
    if (bytes.size() > most_bytes_) return false;
    file.insert(file.end(), bytes.begin(), bytes.end());
    return true;
  }
  const std::string& problem() const override { return problem_; }
  std::vector<std::byte> file;

 private:
  std::size_t most_bytes_;
  std::string problem_ = "too large";
};

const std::vector<ChannelDescription> kChannel{{"a/pose", "cdr", "T", "omgidl", "struct T {};", {}}};

TEST(McapWriter, FlushingNothingWritesNothing) {
  Pieces plain;
  Pieces flushed;
  FileWriter one(plain, "test", kChannel);
  FileWriter other(flushed, "test", kChannel);
  other.flush();
  EXPECT_EQ(flushed.file, plain.file);
  for (FileWriter* writer : {&one, &other}) writer->write(1, 7, 8, std::vector<std::byte>(9));
  other.flush();
  const std::size_t size = flushed.file.size();
  other.flush();
  EXPECT_EQ(flushed.file.size(), size);
  EXPECT_TRUE(one.close());
  EXPECT_TRUE(other.close());
  EXPECT_EQ(flushed.file, plain.file);
}

// After a piece that was refused there may be a gap: smaller ones that would fit are not written behind it.
TEST(McapWriter, AfterARefusalOnlyTheEndIsWritten) {
  Pieces output(4'000);
  FileWriter writer(output, "test", kChannel);
  writer.write(1, 1, 1, std::vector<std::byte>(10));
  writer.metadata("before", {{"key", "value"}});
  writer.write(1, 2, 2, std::vector<std::byte>(10'000));
  writer.flush();
  EXPECT_TRUE(writer.failed());
  const std::vector<std::byte> file = output.file;
  writer.write(1, 3, 3, std::vector<std::byte>(10));
  writer.flush();
  writer.metadata("after", {{"key", "value"}});
  EXPECT_EQ(output.file, file);
  writer.close();
  const Contents contents = read(output.file);
  EXPECT_TRUE(contents.complete);
  EXPECT_EQ(contents.messages.size(), 1U);
  EXPECT_EQ(contents.metadata.size(), 1U);
  EXPECT_EQ(contents.metadata.at("before").at("key"), "value");
}

/// Takes numbers and texts one after the other, as the format's description lays them.
class Walk {
 public:
  Walk(const std::vector<std::byte>& file, std::size_t at) : file_(file), at_(at) {}
  template <class Number>
  Number number() {
    Number value{};
    EXPECT_LE(at_ + sizeof value, file_.size());
    if (at_ + sizeof value <= file_.size()) std::memcpy(&value, file_.data() + at_, sizeof value);
    at_ += sizeof value;
    return value;
  }
  std::uint64_t u64() { return number<std::uint64_t>(); }
  std::string text() {
    std::string text(number<std::uint32_t>(), ' ');
    for (char& c : text) c = number<char>();
    return text;
  }
  std::size_t at() const { return at_; }

 private:
  const std::vector<std::byte>& file_;
  std::size_t at_;
};

struct Found {
  Opcode opcode;
  std::size_t at;     // of its first byte
  std::size_t begin;  // of its content
  std::size_t end;
};

std::vector<Found> records(const std::vector<std::byte>& file) {
  std::vector<Found> all;
  for (std::size_t at = kMagic.size(); at + kMagic.size() < file.size();) {
    Walk walk(file, at);
    const auto opcode = static_cast<Opcode>(walk.number<std::uint8_t>());
    const std::uint64_t size = walk.u64();
    all.push_back({opcode, at, walk.at(), walk.at() + size});
    at = all.back().end;
  }
  return all;
}

struct Sent {
  std::uint16_t channel;
  std::uint64_t time;
};
// Neither the first nor the last of a chunk is its earliest or latest, and the second chunk is earlier than the first.
const std::vector<std::vector<Sent>> kChunks{{{1, 105}, {2, 101}, {1, 130}, {1, 103}},
                                             {{2, 60}, {2, 120}, {2, 55}, {2, 70}}};

std::vector<std::byte> indexed_file() {
  Pieces output;
  FileWriter writer(
      output, "test",
      {{"a/pose", "cdr", "T", "omgidl", "struct T {};", {}}, {"a/event", "cdr", "U", "omgidl", "struct U {};", {}}});
  for (const std::vector<Sent>& chunk : kChunks) {
    for (const Sent& sent : chunk)
      writer.write(sent.channel, sent.time, sent.time - 50, std::vector<std::byte>(sent.channel * 10u));
    writer.flush();
  }
  writer.metadata("recording", {{"key", "value"}});
  EXPECT_TRUE(writer.close());
  return output.file;
}

std::vector<Found> of_kind(const std::vector<std::byte>& file, Opcode opcode) {
  std::vector<Found> all = records(file);
  std::erase_if(all, [&](const Found& record) { return record.opcode != opcode; });
  return all;
}

// What a player that jumps relies on: each index names its chunk's bytes and times, and each message's place in it.
TEST(McapWriter, IndexesNameEveryChunkAndEveryMessage) {
  const std::vector<std::byte> file = indexed_file();
  const std::vector<Found> chunks = of_kind(file, Opcode::chunk), indexes = of_kind(file, Opcode::chunk_index);
  ASSERT_EQ(chunks.size(), kChunks.size());
  ASSERT_EQ(indexes.size(), kChunks.size());
  const std::vector<std::pair<std::uint64_t, std::uint64_t>> spans{{101, 130}, {55, 120}};
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    Walk chunk(file, chunks[i].begin), index(file, indexes[i].begin);
    for (Walk* walk : {&chunk, &index}) {
      EXPECT_EQ(walk->u64(), spans[i].first);
      EXPECT_EQ(walk->u64(), spans[i].second);
    }
    EXPECT_EQ(index.u64(), chunks[i].at);
    EXPECT_EQ(index.u64(), chunks[i].end - chunks[i].at);
    const std::uint64_t size = chunk.u64();
    chunk.number<std::uint32_t>();  // the checksum, which reading looks at
    EXPECT_EQ(chunk.text(), "");
    EXPECT_EQ(chunk.u64(), size);
    const std::size_t first_message = chunk.at();
    EXPECT_EQ(first_message + size, chunks[i].end);
    const auto map_bytes = index.number<std::uint32_t>();
    ASSERT_EQ(map_bytes, (i == 0 ? 2u : 1u) * 10);
    std::size_t after_indexes = chunks[i].end;
    std::size_t indexed_count = 0;
    for (std::uint32_t left = map_bytes; left > 0; left -= 10) {
      const auto channel = index.number<std::uint16_t>();
      const std::uint64_t offset = index.u64();
      EXPECT_EQ(offset, after_indexes) << "one index follows the other";
      Walk messages(file, offset);
      EXPECT_EQ(static_cast<Opcode>(messages.number<std::uint8_t>()), Opcode::message_index);
      const std::uint64_t content = messages.u64();
      after_indexes = messages.at() + content;
      EXPECT_EQ(messages.number<std::uint16_t>(), channel);
      const auto list_bytes = messages.number<std::uint32_t>();
      EXPECT_EQ(content, 2 + 4 + list_bytes);
      for (const Sent& sent : kChunks[i]) {
        if (sent.channel != channel) continue;
        EXPECT_EQ(messages.u64(), sent.time);
        Walk message(file, first_message + messages.u64());
        EXPECT_EQ(static_cast<Opcode>(message.number<std::uint8_t>()), Opcode::message);
        EXPECT_EQ(message.u64(), 22u + channel * 10u);
        EXPECT_EQ(message.number<std::uint16_t>(), channel);
        message.number<std::uint32_t>();
        EXPECT_EQ(message.u64(), sent.time);
        EXPECT_EQ(message.u64(), sent.time - 50);
        ++indexed_count;
      }
      EXPECT_EQ(messages.at(), after_indexes);
    }
    EXPECT_EQ(indexed_count, kChunks[i].size());
    EXPECT_EQ(index.u64(), after_indexes - chunks[i].end) << "bytes of its indexes";
    EXPECT_EQ(index.text(), "");
    EXPECT_EQ(index.u64(), size);
    EXPECT_EQ(index.u64(), size);
    EXPECT_EQ(index.at(), indexes[i].end);
  }
}

TEST(McapWriter, TheSummaryCountsAndFindsEverything) {
  const std::vector<std::byte> file = indexed_file();
  const std::vector<Found> statistics = of_kind(file, Opcode::statistics);
  ASSERT_EQ(statistics.size(), 1u);
  Walk walk(file, statistics[0].begin);
  EXPECT_EQ(walk.u64(), 8u) << "messages";
  EXPECT_EQ(walk.number<std::uint16_t>(), 2u) << "schemas";
  EXPECT_EQ(walk.number<std::uint32_t>(), 2u) << "channels";
  EXPECT_EQ(walk.number<std::uint32_t>(), 0u) << "attachments";
  EXPECT_EQ(walk.number<std::uint32_t>(), 1u) << "metadata";
  EXPECT_EQ(walk.number<std::uint32_t>(), 2u) << "chunks";
  EXPECT_EQ(walk.u64(), 55u);
  EXPECT_EQ(walk.u64(), 130u);
  EXPECT_EQ(walk.number<std::uint32_t>(), 20u);
  for (const auto& [channel, count] : {std::pair<std::uint16_t, std::uint64_t>{1, 3}, {2, 5}}) {
    EXPECT_EQ(walk.number<std::uint16_t>(), channel);
    EXPECT_EQ(walk.u64(), count);
  }
  EXPECT_EQ(walk.at(), statistics[0].end);
  const std::vector<Found> metadata = of_kind(file, Opcode::metadata), named = of_kind(file, Opcode::metadata_index);
  ASSERT_EQ(metadata.size(), 1u);
  ASSERT_EQ(named.size(), 1u);
  Walk name(file, named[0].begin);
  EXPECT_EQ(name.u64(), metadata[0].at);
  EXPECT_EQ(name.u64(), metadata[0].end - metadata[0].at);
  EXPECT_EQ(name.text(), "recording");
  // The summary begins behind the end of the data: the schemas once more.
  const std::vector<Found> data_end = of_kind(file, Opcode::data_end), footer = of_kind(file, Opcode::footer);
  ASSERT_EQ(data_end.size(), 1u);
  ASSERT_EQ(footer.size(), 1u);
  Walk end(file, footer[0].begin);
  EXPECT_EQ(end.u64(), data_end[0].end);
  EXPECT_EQ(end.u64(), 0u);
  EXPECT_EQ(footer[0].end + kMagic.size(), file.size());
  EXPECT_EQ(of_kind(file, Opcode::schema).size(), 4u);
  EXPECT_EQ(of_kind(file, Opcode::channel).size(), 4u);
}

// Whatever byte it was cut at, the damage names the first byte of the record that is not whole.
TEST(McapReader, DamageNamesTheRecordThatBreaksOff) {
  const std::vector<std::byte> file = indexed_file();
  for (const Found& record : records(file)) {
    if (record.opcode == Opcode::data_end) break;
    for (const std::size_t size : {record.at + 1, record.begin, record.end - 1}) {
      EXPECT_EQ(read(std::span(file).first(size)).damage,
                "breaks off in the record at byte " + std::to_string(record.at) + "; what stands before it was read");
    }
    EXPECT_EQ(read(std::span(file).first(record.end)).damage,
              "has no end: its writer was stopped; what stands there was read");
  }
}

}  // namespace
}  // namespace collided::mcap
