// The state that a flight recording opens with.
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

#include <nlohmann/json.hpp>

#include "idl/commands.hpp"
#include "idl/mcap/reader.hpp"
#include "idl/packed_fences.hpp"
#include "server/service/recording/flight_recorder.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/recording/flight_samples.hpp"
#include "tests/service/wire/rows.hpp"

namespace collided::engine::service {
namespace {

struct Written {
  std::map<std::uint32_t, std::uint64_t> objects;  // sequence by number
  std::map<std::uint32_t, double> x;               // of the newest pose
  std::vector<std::string> commands;
  std::uint64_t newest = 0;
};
Written written(const FlightOpening& opening) {
  Written all;
  opening.write([&](Recorded topic, std::span<const std::byte> data) {
    dds::Sample<wire::Definition> definition;
    dds::Sample<wire::PoseBatch> poses;
    dds::Sample<wire::Query> query;
    if (topic == Recorded::object && wire::read_cdr(data, definition))
      all.objects[definition->object_number] = definition->sequence_number;
    if (topic == Recorded::pose && wire::read_cdr(data, poses)) {
      all.newest = poses->sequence_number;
      for (std::uint32_t i = 0; i < poses->object_numbers._length; ++i)
        all.x[poses->object_numbers._buffer[i]] = poses->positions._buffer[3 * i];
    }
    if (topic == Recorded::query && wire::read_cdr(data, query)) all.commands.emplace_back(query->text);
  });
  return all;
}

TEST(FlightOpening, IsTheNewestOfEachObjectWhateverTheOrder) {
  FlightOpening opening;
  opening.fold(*definition(7, 0, 1));
  opening.fold(*definition(7, 1, 2));
  opening.fold(*definition(7, 2, 3));
  opening.fold(*batch(7, 5, 3, 5));
  opening.fold(*batch(7, 4, 3, 4));  // late
  opening.fold(*definition(7, 1, 6, true));
  opening.fold(*batch(7, 7, 2, 7));
  const Written all = written(opening);
  EXPECT_EQ(all.objects, (std::map<std::uint32_t, std::uint64_t>{{0, 1}, {2, 3}}));
  EXPECT_EQ(all.x, (std::map<std::uint32_t, double>{{0, 7}, {2, 5}}));
  EXPECT_EQ(all.newest, 7U);
}

// A publisher's gap is said once, at its beginning; a replay of what came later needs it. Signs of life do not date poses.
TEST(FlightOpening, HasThePublishersGapAndTheTimeOfItsPoses) {
  FlightOpening opening;
  dds::Sample<wire::Definition> itself = definition(7, wire_contract::kObjectPublisherItself, 1, true);
  itself->position[0] = 2;
  opening.fold(*itself);
  opening.fold(*definition(7, 0, 2));
  dds::Sample<wire::PoseBatch> posed = batch(7, 3, 0, 5);
  posed->source_time_ns = 1'000;
  opening.fold(*posed);
  dds::Sample<wire::PoseBatch> alive;
  alive->publisher = 7;
  alive->incarnation = posed->incarnation;
  alive->source_time_ns = 2'000;
  alive->flags = wire_contract::kPosesStreamed;
  opening.fold(*alive);
  std::vector<double> gaps_s;
  std::vector<std::int64_t> times_ns;
  opening.write([&](Recorded topic, std::span<const std::byte> data) {
    dds::Sample<wire::Definition> said;
    dds::Sample<wire::PoseBatch> poses;
    if (topic == Recorded::object && wire::read_cdr(data, said) &&
        said->object_number == wire_contract::kObjectPublisherItself)
      gaps_s.push_back(said->position[0]);
    if (topic == Recorded::pose && wire::read_cdr(data, poses)) times_ns.push_back(poses->source_time_ns);
  });
  EXPECT_EQ(gaps_s, std::vector<double>{2});
  EXPECT_EQ(times_ns, std::vector<std::int64_t>{1'000});
}

// Definitions and poses are on topics of their own, either may overtake the other.
TEST(FlightOpening, APoseMayComeBeforeItsObject) {
  FlightOpening opening;
  opening.fold(*batch(7, 2, 2, 4));
  opening.fold(*definition(7, 0, 1));
  opening.fold(*definition(7, 1, 3));  // anew, after the pose
  const Written all = written(opening);
  EXPECT_EQ(all.objects, (std::map<std::uint32_t, std::uint64_t>{{0, 1}, {1, 3}}));
  EXPECT_EQ(all.x, (std::map<std::uint32_t, double>{{0, 4}}));
}

// A sample of each topic with one number: the server takes the pose, so it is in the state that the file begins with.
TEST(FlightOpening, APoseWithTheNumberOfItsDefinitionIsOfIt) {
  FlightOpening opening;
  opening.fold(*definition(7, 0, 5));
  opening.fold(*batch(7, 5, 1, 9));
  EXPECT_EQ(written(opening).x, (std::map<std::uint32_t, double>{{0, 9}}));
  opening.fold(*definition(7, 0, 5));  // sent again
  EXPECT_EQ(written(opening).objects, (std::map<std::uint32_t, std::uint64_t>{{0, 5}}));
  EXPECT_EQ(written(opening).x, (std::map<std::uint32_t, double>{{0, 9}}));
  opening.fold(*batch(7, 4, 1, 8));
  EXPECT_EQ(written(opening).x, (std::map<std::uint32_t, double>{{0, 9}})) << "late";
}

// Whoever replays it must know which definitions the poses are of, and when they were.
TEST(FlightOpening, ItsPosesSayWhatTheyAreOf) {
  FlightOpening opening;
  opening.fold(*definition(7, 0, 1));
  opening.fold(*definition(7, 1, 3));
  for (const std::uint64_t sequence : {4, 2}) {  // the older one late
    dds::Sample<wire::PoseBatch> poses = batch(7, sequence, 1, 0.5);
    poses->source_time_ns = static_cast<std::int64_t>(100 * sequence);
    opening.fold(*poses);
  }
  dds::Sample<wire::PoseBatch> told;
  opening.write([&](Recorded topic, std::span<const std::byte> data) {
    if (topic != Recorded::pose) return;
    ASSERT_TRUE(wire::read_cdr(data, told));
  });
  EXPECT_EQ(told->publisher, 7U);
  EXPECT_EQ(told->incarnation, 1U);
  EXPECT_EQ(told->sequence_number, 4U);
  EXPECT_EQ(told->definitions_through, 3U);
  EXPECT_EQ(told->source_time_ns, 400);
  EXPECT_EQ(told->flags, wire_contract::kPosesTeleported);
}

TEST(FlightOpening, ANewLifeOfAPublisherReplacesTheOld) {
  FlightOpening opening;
  opening.fold(*definition(7, 0, 9));
  dds::Sample<wire::Definition> next = definition(7, 1, 1);
  next->incarnation = 2;
  opening.fold(*next);
  opening.fold(*definition(7, 3, 10));  // of the old life
  EXPECT_EQ(written(opening).objects, (std::map<std::uint32_t, std::uint64_t>{{1, 1}}));
}

void tell(FlightOpening& opening, const std::vector<std::pair<std::uint64_t, wire_contract::PublisherState>>& listed,
          std::int64_t time_ns = 0) {
  std::vector<std::uint64_t> publishers;
  std::vector<std::uint8_t> states;
  for (const auto& [publisher, state] : listed)
    publishers.push_back(publisher), states.push_back(static_cast<std::uint8_t>(state));
  dds::Sample<wire::Status> status;
  status->world_time_ns = time_ns;
  dds::borrow(status->publishers, publishers);
  dds::borrow(status->publisher_states, states);
  opening.fold(*status);
  dds::borrow(status->publishers, std::span<const std::uint64_t>());
  dds::borrow(status->publisher_states, std::span<const std::uint8_t>());
}

/// Asks and lets the server say what it did.
void ask(FlightOpening& opening, const std::string& text, const std::string& answer = "{}",
         wire_contract::ReplyStatus status = wire_contract::ReplyStatus::ok) {
  static std::uint64_t request = 0;
  opening.fold(*command(text, ++request));
  dds::Sample<wire::Reply> reply;
  reply->client = 5;
  reply->request = request;
  reply->chunk_count = 1;
  reply->status = static_cast<std::uint8_t>(status);
  const std::vector<std::uint8_t> bytes(answer.begin(), answer.end());
  dds::borrow(reply->text, bytes);
  opening.fold(*reply);
  dds::borrow(reply->text, std::span<const std::uint8_t>());
}

using wire_contract::PublisherState;

TEST(FlightOpening, ALostPublishersObjectsGoAsItWishedAndComeBackWithIt) {
  FlightOpening opening;
  dds::Sample<wire::Definition> kept = definition(7, 1, 2);
  kept->lost_policy = static_cast<std::uint8_t>(wire_contract::LostPolicy::freeze);
  opening.fold(*definition(7, 0, 1));
  opening.fold(*kept);
  tell(opening, {{7, PublisherState::lost}});
  EXPECT_EQ(written(opening).objects, (std::map<std::uint32_t, std::uint64_t>{{1, 2}}));
  tell(opening, {{7, PublisherState::alive}});
  EXPECT_EQ(written(opening).objects, (std::map<std::uint32_t, std::uint64_t>{{0, 1}, {1, 2}}));
}

TEST(FlightOpening, ALostPublishersObjectsAreThereUntilTheyAreForgotten) {
  FlightOpening opening(5'000);
  opening.fold(*definition(7, 0, 1));
  tell(opening, {{7, PublisherState::lost}}, 10'000);
  tell(opening, {{7, PublisherState::lost}}, 14'999);
  EXPECT_EQ(written(opening).objects.size(), 1U);
  tell(opening, {{7, PublisherState::lost}}, 15'000);
  EXPECT_TRUE(written(opening).objects.empty());
}

// A thousand publishers have room; those that came and went do not take it from the next.
TEST(FlightOpening, PublishersThatTheServerForgotAreForgotten) {
  FlightOpening opening;
  for (std::uint64_t publisher = 1; publisher <= 3'000; ++publisher) {
    tell(opening, {});
    opening.fold(*definition(publisher, 0, 1));
    opening.fold(*batch(publisher, 2, 1, 5));
    tell(opening, {});  // on its way: not listed yet
    EXPECT_EQ(written(opening).objects.size(), 1U);
    tell(opening, {{publisher, PublisherState::alive}});
    EXPECT_EQ(written(opening).x.at(0), 5);
    tell(opening, {});
    EXPECT_TRUE(written(opening).objects.empty());
  }
  EXPECT_EQ(opening.left_out(), 0U);
}

TEST(FlightOpening, CommandsThatUndoEachOtherTakeNoRoom) {
  FlightOpening opening;
  for (int i = 0; i < 10; ++i) {
    ask(opening, R"({"command":"add","name":"crate"})");
    ask(opening, R"({"command":"move","name":"crate","pose":[1]})");
    ask(opening, R"({"command":"move","name":"crate","pose":[2]})");
    ask(opening, R"({"command":"list"})");
    if (i < 9)
      ask(opening, i % 2 == 0 ? R"({"command":"remove","name":"crate"})" : R"({"command":"remove","name":"c*"})",
          R"({"removed":["crate"]})");
  }
  EXPECT_EQ(written(opening).commands, (std::vector<std::string>{R"({"command":"add","name":"crate"})",
                                                                 R"({"command":"move","name":"crate","pose":[2]})"}));
  for (int i = 0; i < 10; ++i) {
    ask(opening, R"({"command":"load","path":"/a/plate.obj"})", R"({"scene":"plate"})");
    ask(opening, R"({"command":"clear","scene":"plate"})");
    ask(opening, R"({"command":"probe","name":"ear","object":"crate"})");
    ask(opening, R"({"command":"probe","name":"e*","remove":true})", R"({"probes":["ear"]})");
  }
  EXPECT_EQ(written(opening).commands.size(), 2U);
  ask(opening, R"({"command":"clear"})");
  EXPECT_EQ(written(opening).commands, (std::vector<std::string>{R"({"command":"clear"})"}))
      << "the scenes of the start are gone too";
}

// The names of what a glob removes may be more than one sample of an answer holds, so that its text ends anywhere.
TEST(FlightOpening, ProbesThatWereRemovedStayAwayHoweverLongTheAnswer) {
  FlightOpening opening;
  for (const char* name : {"ear_1", "ear_2", "nose"})
    ask(opening, R"({"command":"probe","object":"crate","name":")" + std::string(name) + "\"}");
  ask(opening, R"({"command":"probe","name":"ear_*","remove":true})", R"({"probes":["ear_1","ea)");
  EXPECT_EQ(written(opening).commands,
            (std::vector<std::string>{R"({"command":"probe","object":"crate","name":"nose"})"}));
}

TEST(FlightOpening, HasTheRulesThatStandInTheirOrder) {
  FlightOpening opening;
  ask(opening, R"({"command":"deny","a":"x","b":"y"})");
  EXPECT_TRUE(written(opening).commands.empty()) << "there is nothing to take back";
  ask(opening, R"({"command":"allow","a":"robot/*","b":"table","because":"it stands there"})");
  ask(opening, R"({"command":"deny","a":"robot/hand","b":"table"})");
  for (int i = 0; i < 5; ++i) {
    ask(opening, R"({"command":"allow","a":"cup","b":"table"})");
    ask(opening, R"({"command":"deny","a":"table","b":"cup"})");
  }
  EXPECT_EQ(written(opening).commands,
            (std::vector<std::string>{R"({"command":"allow","a":"robot/*","b":"table","because":"it stands there"})",
                                      R"({"command":"deny","a":"robot/hand","b":"table"})",
                                      R"({"command":"deny","a":"table","b":"cup"})"}));
}

// Where the two are by now is another place, and the publisher of the parent may have moved it since.
TEST(FlightOpening, HasWhatIsAttachedWithThePlaceThatItTook) {
  FlightOpening opening;
  const std::string placed =
      R"({"child":"crate","command":"attach","parent":"arm/hand","pose":[0.0,0.0,-1.0,1.0,0.0,0.0,0.0]})";
  const auto attach = [&] {
    ask(opening, R"({"command":"attach","child":"crate","parent":"arm/hand"})",
        R"({"child":"crate","parent":"arm/hand","pose":[0.0,0.0,-1.0,1.0,0.0,0.0,0.0],"version":7})");
  };
  const std::string add = R"({"command":"add","name":"crate"})";
  ask(opening, add);
  for (int i = 0; i < 5; ++i) attach();
  EXPECT_EQ(written(opening).commands, (std::vector<std::string>{add, placed}));
  // The server says itself where something stays that is attached no longer, whatever ended that.
  const std::string stays = R"({"command":"move","name":"crate","pose":[4,5,6,1,0,0,0],"teleport":true})";
  opening.fold(*command(stays));
  EXPECT_EQ(written(opening).commands, (std::vector<std::string>{add, stays}));
  attach();
  ask(opening, R"({"command":"detach","child":"crate"})", R"({"child":"crate","parent":"arm/hand","version":9})");
  EXPECT_EQ(written(opening).commands, (std::vector<std::string>{add, stays}));
  attach();
  ask(opening, R"({"command":"remove","name":"crate"})", R"({"removed":["crate"]})");
  EXPECT_TRUE(written(opening).commands.empty());
}

TEST(FlightOpening, WhatWasRefusedChangedNothing) {
  FlightOpening opening;
  ask(opening, R"({"command":"add","name":"crate"})");
  ask(opening, R"({"command":"remove","name":"*"})", "a living publisher has one", wire_contract::ReplyStatus::refused);
  ask(opening, R"({"command":"load","path":"/nowhere.obj"})", "no such file", wire_contract::ReplyStatus::refused);
  EXPECT_EQ(written(opening).commands, (std::vector<std::string>{R"({"command":"add","name":"crate"})"}));
}

// What the server carried out is taken as it stands, whatever its text; one that cannot be read says nothing of objects.
TEST(FlightOpening, ACommandWhoseTextIsNoJsonIsSurvived) {
  FlightOpening opening;
  ask(opening, R"({"command":"add","name":"crate"})");
  ask(opening, R"({"command":"remove","na)", R"({"removed":["crate"]})");
  ask(opening, R"({"command":"remove","name":"crate"})", R"({"removed":["cra)");
  ask(opening, R"({"command":"add","name":"ball"})");
  const std::vector<std::string> commands = written(opening).commands;
  ASSERT_FALSE(commands.empty());
  EXPECT_EQ(commands.back(), R"({"command":"add","name":"ball"})");
}

TEST(FlightOpening, WhatIsNoNameAmongTheRemovedIsPassedOver) {
  FlightOpening opening;
  ask(opening, R"({"command":"add","name":"crate"})");
  ask(opening, R"({"command":"remove","name":"*"})", R"({"removed":[1,null,"crate",{"name":"ball"},"door"]})");
  EXPECT_EQ(written(opening).commands, (std::vector<std::string>{R"({"command":"remove","name":"door"})"}));
}

TEST(FlightOpening, AnObjectOfASceneStaysAwayOnceItWasRemoved) {
  FlightOpening opening;
  for (int i = 0; i < 3; ++i) {
    ask(opening, R"({"command":"load","path":"/a/hall.obj","replace":true})", R"({"scene":"hall"})");
    ask(opening, R"({"command":"remove","name":"door?"})", R"({"removed":["door1","door2"]})");
  }
  EXPECT_EQ(
      written(opening).commands,
      (std::vector<std::string>{R"({"command":"load","path":"/a/hall.obj","replace":true})",
                                R"({"command":"remove","name":"door1"})", R"({"command":"remove","name":"door2"})"}));
}

TEST(FlightOpening, WhatALostPublisherLeftCanBeRemovedAndOfALivingOneNothing) {
  FlightOpening opening;
  for (const std::uint64_t publisher : {7, 8}) {
    dds::Sample<wire::Definition> frozen = definition(publisher, 10 + static_cast<std::uint32_t>(publisher), 1);
    frozen->lost_policy = static_cast<std::uint8_t>(wire_contract::LostPolicy::freeze);
    opening.fold(*frozen);
  }
  tell(opening, {{7, PublisherState::lost}, {8, PublisherState::alive}});
  ask(opening, R"({"command":"remove","name":"object 17"})", R"({"removed":["object 17"]})");
  EXPECT_EQ(written(opening).objects, (std::map<std::uint32_t, std::uint64_t>{{18, 1}}));
  EXPECT_TRUE(written(opening).commands.empty());
  ask(opening, R"({"command":"clear"})");
  EXPECT_EQ(written(opening).objects, (std::map<std::uint32_t, std::uint64_t>{{18, 1}}));
}

/// A fence that a client adds, and the answer.
std::string fence_text(const std::string& name, const std::string& more = {}) {
  return R"({"command":"fence","name":")" + name + '"' + more + '}';
}

TEST(FlightOpening, HasTheFencesThatStandInTheirOrder) {
  FlightOpening opening;
  const std::string margin = R"(,"around":"a","only":"b","bands":[1])",
                    nearest = R"(,"only":"a","point":[0,0,0],"within":3)";
  ask(opening, fence_text("dock 2"));
  ask(opening, fence_text("dock 1", R"(,"keep":true)"));
  ask(opening, fence_text("gap", margin));
  ask(opening, fence_text("who", nearest));
  ask(opening, fence_text("refused"), R"({"error":"taken"})", wire_contract::ReplyStatus::refused);
  const auto names = [&] {
    std::vector<std::string> all;
    for (const std::string& text : written(opening).commands)
      all.push_back(nlohmann::json::parse(text).at("name").get<std::string>());
    return all;
  };
  EXPECT_EQ(names(), (std::vector<std::string>{"dock 2", "dock 1", "gap", "who"}));
  ask(opening, fence_text("", R"(,"remove":true)"));  // of fences alone
  EXPECT_EQ(names(), (std::vector<std::string>{"gap", "who"}));
  ask(opening, fence_text("w*", R"(,"remove":true,"margins":true)"));
  EXPECT_EQ(names(), (std::vector<std::string>{"gap", "who"}));
  ask(opening, fence_text("who", R"(,"remove":true,"nearest":true)"));
  ask(opening, fence_text("dock"));
  ask(opening, fence_text("g?p", R"(,"remove":true,"margins":true)"));
  EXPECT_EQ(names(), (std::vector<std::string>{"dock"}));
  EXPECT_EQ(opening.left_out(), 0U);
}

/// The server says that the client of ask() has gone.
void bid_farewell(FlightOpening& opening, std::uint64_t client) {
  dds::Sample<wire::Reply> reply;
  reply->client = client;
  reply->chunk_count = 1;
  const std::string_view text = wire_contract::command::kClientGone;
  const std::vector<std::uint8_t> bytes(text.begin(), text.end());
  dds::borrow(reply->text, bytes);
  opening.fold(*reply);
  dds::borrow(reply->text, std::span<const std::uint8_t>());
}

TEST(FlightOpening, FencesThatAreNotKeptGoWithTheirOwner) {
  FlightOpening opening;
  ask(opening, fence_text("mine"));
  ask(opening, fence_text("kept", R"(,"keep":true)"));
  std::map<std::string, std::uint64_t> owners;
  opening.write([&](Recorded, std::span<const std::byte> data) {
    dds::Sample<wire::Query> query;
    ASSERT_TRUE(wire::read_cdr(data, query));
    owners[nlohmann::json::parse(query->text).at("name")] = query->client;
  });
  EXPECT_EQ(owners, (std::map<std::string, std::uint64_t>{{"mine", 5}, {"kept", 0}}));
  bid_farewell(opening, 6);
  EXPECT_EQ(written(opening).commands.size(), 2U);
  bid_farewell(opening, 5);
  EXPECT_EQ(written(opening).commands, (std::vector<std::string>{R"({"command":"fence","keep":true,"name":"kept"})"}));
}

/// The names of all fences that the opening makes again, and in how many commands.
std::pair<std::vector<std::string>, std::size_t> fences_of(const FlightOpening& opening) {
  std::pair<std::vector<std::string>, std::size_t> all;
  opening.write([&](Recorded, std::span<const std::byte> data) {
    dds::Sample<wire::Query> query;
    ASSERT_TRUE(wire::read_cdr(data, query));
    ASSERT_LT(data.size(), wire_contract::kMaxMessageBytes);
    ++all.second;
    const auto packed = wire_contract::unpack_fences(std::as_bytes(dds::view(query->blob)));
    ASSERT_TRUE(packed);
    for (const wire_contract::PackedFence& fence : *packed) {
      all.first.push_back(nlohmann::json::parse(fence.arguments).at("name"));
      EXPECT_EQ(fence.shape.size(), 100U);
      EXPECT_EQ(static_cast<char>(fence.shape[0]), all.first.back().back());
    }
  });
  return all;
}

// Added by the message of many, taken out one by one and by globs, and written as many again.
TEST(FlightOpening, ManyFencesAreAFewCommands) {
  FlightOpening opening;
  std::vector<std::uint8_t> packed;
  std::vector<std::string> left;
  for (int i = 0; i < 10'000; ++i) {
    const std::string name = "fence " + std::to_string(i);
    const std::vector<std::uint8_t> shape(100, static_cast<std::uint8_t>(name.back()));
    wire_contract::pack_fence(packed, fence_text(name, R"(,"keep":true)"), shape);
    if (i % 10 != 7 && i != 123) left.push_back(name);
  }
  dds::Sample<wire::Query> many = command(R"({"command":"fence","many":true})");
  dds::borrow(many->blob, packed);
  opening.fold(*many);
  dds::borrow(many->blob, std::span<const std::uint8_t>());
  EXPECT_EQ(fences_of(opening).first.size(), 10'000U);
  ask(opening, fence_text("fence 123", R"(,"remove":true)"));
  ask(opening, fence_text("*7", R"(,"remove":true)"));
  const auto [names, commands] = fences_of(opening);
  EXPECT_EQ(names, left);
  EXPECT_LE(commands, 3U);
  EXPECT_EQ(opening.left_out(), 0U);
}

TEST(FlightOpening, FencesWithoutRoomAreLeftOutAndCounted) {
  FlightOpening opening;
  const std::vector<std::uint8_t> shape(1'000'000, 1);
  const auto add = [&](const std::string& name) {
    dds::Sample<wire::Query> one = command(fence_text(name, R"(,"keep":true)"));
    dds::borrow(one->blob, shape);
    opening.fold(*one);
    dds::borrow(one->blob, std::span<const std::uint8_t>());
  };
  const std::size_t room = FlightFences::kMostBytes / 1'000'200;
  for (std::size_t i = 0; i < room + 3; ++i) add("fence " + std::to_string(i));
  EXPECT_EQ(written(opening).commands.size(), room);
  EXPECT_EQ(opening.left_out(), 3U);
  ask(opening, fence_text("fence 0", R"(,"remove":true)"));
  add("last");
  EXPECT_EQ(written(opening).commands.size(), room);
  EXPECT_EQ(opening.left_out(), 3U);
}

// Whoever has heard the commands meanwhile knows by that which of them it need not repeat.
TEST(FlightOpening, SaysWhichCommandsItHasTakenIntoAccount) {
  FlightOpening opening;
  for (std::uint64_t request = 1; request <= 5'000; ++request) {
    opening.fold(*command(R"({"command":"list"})", 10'000 + request));
    opening.fold(*command(R"({"command":"move","name":"crate"})", request));
  }
  std::vector<recording::CommandNumber> newest;
  for (std::uint64_t request = 5'001 - FlightCommands::kMostNoted; request <= 5'000; ++request)
    newest.emplace_back(5, request);
  EXPECT_EQ(opening.noted_commands(), newest);
  const std::string text = recording::text_of(newest);
  EXPECT_EQ(recording::command_numbers(text), newest);
  EXPECT_EQ(text.substr(0, 12), "5:389 5:38a ");
  for (const char* broken : {"", "x", "5", "5:", "5:1 zz:3", "ffffffffffffffffff:1"})
    EXPECT_EQ(recording::command_numbers(broken).size(), std::string_view(broken) == "5:1 zz:3" ? 1U : 0U) << broken;
}

// What the window's end cuts off from its answer is written, and so is what the server carried out by itself.
TEST(FlightOpening, ACommandWithoutAnAnswerIsWrittenLast) {
  FlightOpening opening;
  opening.fold(*command(R"({"command":"add","name":"late"})", 1'000'000));
  opening.fold(*command(R"({"command":"add","name":"from the journal"})"));
  EXPECT_EQ(written(opening).commands, (std::vector<std::string>{R"({"command":"add","name":"from the journal"})",
                                                                 R"({"command":"add","name":"late"})"}));
  for (std::uint64_t i = 0; i < 200; ++i) opening.fold(*command(R"({"command":"add","name":"lost"})", 2'000'000 + i));
  EXPECT_EQ(written(opening).commands.size(), 1 + FlightCommands::kMostUnanswered);
  EXPECT_EQ(opening.left_out(), 201 - FlightCommands::kMostUnanswered);
}

// What has left the window comes back as the state that the file begins with.
/// The contacts of a shard after an event, each of this size at least.
void hold(FlightOpening& opening, std::uint8_t shard, std::uint64_t as_of, std::size_t count,
          std::size_t name_bytes = 0) {
  std::vector<std::uint64_t> ids(count, 7);
  const std::vector<std::uint8_t> names(name_bytes, 'x');
  dds::Sample<wire::ContactShard> sample;
  sample->shard = shard;
  sample->as_of_sequence = as_of;
  dds::borrow(sample->a, ids);
  dds::borrow(sample->names, names);
  opening.fold(*sample);
}

/// As of when each shard was written.
std::map<std::uint8_t, std::uint64_t> held(const FlightOpening& opening) {
  std::map<std::uint8_t, std::uint64_t> shards;
  opening.write([&](Recorded topic, std::span<const std::byte> data) {
    dds::Sample<wire::ContactShard> sample;
    if (topic == Recorded::contact && wire::read_cdr(data, sample)) shards[sample->shard] = sample->as_of_sequence;
  });
  return shards;
}

TEST(FlightOpening, HasTheContactsThatHeld) {
  FlightOpening opening;
  hold(opening, 3, 10, 1);
  hold(opening, 5, 11, 1);
  hold(opening, 3, 12, 2);
  hold(opening, 5, 13, 0);
  EXPECT_EQ(held(opening), (std::map<std::uint8_t, std::uint64_t>{{3, 12}}));
}

TEST(FlightOpening, HasWhoWasInFences) {
  FlightOpening opening;
  hold(opening, 3, 10, 1);
  const std::vector<std::uint64_t> ids(2, 7);
  dds::Sample<wire::ContactShard> sample;
  sample->shard = 3;
  sample->as_of_sequence = 4;
  dds::borrow(sample->a, ids);
  opening.fold_fences(*sample);
  std::map<Recorded, std::uint64_t> shards;
  opening.write([&](Recorded topic, std::span<const std::byte> data) {
    dds::Sample<wire::ContactShard> shard;
    ASSERT_TRUE(wire::read_cdr(data, shard));
    shards[topic] = shard->as_of_sequence;
  });
  EXPECT_EQ(shards, (std::map<Recorded, std::uint64_t>{{Recorded::contact, 10}, {Recorded::fence_state, 4}}));
}

// An old sample would be a lie: it goes also where the new one has no room.
TEST(FlightOpening, ContactsThatHaveNoRoomAreLeftOutAndCounted) {
  FlightOpening opening;
  for (std::uint8_t shard = 0; shard < 16; ++shard) hold(opening, shard, 1, 1, 1'000'000);
  EXPECT_EQ(held(opening).size(), 16U);
  EXPECT_EQ(opening.left_out(), 0U);
  hold(opening, 4, 2, 1, 2'000'000);
  EXPECT_EQ(held(opening).count(4), 0U);
  EXPECT_EQ(opening.left_out(), 1U);
  hold(opening, 4, 3, 1, 1'000'000);
  EXPECT_EQ(held(opening).size(), 16U) << "there is room again";
}

}  // namespace
}  // namespace collided::engine::service
