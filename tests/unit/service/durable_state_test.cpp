// What a server leaves for the next one, and what of it is told to be lost.
#include "server/service/durability/durable_state.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <unistd.h>

#include "tests/oracle/seed.hpp"

namespace collided::engine::service {
namespace {

using Bytes = std::vector<std::byte>;

// A server that crashes again before it has carried out what an earlier one left must leave it too.
class DurableStateTest : public ::testing::Test {
 protected:
  DurableStateTest() { std::filesystem::create_directories(folder); }
  ~DurableStateTest() override { std::filesystem::remove_all(folder); }
  std::unique_ptr<DurableState> live(PastEnd past = PastEnd::running) {
    return std::make_unique<DurableState>(disk_in(folder.string()), "it.journal", past,
                                          [this](const std::string& sentence) { notices.push_back(sentence); });
  }
  static CommandAsk asked(const std::string& text) { return {.client = 1, .request = 1, .text = text, .blob = {}}; }
  std::vector<std::string> left() {
    std::vector<std::string> texts;
    const auto next = live();
    for (const CommandAsk& ask : next->commands_left()) texts.push_back(ask.text);
    return texts;
  }
  /// As a server does after a crash.
  static void carry_out_again(DurableState& state) {
    for (const CommandAsk& ask : state.commands_left()) {
      if (!state.is_due(ask.request)) continue;
      if (ask.text == "load hall") state.scene_loaded("hall", ask);
      if (ask.text == "add crate") state.object_added("crate", ask);
      if (ask.text == "move hall/shelf") state.object_moved("hall", "hall/shelf", {0, 0, ask.text, {}});
      if (ask.text.starts_with("move crate")) state.object_moved("", "crate", {0, 0, ask.text, {}});
    }
    state.note_restored();
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
  state->object_added("crate", asked("add crate"));
  state->wait(std::chrono::seconds(5));
  EXPECT_NE(state->problem(), "");
  std::filesystem::create_directories(folder);
  state->object_added("ball", asked("add ball"));
  state->wait(std::chrono::seconds(5));
  EXPECT_EQ(state->problem(), "");
}

TEST_F(DurableStateTest, WhatIsLeftOutlivesCrashesInARow) {
  {
    const auto first = live(PastEnd::unknown);
    EXPECT_FALSE(first->crashed()) << "there was none before";
    first->object_added("crate", asked("add crate"));
    first->scene_loaded("hall", asked("load hall"));
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
    next->object_moved("", "crate", asked("move crate"));
    next->object_moved("", "crate", asked("move crate on"));
  }
  ASSERT_EQ(left(), (Texts{"load hall", "add crate", "move crate on"})) << "after it was added";
  {
    const auto next = live();
    next->object_added("crate", next->commands_left()[1]);
  }
  ASSERT_EQ(left().size(), 3u) << "a crash before its turn came";
  {
    const auto next = live();
    carry_out_again(*next);
    next->object_added("crate", asked("add another crate"));
  }
  ASSERT_EQ(left(), (Texts{"load hall", "add another crate"})) << "another one stands where it was added";
  {
    const auto next = live();
    next->object_moved("", "crate", asked("move crate"));
    next->removed({{.scene = "", .name = "crate"}});
  }
  ASSERT_EQ(left(), Texts{"load hall"});
  {
    const auto next = live();
    for (const char* name : {"front", "rear"}) next->probe_set(name, asked(std::string("probe ") + name));
    next->probes_removed({"front", "none"});
  }
  ASSERT_EQ(left(), (Texts{"load hall", "probe rear"}));
  live()->set_publishers({9});
  EXPECT_EQ(live()->publishers_left(), std::vector<std::uint64_t>{9}) << "who has not come back is waited for once";
  {
    const auto last = live();
    last->finish();
    last->close();
  }
  EXPECT_FALSE(live(PastEnd::running)->crashed()) << "the journal says that it ended, whatever the epoch's file says";
  EXPECT_TRUE(left().empty()) << "a stop in order forgets";
}

// A crate that was taken out of a loaded file is in that file still.
TEST_F(DurableStateTest, WhatWasTakenOutOfASceneStaysOutUntilTheSceneIsLoadedAnew) {
  {
    const auto first = live(PastEnd::unknown);
    first->scene_loaded("hall", asked("load hall"));
    first->object_moved("hall", "hall/shelf", asked("move hall/shelf"));
    first->removed({{.scene = "hall", .name = "hall/door"}});
  }
  const Texts all{"load hall", R"({"command":"remove","name":"hall/door"})", "move hall/shelf"};
  for (int crash = 0; crash < 2; ++crash) {
    ASSERT_EQ(left(), all);
    carry_out_again(*live());
  }
  live()->removed({{.scene = "hall", .name = "hall/shelf"}});
  ASSERT_EQ(left().size(), 3u) << "gone, and so is its move";
  live()->scene_loaded("hall", asked("load hall"));
  ASSERT_EQ(left(), Texts{"load hall"}) << "a client has loaded it again, the door is there";
  live()->scene_removed("hall");
  EXPECT_TRUE(left().empty());
  {
    const auto next = live();
    next->set_start_scenes({"hall"});
    next->scene_removed("hall");
    next->scene_loaded("hall", asked("load another hall"));
  }
  EXPECT_EQ(left(), (Texts{R"({"command":"clear","scene":"hall"})", "load another hall"}))
      << "the start options load it whatever is kept here";
}

TEST_F(DurableStateTest, ALossLastsUntilItIsAccepted) {
  {
    const auto first = live(PastEnd::unknown);
    first->object_added("crate", asked("add crate"));
    first->object_added("box", asked("add box"));
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
  live()->accept_losses();
  EXPECT_FALSE(live()->has_losses());
  EXPECT_EQ(left(), Texts{"add crate"});
  std::filesystem::remove(folder / "it.journal");
  ASSERT_TRUE(live()->has_losses()) << "the epoch's file knows that there was one";
  ASSERT_TRUE(live()->has_losses()) << "and so does the journal that was written since";
  live()->accept_losses();
  EXPECT_FALSE(live(PastEnd::unknown)->has_losses());
}

TEST_F(DurableStateTest, WhatCannotBeCarriedOutAgainIsALossUntilItIsReplacedOrAccepted) {
  {
    const auto first = live(PastEnd::unknown);
    first->scene_loaded("hall", asked("load hall"));
    first->object_added("crate", asked("add crate"));
  }
  {
    const auto next = live();
    next->not_restored(1, "hall.obj: no such file");
    next->not_restored(2, "no room");
    EXPECT_EQ(next->losses(), (Texts{"no room", "hall.obj: no such file"}));
    next->object_added("crate", asked("add crate by hand"));
    EXPECT_EQ(next->losses(), Texts{"hall.obj: no such file"});
    next->not_restored(2, "its name is taken");
    EXPECT_EQ(next->losses(), Texts{"hall.obj: no such file"}) << "a client was faster";
    EXPECT_FALSE(next->is_due(2));
  }
  ASSERT_EQ(left(), (Texts{"load hall", "add crate by hand"})) << "the file may be there at the next start";
  {
    const auto next = live();
    next->not_restored(1, "hall.obj: no such file");
    next->accept_losses();
    EXPECT_FALSE(next->has_losses());
  }
  EXPECT_EQ(left(), Texts{"add crate by hand"});
}

// A byte anywhere, a cut anywhere: what was put is there or its loss is told, with and without the epoch's file.
TEST_F(DurableStateTest, NoDamageIsSilent) {
  std::mt19937_64 random = oracle::seeded(101);
  {
    const auto first = live(PastEnd::unknown);
    for (int i = 0; i < 20; ++i) first->object_added("thing" + std::to_string(i), asked("add " + std::to_string(i)));
    first->removed({{.scene = "", .name = "thing3"}});
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
    const auto next = live(round % 2 == 0 ? PastEnd::running : PastEnd::unknown);
    ASSERT_TRUE(next->crashed());
    ASSERT_TRUE(next->has_losses() || next->commands_left().size() == 19) << "round " << round;
    told += next->has_losses() ? 1 : 0;
  }
  EXPECT_GT(told, rounds / 2) << "the damage must be worth testing";
  EXPECT_LT(told, rounds) << "a flipped count is no loss";
}

}  // namespace
}  // namespace collided::engine::service
