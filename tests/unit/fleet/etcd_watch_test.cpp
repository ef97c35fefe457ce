// A watch tells every change once and in order, whatever becomes of the members that it reads from.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "idl/base64.hpp"
#include "idl/etcd/etcd_client.hpp"
#include "idl/etcd/etcd_members.hpp"
#include "idl/etcd/etcd_watch.hpp"
#include "tests/service/child_process.hpp"
#include "tests/service/etcd_process.hpp"
#include "tests/service/eventually.hpp"
#include "tests/unit/fleet/hostile_server.hpp"
#include "tests/unit/fleet/watch_run.hpp"

namespace collided::etcd {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using testing_support::EtcdCluster;
using testing_support::HostileServer;
using testing_support::WatchRun;

const std::string kStreamHead = "HTTP/1.1 200 OK\r\nContent-Type: application/json\r\n\r\n";
const std::string kCreated = R"({"result":{"header":{"revision":"9"},"created":true}})"
                             "\n";

std::string put(const std::string& key, const std::string& value, int revision) {
  return R"({"kv":{"key":")" + encode_base64(key) + R"(","value":")" + encode_base64(value) + R"(","mod_revision":")" +
         std::to_string(revision) + R"("}})";
}
std::string line_of(const std::string& events, bool is_fragment = false) {
  return R"({"result":{"header":{"revision":"9"},)" + std::string(is_fragment ? R"("fragment":true,)" : "") +
         R"("events":[)" + events + "]}}\n";
}
HostileServer::Treat silent() {
  return [](int, const std::atomic<bool>& is_over) {
    while (!is_over.load()) std::this_thread::sleep_for(5ms);
  };
}
/// Says a text, and then nothing.
HostileServer::Treat says_and_waits(const std::string& text) {
  return [text](int connection, const std::atomic<bool>& is_over) {
    HostileServer::send_all(connection, text);
    silent()(connection, is_over);
  };
}
EtcdAddress at(const std::vector<const HostileServer*>& servers) {
  EtcdAddress address{.endpoints = {}, .key = ""};
  for (const HostileServer* one : servers) address.endpoints.push_back(one->endpoint());
  return address;
}

TEST(EtcdWatch, TellsPutsAndRemovalsInTheirOrder) {
  const HostileServer server(says_and_waits(
      kStreamHead + kCreated +
      line_of(put("yard", "west", 5) + R"(,{"type":"DELETE","kv":{"key":"eWFyZA==","mod_revision":"6"}})") +
      line_of(put("yard", "", 7))));
  WatchRun run(at({&server}), {.key = "yard", .from = 5});
  EXPECT_TRUE(test::eventually([&] { return run.texts().size() == 3; }));
  EXPECT_EQ(run.texts(), (std::vector<std::string>{"yard=west@5", "yard=gone@6", "yard=@7"}));
  const std::string question = server.questions().at(0);
  EXPECT_NE(question.find(R"("start_revision":"5")"), question.npos) << question;
  EXPECT_EQ(question.find("range_end"), question.npos) << question;
  EXPECT_LT(run.stop(), 1s);
  EXPECT_EQ(run.end(), WatchEnd::over);
}

// The stream breaks off within revision 6, of which nothing was told; it comes whole from the next member.
TEST(EtcdWatch, GoesOnWhereItWasWithAnotherMember) {
  const HostileServer first(
      HostileServer::says(kStreamHead + kCreated + line_of(put("a", "1", 5) + "," + put("a", "2", 6), true)));
  const HostileServer second(says_and_waits(
      kStreamHead + kCreated + line_of(put("a", "2", 6) + "," + put("b", "3", 6)) + line_of(put("a", "4", 8))));
  WatchRun run(at({&first, &second}), {.key = "", .is_prefix = true, .from = 3});
  EXPECT_TRUE(test::eventually([&] { return run.texts().size() >= 4; }));
  EXPECT_EQ(run.texts(), (std::vector<std::string>{"a=1@5", "a=2@6", "b=3@6", "a=4@8"}));
  const std::string question = second.questions().at(0);
  EXPECT_NE(question.find(R"("start_revision":"6")"), question.npos) << question;
  EXPECT_EQ(run.problems().size(), 2U) << "one, and that it is over";
}

TEST(EtcdWatch, LeavesAMemberThatDoesNotBegin) {
  const HostileServer frozen(silent());
  const HostileServer good(says_and_waits(kStreamHead + kCreated + line_of(put("a", "1", 5))));
  WatchRun run(at({&frozen, &good}), {.key = "a"});
  EXPECT_TRUE(test::eventually([&] { return run.texts().size() == 1; }));
  ASSERT_FALSE(run.problems().empty());
  EXPECT_NE(run.problems()[0].find("no answer within 300 ms"), std::string::npos) << run.problems()[0];
}

TEST(EtcdWatch, EndsWithinASecondWhileNobodyAnswers) {
  const HostileServer frozen(silent());
  WatchRun run(at({&frozen}), {.key = "a"}, 60'000'000'000);
  EXPECT_TRUE(test::eventually([&] { return frozen.asked() > 0; }));
  EXPECT_LT(run.stop(), 1s);
}

TEST(EtcdWatch, WhatIsNoAnswerIsAProblemAndTriedAgain) {
  for (const std::string& text :
       {std::string("no JSON\n"), std::string("[]\n"), std::string("{}\n"), std::string("{\"result\":7}\n"),
        std::string("{\"result\":{\"events\":[7]}}\n"), std::string("{\"result\":{\"events\":{}}}\n"),
        std::string("{\"error\":{\"message\":\"no leader\"}}\n"), std::string("{\"result\":{\"canceled\":true}}\n")}) {
    std::atomic<bool> is_good = false;
    const HostileServer server([&](int connection, const std::atomic<bool>& is_over) {
      says_and_waits(kStreamHead + (is_good ? kCreated + line_of(put("a", "1", 5)) : text))(connection, is_over);
    });
    WatchRun run(at({&server}), {.key = "a"});
    EXPECT_TRUE(test::eventually([&] { return !run.problems().empty(); })) << text;
    EXPECT_TRUE(run.texts().empty()) << text;
  }
}

TEST(EtcdWatch, WhatIsCompactedIsToBeReadAgain) {
  const HostileServer server(says_and_waits(kStreamHead + kCreated +
                                            R"({"result":{"canceled":true,"compact_revision":"7"}})"
                                            "\n"));
  WatchRun run(at({&server}), {.key = "a", .from = 2});
  EXPECT_TRUE(test::eventually([&] { return run.has_ended(); }));
  EXPECT_EQ(run.end(), WatchEnd::read_again);
}

class EtcdWatchOfThree : public testing::Test {
 protected:
  void SetUp() override {
    if (!testing_support::has_etcd()) GTEST_SKIP() << "etcd is not installed";
    cluster_ = std::make_unique<EtcdCluster>(3, folder_.path());
    ASSERT_TRUE(cluster_->is_ready(60s));
    writer_ = std::make_unique<EtcdClient>(address(), 2'000'000'000);
  }
  EtcdAddress address() const { return *parse_etcd_address(cluster_->address()); }
  /// Writes as often, to two keys in turn, also while a member is away.
  void write(int from, int until) {
    for (int i = from; i < until;) {
      const std::string key = i % 2 == 0 ? "log/a" : "log/b";
      StoreTransaction once{.conditions = {{.key = "count"}}, .writes = {{key, std::to_string(i)}}, .reads = {"count"}};
      once.writes.push_back({"count", std::to_string(i)});
      if (i > 0) once.conditions = {{.key = "count", .is = StoreCondition::Is::equal, .value = std::to_string(i - 1)}};
      try {
        const StoreResult result = writer_->transact(once);
        ASSERT_TRUE(result.is_done || result.values.at(0) == std::to_string(i)) << i;
        ++i;
      } catch (const StoreError&) {}
    }
  }
  static std::vector<std::string> values_of(const WatchRun& run) {
    std::vector<std::string> values;
    for (const std::string& text : run.texts()) values.push_back(text.substr(6, text.find('@') - 6));
    return values;
  }
  static std::vector<std::string> numbers_to(int count) {
    std::vector<std::string> numbers;
    for (int i = 0; i < count; ++i) numbers.push_back(std::to_string(i));
    return numbers;
  }

  const testing_support::ScratchFolder folder_;
  std::unique_ptr<EtcdCluster> cluster_;
  std::unique_ptr<EtcdClient> writer_;
};

// The watch reads from the first member; whatever is killed and frozen meanwhile, each number comes once, in order.
TEST_F(EtcdWatchOfThree, LosesAndDoublesNothingWhereItsMemberDiesOrFreezes) {
  WatchRun run(address(), {.key = "log/", .is_prefix = true}, 1'000'000'000);
  write(0, 100);
  ASSERT_TRUE(test::eventually([&] { return run.texts().size() == 100; }));
  cluster_->member(0).signal(SIGKILL);
  write(100, 200);
  ASSERT_TRUE(test::eventually([&] { return run.texts().size() == 200; }));
  cluster_->member(0).wait(5s);
  cluster_->start(0);
  ASSERT_TRUE(cluster_->is_ready(60s));
  cluster_->member(1).signal(SIGSTOP);
  write(200, 300);
  EXPECT_TRUE(test::eventually([&] { return run.texts().size() == 300; }));
  cluster_->member(1).signal(SIGCONT);
  EXPECT_EQ(values_of(run), numbers_to(300));
  EXPECT_LT(run.stop(), 1s);
}

TEST_F(EtcdWatchOfThree, BeginsAtARevisionAndSaysWhereThatIsCompactedAway) {
  write(0, 10);
  const std::int64_t last = writer_->transact({.conditions = {}, .writes = {}, .reads = {"count"}}).revisions.at(0);
  {
    WatchRun run(address(), {.key = "log/", .is_prefix = true, .from = last - 3});
    EXPECT_TRUE(test::eventually([&] { return run.texts().size() == 4; }));
    EXPECT_EQ(values_of(run), (std::vector<std::string>{"6", "7", "8", "9"}));
  }
  EtcdMembers(address(), 5'000'000'000).ask("/v3/kv/compaction", {{"revision", std::to_string(last)}}, [](const json&) {
  });
  WatchRun run(address(), {.key = "log/", .is_prefix = true, .from = last - 3});
  EXPECT_TRUE(test::eventually([&] { return run.has_ended(); }));
  EXPECT_EQ(run.end(), WatchEnd::read_again);
}

}  // namespace
}  // namespace collided::etcd
