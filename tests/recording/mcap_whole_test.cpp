#include <gtest/gtest.h>

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
  Writer one(plain, "test", kChannel);
  Writer other(flushed, "test", kChannel);
  other.flush();
  EXPECT_EQ(flushed.file, plain.file);
  for (Writer* writer : {&one, &other}) writer->write(1, 7, 8, std::vector<std::byte>(9));
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
  Writer writer(output, "test", kChannel);
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

}  // namespace
}  // namespace collided::mcap
