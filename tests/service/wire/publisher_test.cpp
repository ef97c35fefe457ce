#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "client/library/publishing/published_objects.hpp"
#include "collided/client.hpp"
#include "tests/service/wire/fake_server.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;
using test::eventually;
using test::FakeServer;

ObjectOptions ball(const std::string& name) { return {.name = name, .shape = {SphereShape{.radius_m = 0.5}}}; }

class ClientPublish : public testing::Test {
 protected:
  void SetUp() override {
    Result<Client> connected =
        Client::connect({.domain = test::own_domain(), .name_space = test::own_namespace(), .wait = 5s});
    ASSERT_TRUE(connected) << connected.error().message;
    client_.emplace(std::move(*connected));
    Result<Publisher> publisher = client_->publish("arm");
    ASSERT_TRUE(publisher) << publisher.error().message;
    publisher_.emplace(std::move(*publisher));
  }
  Publisher::Object add(const std::string& name) {
    const Result<Publisher::Object> object = publisher_->add(ball(name));
    EXPECT_TRUE(object) << object.error().message;
    return *object;
  }
  FakeServer server_{test::own_namespace()};
  std::optional<Client> client_;
  std::optional<Publisher> publisher_;
};

TEST_F(ClientPublish, DefinitionsAndPosesArriveUnderOneGaplessCount) {
  const Publisher::Object first = add("first");
  const Publisher::Object second = add("second");
  ASSERT_TRUE(publisher_->move(first, {.position = {1, 2, 3}}));
  ASSERT_TRUE(publisher_->move(second, {.position = {4, 5, 6}}));
  ASSERT_TRUE(publisher_->move(first, {.position = {7, 8, 9}}));  // the newest wins
  const Result<FlushReport> sequence = publisher_->flush(123ns);
  ASSERT_TRUE(sequence) << sequence.error().message;
  EXPECT_EQ(*sequence, 3u);
  ASSERT_TRUE(publisher_->wait_applied(2s));
  // Definitions and poses come on two topics, each by a thread of its own.
  EXPECT_TRUE(eventually([&] { return server_.received().sequences.size() >= 3; }));
  const FakeServer::Received received = server_.received();
  EXPECT_EQ(std::set(received.sequences.begin(), received.sequences.end()), (std::set<std::uint64_t>{1, 2, 3}));
  EXPECT_EQ(received.names, (std::map<std::uint32_t, std::string>{{0, "first"}, {1, "second"}}));
  EXPECT_EQ(received.batch_sizes, std::vector<std::size_t>{2});
  EXPECT_EQ(received.definitions_through, std::vector<std::uint64_t>{2});
  EXPECT_EQ(received.poses.at(0).numbers, (std::vector<double>{7, 8, 9, 1, 0, 0, 0}));
  EXPECT_EQ(received.poses.at(1).numbers, (std::vector<double>{4, 5, 6, 1, 0, 0, 0}));
}

TEST_F(ClientPublish, TenThousandPosesGoInBatchesOfAtMost4096) {
  // A publisher that a busy machine has made miss its lease defines everything again.
  publisher_.emplace(std::move(*client_->publish("crowd", {.lease = 60s})));
  std::vector<Publisher::Object> objects;
  for (int i = 0; i < 10'000; ++i) { objects.push_back(add("object_" + std::to_string(i))); }
  for (int round = 0; round < 30; ++round) {
    for (std::size_t i = 0; i < objects.size(); ++i) {
      ASSERT_TRUE(publisher_->move(objects[i], {.position = {static_cast<double>(i), 0, static_cast<double>(round)}}));
    }
    ASSERT_TRUE(publisher_->flush());
  }
  ASSERT_TRUE(publisher_->wait_applied(20s));
  FakeServer::Received received = server_.received();
  // On a busy machine half a second may pass between two rounds; then the library sends a sign of life, an empty batch.
  std::erase(received.batch_sizes, 0u);
  // 90 batches through a history of 64: none was pushed out before the server had it.
  ASSERT_EQ(received.batch_sizes.size(), 90u);
  EXPECT_EQ(std::vector(received.batch_sizes.begin(), received.batch_sizes.begin() + 3),
            (std::vector<std::size_t>{4'096, 4'096, 1'808}));
  // One that a busy machine keeps behind defines everything again; nothing is missing either way.
  const std::set<std::uint64_t> numbers(received.sequences.begin(), received.sequences.end());
  EXPECT_EQ(numbers.size(), received.sequences.size()) << "none came twice";
  EXPECT_EQ(numbers.size(), *numbers.rbegin()) << "none is missing";
  EXPECT_EQ(received.names.size(), 10'000u);
  EXPECT_EQ(received.poses.at(9'999).numbers[0], 9'999);
  EXPECT_EQ(received.poses.at(9'999).numbers[2], 29);
}

TEST_F(ClientPublish, TeleportsTravelApart) {
  const Publisher::Object walks = add("walks");
  const Publisher::Object jumps = add("jumps");
  ASSERT_TRUE(publisher_->move(jumps, {.position = {9, 0, 0}}, true));
  ASSERT_TRUE(publisher_->move(walks, {.position = {1, 0, 0}}));
  ASSERT_TRUE(publisher_->move(jumps, {.position = {9, 1, 0}}));  // still arrives by a jump
  ASSERT_TRUE(publisher_->flush());
  ASSERT_TRUE(publisher_->wait_applied(2s));
  const FakeServer::Received received = server_.received();
  EXPECT_EQ(received.batch_sizes, (std::vector<std::size_t>{1, 1}));
  EXPECT_FALSE(received.poses.at(0).teleported);
  EXPECT_TRUE(received.poses.at(1).teleported);
  EXPECT_EQ(received.poses.at(1).numbers[1], 1);
}

TEST_F(ClientPublish, RemovedNumbersAreReusedAndOldHandlesFindNothing) {
  const Publisher::Object old_handle = add("old");
  ASSERT_TRUE(publisher_->move(old_handle, {.position = {1, 0, 0}}));
  ASSERT_TRUE(publisher_->remove(old_handle));
  const Publisher::Object next = add("new");
  EXPECT_NE(next, old_handle);
  EXPECT_EQ(client::PublishedObjects::number(next), client::PublishedObjects::number(old_handle));
  EXPECT_EQ(publisher_->move(old_handle, {}).error().code, ErrorCode::bad_input);
  EXPECT_EQ(publisher_->remove(old_handle).error().code, ErrorCode::bad_input);
  ASSERT_TRUE(publisher_->flush());
  ASSERT_TRUE(publisher_->wait_applied(2s));
  const FakeServer::Received received = server_.received();
  EXPECT_EQ(received.names, (std::map<std::uint32_t, std::string>{{0, "new"}}));
  EXPECT_TRUE(std::all_of(received.batch_sizes.begin(), received.batch_sizes.end(), [](std::size_t size) {
    return size == 0;
  })) << "the removed object's pose was sent to its successor";
}

TEST_F(ClientPublish, WrongObjectsAndPosesAreRefusedByName) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Publisher::Object object = add("crate");
  EXPECT_EQ(publisher_->add(ball("crate")).error().message,
            "object 'crate': this publisher has an object of that name already");
  EXPECT_EQ(publisher_->add(ball("")).error().code, ErrorCode::bad_input);
  EXPECT_EQ(publisher_->add(ball(std::string(256, 'x'))).error().code, ErrorCode::bad_input);
  EXPECT_EQ(publisher_->add({.name = "empty"}).error().message, "object 'empty': its shape has no part");
  EXPECT_EQ(publisher_->add({.name = "bad", .shape = {SphereShape{.radius_m = -1}}}).error().message,
            "object 'bad': part 0: radius -1: allowed 0 to 1e290");
  const MeshShape outside{.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .triangles = {{0, 1, 3}}};
  EXPECT_EQ(publisher_->add({.name = "mesh", .shape = {outside}}).error().message,
            "object 'mesh': part 0: triangle 0 names vertex 3 of 3");
  const MeshShape triangle{.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .triangles = {{0, 1, 2}}};
  const HeightFieldShape field{2, 1, 1, {0, 0, 0, 1}};
  for (const Shape& two :
       {Shape{triangle, triangle}, Shape{triangle, field}, Shape{field, triangle}, Shape{field, field}}) {
    EXPECT_EQ(publisher_->add({.name = "two", .shape = two}).error().message,
              "object 'two': part 1: a second mesh; a shape holds at most one");
  }
  EXPECT_EQ(publisher_->move(object, {.position = {nan, 0, 0}}).error().message,
            "object 'crate': position nan 0 0 is not finite");
  EXPECT_EQ(publisher_->move(object, {.rotation = Quat(0.87, 0, 0, 0)}).error().message,
            "object 'crate': rotation 0.87 0 0 0 has norm 0.87, allowed 1 +- 1e-06");
  EXPECT_EQ(client_->publish("").error().code, ErrorCode::bad_input);
}

TEST_F(ClientPublish, ANameMayHave255BytesAndNoMore) {
  EXPECT_TRUE(publisher_->add(ball(std::string(255, 'x'))));
  EXPECT_EQ(publisher_->add(ball(std::string(256, 'x'))).error().message,
            "object '" + std::string(256, 'x') + "': its name has 256 bytes; allowed 1 to 255");
}

TEST_F(ClientPublish, ShapeBeyondOneSampleIsRefusedWithItsSize) {
  MeshShape mesh;
  mesh.vertices.assign(50'000, Vec3(1, 2, 3));
  mesh.triangles.assign(1, {0, 1, 2});
  const Result<Publisher::Object> object = publisher_->add({.name = "big", .shape = {mesh}});
  ASSERT_FALSE(object);
  EXPECT_EQ(object.error().message.find("object 'big': its shape takes 1200"), 0u) << object.error().message;
  mesh.vertices.resize(40'000);
  ASSERT_TRUE(publisher_->add({.name = "fits", .shape = {mesh}}));
  ASSERT_TRUE(publisher_->wait_applied(2s));
  EXPECT_GT(server_.received().largest_shape, 960'000u);
}

TEST_F(ClientPublish, FreshQuestionsNameTheLastWrite) {
  const Publisher::Object object = add("crate");
  ASSERT_TRUE(publisher_->move(object, {.position = {1, 0, 0}}));
  const Result<FlushReport> sequence = publisher_->flush();
  ASSERT_TRUE(client_->ask(RayQuestion{{1, 0, 0}, {0, 0, 1}}, {.fresh = true}));
  EXPECT_EQ(server_.last_query().barrier_sequence, *sequence);
  EXPECT_NE(server_.last_query().barrier_publisher, 0u);
  ASSERT_TRUE(client_->ask(RayQuestion{{1, 0, 0}, {0, 0, 1}}));
  EXPECT_EQ(server_.last_query().barrier_publisher, 0u);
}

// Whoever was silent for longer than the lease is forgotten with all its objects: it must say everything anew, at the
// newest poses, before it goes on.
TEST_F(ClientPublish, AfterAHangEverythingIsDefinedAnew) {
  const Publisher::Object first = add("first");
  add("second");
  ASSERT_TRUE(publisher_->move(first, {.position = {1, 0, 0}}));
  ASSERT_TRUE(publisher_->flush());
  ASSERT_TRUE(publisher_->wait_applied(2s));
  EXPECT_EQ(server_.received().definition_count, 2u);
  std::this_thread::sleep_for(700ms);
  ASSERT_TRUE(publisher_->keep_alive());
  const Result<FlushReport> flushed = publisher_->flush();
  ASSERT_TRUE(flushed);
  EXPECT_TRUE(flushed->lost.starts_with("publisher 'arm' was silent for 7")) << flushed->lost;
  EXPECT_NE(flushed->lost.find("longer than its lease of 500 ms: the server counted it as lost"), std::string::npos);
  EXPECT_EQ(publisher_->flush()->lost, "") << "once";
  ASSERT_TRUE(publisher_->wait_applied(2s));
  const FakeServer::Received received = server_.received();
  EXPECT_EQ(received.definition_count, 4u);
  EXPECT_EQ(received.poses.at(0).numbers[0], 1);
}

// What is kept alive may move on: nothing is said of where it is, only how far the publisher's time has come.
TEST_F(ClientPublish, ASignOfLifeSaysNothingOfMotion) {
  const Publisher::Object object = add("first");
  ASSERT_TRUE(publisher_->move(object, {.position = {1, 0, 0}}));
  ASSERT_TRUE(publisher_->flush());
  ASSERT_TRUE(eventually([&] {
    EXPECT_TRUE(publisher_->keep_alive());
    return server_.received().batches.size() >= 3;
  }));
  const std::vector<FakeServer::Batch> batches = server_.received().batches;
  std::int64_t before_ns = batches[0].source_time_ns;
  for (std::size_t i = 1; i < batches.size(); ++i) {
    EXPECT_EQ(batches[i].sequence, 0u);
    EXPECT_TRUE(batches[i].object_numbers.empty());
    EXPECT_NE(batches[i].flags & wire_contract::kPosesStreamed, 0);
    EXPECT_GT(batches[i].source_time_ns, std::exchange(before_ns, batches[i].source_time_ns));
  }
  ASSERT_TRUE(publisher_->flush(7s));
  ASSERT_TRUE(publisher_->wait_applied(2s));
  ASSERT_TRUE(eventually([&] { return server_.received().batches.back().source_time_ns == 7'000'000'000; }));
  EXPECT_EQ(server_.received().batches.back().flags & wire_contract::kPosesStreamed, 0)
      << "a flush says that all has rested";
  std::this_thread::sleep_for(300ms);
  ASSERT_TRUE(publisher_->keep_alive());
  ASSERT_TRUE(publisher_->keep_alive(8s));
  ASSERT_TRUE(eventually([&] { return server_.received().batches.back().source_time_ns == 8'000'000'000; }))
      << "of the user's own clock the library knows what it is given";
}

TEST_F(ClientPublish, AGapIsSaidBeforeAllElse) {
  Result<Publisher> slow = client_->publish("slow", {.gap = 2s});
  ASSERT_TRUE(slow) << slow.error().message;
  ASSERT_TRUE(slow->add(ball("crate")));
  ASSERT_TRUE(slow->wait_applied(2s));
  EXPECT_EQ(server_.received().gaps_s, std::vector<double>{2});
  EXPECT_EQ(server_.received().names.size(), 1u);
  EXPECT_EQ(client_->publish("slower", {.gap = 9s}).error().message,
            "publisher 'slower': its gap is 9 s; allowed 1 ms to 8 s");
}

TEST_F(ClientPublish, APauseWithinALongerLeaseIsNoLoss) {
  Result<Publisher> slow = client_->publish("slow", {.lease = 20s});
  ASSERT_TRUE(slow) << slow.error().message;
  ASSERT_TRUE(slow->add(ball("crate")));
  ASSERT_TRUE(slow->wait_applied(2s));
  std::this_thread::sleep_for(700ms);
  EXPECT_EQ(slow->flush()->lost, "");
  EXPECT_EQ(server_.received().definition_count, 1u);
}

TEST_F(ClientPublish, KeepAliveInTimeDefinesNothingAnew) {
  add("first");
  for (int i = 0; i < 8; ++i) {
    std::this_thread::sleep_for(100ms);
    ASSERT_TRUE(publisher_->keep_alive());
  }
  ASSERT_TRUE(publisher_->wait_applied(2s));
  EXPECT_EQ(server_.received().definition_count, 1u);
}

TEST_F(ClientPublish, ServerThatCallsItLostGetsEverythingOnce) {
  add("first");
  ASSERT_TRUE(publisher_->wait_applied(2s));
  server_.hold_publisher_lost = true;
  ASSERT_TRUE(eventually([&] {
    EXPECT_TRUE(publisher_->keep_alive());
    return server_.received().definition_count >= 2;
  }));
  server_.hold_publisher_lost = false;
  std::this_thread::sleep_for(250ms);
  const std::size_t count = server_.received().definition_count;
  for (int i = 0; i < 5; ++i) { ASSERT_TRUE(publisher_->keep_alive()); }
  ASSERT_TRUE(publisher_->wait_applied(2s));
  EXPECT_EQ(server_.received().definition_count, count);
}

// The word that it is lost is heard once, and nothing after it: what is said while that word is the newest is no news.
TEST_F(ClientPublish, OneWordThatItIsLostIsAnsweredOnce) {
  add("first");
  ASSERT_TRUE(publisher_->wait_applied(2s));
  server_.beating = false;
  server_.hold_publisher_lost = true;
  server_.send_status();
  ASSERT_TRUE(eventually([&] {
    EXPECT_TRUE(publisher_->keep_alive());
    return server_.received().definition_count >= 2;
  }));
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(publisher_->keep_alive());
  add("second");
  ASSERT_TRUE(eventually([&] { return server_.received().names.size() == 2; }));
  EXPECT_EQ(server_.received().definition_count, 3u) << "the first one, once more, and the second";
}

// A batch that found no reader: nobody would send it again, and the object would stay where its definition put it.
TEST_F(ClientPublish, WhatTheServerHasMissedIsSaidAgain) {
  const Publisher::Object object = add("first");
  ASSERT_TRUE(publisher_->move(object, {.position = {1, 0, 0}}));
  ASSERT_TRUE(publisher_->flush());
  ASSERT_TRUE(publisher_->wait_applied(2s));
  EXPECT_EQ(server_.received().definition_count, 1u);
  server_.missed_the_last = true;
  ASSERT_TRUE(eventually([&] {
    EXPECT_TRUE(publisher_->keep_alive());
    return server_.received().definition_count >= 2;
  }));
  server_.missed_the_last = false;
  ASSERT_TRUE(publisher_->wait_applied(2s));
  EXPECT_EQ(server_.received().poses.at(0).numbers[0], 1);
}

// Who flushes on and on without news, as a loop does whose machine stands still.
TEST_F(ClientPublish, WhatTheServerHasMissedIsSaidAgainAlsoToWhoFlushesOn) {
  const Publisher::Object object = add("first");
  ASSERT_TRUE(publisher_->move(object, {.position = {1, 0, 0}}));
  const Result<FlushReport> moved = publisher_->flush();
  ASSERT_TRUE(publisher_->wait_applied(2s));
  EXPECT_EQ(*publisher_->flush(), *moved) << "a flush without news has no number of its own";
  server_.missed_the_last = true;
  EXPECT_TRUE(eventually([&] {
    EXPECT_TRUE(publisher_->flush());
    return server_.received().definition_count >= 2;
  }));
}

// It applies nothing while its world is at a step, and has yet to apply what came meanwhile when that ends.
TEST_F(ClientPublish, NothingIsSaidAgainToABusyServer) {
  const Publisher::Object object = add("first");
  ASSERT_TRUE(publisher_->wait_applied(2s));
  server_.busy_ns = 700'000'000;
  server_.missed_the_last = true;
  ASSERT_TRUE(publisher_->move(object, {.position = {1, 0, 0}}));
  ASSERT_TRUE(publisher_->flush());
  const auto begun = std::chrono::steady_clock::now();
  const Result<void> waited = publisher_->wait_applied(900ms);
  ASSERT_FALSE(waited);
  EXPECT_EQ(waited.error().code, ErrorCode::timeout) << "a busy server is not a silent one: " << waited.error().message;
  EXPECT_EQ(waited.error().hint, "it is busy: a step has lasted 700 ms");
  EXPECT_GE(std::chrono::steady_clock::now() - begun, 900ms);
  EXPECT_EQ(server_.received().definition_count, 1U);
  server_.missed_the_last = false;
  server_.busy_ns = 0;
  EXPECT_TRUE(publisher_->wait_applied(2s));
  EXPECT_EQ(server_.received().definition_count, 1U);
}

// The answer to what it left out comes only after the step, and a lease passes sooner.
TEST_F(ClientPublish, AWaitAtABusyServerOutlastsTheLease) {
  add("first");
  server_.busy_ns = 1'000'000'000;
  const Result<void> waited = publisher_->wait_applied(1'200ms);
  EXPECT_TRUE(waited) << waited.error().message;
  const Result<FlushReport> flushed = publisher_->flush();
  ASSERT_TRUE(flushed);
  EXPECT_EQ(flushed->lost, "") << "it said all the time that it lives";
}

TEST_F(ClientPublish, LeavingRemovesItsObjects) {
  add("first");
  add("second");
  ASSERT_TRUE(publisher_->wait_applied(2s));
  EXPECT_EQ(server_.received().names.size(), 2u);
  publisher_.reset();
  EXPECT_TRUE(eventually([&] { return server_.received().names.empty(); }));
}

TEST_F(ClientPublish, NewServerLearnsTheNewestPoses) {
  const Publisher::Object object = add("first");
  ASSERT_TRUE(publisher_->move(object, {.position = {1, 0, 0}}));
  ASSERT_TRUE(publisher_->flush());
  ASSERT_TRUE(publisher_->wait_applied(2s));
  server_.beating = false;
  std::this_thread::sleep_for(350ms);
  const dds::ParticipantOptions elsewhere{
      .domain = test::own_domain(), .role = dds::Role::server, .process_domain = test::own_domain() + 200'000};
  FakeServer second(test::own_namespace(), 2, elsewhere);
  EXPECT_TRUE(eventually([&] {
    EXPECT_TRUE(publisher_->keep_alive());
    const FakeServer::Received received = second.received();
    return received.poses.contains(0) && received.poses.at(0).numbers[0] == 1;
  }));
}

}  // namespace
}  // namespace collided
