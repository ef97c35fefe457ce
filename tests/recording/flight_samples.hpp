#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <random>
#include <thread>
#include <vector>

#include "idl/mcap/reader.hpp"
#include "server/service/recording/flight_recorder.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/service/wire/rows.hpp"

namespace collided::engine::service {

using recording::Recorded;

class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "flight_XXXXXX").string();
    EXPECT_NE(mkdtemp(name.data()), nullptr);
    path_ = name;
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  std::string stem() const { return path_ + "/server"; }

 private:
  std::string path_;
};

/// Of `count` objects numbered from 0, all at x.
inline dds::Sample<wire::PoseBatch> batch(std::uint64_t publisher, std::uint64_t sequence, std::uint32_t count,
                                          double x) {
  dds::Sample<wire::PoseBatch> sample;
  sample->publisher = publisher;
  sample->incarnation = 1;
  sample->sequence_number = sequence;
  std::vector<std::uint32_t> numbers(count);
  std::vector<double> poses;
  for (std::uint32_t i = 0; i < count; ++i) {
    numbers[i] = i;
    poses.insert(poses.end(), {x, 0, 0, 1, 0, 0, 0});
  }
  dds::borrow(sample->object_numbers, numbers);
  test::put_poses(*sample, poses);
  std::vector<std::byte> bytes(wire::cdr_size(*sample));
  wire::write_cdr(*sample, bytes);
  dds::Sample<wire::PoseBatch> owner;  // of its sequences
  EXPECT_TRUE(wire::read_cdr(std::span<const std::byte>(bytes), owner));
  dds::borrow(sample->object_numbers, std::span<const std::uint32_t>());
  return owner;
}

inline dds::Sample<wire::Definition> definition(std::uint64_t publisher, std::uint32_t number, std::uint64_t sequence,
                                                bool removed = false) {
  dds::Sample<wire::Definition> sample;
  sample->publisher = publisher;
  sample->object_number = number;
  sample->incarnation = 1;
  sample->sequence_number = sequence;
  sample->removed = removed;
  EXPECT_TRUE(dds::set_text(sample->name, "object " + std::to_string(number)));
  return sample;
}

inline dds::Sample<wire::Query> command(const std::string& text, std::uint64_t request = 0) {
  dds::Sample<wire::Query> sample;
  sample->client = request == 0 ? 0 : 5;
  sample->request = request;
  sample->kind = static_cast<std::uint8_t>(wire_contract::QuestionKind::command);
  sample->chunk_count = 1;
  EXPECT_TRUE(dds::set_text(sample->text, text));
  return sample;
}

}  // namespace collided::engine::service
