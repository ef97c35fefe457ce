// What commands have brought in: its order, what goes with what, and that everything that listens has the same.
#include "server/service/durability/inventory.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "tests/oracle/seed.hpp"

namespace collided::engine::service {
namespace {

using Dump = std::vector<KeptCommand>;

Dump dump_of(const KeptCommands& commands) {
  Dump dump;
  commands.for_each([&](const KeptCommand& command) { dump.push_back(command); });
  return dump;
}

/// An inventory, and what a sink has made of its changes.
struct Listened {
  KeptCommands heard;
  std::vector<Inventory::Changes> changes;
  Inventory inventory{{[this](const Inventory::Changes& all) {
                         for (const KeptKey& key : all.erased) heard.erase(key);
                         for (const KeptCommand& command : all.put) heard.put(command);
                       },
                       [this](const Inventory::Changes& all) { changes.push_back(all); }}};
  void put(KeptKind kind, const std::string& name, const std::string& text = "it") {
    inventory.put({.key = {kind, name}, .text = text});
  }
  std::vector<std::string> keys() const {
    std::vector<std::string> keys;
    inventory.commands().for_each([&](const KeptCommand& command) { keys.push_back(command.key.text()); });
    return keys;
  }
};

using Keys = std::vector<std::string>;

TEST(Inventory, KeysAreReadAsTheyAreWritten) {
  for (int kind = 0; kind <= static_cast<int>(KeptKind::published); ++kind) {
    const KeptKey key{static_cast<KeptKind>(kind), "a/b\nc"};
    EXPECT_EQ(KeptKey::parse(key.text()), key) << key.text();
  }
  for (const char* other : {"", "covers", "loss/x", "publisher/00", "object"}) EXPECT_FALSE(KeptKey::parse(other));
  EXPECT_EQ(KeptKey::of_member(KeptKind::gone, "hall", "hall/door").text(), "gone/hall\nhall/door");
  EXPECT_EQ(KeptKey::of_member(KeptKind::member_moved, "hall", "hall/door").scene(), "hall");
  EXPECT_EQ((KeptKey{KeptKind::object, "hall\ndoor"}).scene(), "");
}

TEST(Inventory, IsInTheOrderOfKindsAndThenOfComing) {
  Listened it;
  for (const KeptKind kind : {KeptKind::attached, KeptKind::rule, KeptKind::object, KeptKind::moved, KeptKind::scene})
    for (const char* name : {"b", "a"}) it.put(kind, name);
  it.put(KeptKind::object, "b", "another");
  EXPECT_EQ(it.keys(), (Keys{"scene/b", "scene/a", "object/b", "object/a", "moved/a", "rule/b", "rule/a", "attached/b",
                             "attached/a"}))
      << "the new b is not where the old one was";
  it.inventory.erase({KeptKind::rule, "b"});
  it.put(KeptKind::rule, "b");
  EXPECT_EQ(it.keys()[5], "rule/a") << "b has come again";
}

TEST(Inventory, WhatDependsOnAThingGoesWithIt) {
  Listened it;
  const auto moved_and_attached = [&] {
    it.put(KeptKind::moved, "crate");
    it.put(KeptKind::attached, "crate");
  };
  it.put(KeptKind::object, "crate");
  moved_and_attached();
  it.put(KeptKind::moved, "other");
  it.inventory.erase({KeptKind::object, "crate"});
  EXPECT_EQ(it.keys(), Keys{"moved/other"});

  it.inventory.put({.key = KeptKey::of_member(KeptKind::member_moved, "hall", "door"), .text = "move door"});
  it.put(KeptKind::attached, "door");
  it.inventory.put({.key = KeptKey::of_member(KeptKind::gone, "hall", "door"), .text = "remove door"});
  EXPECT_EQ(it.keys(), (Keys{"gone/hall\ndoor", "moved/other"}));
}

TEST(Inventory, MembersGoWithTheirSceneAndOfAnotherOnesNone) {
  Listened it;
  const auto fill = [&] {
    for (const char* scene : {"hall", "hall 2", "hal"}) {
      for (const KeptKind kind : {KeptKind::gone, KeptKind::member_moved}) {
        for (const char* member : {"a", "b"})
          it.inventory.put(
              {.key = KeptKey::of_member(kind, scene, std::string(member) + (kind == KeptKind::gone ? "" : "2")),
               .text = "it"});
      }
    }
  };
  fill();
  EXPECT_EQ(it.keys().size(), 12U);
  it.inventory.erase_members("hall");
  EXPECT_EQ(it.keys().size(), 8U);
  for (const std::string& key : it.keys()) EXPECT_EQ(key.find("hall\n"), std::string::npos) << key;
  fill();
  it.put(KeptKind::scene, "hall");
  EXPECT_EQ(it.keys().size(), 9U) << "loaded again, it has all of its members";
  fill();
  it.inventory.erase({KeptKind::scene, "hall"});
  EXPECT_EQ(it.keys().size(), 8U);
}

// The next process loads it by itself.
TEST(Inventory, TheRemovalOfASceneOfTheStartIsKept) {
  Listened it;
  it.inventory.set_start_scenes({"hall"});
  it.put(KeptKind::scene, "yard");
  for (const char* scene : {"hall", "yard"}) it.inventory.erase({KeptKind::scene, scene});
  ASSERT_EQ(it.keys(), Keys{"cleared/hall"});
  EXPECT_EQ(dump_of(it.inventory.commands())[0].text, R"({"command":"clear","scene":"hall"})");
}

// Its members are still to be taken out, and its objects to be moved.
TEST(Inventory, WhatIsCarriedOutAgainTakesNothingAway) {
  const Dump left{{.key = {KeptKind::scene, "hall"}, .text = "load hall"},
                  {.key = KeptKey::of_member(KeptKind::gone, "hall", "crate"), .text = "remove crate"},
                  {.key = {KeptKind::object, "crate"}, .text = "add crate"},
                  {.key = KeptKey::of_member(KeptKind::member_moved, "hall", "shelf"), .text = "move shelf"},
                  {.key = {KeptKind::moved, "crate"}, .text = "move crate"},
                  {.key = {KeptKind::attached, "crate"}, .text = "attach crate"}};
  Listened it;
  for (const KeptCommand& command : left) it.inventory.restore(command);
  it.inventory.flush();
  EXPECT_TRUE(dump_of(it.heard).empty()) << "a sink has it once it is carried out";
  for (const KeptCommand& command : left) {
    it.inventory.put(command, Inventory::Turn::again);
    it.inventory.flush();
  }
  EXPECT_EQ(dump_of(it.inventory.commands()), left);
  EXPECT_EQ(dump_of(it.heard), left);
}

TEST(Inventory, ACommandsChangesComeInOnePiece) {
  Listened it;
  it.put(KeptKind::object, "crate");
  it.put(KeptKind::moved, "crate", "once");
  it.put(KeptKind::moved, "crate", "twice");
  it.put(KeptKind::probe, "ear");
  it.inventory.erase({KeptKind::probe, "ear"});
  it.inventory.erase({KeptKind::fence, "none"});
  it.inventory.erase({KeptKind::published, "ball"});
  const Inventory::Changes returned = it.inventory.flush(5, 7);
  ASSERT_EQ(it.changes.size(), 1U);
  EXPECT_EQ(it.changes[0].client, 5U);
  EXPECT_EQ(it.changes[0].request, 7U);
  EXPECT_EQ(it.changes[0].erased, (std::vector<KeptKey>{{KeptKind::probe, "ear"}, {KeptKind::published, "ball"}}))
      << "which objects publishers have the inventory does not know";
  EXPECT_EQ(it.changes[0].put, (Dump{{.key = {KeptKind::object, "crate"}, .text = "it"},
                                     {.key = {KeptKind::moved, "crate"}, .text = "twice"}}));
  EXPECT_EQ(returned.put, it.changes[0].put);
  EXPECT_TRUE(it.inventory.flush().is_empty());
}

TEST(Inventory, CountsItsBytes) {
  KeptCommands commands;
  const KeptCommand small{.key = {KeptKind::object, "a"}, .text = "x"};
  KeptCommand large = small;
  large.blob.resize(10'000);
  commands.put(large);
  EXPECT_EQ(commands.bytes(), large.bytes());
  commands.put(small);
  EXPECT_EQ(commands.bytes(), small.bytes());
  EXPECT_TRUE(commands.erase(small.key));
  EXPECT_FALSE(commands.erase(small.key));
  EXPECT_EQ(commands.bytes(), 0U);
}

/// Any command, about few enough things that they meet again.
void do_anything(Inventory& inventory, std::mt19937_64& random) {
  const auto one_of = [&](std::size_t count) { return random() % count; };
  const auto kind = static_cast<KeptKind>(one_of(static_cast<std::size_t>(KeptKind::published) + 1));
  const bool is_member = kind == KeptKind::gone || kind == KeptKind::member_moved;
  const std::string scene = "scene" + std::to_string(one_of(3)), name = "thing" + std::to_string(one_of(4));
  const KeptKey key = is_member                 ? KeptKey::of_member(kind, scene, name)
                      : kind == KeptKind::scene ? KeptKey{kind, scene}
                                                : KeptKey{kind, name};
  switch (one_of(4)) {
    case 0: return inventory.erase(key);
    case 1:
      if (one_of(4) == 0) return inventory.erase_members(scene);
      [[fallthrough]];
    default:
      inventory.put({.key = key,
                     .text = std::to_string(random()),
                     .blob = std::vector<std::byte>(one_of(3)),
                     .owner = one_of(3) == 0 ? random() : 0});
  }
}

TEST(Inventory, AnySequenceIsHeardAsItIsAndItsDumpMakesTheSame) {
  std::mt19937_64 random = oracle::seeded(54);
  for (int sequence = 0; sequence < 200; ++sequence) {
    Listened it;
    it.inventory.set_start_scenes({"scene0"});
    for (int i = 0; i < 100; ++i) {
      do_anything(it.inventory, random);
      if (random() % 3 == 0) it.inventory.flush();
    }
    it.inventory.flush();
    const Dump dump = dump_of(it.inventory.commands());
    ASSERT_EQ(dump_of(it.heard), dump) << "sequence " << sequence;
    EXPECT_TRUE(std::ranges::is_sorted(dump, {}, [](const KeptCommand& command) { return command.key.kind; }));
    for (const Inventory::Turn turn : {Inventory::Turn::first, Inventory::Turn::again}) {
      Listened again;
      for (const KeptCommand& command : dump) {
        if (turn == Inventory::Turn::again) again.inventory.restore(command);
      }
      for (const KeptCommand& command : dump) {
        again.inventory.put(command, turn);
        again.inventory.flush();
      }
      ASSERT_EQ(dump_of(again.inventory.commands()), dump) << "sequence " << sequence;
      ASSERT_EQ(dump_of(again.heard), dump) << "sequence " << sequence;
    }
  }
}

}  // namespace
}  // namespace collided::engine::service
