// Whoever is on the domain can write into a client's reply partition, and on every topic of the server: nothing of that
// is believed, and it is told.
#include <gtest/gtest.h>

#include <algorithm>

#include "collided/client.hpp"
#include "collided/diagnosis.hpp"
#include "tests/service/child_process.hpp"
#include "tests/service/wire/fake_server.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;
using test::eventually;
using test::FakeServer;
using testing_support::ChildProcess;

dds::ParticipantOptions third_side() {
  return {.domain = test::own_domain(), .role = dds::Role::server, .process_domain = test::own_domain() + 200'000};
}

/// Reads the questions of all clients, and once it has begun answers each ray at once: a miss, with the right numbers of
/// client and request.
class Denier {
 public:
  explicit Denier(dds::Participant& participant)
      : query_topic_(participant, test::own_namespace()),
        reply_topic_(participant, test::own_namespace()),
        query_reader_(query_topic_, {.data = [this](dds::Taker<wire::Query> taker) { take(taker); }}) {}

  std::uint64_t client() {
    const std::lock_guard lock(mutex_);
    return client_;
  }
  std::uint64_t denied() {
    const std::lock_guard lock(mutex_);
    return denied_;
  }
  /// True once that client's reader is matched.
  bool begin(std::uint64_t client) {
    auto writer = std::make_unique<dds::Writer<wire::Reply>>(
        reply_topic_, dds::WriterOptions{.partition = wire_contract::reply_partition(client)});
    const bool is_matched = eventually([&] { return writer->matched_readers() > 0; });
    const std::lock_guard lock(mutex_);
    writer_ = std::move(writer);
    return is_matched;
  }

 private:
  void take(const dds::Taker<wire::Query>& taker) {
    while (taker.take(query_)) {
      if (!query_.info().valid_data) continue;
      const std::lock_guard lock(mutex_);
      client_ = query_->client;
      if (writer_ && query_->kind == static_cast<std::uint8_t>(wire_contract::QuestionKind::ray)) deny(*query_);
    }
  }
  void deny(const wire::Query& query) {
    static const std::vector<std::uint8_t> kMiss{0}, kNoReason{0}, kLevel{1};
    static const std::vector<std::uint32_t> kNone{0};
    wire::Reply reply{};
    reply.client = query.client;
    reply.request = query.request;
    reply.chunk_index = query.chunk_index;
    reply.chunk_count = query.chunk_count;
    reply.first_question = query.first_question;
    reply.server = 1;
    reply.epoch = 101;
    reply.version = 5;
    reply.oldest_pose_age_ns = -1;
    dds::borrow(reply.answers, kMiss);
    dds::borrow(reply.reasons, kNoReason);
    dds::borrow(reply.levels, kLevel);
    dds::borrow(reply.hit_counts, kNone);
    dds::borrow(reply.nodes, kNone);
    dds::borrow(reply.exact_tests, kNone);
    denied_ += writer_->write(reply) ? 1 : 0;
  }

  std::mutex mutex_;
  std::uint64_t client_ = 0;
  std::uint64_t denied_ = 0;
  std::unique_ptr<dds::Writer<wire::Reply>> writer_;
  dds::Sample<wire::Query> query_;
  dds::Topic<wire::Query> query_topic_;
  dds::Topic<wire::Reply> reply_topic_;
  dds::Reader<wire::Query> query_reader_;
};

class ClientStrangers : public testing::Test {
 protected:
  void SetUp() override {
    Result<Client> connected = Client::connect(test::here());
    ASSERT_TRUE(connected) << connected.error().message;
    client_.emplace(std::move(*connected));
  }
  /// Of so many rays that hit, how many the client was told are misses, while the denier answers before the server.
  int misses_of(int rays, Denier& denier) {
    const auto ask = [&] { return client_->ask(RayQuestion{{1, 0, 5}, {0, 0, -1}}); };
    // Until it hears the client's questions.
    EXPECT_TRUE(eventually([&] { return ask() && denier.client() != 0; }));
    EXPECT_TRUE(denier.begin(denier.client()));
    server_.delay_us = 3'000;
    int misses = 0;
    for (int i = 0; i < rays; ++i) {
      const Result<Answer> answer = ask();
      EXPECT_TRUE(answer) << answer.error().message;
      misses += answer && answer->verdict == Verdict::miss ? 1 : 0;
    }
    // A question that waited long is asked again; the server's answer to the last one may come before the denial.
    EXPECT_TRUE(eventually([&] { return denier.denied() >= static_cast<std::uint64_t>(rays); }));
    return misses;
  }
  FakeServer server_{test::own_namespace()};
  std::optional<Client> client_;
};

// Of 300 hits 157 had become misses.
TEST_F(ClientStrangers, ForgedRepliesAreNotBelieved) {
  dds::Participant stranger(third_side());
  Denier denier(stranger);
  EXPECT_EQ(client_->strangers().samples, 0U);
  EXPECT_EQ(misses_of(300, denier), 0);
  EXPECT_TRUE(eventually([&] { return client_->strangers().samples == denier.denied(); }))
      << client_->strangers().samples;
  EXPECT_TRUE(client_->strangers().speak_now);
}

// The same replies out of the server's own process are believed: it is the writer that counts, and the forgery is good.
TEST_F(ClientStrangers, TheSameRepliesOfTheServerItselfAreBelieved) {
  Denier denier(server_.participant());
  EXPECT_GT(misses_of(50, denier), 0);
  EXPECT_EQ(client_->strangers().samples, 0U);
  EXPECT_FALSE(client_->strangers().speak_now);
}

// Before anybody has answered its hello a client cannot know whose a status is. What is not the server's is forgotten then.
TEST_F(ClientStrangers, AForgedStatusIsNotBelievedByWhoeverHasJustJoined) {
  constexpr std::uint32_t kForgedPid = 666;
  FakeServer stranger(test::own_namespace(), server_.number(), third_side());
  stranger.answering = false;
  {
    const std::lock_guard lock(stranger.mutex);
    stranger.status->pid = kForgedPid;
  }
  ASSERT_TRUE(eventually([&] { return client_->strangers().speak_now; }));
  for (int i = 0; i < 20; ++i) {
    Result<Client> joined = Client::connect(test::here());
    ASSERT_TRUE(joined) << joined.error().message;
    const Result<ServerStatus> status = joined->status();
    ASSERT_TRUE(status) << status.error().message;
    EXPECT_NE(status->pid, kForgedPid) << "client " << i;
  }
}

// The first words of a new server may come before the old one counts as silent.
TEST_F(ClientStrangers, ASuccessorIsNone) {
  server_.beating = false;
  server_.answering = false;
  FakeServer successor(test::own_namespace(), 2, third_side());
  ASSERT_TRUE(eventually([&] { return client_->status() && client_->status()->epoch == 102; }));
  ASSERT_TRUE(eventually([&] { return !!client_->ask(RayQuestion{{1, 0, 5}, {0, 0, -1}}); }));
  EXPECT_FALSE(eventually([&] { return client_->strangers().speak_now; }, 300ms));
}

TEST_F(ClientStrangers, ASecondServerIsToldByTheDoctorAndWarnedOfOnce) {
  const auto finding = [&]() -> std::optional<Finding> {
    for (const Finding& one : diagnose(test::here())) {
      if (one.about == "strangers") return one;
    }
    return std::nullopt;
  };
  const auto warnings = [&] {
    ChildProcess watching({COLLIDED_CLI, "--domain", std::to_string(test::own_domain()), "--namespace",
                           test::own_namespace(), "--wait", "5s", "watch", "--for", "1s"},
                          ::testing::TempDir(), "watching_" + test::own_namespace());
    watching.wait(20s);
    const std::string said = watching.errors();
    int count = 0;
    for (std::size_t at = 0; (at = said.find("warning: a second server speaks", at)) != std::string::npos; ++at)
      ++count;
    return count;
  };
  EXPECT_FALSE(finding());
  EXPECT_EQ(warnings(), 0);
  EXPECT_FALSE(client_->strangers().speak_now);
  // It says of itself that it is the one that was met.
  FakeServer stranger(test::own_namespace(), server_.number(), third_side());
  stranger.answering = false;
  ASSERT_TRUE(eventually([&] { return client_->strangers().speak_now; }));
  const std::optional<Finding> found = finding();
  ASSERT_TRUE(found);
  EXPECT_EQ(found->health, Health::warn);
  EXPECT_NE(found->text.find("came from a process that is not the server; none was taken"), std::string::npos)
      << found->text;
  EXPECT_EQ(warnings(), 1);
}

}  // namespace
}  // namespace collided
