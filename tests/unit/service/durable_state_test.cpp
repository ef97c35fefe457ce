// What a server leaves for the next one, and what of it is told to be lost.
#include "server/service/durability/durable_state.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <set>
#include <unistd.h>

#include "server/service/durability/journal_layout.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::service {
namespace {

using Bytes = std::vector<std::byte>;

/// With the inventory that a server has beside it.
struct Life : DurableState {
  using DurableState::DurableState;
  void put(const KeptKey& key, const std::string& text) {
    inventory.put({.key = key, .text = text});
    inventory.flush();
  }
  void erase(const KeptKey& key) {
    inventory.erase(key);
    inventory.flush();
  }
  void put_again(const KeptCommand& command) {
    inventory.put(command, Inventory::Turn::again);
    inventory.flush();
  }
  void accept() {
    for (const KeptKey& key : accept_losses()) inventory.erase(key);
    inventory.flush();
  }
  Inventory inventory{{[this](const Inventory::Changes& changes) { keep(changes); }}};
};

// A server that crashes again before it has carried out what an earlier one left must leave it too.
class DurableStateTest : public ::testing::Test {
 protected:
  DurableStateTest() { std::filesystem::create_directories(folder); }
  ~DurableStateTest() override { std::filesystem::remove_all(folder); }
  std::unique_ptr<Life> live(PastEnd past = PastEnd::running, DurableState::Start start = DurableState::Start::restores,
                             std::set<std::string> start_scenes = {}) {
    auto life = std::make_unique<Life>(
        disk_in(folder.string()), "it.journal", past,
        [this](const std::string& sentence) { notices.push_back(sentence); }, start);
    life->inventory.set_start_scenes(std::move(start_scenes));
    life->restore(life->inventory);
    return life;
  }
  std::vector<std::string> left() {
    std::vector<std::string> texts;
    const auto next = live();
    for (const KeptCommand& command : next->commands_left()) texts.push_back(command.text);
    return texts;
  }
  void stop(std::unique_ptr<Life> state) {
    state->finish();
    state->close();
  }
  /// As a server does at its start, but for what waits for something.
  static void carry_out_again(Life& state) {
    for (std::size_t i = 0; i < state.commands_left().size(); ++i) {
      const KeptCommand& command = state.commands_left()[i];
      const bool waits = command.key.kind == KeptKind::attached || command.key.kind == KeptKind::gone;
      if (state.is_due(i + 1) && !waits) state.put_again(command);
    }
  }
  static KeptKey object(const std::string& name) { return {KeptKind::object, name}; }
  static KeptKey moved(const std::string& name) { return {KeptKind::moved, name}; }
  static KeptKey scene(const std::string& name) { return {KeptKind::scene, name}; }
  static KeptKey gone(const std::string& scene, const std::string& member) {
    return KeptKey::of_member(KeptKind::gone, scene, member);
  }
  static KeptKey member_moved(const std::string& scene, const std::string& member) {
    return KeptKey::of_member(KeptKind::member_moved, scene, member);
  }
  void damage(const std::function<void(Bytes&)>& how) {
    const auto path = folder / "it.journal";
    Bytes bytes = *disk_in(folder.string())->read("it.journal");
    how(bytes);
    std::ofstream(path, std::ios::binary | std::ios::trunc)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  }

  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("durable_" + std::to_string(::getpid()));
  std::vector<std::string> notices;
};

using Texts = std::vector<std::string>;

TEST_F(DurableStateTest, WhyNothingIsKeptIsToldForAsLongAsItIsSo) {
  const auto state = live();
  EXPECT_EQ(state->problem(), "");
  std::filesystem::remove_all(folder);
  state->put(object("crate"), "add crate");
  state->wait(std::chrono::seconds(5));
  EXPECT_NE(state->problem(), "");
  std::filesystem::create_directories(folder);
  state->put(object("ball"), "add ball");
  state->wait(std::chrono::seconds(5));
  EXPECT_EQ(state->problem(), "");
}

TEST_F(DurableStateTest, WhatIsLeftOutlivesCrashesInARow) {
  {
    const auto first = live(PastEnd::unknown);
    EXPECT_FALSE(first->crashed()) << "there was none before";
    first->put(object("crate"), "add crate");
    first->put(scene("hall"), "load hall");
    first->set_publishers({7, 9});
  }
  for (int crash = 0; crash < 3; ++crash) {
    const auto next = live();
    ASSERT_EQ(left(), (Texts{"load hall", "add crate"}));
    EXPECT_EQ(next->publishers_left(), (std::vector<std::uint64_t>{7, 9}));
    carry_out_again(*next);
  }
  {
    const auto next = live();
    carry_out_again(*next);
    next->put(moved("crate"), "move crate");
    next->put(moved("crate"), "move crate on");
  }
  ASSERT_EQ(left(), (Texts{"load hall", "add crate", "move crate on"})) << "after it was added";
  {
    const auto next = live();
    next->put_again(next->commands_left()[1]);
  }
  ASSERT_EQ(left().size(), 3u) << "a crash before its turn came";
  {
    const auto next = live();
    carry_out_again(*next);
    next->put(object("crate"), "add another crate");
  }
  ASSERT_EQ(left(), (Texts{"load hall", "add another crate"})) << "another one stands where it was added";
  {
    const auto next = live();
    next->put(moved("crate"), "move crate");
    next->erase(object("crate"));
  }
  ASSERT_EQ(left(), Texts{"load hall"});
  {
    const auto next = live();
    for (const char* name : {"front", "rear"}) next->put({KeptKind::probe, name}, std::string("probe ") + name);
    for (const char* name : {"front", "none"}) next->erase({KeptKind::probe, name});
  }
  ASSERT_EQ(left(), (Texts{"load hall", "probe rear"}));
  live()->set_publishers({9});
  EXPECT_EQ(live()->publishers_left(), std::vector<std::uint64_t>{9}) << "who has not come back is waited for once";
  stop(live());
  EXPECT_FALSE(live(PastEnd::running)->crashed()) << "the journal says that it ended, whatever the epoch's file says";
}

TEST_F(DurableStateTest, AStopLeavesWhatACrashLeavesButNoPublishers) {
  {
    auto first = live(PastEnd::unknown);
    first->put(scene("hall"), "load hall");
    first->put(object("crate"), "add crate");
    first->set_publishers({7, 9});
    stop(std::move(first));
  }
  const Texts all{"load hall", "add crate"};
  for (int restart = 0; restart < 2; ++restart) {
    auto next = live(PastEnd::stopped);
    EXPECT_FALSE(next->crashed());
    EXPECT_EQ(next->publishers_left(), std::vector<std::uint64_t>{});
    ASSERT_EQ(next->commands_left().size(), 2u) << "restart " << restart;
    EXPECT_EQ(next->losses(), Texts{});
    if (restart == 1) carry_out_again(*next);  // the first one is stopped before it has come so far
    stop(std::move(next));
  }
  { const auto killed = live(PastEnd::stopped); }
  const auto next = live(PastEnd::running);
  EXPECT_TRUE(next->crashed()) << "before its first change";
  EXPECT_EQ(next->publishers_left(), std::vector<std::uint64_t>{}) << "of two servers ago";
  EXPECT_EQ(next->commands_left().size(), 2u);
}

TEST_F(DurableStateTest, AStopDoesNotEndALoss) {
  {
    auto first = live(PastEnd::unknown);
    first->put(object("crate"), "add crate");
    first->put(object("box"), "add box");
    stop(std::move(first));
  }
  damage([](Bytes& bytes) { bytes.resize(bytes.size() - 5); });
  for (int restart = 0; restart < 2; ++restart) {
    auto next = live(PastEnd::stopped);
    EXPECT_FALSE(next->crashed());
    ASSERT_EQ(next->losses().size(), 1u) << "restart " << restart;
    EXPECT_EQ(next->commands_left().size(), 1u);
    stop(std::move(next));
  }
  std::filesystem::remove(folder / "it.journal");
  EXPECT_TRUE(live(PastEnd::stopped)->has_losses()) << "the epoch's file knows that there was a server";
}

TEST_F(DurableStateTest, AFreshStartDropsAllAndSaysHowMuch) {
  {
    auto first = live(PastEnd::unknown);
    first->put(scene("hall"), "load hall");
    for (const char* name : {"crate", "box"}) first->put(object(name), "add");
    first->put({KeptKind::probe, "front"}, "probe front");
    stop(std::move(first));
  }
  {
    const auto fresh = live(PastEnd::stopped, DurableState::Start::drops);
    EXPECT_EQ(fresh->dropped(), "1 scenes, 2 objects, 1 probes");
    EXPECT_TRUE(fresh->commands_left().empty());
  }
  EXPECT_TRUE(left().empty());
  EXPECT_EQ(live(PastEnd::stopped, DurableState::Start::drops)->dropped(), "");
}

TEST_F(DurableStateTest, AFolderOfAnotherVersionIsRefusedUnlessItIsDropped) {
  live(PastEnd::unknown)->put(object("crate"), "add crate");
  damage([](Bytes& bytes) { bytes[journal_layout::kMagicStem.size()] = static_cast<std::byte>('3'); });
  const Bytes before = *disk_in(folder.string())->read("it.journal");
  try {
    live();
    FAIL() << "it was taken";
  } catch (const StateError& wrong) {
    EXPECT_NE(std::string(wrong.what()).find("it.journal: its layout is 3, and this version reads layout"),
              std::string::npos)
        << wrong.what();
  }
  EXPECT_EQ(*disk_in(folder.string())->read("it.journal"), before);
  EXPECT_FALSE(live(PastEnd::running, DurableState::Start::drops)->has_losses());
  EXPECT_TRUE(left().empty());
}

// What was kept about scenes follows the start options of the next start.
TEST_F(DurableStateTest, StartOptionsWinOverWhatWasKeptAboutTheirScenes) {
  const auto leave = [&] {
    auto first = live(PastEnd::unknown, DurableState::Start::drops, {"hall", "yard"});
    first->erase(scene("yard"));
    first->put(gone("hall", "hall/door"), R"({"command":"remove","name":"hall/door"})");
    first->put(member_moved("hall", "hall/shelf"), "move hall/shelf");
    first->put(scene("shed"), R"({"command":"load","path":"shed.obj"})");
    first->put(gone("shed", "shed/door"), R"({"command":"remove","name":"shed/door"})");
    stop(std::move(first));
  };
  const auto left_with = [&](std::set<std::string> scenes) {
    leave();
    const auto next = live(PastEnd::stopped, DurableState::Start::restores, std::move(scenes));
    Texts due, restored;
    for (std::size_t i = 0; i < next->commands_left().size(); ++i) {
      if (next->is_due(i + 1)) due.push_back(next->commands_left()[i].text);
    }
    next->inventory.commands().for_each([&](const KeptCommand& command) { restored.push_back(command.text); });
    EXPECT_EQ(restored, due);
    return due;
  };
  const std::string yard = R"({"command":"clear","scene":"yard"})";
  const std::string shed = R"({"command":"load","path":"shed.obj"})";
  const std::string hall_door = R"({"command":"remove","name":"hall/door"})";
  const std::string shed_door = R"({"command":"remove","name":"shed/door"})";
  EXPECT_EQ(left_with({"hall", "yard"}), (Texts{yard, shed, hall_door, shed_door, "move hall/shelf"}));
  EXPECT_EQ(left_with({"hall"}), (Texts{shed, hall_door, shed_door, "move hall/shelf"})) << "there is no yard to clear";
  EXPECT_EQ(left_with({}), (Texts{shed, shed_door})) << "no hall either";
  EXPECT_EQ(left_with({"hall", "yard", "shed"}), (Texts{yard, hall_door, "move hall/shelf"}))
      << "the options load the shed themselves, as it is in its file";
  ASSERT_EQ(left().size(), 3u) << "what was dropped is gone from the journal too";
}

// A command and a crash later an attachment of before must not come back.
TEST_F(DurableStateTest, WhatWaitsForItsParentIsNotSentAndGoesWithItsChild) {
  const KeptKey attachment{KeptKind::attached, "crate"};
  {
    auto first = live(PastEnd::unknown);
    first->put(object("crate"), "add crate");
    first->put(attachment, "attach crate truck");
    EXPECT_EQ(first->followed(first->inventory).size(), 2u);
    stop(std::move(first));
  }
  {
    const auto next = live(PastEnd::stopped);
    carry_out_again(*next);
    EXPECT_EQ(next->followed(next->inventory).size(), 1u) << "the truck is not there yet";
    EXPECT_TRUE(next->is_due(2));
  }
  {
    const auto next = live();
    carry_out_again(*next);
    next->put(attachment, "attach crate truck");
    EXPECT_EQ(next->followed(next->inventory).size(), 2u);
    EXPECT_FALSE(next->is_due(2));
  }
  {
    const auto next = live();
    carry_out_again(*next);
    next->erase(object("crate"));
    EXPECT_FALSE(next->is_due(2));
  }
  EXPECT_TRUE(left().empty());
}

// A crate that was taken out of a loaded file is in that file still.
TEST_F(DurableStateTest, WhatWasTakenOutOfASceneStaysOutUntilTheSceneIsLoadedAnew) {
  {
    const auto first = live(PastEnd::unknown);
    first->put(scene("hall"), "load hall");
    first->put(member_moved("hall", "hall/shelf"), "move hall/shelf");
    first->put(gone("hall", "hall/door"), R"({"command":"remove","name":"hall/door"})");
  }
  const Texts all{"load hall", R"({"command":"remove","name":"hall/door"})", "move hall/shelf"};
  for (int crash = 0; crash < 2; ++crash) {
    ASSERT_EQ(left(), all);
    carry_out_again(*live());
  }
  live()->put(gone("hall", "hall/shelf"), R"({"command":"remove","name":"hall/shelf"})");
  ASSERT_EQ(left().size(), 3u) << "gone, and so is its move";
  live()->put(scene("hall"), "load hall");
  ASSERT_EQ(left(), Texts{"load hall"}) << "a client has loaded it again, the door is there";
  live()->erase(scene("hall"));
  EXPECT_TRUE(left().empty());
  {
    const auto next = live(PastEnd::running, DurableState::Start::restores, {"hall"});
    next->erase(scene("hall"));
    next->put(scene("hall"), "load another hall");
  }
  EXPECT_EQ(left(), (Texts{R"({"command":"clear","scene":"hall"})", "load another hall"}))
      << "the start options load it whatever is kept here";
}

TEST_F(DurableStateTest, ALossLastsUntilItIsAccepted) {
  {
    const auto first = live(PastEnd::unknown);
    first->put(object("crate"), "add crate");
    first->put(object("box"), "add box");
  }
  damage([](Bytes& bytes) { bytes.resize(bytes.size() - 5); });
  for (int crash = 0; crash < 3; ++crash) {
    const auto next = live();
    ASSERT_TRUE(next->has_losses());
    ASSERT_EQ(next->losses().size(), 1u);
    EXPECT_NE(next->losses()[0].find("2 records and"), std::string::npos) << next->losses()[0];
    EXPECT_EQ(next->commands_left().size(), 1u);
    carry_out_again(*next);
  }
  EXPECT_TRUE(std::filesystem::exists(folder / "it.journal.damaged"));
  live()->accept();
  EXPECT_FALSE(live()->has_losses());
  EXPECT_EQ(left(), Texts{"add crate"});
  std::filesystem::remove(folder / "it.journal");
  ASSERT_TRUE(live()->has_losses()) << "the epoch's file knows that there was one";
  ASSERT_TRUE(live()->has_losses()) << "and so does the journal that was written since";
  live()->accept();
  EXPECT_FALSE(live(PastEnd::unknown)->has_losses());
}

TEST_F(DurableStateTest, WhatCannotBeCarriedOutAgainIsALossUntilItIsReplacedOrAccepted) {
  {
    const auto first = live(PastEnd::unknown);
    first->put(scene("hall"), "load hall");
    first->put(object("crate"), "add crate");
  }
  {
    const auto next = live();
    next->not_restored(1, "hall.obj: no such file");
    next->not_restored(2, "no room");
    EXPECT_EQ(next->losses(), (Texts{"no room", "hall.obj: no such file"}));
    next->put(object("crate"), "add crate by hand");
    EXPECT_EQ(next->losses(), Texts{"hall.obj: no such file"});
    next->not_restored(2, "its name is taken");
    EXPECT_EQ(next->losses(), Texts{"hall.obj: no such file"}) << "a client was faster";
    EXPECT_FALSE(next->is_due(2));
  }
  ASSERT_EQ(left(), (Texts{"load hall", "add crate by hand"})) << "the file may be there at the next start";
  {
    const auto next = live();
    next->not_restored(1, "hall.obj: no such file");
    next->accept();
    EXPECT_FALSE(next->has_losses());
  }
  EXPECT_EQ(left(), Texts{"add crate by hand"});
}

// A byte anywhere, a cut anywhere: what was put is there or its loss is told, with and without the epoch's file.
TEST_F(DurableStateTest, NoDamageIsSilent) {
  std::mt19937_64 random = oracle::seeded(101);
  {
    const auto first = live(PastEnd::unknown);
    for (int i = 0; i < 20; ++i) first->put(object("thing" + std::to_string(i)), "add " + std::to_string(i));
    first->erase(object("thing3"));
  }
  const Bytes whole = *disk_in(folder.string())->read("it.journal");
  const char* asked_rounds = std::getenv("COLLIDED_DAMAGE_ROUNDS");
  const int rounds = asked_rounds != nullptr ? std::atoi(asked_rounds) : 400;
  int told = 0;
  for (int round = 0; round < rounds; ++round) {
    damage([&](Bytes& bytes) {
      bytes = whole;
      const std::size_t at = random() % bytes.size();
      switch (round % 4) {
        case 0: bytes[at] ^= static_cast<std::byte>(1u << random() % 8); break;
        case 1: bytes.resize(at); break;
        case 2:
          for (std::size_t i = at; i < std::min(at + 64, bytes.size()); ++i)
            bytes[i] = static_cast<std::byte>(random());
          break;
        default:
          for (std::byte& byte : bytes) byte = static_cast<std::byte>(random());
      }
    });
    std::unique_ptr<Life> next;
    try {
      next = live(round % 2 == 0 ? PastEnd::running : PastEnd::unknown);
    } catch (const StateError&) {  // the number of the layout is hit
      ++told;
      continue;
    }
    ASSERT_TRUE(next->crashed());
    ASSERT_TRUE(next->has_losses() || next->commands_left().size() == 19) << "round " << round;
    told += next->has_losses() ? 1 : 0;
  }
  EXPECT_GT(told, rounds / 2) << "the damage must be worth testing";
  EXPECT_LT(told, rounds) << "a flipped count is no loss";
}

}  // namespace
}  // namespace collided::engine::service
