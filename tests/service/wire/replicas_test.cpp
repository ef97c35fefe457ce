// Who of a server and its replicas is asked next.
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "collided/client.hpp"
#include "idl/host_name.hpp"
#include "tests/service/wire/fake_server.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;
using test::FakeServer;

constexpr const char* kReplicaName = "east";

/// A made-up server and a replica of it, which hold the same world.
class AskedReplicas : public testing::Test {
 protected:
  AskedReplicas()
      : primary_(test::own_namespace()),
        replica_(wire_contract::replica_namespace(test::own_namespace(), kReplicaName), 2, elsewhere(200'000)),
        participant_(elsewhere(300'000)),
        status_topic_(participant_, test::own_namespace()),
        sign_(status_topic_),
        member_topic_(participant_, test::own_namespace()),
        members_(member_topic_) {}

  static dds::ParticipantOptions elsewhere(int which) {
    return {.domain = test::own_domain(), .role = dds::Role::server, .process_domain = test::own_domain() + which};
  }
  void say_member(std::uint64_t server, wire_contract::MemberRole role, std::string_view host) {
    dds::Sample<wire::Member> member;
    member->server = server;
    member->epoch = 100 + server;
    member->role = static_cast<std::uint8_t>(role);
    member->state = static_cast<std::uint8_t>(wire_contract::ServerState::ready);
    static_cast<void>(dds::set_text(member->name, kReplicaName));
    static_cast<void>(dds::set_text(member->host, host));
    static_cast<void>(dds::set_text(member->server_version, "1.0.0"));
    member->digest_time_ns = ++instant_ * 1'000'000'000;
    const std::vector<std::uint64_t> sums(128, 7);
    dds::borrow(member->digest, sums);
    ASSERT_TRUE(members_.write(*member));
  }
  /// Which of 40 questions, one after the other, the replica was asked, once it is asked at all or the primary has been asked
  /// often enough to know it.
  std::size_t asked_of_replica(Client& client, std::string_view primary_host, std::string_view replica_host) {
    const auto ask = [&](int count) {
      const std::size_t before = replica_.query_chunks().size();
      for (int i = 0; i < count; ++i)
        EXPECT_TRUE(client.ask(RayQuestion{.origin = {1, 0, 0}, .direction = {1, 0, 0}}, {.timeout = 5s}));
      return replica_.query_chunks().size() - before;
    };
    // Both are asked where several questions are under way, wherever they are: then the replica is known.
    const bool is_known = test::eventually(
        [&] {
          const std::int64_t instant = instant_;
          say_member(1, wire_contract::MemberRole::primary, primary_host);
          instant_ = instant;  // the same one
          say_member(2, wire_contract::MemberRole::replica, replica_host);
          return both_are_asked(client);
        },
        20s);
    EXPECT_TRUE(is_known);
    return ask(40);
  }
  bool both_are_asked(Client& client) {
    const std::size_t before = replica_.query_chunks().size();
    std::vector<std::thread> askers;
    for (int i = 0; i < 4; ++i) {
      askers.emplace_back([&] {
        for (int k = 0; k < 10; ++k)
          static_cast<void>(client.ask(RayQuestion{.origin = {1, 0, 0}, .direction = {1, 0, 0}}, {.timeout = 5s}));
      });
    }
    for (std::thread& asker : askers) asker.join();
    return replica_.query_chunks().size() > before;
  }

  FakeServer primary_;
  FakeServer replica_;
  dds::Participant participant_;
  dds::Topic<wire::Status> status_topic_;
  dds::Writer<wire::Status> sign_;  // that there is somebody besides
  dds::Topic<wire::Member> member_topic_;
  dds::Writer<wire::Member> members_;
  std::int64_t instant_ = 0;
};

TEST_F(AskedReplicas, OfTwoOnThisMachineEachIsAskedInTurn) {
  Result<Client> client = Client::connect(test::here());
  ASSERT_TRUE(client) << client.error().message;
  const std::string host = wire_contract::host_name();
  EXPECT_EQ(asked_of_replica(*client, host, host), 20u);
}

TEST_F(AskedReplicas, OneOnAnotherMachineIsAskedOnlyWhereTheOneHereIsBusy) {
  Result<Client> client = Client::connect(test::here());
  ASSERT_TRUE(client) << client.error().message;
  EXPECT_EQ(asked_of_replica(*client, wire_contract::host_name(), "elsewhere"), 0u);
}

TEST_F(AskedReplicas, AReplicaOnThisMachineIsAskedBeforeAPrimaryElsewhere) {
  Result<Client> client = Client::connect(test::here());
  ASSERT_TRUE(client) << client.error().message;
  EXPECT_EQ(asked_of_replica(*client, "elsewhere", wire_contract::host_name()), 40u);
}

}  // namespace
}  // namespace collided
