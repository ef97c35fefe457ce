#include "idl/dds.hpp"

#include <atomic>
#include <chrono>
#include <mutex>

#include <gtest/gtest.h>

#include "tests/service/wire/network.hpp"
#include "tests/service/wire/rows.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;
using test::eventually;

TEST(WireTopics, NamespaceMayHoldOnlyWhatDdsAccepts) {
  EXPECT_EQ(wire_contract::topic_name("plant/hall_2", wire_contract::kQueryTopic), "plant/hall_2/query_v2");
  EXPECT_THROW(wire_contract::topic_name("", wire_contract::kQueryTopic), std::invalid_argument);
  EXPECT_THROW(wire_contract::topic_name("2nd", wire_contract::kQueryTopic), std::invalid_argument);
  EXPECT_THROW(wire_contract::topic_name("a-b", wire_contract::kQueryTopic), std::invalid_argument);
}

// A reader that is being deleted has nothing to take, whichever way that is said; everything else that fails is told.
TEST(WireTake, WhatADeletedReaderReturnsIsNothing) {
  EXPECT_EQ(dds::taken_count(DDS_RETCODE_BAD_PARAMETER), 0u);
  EXPECT_EQ(dds::taken_count(DDS_RETCODE_ALREADY_DELETED), 0u);
  EXPECT_EQ(dds::taken_count(0), 0u);
  EXPECT_EQ(dds::taken_count(7), 7u);
  EXPECT_ANY_THROW(dds::taken_count(DDS_RETCODE_ERROR));
  EXPECT_ANY_THROW(dds::taken_count(DDS_RETCODE_OUT_OF_RESOURCES));
}

TEST(WireTopics, PartitionHasTheLastTwoDigits) {
  EXPECT_EQ(wire_contract::reply_partition(0xabc), "client_bc");
  EXPECT_EQ(wire_contract::reply_partition(5), "client_05");
  EXPECT_EQ(wire_contract::reply_partition(~std::uint64_t{0}), "client_ff");
}

TEST(WireTopics, NamesSurvivePackingAndACutOneIsLeftOut) {
  std::vector<std::uint8_t> packed = wire_contract::pack_names(std::vector<std::string>{"wall", "", "käfig"});
  EXPECT_EQ(wire_contract::unpack_names(packed), (std::vector<std::string_view>{"wall", "", "käfig"}));
  packed.pop_back();
  EXPECT_EQ(wire_contract::unpack_names(packed), (std::vector<std::string_view>{"wall", ""}));
}

// The sum over pairs is the state's hash: order must not matter, and swapping two episodes must.
TEST(WireTopics, ContactHashTellsEpisodesApart) {
  using wire_contract::contact_hash;
  EXPECT_EQ(contact_hash(1, 2, 7) + contact_hash(3, 4, 8), contact_hash(3, 4, 8) + contact_hash(1, 2, 7));
  EXPECT_NE(contact_hash(1, 2, 7) + contact_hash(3, 4, 8), contact_hash(1, 2, 8) + contact_hash(3, 4, 7));
}

TEST(WireDds, ConfigurationRefusesWordsThatWouldBreakItsXml) {
  EXPECT_THROW(dds::domain_config({.interface = "eth0\"/><x"}), dds::DdsError);
  EXPECT_THROW(dds::domain_config({.peers = {"<evil>"}}), dds::DdsError);
  EXPECT_THROW(dds::Participant({.domain = 231}), std::invalid_argument);
}

TEST(WireDds, SampleCrossesTheNetworkStackIntoReusedMemory) {
  const dds::Participant server(test::far_side());
  const dds::Participant client(test::near_side());
  const dds::Topic<wire::Query> far_topic(server, test::own_namespace());
  const dds::Topic<wire::Query> near_topic(client, test::own_namespace());

  std::mutex mutex;
  std::vector<double> received;
  std::string only;
  dds::Sample<wire::Query> room;
  const dds::Reader<wire::Query> reader(far_topic, {.data = [&](dds::Taker<wire::Query> taker) {
                                          const std::lock_guard lock(mutex);
                                          while (taker.take(room)) {
                                            received.insert(received.end(), dds::view(room->lengths).begin(),
                                                            dds::view(room->lengths).end());
                                            only = room->only;
                                          }
                                        }});
  dds::Writer<wire::Query> writer(near_topic);
  ASSERT_TRUE(eventually([&] { return writer.matched_readers() == 1 && reader.matched_writers() == 1; }));

  const std::vector<double> numbers{0, -0.0, 1e308, 5e-324};
  dds::Sample<wire::Query> query;
  dds::borrow(query->lengths, numbers);
  ASSERT_TRUE(dds::set_text(query->only, "pallet_*"));
  EXPECT_FALSE(dds::set_text(query->skip, std::string(256, 'x')));
  ASSERT_TRUE(writer.write(*query));
  ASSERT_TRUE(writer.write(*query));
  ASSERT_TRUE(eventually([&] {
    const std::lock_guard lock(mutex);
    return received.size() == 2 * numbers.size();
  }));
  EXPECT_EQ(only, "pallet_*");
  EXPECT_EQ(std::vector<double>(received.begin(), received.begin() + 4), numbers);
}

TEST(WireDds, ReplyStaysInItsPartition) {
  const dds::Participant server(test::far_side());
  const dds::Participant client(test::near_side());
  const dds::Topic<wire::Reply> far_topic(server, test::own_namespace());
  const dds::Topic<wire::Reply> near_topic(client, test::own_namespace());
  dds::Reader<wire::Reply> mine(near_topic, {.partition = wire_contract::reply_partition(1)});
  dds::Reader<wire::Reply> other(near_topic, {.partition = wire_contract::reply_partition(2)});
  dds::Writer<wire::Reply> writer(far_topic, {.partition = wire_contract::reply_partition(1)});
  ASSERT_TRUE(eventually([&] { return mine.matched_writers() == 1 && writer.matched_readers() == 1; }));
  dds::Sample<wire::Reply> reply;
  reply->request = 42;
  ASSERT_TRUE(writer.write(*reply));
  dds::Sample<wire::Reply> taken;
  ASSERT_TRUE(eventually([&] { return mine.take(taken); }));
  EXPECT_EQ(taken->request, 42u);
  EXPECT_EQ(other.matched_writers(), 0u);
  EXPECT_EQ(other.take_loans().size(), 0u);
}

TEST(WireDds, LateJoinerGetsStateOfEveryKey) {
  const dds::Participant server(test::far_side());
  const dds::Topic<wire::ContactShard> far_topic(server, test::own_namespace());
  dds::Writer<wire::ContactShard> writer(far_topic);
  for (std::uint8_t shard = 0; shard < 3; ++shard) {
    for (std::uint64_t version = 1; version <= 2; ++version) {
      dds::Sample<wire::ContactShard> sample;
      sample->shard = shard;
      sample->version = version;
      ASSERT_TRUE(writer.write(*sample));
    }
  }
  const dds::Participant client(test::near_side());
  const dds::Topic<wire::ContactShard> near_topic(client, test::own_namespace());
  dds::Reader<wire::ContactShard> reader(near_topic);
  std::vector<std::uint64_t> versions;
  EXPECT_TRUE(eventually([&] {
    const dds::Loans<wire::ContactShard> loans = reader.take_loans();
    for (std::size_t i = 0; i < loans.size(); ++i) { versions.push_back(loans[i].version); }
    return versions.size() >= 3;
  }));
  EXPECT_EQ(versions, (std::vector<std::uint64_t>{2, 2, 2}));
}

// A hung publisher must be noticed: nothing asserts for it, so its lease runs out although its process lives.
// Asserting keeps a writer alive but does not raise it from the dead: that takes a sample.
TEST(WireDds, SilentWriterIsDeadAfterItsLeaseUntilItWrites) {
  const dds::Participant server(test::far_side());
  const dds::Participant client(test::near_side());
  const dds::Topic<wire::PoseBatch> far_topic(server, test::own_namespace());
  const dds::Topic<wire::PoseBatch> near_topic(client, test::own_namespace());
  std::atomic<std::uint32_t> alive{0};
  std::atomic<std::uint32_t> dead{0};
  const dds::Reader<wire::PoseBatch> reader(far_topic, {.liveliness = [&](const dds::Liveliness& liveliness) {
                                              alive = liveliness.alive;
                                              dead = liveliness.not_alive;
                                            }});
  dds::Writer<wire::PoseBatch> writer(near_topic, {.lease_ns = wire_contract::kPublisherLeaseNs});
  ASSERT_TRUE(eventually([&] { return alive == 1; }));
  const auto asserted = std::chrono::steady_clock::now();
  writer.assert_liveliness();
  ASSERT_TRUE(eventually([&] { return dead == 1; }, 2s));
  EXPECT_GE(std::chrono::steady_clock::now() - asserted, 450ms);
  // A second is two leases. On a busy machine an assertion may come too late, so a few such seconds are tried.
  bool has_stayed = false;
  for (int round = 0; round < 10 && !has_stayed; ++round) {
    ASSERT_TRUE(writer.write(*dds::Sample<wire::PoseBatch>()));
    ASSERT_TRUE(eventually([&] { return alive == 1 && dead == 0; }));
    has_stayed = true;
    for (int i = 0; i < 5; ++i) {
      std::this_thread::sleep_for(200ms);
      writer.assert_liveliness();
      has_stayed = has_stayed && alive == 1;
    }
  }
  EXPECT_TRUE(has_stayed);
}

TEST(WireDds, ParticipantsOfTheDomainAreCounted) {
  const dds::Participant client(test::near_side());
  EXPECT_EQ(client.others_seen(), 0u);
  const dds::Participant server(test::far_side());
  EXPECT_TRUE(eventually([&] { return client.others_seen() == 1; }));
}

TEST(WireDds, WaitSetWakesForDataAndForItsOwner) {
  const dds::Participant participant(test::near_side());
  const dds::Topic<wire::Status> topic(participant, test::own_namespace());
  const dds::Reader<wire::Status> reader(topic);
  dds::Writer<wire::Status> writer(topic);
  dds::WaitSet waitset(participant);
  waitset.attach(reader, 7);
  EXPECT_TRUE(waitset.wait(1'000'000).empty());
  waitset.wake();
  EXPECT_TRUE(waitset.wait(1'000'000'000).empty());
  ASSERT_TRUE(writer.write(*dds::Sample<wire::Status>()));
  EXPECT_EQ(waitset.wait(1'000'000'000), std::vector<std::intptr_t>{7});
}

}  // namespace
}  // namespace collided
