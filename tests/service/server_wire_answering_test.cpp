// The answering side of the server around a world of its own: what its options do to answers, and who is a client.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

#include "server/service/questions/answering.hpp"
#include "tests/service/wire/network.hpp"
#include "tests/service/wire/rows.hpp"

namespace collided::engine::service {
namespace {

using namespace std::chrono_literals;
using wire_contract::QuestionKind;
using wire_contract::UndecidedReason;
using wire_contract::Verdict;

/// A client's ears: the newest reply, and whether there is one.
class Ears {
 public:
  Ears(const dds::Participant& participant, std::uint64_t client)
      : topic_(participant, test::own_namespace()),
        reader_(topic_, {.data =
                             [this](dds::Taker<wire::Reply> taker) {
                               while (taker.take(reply_)) {
                                 if (reply_.info().valid_data) heard_.store(reply_->request);
                               }
                             },
                         .partition = wire_contract::reply_partition(client)}) {}
  bool hears(std::uint64_t request) {
    return test::eventually([&] { return heard_.load() == request; });
  }
  const wire::Reply& reply() const { return *reply_; }

 private:
  std::atomic<std::uint64_t> heard_{0};
  dds::Sample<wire::Reply> reply_;
  dds::Topic<wire::Reply> topic_;
  dds::Reader<wire::Reply> reader_;
};

class WireClients : public testing::Test {
 protected:
  static constexpr std::uint64_t kClient = 0x77;
  static constexpr std::uint64_t kAsker = 5;
  static constexpr std::uint64_t kProcess = 77;
  dds::Participant near_side{test::near_side()};
  dds::Participant far_side{test::far_side()};
  dds::Topic<wire::Reply> topic{far_side, test::own_namespace()};
  std::atomic<int> listening{0};
  Clients clients{topic, [this](std::uint32_t) { ++listening; }};
};

// The short cut past the table is forgotten with the client: who is gone is not answered, and who comes back is met anew.
TEST_F(WireClients, WhoHasLeftIsNoLongerFoundReady) {
  Ears ears(near_side, kClient);
  EXPECT_EQ(clients.find_ready(kClient, kAsker), nullptr) << "nobody of that number has asked";
  const std::shared_ptr<Client> met = clients.meet(kClient, kAsker, kProcess);
  ASSERT_TRUE(met);
  ASSERT_TRUE(test::eventually([&] { return clients.find_ready(kClient, kAsker) == met.get(); }));
  EXPECT_EQ(clients.find_ready(kClient + 1, kAsker), nullptr);
  EXPECT_EQ(clients.find_ready(kClient, kAsker), met.get());
  const std::uint64_t still_there[] = {kAsker + 1, kAsker};
  clients.forget_gone(still_there, steady_ns());
  EXPECT_EQ(clients.find_ready(kClient, kAsker), met.get()) << "its writer lives";
  clients.forget_gone(std::span(still_there).first(1), steady_ns());
  EXPECT_EQ(clients.size(), 0U);
  EXPECT_EQ(clients.find_ready(kClient, kAsker), nullptr);
  const std::shared_ptr<Client> again = clients.meet(kClient, kAsker, kProcess);
  EXPECT_NE(again, met);
  EXPECT_EQ(clients.find_ready(kClient, kAsker), again.get());
}

// Numbers that share a place of the short cut are each their own client.
TEST_F(WireClients, ClientsWhoseNumbersLookAlikeAreNotTakenForEachOther) {
  Ears ears(near_side, kClient);
  Ears other_ears(near_side, kClient + 16);
  const std::shared_ptr<Client> one = clients.meet(kClient, kAsker, kProcess);
  const std::shared_ptr<Client> other = clients.meet(kClient + 16, kAsker, kProcess);
  ASSERT_TRUE(test::eventually([&] {
    return clients.find_ready(kClient, kAsker) == one.get() && clients.find_ready(kClient + 16, kAsker) == other.get();
  }));
  EXPECT_EQ(clients.find_ready(kClient, kAsker), one.get());
}

// Who asks under another's number would have its answers sent to that one. A program that makes its query writer anew
// goes on once the old one is gone.
TEST_F(WireClients, ANumberIsItsFirstWritersForAsLongAsThatLives) {
  Ears ears(near_side, kClient);
  const std::shared_ptr<Client> met = clients.meet(kClient, kAsker, kProcess);
  ASSERT_TRUE(test::eventually([&] { return clients.find_ready(kClient, kAsker) == met.get(); }));
  EXPECT_EQ(clients.find_ready(kClient, kAsker + 1), nullptr);
  EXPECT_EQ(clients.meet(kClient, kAsker + 1, kProcess), nullptr);
  EXPECT_EQ(clients.find_ready(kClient, kAsker), met.get());
  const std::uint64_t newer[] = {kAsker + 1};
  clients.forget_gone(newer, steady_ns());
  EXPECT_EQ(clients.size(), 0U);
  EXPECT_NE(clients.meet(kClient, kAsker + 1, kProcess), nullptr);
}

TEST_F(WireClients, OneWriterTakesNotAllNumbers) {
  std::size_t met = 0;
  for (std::uint64_t number = 0; number < 3'000; ++number) met += clients.meet(number + 1, kAsker, kProcess) ? 1 : 0;
  EXPECT_EQ(met, Clients::kMostOfOne);
  EXPECT_NE(clients.meet(5'000, kAsker + 1, kProcess), nullptr) << "others are met as before";
  clients.forget_gone({}, steady_ns());
  EXPECT_EQ(clients.size(), 0U) << "what a writer held goes with it";
}

// Twenty writers of one process took every place, and no new client was answered.
TEST_F(WireClients, OneProcessTakesNotAllPlacesHoweverManyWritersItHas) {
  std::uint64_t number = 0;
  const auto meet = [&](std::uint64_t process) {
    std::size_t met = 0;
    for (std::uint64_t i = 0; i < 20 * Clients::kMostOfOne; ++i)
      met += clients.meet(++number, 100 * process + i / Clients::kMostOfOne, process) ? 1 : 0;
    return met;
  };
  EXPECT_EQ(meet(1), Clients::kMostOfParticipant);
  EXPECT_EQ(clients.turned_away(), 20 * Clients::kMostOfOne - Clients::kMostOfParticipant);
  for (std::uint64_t process = 2; process < 8; ++process) meet(process);
  EXPECT_NE(clients.meet(++number, kAsker, kProcess), nullptr) << "the last places are for processes with few";
}

// Until somebody listens asks wait: the oldest goes where too many do, and none waits longer than its patience.
TEST_F(WireClients, AsksOfAClientThatDoesNotListenYetWaitInOrderAndNotForEver) {
  const std::shared_ptr<Client> met = clients.meet(kClient, kAsker, kProcess);
  const std::int64_t now_ns = steady_ns();
  for (std::uint64_t i = 0; i < Clients::kMostWaiting + 3; ++i) {
    auto ask = std::make_unique<Ask>();
    ask->query->request = i;
    ask->taken_ns = now_ns + static_cast<std::int64_t>(i);
    ASSERT_TRUE(clients.hold(*met, ask));
  }
  const std::uint64_t there[] = {kAsker};
  const std::vector<AskPointer> late = clients.forget_gone(there, now_ns + Clients::kMatchPatienceNs + 5);
  ASSERT_EQ(late.size(), 2U) << "three were dropped, of the rest the first two have waited too long";
  EXPECT_EQ(late[0]->query->request, 3U);
  EXPECT_EQ(late[1]->query->request, 4U);
  clients.forget_gone({}, now_ns + Clients::kMatchPatienceNs);
  EXPECT_EQ(clients.size(), 1U) << "what it asked is not answered yet";
  Ears ears(near_side, kClient);
  ASSERT_TRUE(test::eventually([&] { return listening.load() > 0; }));
  EXPECT_TRUE(clients.resume(wire_contract::reply_place(kClient) + 1).empty()) << "somebody else's place";
  const std::vector<AskPointer> resumed = clients.resume(wire_contract::reply_place(kClient));
  ASSERT_EQ(resumed.size(), Clients::kMostWaiting - 2);
  for (std::size_t i = 0; i < resumed.size(); ++i) EXPECT_EQ(resumed[i]->query->request, i + 5);
  auto ask = std::make_unique<Ask>();
  EXPECT_FALSE(clients.hold(*met, ask)) << "it listens";
}

// Who asks in many names has no more waiting than in one, and leaves room for others.
TEST_F(WireClients, AsksThatWaitAreBoundedInBytes) {
  const auto large = [](std::uint64_t request) {
    auto ask = std::make_unique<Ask>();
    ask->query->request = request;
    ask->query->kind = static_cast<std::uint8_t>(wire_contract::QuestionKind::ray);
    ask->taken_ns = steady_ns();
    test::put_questions(*ask->query, std::vector<double>(7 * 16'000));
    return ask;
  };
  std::size_t kept = 0;
  for (std::uint64_t i = 0; i < Clients::kMostOfOne; ++i) {
    AskPointer ask = large(i);
    ASSERT_TRUE(clients.hold(*clients.meet(kClient + i, kAsker, kProcess), ask));
    kept += ask ? 0 : 1;
    EXPECT_TRUE(!ask || ask->query->request == i) << "the one that does not fit is handed back";
  }
  const std::size_t bytes = wire::room_of(*large(0)->query);
  EXPECT_EQ(kept, Clients::kMostBytesOfOne / bytes);
  std::size_t of_all = kept;
  for (std::uint64_t other = 1; other < 20; ++other) {
    for (std::uint64_t i = 0; i < 12; ++i) {
      AskPointer ask = large(i);
      ASSERT_TRUE(clients.hold(*clients.meet(kClient + 100 * other, kAsker + other, kProcess), ask));
      of_all += ask ? 0 : 1;
    }
  }
  EXPECT_EQ(of_all, Clients::kMostWaitingBytes / bytes);
  clients.forget_gone({}, steady_ns() + Clients::kMatchPatienceNs + 1);
  EXPECT_EQ(clients.size(), 0U);
  AskPointer ask = large(0);
  ASSERT_TRUE(clients.hold(*clients.meet(kClient, kAsker, kProcess), ask));
  EXPECT_FALSE(ask) << "what was handed back takes no room";
}

TEST_F(WireClients, WhoNeverListensIsForgottenInTheEnd) {
  const std::shared_ptr<Client> met = clients.meet(kClient, kAsker, kProcess);
  const std::uint64_t there[] = {kAsker};
  const std::int64_t now_ns = steady_ns();
  clients.forget_gone(there, now_ns + Clients::kDeafPatienceNs - 1'000'000'000);
  EXPECT_EQ(clients.size(), 1U);
  clients.forget_gone(there, now_ns + Clients::kDeafPatienceNs + 1'000'000'000);
  EXPECT_EQ(clients.size(), 0U);
}

TEST_F(WireClients, TheNewestVersionThatWasToldStays) {
  const std::shared_ptr<Client> met = clients.meet(kClient, kAsker, kProcess);
  EXPECT_EQ(met->reported_version(), 0U);
  met->note_reported(5);
  met->note_reported(3);
  EXPECT_EQ(met->reported_version(), 5U);
}

/// Answering with options, asked by one client.
class WireAnswering : public testing::Test {
 protected:
  static constexpr std::uint64_t kClient = 0x78;

  void SetUp() override {
    // A wall that a ray grazes, and a ball that moved a while ago.
    auto mesh = std::make_shared<TriangleMesh>();
    mesh->vertices = {{-1e3, -1e3, 0.1}, {1e3, -1e3, 0.3}, {0, 2e3, 0.7}};
    mesh->triangles = {{0, 1, 2}};
    ObjectDefinition wall;
    wall.name = "wall";
    wall.shape.mesh = mesh;
    wall.moving = false;
    world.define(wall);
    ObjectDefinition ball;
    ball.name = "ball";
    ball.shape.primitives.emplace_back(Sphere{.center = Vec3::Zero(), .radius_m = 0.5});
    ball.pose.position = {0, 0, 50};
    const auto defined = world.define(ball);
    world.step(clock.now_ns(), 1, {});
    world.move(std::get<ObjectId>(defined), {.position = {0, 0, 50}}, clock.now_ns(), true);
    world.step(clock.now_ns(), 1, {});
    const Vec3 normal =
        (mesh->vertices[1] - mesh->vertices[0]).cross(mesh->vertices[2] - mesh->vertices[0]).normalized();
    const Vec3 along = (mesh->vertices[2] - mesh->vertices[0]).normalized();
    const Vec3 direction = along - 1e-9 * normal;
    const Vec3 origin = (mesh->vertices[0] + mesh->vertices[1] + mesh->vertices[2]) / 3 - 100 * direction;
    grazing = {origin.x(), origin.y(), origin.z(), direction.x(), direction.y(), direction.z(), INFINITY};
  }
  void answer_with(AnsweringOptions options) {
    options.server = 3;
    options.epoch = 4;
    options.threads = 1;
    if (!options.recovering) options.recovering = [] { return false; };
    reader.reset();
    answering.reset();
    answering = std::make_unique<Answering>(
        Answering::Collaborators{world, clock, write_barriers, leases, counts, audit, part_meshes, samples, place},
        reply_topic, options, [](CommandAsk) {});
    reader.emplace(query_topic, dds::ReaderOptions<wire::Query>{.data = [this](const dds::Taker<wire::Query>& taker) {
                     answering->listen(taker);
                   }});
    ASSERT_TRUE(test::eventually([&] { return writer.matched_readers() == 1; }));
    hello();
  }
  static AnsweringOptions with_error(double error_m) {
    AnsweringOptions options;
    options.error_m = error_m;
    return options;
  }
  static AnsweringOptions with_deadline(std::int64_t deadline_ns) {
    AnsweringOptions options;
    options.deadline_ns = deadline_ns;
    return options;
  }
  void hello() {
    for (int i = 0; i < 100; ++i) {
      dds::Sample<wire::Query> query;
      query->kind = static_cast<std::uint8_t>(QuestionKind::hello);
      query->client = kClient;
      query->chunk_count = 1;
      query->request = ++request;
      ASSERT_TRUE(writer.write(*query));
      if (test::eventually([&] { return ears.hears(request); }, 1ms)) return;
    }
  }
  /// The reply to rays.
  const wire::Reply& ask(const std::vector<double>& numbers, double error_m = 0, std::int64_t deadline_ns = 0,
                         wire_contract::HitMode mode = wire_contract::HitMode::closest) {
    dds::Sample<wire::Query> query;
    query->kind = static_cast<std::uint8_t>(QuestionKind::ray);
    query->mode = static_cast<std::uint8_t>(mode);
    query->client = kClient;
    query->request = ++request;
    query->chunk_count = 1;
    query->first_question = 7;
    query->mask = 0xffffffff;
    query->max_hits = 10;
    query->error_asked = error_m;
    query->deadline_ns = deadline_ns;
    test::put_questions(*query, numbers);
    EXPECT_TRUE(writer.write(*query));
    EXPECT_TRUE(ears.hears(request));
    return ears.reply();
  }
  static double error_of(const wire::Reply& reply) {
    EXPECT_EQ(reply.objects._length, 1U);
    return reply.distance_errors._length > 0 ? reply.distance_errors._buffer[0] : -1;
  }

  World world{WorldOptions{.epoch = 4}};
  WorldClock clock;
  WriteBarriers write_barriers;
  SnapshotLeases leases{world};
  QuestionCounts counts;
  BackgroundAudit audit{0, {}};
  PartMeshes part_meshes;
  QuestionSamples samples;
  const Place place;
  std::vector<double> grazing;
  const std::vector<double> down{0, 0, 60, 0, 0, -1, 20};
  std::uint64_t request = 0;
  dds::Participant client_side{test::near_side()};
  Ears ears{client_side, kClient};
  dds::Participant server_side{test::far_side()};
  dds::Topic<wire::Reply> reply_topic{server_side, test::own_namespace()};
  dds::Topic<wire::Query> query_topic{server_side, test::own_namespace()};
  dds::Topic<wire::Query> asked_topic{client_side, test::own_namespace()};
  dds::Writer<wire::Query> writer{asked_topic};
  std::unique_ptr<Answering> answering;
  std::optional<dds::Reader<wire::Query>> reader;
};

TEST_F(WireAnswering, TheServersErrorIsForQuestionsThatAskForNone) {
  answer_with({});
  const double exact_m = error_of(ask(grazing));
  const double loose_m = error_of(ask(grazing, 1e-2));
  ASSERT_GT(loose_m, exact_m) << "the scene must show the difference";
  answer_with(with_error(1e-2));
  EXPECT_EQ(error_of(ask(grazing)), loose_m);
  EXPECT_LE(error_of(ask(grazing, 1e-9)), 1e-9) << "what a question asks for comes first";
}

TEST_F(WireAnswering, TheServersDeadlineIsForQuestionsThatBringNone) {
  answer_with(with_deadline(1));
  const wire::Reply& late = ask(down);
  ASSERT_EQ(late.answers._length, 1U);
  EXPECT_EQ(late.answers._buffer[0], static_cast<std::uint8_t>(Verdict::undecided));
  EXPECT_EQ(late.reasons._buffer[0], static_cast<std::uint8_t>(UndecidedReason::deadline));
  EXPECT_EQ(ask(down, 0, 60'000'000'000).answers._buffer[0], static_cast<std::uint8_t>(Verdict::hit));
  answer_with(with_deadline(60'000'000'000));
  EXPECT_EQ(ask(down).answers._buffer[0], static_cast<std::uint8_t>(Verdict::hit));
  EXPECT_EQ(ask(down, 0, 1).answers._buffer[0], static_cast<std::uint8_t>(Verdict::undecided));
  answer_with({});
  EXPECT_EQ(ask(down).answers._buffer[0], static_cast<std::uint8_t>(Verdict::hit)) << "none is none";
}

// What is there now is real; what is not, or is nearest, may be otherwise once all publishers are back.
TEST_F(WireAnswering, WhileRecoveringOnlyAHitWhereAnyWillDoIsCertain) {
  std::atomic<bool> recovering{true};
  AnsweringOptions options;
  options.recovering = [&] { return recovering.load(); };
  answer_with(options);
  const auto answer_of = [&](const std::vector<double>& ray, wire_contract::HitMode mode) {
    const wire::Reply& reply = ask(ray, 0, 0, mode);
    return std::pair(static_cast<Verdict>(reply.answers._buffer[0]),
                     static_cast<UndecidedReason>(reply.reasons._buffer[0]));
  };
  const std::vector<double> up{0, 0, 60, 0, 0, 1, 20};
  const std::vector<double> nowhere{0, 0, 60, 0, 0, 0, 20};
  const std::pair unknown{Verdict::undecided, UndecidedReason::recovering};
  using enum wire_contract::HitMode;
  EXPECT_EQ(answer_of(down, any), std::pair(Verdict::hit, UndecidedReason::none));
  EXPECT_EQ(answer_of(down, closest), unknown);
  EXPECT_EQ(answer_of(down, all), unknown);
  EXPECT_EQ(answer_of(up, any), unknown);
  EXPECT_EQ(answer_of(nowhere, closest), std::pair(Verdict::invalid, UndecidedReason::none));
  recovering.store(false);
  EXPECT_EQ(answer_of(down, closest), std::pair(Verdict::hit, UndecidedReason::none));
  EXPECT_EQ(answer_of(up, any), std::pair(Verdict::miss, UndecidedReason::none));
}

TEST_F(WireAnswering, AReplySaysWhoseItIsAndWhatItIsAbout) {
  answer_with({});
  const std::int64_t before_ns = clock.now_ns();
  const wire::Reply& reply = ask(down);
  const std::int64_t age_ns = reply.oldest_pose_age_ns;
  EXPECT_EQ(reply.client, kClient);
  EXPECT_EQ(reply.request, request);
  EXPECT_EQ(reply.server, 3U);
  EXPECT_EQ(reply.epoch, 4U);
  EXPECT_EQ(reply.chunk_index, 0U);
  EXPECT_EQ(reply.chunk_count, 1U);
  EXPECT_EQ(reply.first_question, 7U);
  EXPECT_EQ(reply.status, static_cast<std::uint8_t>(wire_contract::ReplyStatus::ok));
  EXPECT_EQ(reply.version, world.newest()->version);
  EXPECT_EQ(reply.world_time_ns, world.newest()->world_time_ns);
  EXPECT_GT(reply.compute_ns, 0);
  const std::int64_t pose_ns = world.newest()->posed_ns[slot_of(*world.find("ball"))];
  EXPECT_GE(age_ns, before_ns - pose_ns);
  EXPECT_LE(age_ns, clock.now_ns() - pose_ns);
  EXPECT_EQ(ask(grazing).oldest_pose_age_ns, -1) << "the wall does not move";
  EXPECT_EQ(ask(down, 0, 0, wire_contract::HitMode::any).oldest_pose_age_ns >= age_ns, true) << "and is not left over";
}

// Texts are of no object and no question: what a reply before them had of either is not left over.
TEST_F(WireAnswering, ATextSaysWhoseItIsAndNothingOfObjects) {
  answer_with({});
  const auto expect_text = [&](const wire::Reply& reply, wire_contract::ReplyStatus status, const std::string& text) {
    const auto said = dds::view(reply.text);
    EXPECT_EQ(std::string(said.begin(), said.end()), text);
    EXPECT_EQ(reply.client, kClient);
    EXPECT_EQ(reply.request, request);
    EXPECT_EQ(reply.server, 3U);
    EXPECT_EQ(reply.epoch, 4U);
    EXPECT_EQ(reply.chunk_index, 0U);
    EXPECT_EQ(reply.chunk_count, 1U);
    EXPECT_EQ(reply.first_question, 0U);
    EXPECT_EQ(reply.status, static_cast<std::uint8_t>(status));
    EXPECT_EQ(reply.version, world.newest()->version);
    EXPECT_EQ(reply.world_time_ns, world.newest()->world_time_ns);
    EXPECT_EQ(reply.oldest_pose_age_ns, -1);
    EXPECT_EQ(reply.compute_ns, 0);
    EXPECT_EQ(reply.answers._length + reply.objects._length + reply.distances._length + reply.points._length +
                  reply.named_ids._length,
              0U);
  };
  ask(down);
  hello();
  expect_text(ears.reply(), wire_contract::ReplyStatus::ok, "");
  ask(down);
  expect_text(ask({1, 2, 3}), wire_contract::ReplyStatus::refused,
              R"({"error":"the columns of ray questions are empty"})");
  ask(down);
  answering->send_text(kClient, ++request, wire_contract::ReplyStatus::refused, refusal_text("no", "yes"));
  ASSERT_TRUE(ears.hears(request));
  expect_text(ears.reply(), wire_contract::ReplyStatus::refused, R"({"error":"no","hint":"yes"})");
  EXPECT_EQ(counts.refused.load(), 2U);
  EXPECT_EQ(counts.unanswerable.load(), 0U);
}

// Its reader is not there yet, or has not been met: what it asked waits, and is answered once.
TEST_F(WireAnswering, WhoDoesNotListenYetIsAnsweredOnceItDoes) {
  answer_with({});
  dds::Sample<wire::Query> early;
  early->kind = static_cast<std::uint8_t>(QuestionKind::hello);
  early->client = kClient + 1;
  early->chunk_count = 1;
  early->request = 1'000;
  ASSERT_TRUE(writer.write(*early));
  hello();  // the one thread has been through the other one
  Ears late(client_side, kClient + 1);
  EXPECT_TRUE(late.hears(1'000));
  EXPECT_EQ(counts.unanswerable.load(), 0U);
}

// Whoever cannot be answered is counted: a text for a client that nobody has met.
TEST_F(WireAnswering, ATextForNobodyIsCounted) {
  answer_with({});
  answering->send_text(kClient + 1, 1, wire_contract::ReplyStatus::ok, "");
  EXPECT_TRUE(test::eventually([&] { return counts.unanswerable.load() == 1; }));
  EXPECT_EQ(counts.refused.load(), 0U);
}

// A client that saw a state is not answered on an older one, though so many requests are open that new ones wait for
// their states to be free.
TEST_F(WireAnswering, WhatWasToldOnceIsNotUnsaidByARequestInChunks) {
  answer_with({});
  const auto send_chunk = [&](std::uint64_t number, std::uint32_t chunk) {
    dds::Sample<wire::Query> query;
    query->kind = static_cast<std::uint8_t>(QuestionKind::ray);
    query->client = kClient;
    query->request = number;
    query->chunk_index = chunk;
    query->chunk_count = 2;
    query->mask = 0xffffffff;
    query->max_hits = 10;
    test::put_questions(*query, down);
    EXPECT_TRUE(writer.write(*query));
  };
  const auto version_of = [&](std::uint64_t number) {
    EXPECT_TRUE(ears.hears(number));
    return ears.reply().version;
  };
  const auto open_request = [&] {
    send_chunk(++request, 0);
    return version_of(request);
  };
  const std::uint64_t first = request + 1;
  for (std::size_t i = 0; i < SnapshotLeases::kMostStates; ++i) {
    world.step(clock.now_ns(), 1, {});
    EXPECT_EQ(open_request(), world.newest()->version);
  }
  world.step(clock.now_ns(), 1, {});
  const std::uint64_t told = ask(down).version;
  EXPECT_EQ(told, world.newest()->version);
  const std::uint64_t waiting = ++request;
  send_chunk(waiting, 0);
  EXPECT_TRUE(test::eventually([&] { return leases.size() == SnapshotLeases::kMostStates + 1; }));
  send_chunk(first, 1);
  EXPECT_GE(version_of(waiting), told) << "once the first request's state was free";
}

}  // namespace
}  // namespace collided::engine::service
