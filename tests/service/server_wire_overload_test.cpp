#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/service/eventually.hpp"
#include "tests/service/server_process.hpp"
#include "tests/service/server_wire_asker.hpp"
#include "tests/service/wire/rows.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;
using testing_support::WireAsker;
using wire_contract::Importance;
using wire_contract::QuestionKind;
using wire_contract::ReplyStatus;

class ServerWireOverload : public testing_support::ServerProcess {
 protected:
  static dds::Sample<wire::Query> near(const std::vector<double>& numbers, Importance importance) {
    dds::Sample<wire::Query> query;
    query->kind = static_cast<std::uint8_t>(QuestionKind::near);
    query->importance = static_cast<std::uint8_t>(importance);
    query->mask = 0xffffffff;
    query->max_hits = 1;
    test::put_questions(*query, numbers);
    return query;
  }
  static std::optional<WireAsker::Heard> ask(WireAsker& asker, Importance importance) {
    const std::vector<double> point{0, 0, 3, 100};
    dds::Sample<wire::Query> query = near(point, importance);
    return asker.ask(*query, 20s);
  }
  static bool is(const std::optional<WireAsker::Heard>& heard, ReplyStatus status) {
    return heard && heard->status == static_cast<std::uint8_t>(status);
  }
};

// A client sends ten times what one thread can answer. Another's questions of the low class are refused, aloud; its
// other ones, and what it commands, are dealt with meanwhile; and once the flood is over so is all of that.
TEST_F(ServerWireOverload, LowQuestionsAreRefusedFirstAndHighOnesNever) {
  testing_support::ChildProcess& server = start({"--threads", "1"});
  WireAsker flooder(domain_, 0x1111);
  WireAsker quiet(domain_, 0x2222, domain_ + 1'000);
  ASSERT_TRUE(flooder.greet() && quiet.greet());
  std::vector<double> many;
  for (int i = 0; i < 200; ++i) many.insert(many.end(), {0.005 * i, 0.5, 1.0 + 0.005 * i, 100});
  bool is_refused = false;
  const auto give_up = std::chrono::steady_clock::now() + 30s;
  while (!is_refused && std::chrono::steady_clock::now() < give_up) {
    for (int i = 0; i < 1'000; ++i) {
      dds::Sample<wire::Query> query = near(many, Importance::normal);
      flooder.send(*query);
    }
    flooder.forget_replies();
    const auto low = ask(quiet, Importance::low);
    is_refused = is(low, ReplyStatus::refused) && low->text.find("low class") != std::string::npos;
  }
  ASSERT_TRUE(is_refused) << server.errors();
  EXPECT_TRUE(is(ask(quiet, Importance::normal), ReplyStatus::ok));
  EXPECT_TRUE(is(ask(quiet, Importance::high), ReplyStatus::ok));
  EXPECT_TRUE(is(ask(flooder, Importance::high), ReplyStatus::ok)) << "whoever asks";
  dds::Sample<wire::Query> list;
  list->kind = static_cast<std::uint8_t>(QuestionKind::command);
  ASSERT_TRUE(dds::set_text(list->text, R"({"command": "list"})"));
  EXPECT_TRUE(is(quiet.ask(*list, 20s), ReplyStatus::ok));
  EXPECT_NE(server.errors().find("overloaded: more questions come than can be dealt with; "), std::string::npos)
      << server.errors();
  EXPECT_NE(server.errors().find("questions of the low class are refused"), std::string::npos) << server.errors();
  EXPECT_EQ(server.errors().find("more poses come"), std::string::npos) << server.errors();
  const auto until = std::chrono::steady_clock::now() + 60s;
  while (!is(ask(quiet, Importance::low), ReplyStatus::ok) && std::chrono::steady_clock::now() < until)
    std::this_thread::sleep_for(50ms);
  EXPECT_TRUE(is(ask(quiet, Importance::low), ReplyStatus::ok)) << server.errors();
}

// Each is a file of what was remembered; they are written one after the other, and only so many wait for it.
TEST_F(ServerWireOverload, MoreRecordingsThanMayWaitAreRefused) {
  start({"--flight-recorder", "30s"});
  WireAsker asker(domain_);
  ASSERT_TRUE(asker.greet());
  std::vector<std::uint64_t> requests;
  for (int i = 0; i < 300; ++i) {
    dds::Sample<wire::Query> recording;
    recording->kind = static_cast<std::uint8_t>(QuestionKind::command);
    ASSERT_TRUE(dds::set_text(recording->text, R"({"command": "recording"})"));
    asker.send(*recording);
    requests.push_back(recording->request);
  }
  int written = 0, refused = 0;
  for (const std::uint64_t request : requests) {
    const auto heard = asker.reply_to(request, 20s);
    ASSERT_TRUE(heard) << request;
    written += is(heard, ReplyStatus::ok) ? 1 : 0;
    if (!is(heard, ReplyStatus::refused)) continue;
    ++refused;
    EXPECT_NE(heard->text.find("recording: too many such commands wait already"), std::string::npos) << heard->text;
  }
  EXPECT_GE(written, 64);
  EXPECT_GE(refused, 1);
  EXPECT_EQ(written + refused, 300);
}

// Commands that take long are answered later, by another thread, unless they are refused at once: then that is all.
TEST_F(ServerWireOverload, ARefusedCommandIsAnsweredOnce) {
  start({"--flight-recorder", "30s"});
  WireAsker asker(domain_);
  ASSERT_TRUE(asker.greet());
  const auto command = [&](const char* text) {
    dds::Sample<wire::Query> query;
    query->kind = static_cast<std::uint8_t>(QuestionKind::command);
    EXPECT_TRUE(dds::set_text(query->text, text));
    const auto heard = asker.ask(*query, 20s);
    EXPECT_TRUE(heard) << text;
    return std::pair(query->request, heard ? heard->status : std::uint8_t{255});
  };
  const auto status = [](ReplyStatus of) { return static_cast<std::uint8_t>(of); };
  std::vector<std::uint64_t> refused;
  for (const char* const text :
       {R"({"command": "menu", "questions": 100001})", R"({"command": "menu", "sed": 1})",
        R"({"command": "recording", "last_s": 86401})", R"({"command": "recording", "number": 9})",
        R"({"command": "pair", "a": "floor"})", R"({"command": "no such"})"}) {
    const auto [request, said] = command(text);
    EXPECT_EQ(said, status(ReplyStatus::refused)) << text;
    refused.push_back(request);
  }
  // One after the other: what the refused ones had left behind would be answered before these.
  EXPECT_EQ(command(R"({"command": "menu", "questions": 1})").second, status(ReplyStatus::ok));
  EXPECT_EQ(command(R"({"command": "recording", "last_s": 0})").second, status(ReplyStatus::ok));
  for (const std::uint64_t request : refused) EXPECT_FALSE(asker.reply_to(request, 0ms)) << request;
}

TEST_F(ServerWireOverload, AClassThatIsNoneIsRefused) {
  start();
  WireAsker asker(domain_);
  ASSERT_TRUE(asker.greet());
  const auto heard = ask(asker, static_cast<Importance>(3));
  ASSERT_TRUE(is(heard, ReplyStatus::refused));
  EXPECT_NE(heard->text.find("importance 3"), std::string::npos) << heard->text;
}

/// What a process has in memory, or had at most, in MiB: a line of its status.
double memory_mib(pid_t pid, const std::string& line_name) {
  std::ifstream status("/proc/" + std::to_string(pid) + "/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with(line_name)) return std::stod(line.substr(line_name.size())) / 1024;
  }
  return 0;
}

// Batches of 56 kB as fast as DDS takes them, each a request of its own: what waits in the reader (1,024), in the queue
// (64 MB) and for a state (64 MB) is all that may pile up. The flood is of 670 MB.
TEST_F(ServerWireOverload, AFloodOfLargeBatchesIsBoundedInBytes) {
  testing_support::ChildProcess& server = start({"--threads", "1"});
  WireAsker flooder(domain_, 0x3333);
  WireAsker quiet(domain_, 0x4444, domain_ + 1'000);
  ASSERT_TRUE(flooder.greet() && quiet.greet());
  const double before = memory_mib(server.pid(), "VmHWM:");
  std::vector<double> many;
  for (int i = 0; i < 1'000; ++i) many.insert(many.end(), {0.005 * i, 0.5, 5, 0.1, 0.05, -1, 1'000});
  for (int i = 0; i < 12'000; ++i) {
    dds::Sample<wire::Query> query;
    query->kind = static_cast<std::uint8_t>(QuestionKind::ray);
    query->mask = 0xffffffff;
    query->max_hits = 8;
    test::put_questions(*query, many);
    flooder.send(*query);
    if (i % 500 == 0) flooder.forget_replies();
    if (i % 3'000 != 1'500) continue;
    ASSERT_TRUE(ask(quiet, Importance::high)) << "others are answered meanwhile";
  }
  const double most = memory_mib(server.pid(), "VmHWM:");
  std::printf("before %.0f MiB, at most %.0f MiB\n", before, most);
  ASSERT_GT(before, 1);
  EXPECT_LT(most - before, 320);
  ASSERT_TRUE(ask(quiet, Importance::normal));
}

// The same in the names of 64 clients of which none listens: their batches wait for somebody who would read the replies.
TEST_F(ServerWireOverload, AFloodInManyNamesIsBoundedInBytes) {
  testing_support::ChildProcess& server = start({"--threads", "1"});
  WireAsker quiet(domain_, 0x4444);
  ASSERT_TRUE(quiet.greet());
  const dds::Participant participant({.domain = domain_, .process_domain = domain_ + 1'000});
  const dds::Topic<wire::Query> topic(participant, "collided");
  dds::Writer<wire::Query> writer(topic);
  ASSERT_TRUE(test::eventually([&] { return writer.matched_readers() > 0; }));
  const double before = memory_mib(server.pid(), "VmHWM:");
  std::vector<double> many;
  for (int i = 0; i < 1'000; ++i) many.insert(many.end(), {0.005 * i, 0.5, 5, 0.1, 0.05, -1, 1'000});
  dds::Sample<wire::Query> query;
  query->kind = static_cast<std::uint8_t>(QuestionKind::ray);
  query->mask = 0xffffffff;
  query->max_hits = 8;
  query->chunk_count = 1;
  test::put_questions(*query, many);
  for (std::uint64_t i = 0; i < 20'000; ++i) {
    query->client = 0x5000 + i % 64;
    query->request = i + 1;
    ASSERT_TRUE(test::eventually([&] { return writer.write(*query); })) << "the server reads no questions";
    if (i % 5'000 != 2'500) continue;
    ASSERT_TRUE(ask(quiet, Importance::high)) << "others are answered meanwhile";
  }
  const double most = memory_mib(server.pid(), "VmHWM:");
  std::printf("before %.0f MiB, at most %.0f MiB\n", before, most);
  ASSERT_GT(before, 1);
  EXPECT_LT(most - before, 320);
  ASSERT_TRUE(ask(quiet, Importance::normal));
}

}  // namespace
}  // namespace collided
