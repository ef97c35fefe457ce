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

#include "idl/mcap/format.hpp"
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

/// Folds a sample as the window's record of it.
template <class T>
void fold_record(FlightOpening& opening, std::uint16_t channel, const T& sample) {
  const std::size_t bytes = wire::cdr_size(sample);
  std::vector<std::byte> record(mcap::kMessagePrefixBytes + bytes);
  mcap::put_message_prefix(record.data(), {channel, 0, 0, 0}, bytes);
  wire::write_cdr(sample, std::span(record).subspan(mcap::kMessagePrefixBytes));
  opening.fold(record);
}

/// An opening that takes in what the inventory beside it hands on.
struct KeptOpening : FlightOpening {
  void put(KeptKey key, const std::string& text, std::uint64_t owner = 0, std::vector<std::byte> blob = {}) {
    inventory.put({.key = std::move(key), .text = text, .blob = std::move(blob), .owner = owner});
    inventory.flush();
  }
  void erase(const KeptKey& key) {
    inventory.erase(key);
    inventory.flush();
  }
  std::uint64_t own_commands = 0;
  std::size_t records = 0;
  Inventory inventory{{[this](const Inventory::Changes& changes) {
    write_changes(changes, own_commands, [this](const wire::Query& query) {
      ++records;
      EXPECT_LT(wire::cdr_size(query), FlightWindow::kBlockBytes / 2 + 65'536);
      fold_record(*this, kInventoryChannel, query);
    });
  }}};
};

void refuse(FlightOpening& opening, std::uint64_t request, wire_contract::ReplyStatus status) {
  dds::Sample<wire::Reply> reply;
  reply->client = 5;
  reply->request = request;
  reply->chunk_count = 1;
  reply->status = static_cast<std::uint8_t>(status);
  opening.fold(*reply);
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
  KeptOpening opening;
  opening.inventory.set_start_scenes({"hall"});
  const std::string add = R"({"command":"add","name":"crate"})", move = R"({"command":"move","name":"crate"})";
  for (int i = 0; i < 10; ++i) {
    if (i > 0) opening.erase({KeptKind::object, "crate"});
    opening.put({KeptKind::object, "crate"}, add);
    opening.put({KeptKind::moved, "crate"}, "moved once");
    opening.put({KeptKind::moved, "crate"}, move);
  }
  EXPECT_EQ(written(opening).commands, (std::vector<std::string>{add, move}));
  for (int i = 0; i < 10; ++i) {
    opening.put({KeptKind::scene, "plate"}, R"({"command":"load","path":"/a/plate.obj"})");
    opening.erase({KeptKind::scene, "plate"});
    opening.put({KeptKind::probe, "ear"}, R"({"command":"probe","name":"ear","object":"crate"})");
    opening.erase({KeptKind::probe, "ear"});
  }
  EXPECT_EQ(written(opening).commands.size(), 2U);
  opening.erase({KeptKind::object, "crate"});
  opening.erase({KeptKind::scene, "hall"});
  EXPECT_EQ(written(opening).commands, (std::vector<std::string>{R"({"command":"clear","scene":"hall"})"}))
      << "the scenes of the start are gone too";
}

// The names of what a glob removes may be more than one record holds.
TEST(FlightOpening, WhatACommandChangedIsTakenWholeHoweverMuchItIs) {
  KeptOpening opening;
  const std::string stem(200, 'x');
  for (int i = 0; i < 10'000; ++i)
    opening.inventory.put({.key = {KeptKind::probe, stem + std::to_string(i)}, .text = std::to_string(i)});
  opening.inventory.flush();
  EXPECT_GT(opening.records, 2U);
  EXPECT_EQ(written(opening).commands.size(), 10'000U);
  opening.records = 0;
  for (int i = 0; i < 10'000; ++i) {
    if (i != 77) opening.inventory.erase({KeptKind::probe, stem + std::to_string(i)});
  }
  opening.inventory.flush();
  EXPECT_GT(opening.records, 2U);
  EXPECT_EQ(written(opening).commands, std::vector<std::string>{"77"});
  EXPECT_EQ(opening.left_out(), 0U);
}

TEST(FlightOpening, HasTheRulesThatStandInTheirOrder) {
  KeptOpening opening;
  const std::vector<std::string> rules{R"({"a":"robot/*","b":"table","because":"it stands there","command":"allow"})",
                                       R"({"a":"robot/hand","b":"table","command":"deny"})",
                                       R"({"a":"table","b":"cup","command":"deny"})"};
  for (int round = 0; round < 5; ++round) {
    for (const std::size_t place : {2U, 1U}) opening.erase({KeptKind::rule, "0" + std::to_string(place)});
    for (std::size_t place = 0; place < rules.size(); ++place)
      opening.put({KeptKind::rule, "0" + std::to_string(place)}, rules[place]);
    EXPECT_EQ(written(opening).commands, rules);
  }
}

// Where the two are by now is another place, and the publisher of the parent may have moved it since.
TEST(FlightOpening, HasWhatIsAttachedWithThePlaceThatItTook) {
  KeptOpening opening;
  const KeptKey crate{KeptKind::object, "crate"}, attached{KeptKind::attached, "crate"};
  const std::string add = R"({"command":"add","name":"crate"})";
  const std::string placed =
      R"({"child":"crate","command":"attach","parent":"arm/hand","pose":[0.0,0.0,-1.0,1.0,0.0,0.0,0.0]})";
  const std::string stays = R"({"command":"move","name":"crate","pose":[4,5,6,1,0,0,0],"teleport":true})";
  opening.put(crate, add);
  for (int i = 0; i < 5; ++i) opening.put(attached, placed);
  EXPECT_EQ(written(opening).commands, (std::vector<std::string>{add, placed}));
  // Something stays that is attached no longer, whatever ended that.
  opening.inventory.erase(attached);
  opening.put({KeptKind::moved, "crate"}, stays);
  EXPECT_EQ(written(opening).commands, (std::vector<std::string>{add, stays}));
  opening.put(attached, placed);
  EXPECT_EQ(written(opening).commands, (std::vector<std::string>{add, stays, placed}));
  opening.erase(crate);
  EXPECT_TRUE(written(opening).commands.empty());
}

TEST(FlightOpening, WhatWasRefusedChangedNothing) {
  KeptOpening opening;
  const std::string add = R"({"command":"add","name":"crate"})";
  opening.put({KeptKind::object, "crate"}, add);
  std::uint64_t request = 0;
  for (const char* text : {R"({"command":"remove","name":"*"})", R"({"command":"load","path":"/nowhere.obj"})"}) {
    opening.fold(*command(text, ++request));
    refuse(opening, request, wire_contract::ReplyStatus::progress);
    EXPECT_EQ(written(opening).commands, (std::vector<std::string>{add, text})) << "under way";
    refuse(opening, request, wire_contract::ReplyStatus::refused);
  }
  EXPECT_EQ(written(opening).commands, std::vector<std::string>{add});
}

TEST(FlightOpening, ACommandWhoseTextIsNoJsonIsSurvived) {
  KeptOpening opening;
  opening.put({KeptKind::object, "crate"}, "add crate");
  for (const char* text : {R"({"command":"remove","na)", "[1]", R"({"command":7})", "", R"({"command":"nonsense"})"})
    opening.fold(*command(text, 1));
  opening.put({KeptKind::object, "ball"}, "add ball");
  EXPECT_EQ(written(opening).commands, (std::vector<std::string>{"add crate", "add ball"}));
}

TEST(FlightOpening, ChangesThatAreCutShortOrOfUnknownThingsArePassedOver) {
  KeptOpening opening;
  opening.put({KeptKind::object, "crate"}, "add crate");
  std::vector<std::uint8_t> packed;
  for (const char* text : {"[1]", "{}", R"({"erase":"what/crate"})", R"({"put":"what/ball","text":"x","owner":0})"})
    wire_contract::pack_fence(packed, text, {});
  const std::size_t unknown = packed.size();
  wire_contract::pack_fence(packed, R"({"erase":"object/crate"})", {});
  for (std::size_t size = 0; size < packed.size(); ++size) {
    dds::Sample<wire::Query> changes;
    dds::borrow(changes->blob, std::span(packed).first(size));
    opening.fold_changes(*changes);
    ASSERT_EQ(written(opening).commands, std::vector<std::string>{"add crate"}) << size << " of " << unknown;
  }
  dds::Sample<wire::Query> changes;
  dds::borrow(changes->blob, packed);
  opening.fold_changes(*changes);
  EXPECT_TRUE(written(opening).commands.empty());
}

TEST(FlightOpening, AnObjectOfASceneStaysAwayOnceItWasRemoved) {
  KeptOpening opening;
  const std::string load = R"({"command":"load","path":"/a/hall.obj","replace":true})";
  for (int i = 0; i < 3; ++i) {
    opening.put({KeptKind::scene, "hall"}, load);
    EXPECT_EQ(written(opening).commands, std::vector<std::string>{load});
    for (const char* door : {"door1", "door2"})
      opening.put(KeptKey::of_member(KeptKind::gone, "hall", door), std::string("remove ") + door);
  }
  EXPECT_EQ(written(opening).commands, (std::vector<std::string>{load, "remove door1", "remove door2"}));
}

TEST(FlightOpening, WhatALostPublisherLeftCanBeRemovedAndOfALivingOneNothing) {
  KeptOpening opening;
  for (const std::uint64_t publisher : {7, 8}) {
    dds::Sample<wire::Definition> frozen = definition(publisher, 10 + static_cast<std::uint32_t>(publisher), 1);
    frozen->lost_policy = static_cast<std::uint8_t>(wire_contract::LostPolicy::freeze);
    opening.fold(*frozen);
  }
  tell(opening, {{7, PublisherState::lost}, {8, PublisherState::alive}});
  const std::string move = R"({"command":"move","name":"object 17","teleport":true})";
  opening.put({KeptKind::published, "object 17"}, move, 7);
  EXPECT_EQ(written(opening).commands, std::vector<std::string>{move});
  opening.erase({KeptKind::published, "object 17"});
  EXPECT_EQ(written(opening).objects, (std::map<std::uint32_t, std::uint64_t>{{18, 1}}));
  EXPECT_TRUE(written(opening).commands.empty());
  opening.erase({KeptKind::published, "object 18"});
  EXPECT_EQ(written(opening).objects, (std::map<std::uint32_t, std::uint64_t>{{18, 1}}));
}

std::string fence_text(const std::string& name) { return R"({"command":"fence","name":")" + name + "\"}"; }

TEST(FlightOpening, HasTheFencesThatStandInTheirOrder) {
  KeptOpening opening;
  const auto names = [&] {
    std::vector<std::string> all;
    for (const std::string& text : written(opening).commands)
      all.push_back(nlohmann::json::parse(text).at("name").get<std::string>());
    return all;
  };
  for (const char* name : {"dock 2", "dock 1", "gap", "who"})
    opening.put({KeptKind::fence, name}, fence_text(name), name[0] == 'd' ? 0 : 5);
  EXPECT_EQ(names(), (std::vector<std::string>{"dock 2", "dock 1", "gap", "who"}));
  for (const char* name : {"dock 2", "who", "dock 1"}) opening.erase({KeptKind::fence, name});
  EXPECT_EQ(names(), std::vector<std::string>{"gap"});
  opening.put({KeptKind::fence, "dock 2"}, fence_text("dock 2"));
  EXPECT_EQ(names(), (std::vector<std::string>{"gap", "dock 2"}));
  EXPECT_EQ(opening.left_out(), 0U);
}

TEST(FlightOpening, FencesThatAreNotKeptHaveTheirOwner) {
  KeptOpening opening;
  opening.put({KeptKind::fence, "mine"}, fence_text("mine"), 5);
  opening.put({KeptKind::fence, "kept"}, fence_text("kept"));
  std::map<std::string, std::uint64_t> owners;
  opening.write([&](Recorded, std::span<const std::byte> data) {
    dds::Sample<wire::Query> query;
    ASSERT_TRUE(wire::read_cdr(data, query));
    owners[nlohmann::json::parse(query->text).at("name")] = query->client;
  });
  EXPECT_EQ(owners, (std::map<std::string, std::uint64_t>{{"mine", 5}, {"kept", 0}}));
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

// Added at once, taken out one by one and many at once, and written as many again.
TEST(FlightOpening, ManyFencesAreAFewCommands) {
  KeptOpening opening;
  std::vector<std::string> left;
  for (int i = 0; i < 10'000; ++i) {
    const std::string name = "fence " + std::to_string(i);
    opening.inventory.put({.key = {KeptKind::fence, name},
                           .text = fence_text(name),
                           .blob = std::vector<std::byte>(100, static_cast<std::byte>(name.back()))});
    if (i % 10 != 7 && i != 123) left.push_back(name);
  }
  opening.inventory.flush();
  EXPECT_EQ(fences_of(opening).first.size(), 10'000U);
  opening.erase({KeptKind::fence, "fence 123"});
  for (int i = 7; i < 10'000; i += 10) opening.inventory.erase({KeptKind::fence, "fence " + std::to_string(i)});
  opening.inventory.flush();
  const auto [names, commands] = fences_of(opening);
  EXPECT_EQ(names, left);
  EXPECT_LE(commands, 3U);
  EXPECT_EQ(opening.left_out(), 0U);
}

TEST(FlightOpening, CommandsWithoutRoomAreLeftOutAndCounted) {
  KeptOpening opening;
  const auto add = [&](const std::string& name) {
    opening.put({KeptKind::fence, name}, fence_text(name), 0, std::vector<std::byte>(1'000'000));
  };
  const std::size_t room = FlightOpening::kMostKeptBytes / 1'000'200;
  for (std::size_t i = 0; i < room + 3; ++i) add("fence " + std::to_string(i));
  EXPECT_EQ(written(opening).commands.size(), room);
  EXPECT_EQ(opening.left_out(), 3U);
  opening.erase({KeptKind::fence, "fence 0"});
  add("last");
  EXPECT_EQ(written(opening).commands.size(), room);
  EXPECT_EQ(opening.left_out(), 3U);
}

// The bytes of many fences have room for long ones; other commands are written one by one.
TEST(FlightOpening, ATextTooLongForACommandIsLeftOutUnlessItIsOfAFence) {
  KeptOpening opening;
  const std::string longer(sizeof(wire::Query::text), ' ');
  opening.put({KeptKind::probe, "ear"}, longer);
  EXPECT_TRUE(written(opening).commands.empty());
  EXPECT_EQ(opening.left_out(), 1U);
  opening.put({KeptKind::fence, "polygon"}, fence_text("polygon") + longer);
  EXPECT_EQ(written(opening).commands, std::vector<std::string>{R"({"command":"fence","many":true})"});
}

// Whoever has heard the commands meanwhile knows by that which of them it need not repeat.
TEST(FlightOpening, SaysWhichCommandsItHasTakenIntoAccount) {
  FlightOpening opening;
  for (std::uint64_t request = 1; request <= 5'000; ++request) {
    opening.fold(*command(R"({"command":"list"})", 10'000 + request));
    opening.fold(*command(R"({"command":"move","name":"crate"})", request));
  }
  std::vector<recording::CommandNumber> newest;
  for (std::uint64_t request = 5'001 - FlightOpening::kMostNoted; request <= 5'000; ++request)
    newest.emplace_back(5, request);
  EXPECT_EQ(opening.noted_commands(), newest);
  const std::string text = recording::text_of(newest);
  EXPECT_EQ(recording::command_numbers(text), newest);
  EXPECT_EQ(text.substr(0, 12), "5:389 5:38a ");
  for (const char* broken : {"", "x", "5", "5:", "5:1 zz:3", "ffffffffffffffffff:1"})
    EXPECT_EQ(recording::command_numbers(broken).size(), std::string_view(broken) == "5:1 zz:3" ? 1U : 0U) << broken;
}

// What the window's end cuts off from its changes is written; with these it counts once, whoever gave the command.
TEST(FlightOpening, ACommandWithoutItsChangesIsWrittenLast) {
  KeptOpening opening;
  const std::string late = R"({"command":"add","name":"late"})", own = R"({"command":"add","name":"own"})";
  opening.fold(*command(late, 1'000'000));
  dds::Sample<wire::Query> own_command = command(own);
  own_command->request = 3;
  opening.fold(*own_command);
  opening.put({KeptKind::object, "from the journal"}, "from the journal");
  EXPECT_EQ(written(opening).commands, (std::vector<std::string>{"from the journal", late, own}));
  opening.own_commands = 3;
  opening.put({KeptKind::object, "own"}, own);
  EXPECT_EQ(written(opening).commands, (std::vector<std::string>{"from the journal", own, late}));
  opening.inventory.put({.key = {KeptKind::object, "late"}, .text = late});
  opening.inventory.flush(5, 1'000'000);
  EXPECT_EQ(written(opening).commands, (std::vector<std::string>{"from the journal", own, late}));
  EXPECT_EQ(opening.noted_commands(), (std::vector<recording::CommandNumber>{{5, 1'000'000}}));
  for (std::uint64_t i = 0; i < 200; ++i) opening.fold(*command(R"({"command":"add","name":"lost"})", 2'000'000 + i));
  EXPECT_EQ(written(opening).commands.size(), 3 + FlightOpening::kMostUnanswered);
  EXPECT_EQ(opening.left_out(), 200 - FlightOpening::kMostUnanswered);
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

/// What holds of standing questions in a shard after an event.
void hold_standing(FlightOpening& opening, std::uint8_t shard, std::uint64_t as_of, std::size_t count) {
  const std::vector<std::uint64_t> ids(count, 7);
  dds::Sample<wire::StandingShard> sample;
  sample->shard = shard;
  sample->as_of_sequence = as_of;
  dds::borrow(sample->standings, ids);
  dds::borrow(sample->objects, ids);
  fold_record(opening, static_cast<std::uint16_t>(Recorded::standing_state), *sample);
}

// Beside the contacts of the shard with the same number.
TEST(FlightOpening, HasWhatHeldOfStandingQuestions) {
  FlightOpening opening;
  hold(opening, 3, 10, 1);
  hold_standing(opening, 3, 3, 1);
  hold_standing(opening, 5, 3, 1);
  hold_standing(opening, 3, 4, 2);
  hold_standing(opening, 5, 4, 0);
  std::map<std::uint8_t, std::uint64_t> shards;
  opening.write([&](Recorded topic, std::span<const std::byte> data) {
    dds::Sample<wire::StandingShard> shard;
    if (topic == Recorded::standing_state && wire::read_cdr(data, shard)) shards[shard->shard] = shard->as_of_sequence;
  });
  EXPECT_EQ(shards, (std::map<std::uint8_t, std::uint64_t>{{3, 4}}));
  EXPECT_EQ(held(opening), (std::map<std::uint8_t, std::uint64_t>{{3, 10}}));
}

// A reader counts missing events from the first sum, which is one of the window.
TEST(FlightOpening, LacksTheSumOfStandingQuestions) {
  FlightOpening opening;
  hold_standing(opening, wire_contract::kStandingSum, 4, 1);
  std::size_t count = 0;
  opening.write([&](Recorded, std::span<const std::byte>) { ++count; });
  EXPECT_EQ(count, 0U);
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
