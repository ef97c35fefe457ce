#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <fstream>
#include <future>
#include <iterator>
#include <mutex>
#include <thread>

#include "client/cli/io.hpp"
#include "client/view/asker.hpp"
#include "client/view/drawer.hpp"
#include "client/view/follower.hpp"
#include "client/view/foxglove_scene.hpp"
#include "client/view/page_feed.hpp"
#include "client/view/page_messages.hpp"
#include "tests/cli/fakes/fake_client.hpp"
#include "tests/cli/scratch_file.hpp"
#include "tests/cli/terminal.hpp"

namespace collided::view {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using Clock = std::chrono::steady_clock;

class ToldToPages : public testing::Test {
 protected:
  void SetUp() override {
    fake::reset();
    Result<Client> connected = Client::connect({});
    ASSERT_TRUE(connected);
    client.emplace(std::move(*connected));
  }
  std::optional<Client> client;
};

// Two are being asked and 64 wait; what comes then is refused, and all others are answered once.
TEST_F(ToldToPages, SixtyFourQuestionsWaitAndNoMore) {
  std::atomic<int> asked{0};
  std::atomic<int> answered{0};
  std::promise<void> let_go;
  const std::shared_future<void> gate = let_go.get_future().share();
  fake::server().pair = [&](const std::string&, const std::string&, const PairOptions&) -> Result<PairAnswer> {
    ++asked;
    gate.wait();
    return PairAnswer{};
  };
  ServerMemory memory;
  const PageFeed feed([](const WebMessage&) {});
  Asker asker(*client, memory, feed);
  const auto ask = [&] { return asker.ask({1, PairOfNames{"a", "b"}}, [&](const std::string&) { ++answered; }); };
  EXPECT_TRUE(ask());
  EXPECT_TRUE(ask());
  while (asked < 2) std::this_thread::yield();
  for (int i = 0; i < 64; ++i) EXPECT_TRUE(ask()) << i;
  EXPECT_FALSE(ask());
  let_go.set_value();
  while (answered < 66) std::this_thread::yield();
  EXPECT_EQ(asked, 66);
}

// A drawing that takes long is not begun again at once: half of the time is the server's.
TEST_F(ToldToPages, TheDrawerRestsForAsLongAsItDrew) {
  constexpr auto kDrawing = 40ms;
  std::mutex mutex;
  std::vector<Clock::time_point> begun;
  std::vector<Clock::time_point> ended;
  fake::server().shapes = [&](const ShapesOptions&) -> Result<ShownObjects> {
    const std::lock_guard lock(mutex);
    begun.push_back(Clock::now());
    std::this_thread::sleep_until(begun.back() + kDrawing);
    ended.push_back(Clock::now());
    return ShownObjects{};
  };
  {
    Drawer drawer(*client, false);
    for (std::size_t drawn = 0; drawn < 3;) {
      drawer.newest();
      std::this_thread::sleep_for(1ms);
      const std::lock_guard lock(mutex);
      drawn = ended.size();
    }
  }
  for (std::size_t i = 1; i < begun.size(); ++i) EXPECT_GE(begun[i] - ended[i - 1], kDrawing) << i;
}

class Nobody : public Observer {
 public:
  void objects(const std::shared_ptr<const ShownObjects>&) override {}
  void poses(const Poses&) override {}
  void status(const ServerStatus&, const std::optional<Figures>&) override {}
  void silent(double) override {}
  void events(std::span<const Event>) override {}
};

// The time that a look takes is part of its frame. A busy machine may be late, but not every time.
TEST_F(ToldToPages, FramesComeAtTheirRateHoweverLongALookTakes) {
  constexpr auto kFrame = 40ms;
  constexpr auto kLook = 25ms;
  std::mutex mutex;
  std::condition_variable came;
  std::size_t looks = 0;
  Clock::duration least = Clock::duration::max();
  Clock::time_point before;
  fake::server().poses = [&]() -> Result<Poses> {
    const Clock::time_point now = Clock::now();
    {
      const std::lock_guard lock(mutex);
      if (looks++ > 0) least = std::min(least, now - before);
      before = now;
    }
    came.notify_all();
    std::this_thread::sleep_until(now + kLook);
    return Error{ErrorCode::timeout, "slow", ""};
  };
  Nobody nobody;
  const auto follower =
      Follower::start(*client, nobody, {.frame = kFrame, .status = 1h, .is_watched = [] { return true; }});
  ASSERT_TRUE(follower);
  std::unique_lock lock(mutex);
  came.wait_for(lock, 20s, [&] { return least < kFrame + kLook || looks > 100; });
  EXPECT_LT(least, kFrame + kLook);
}

// A status may be old whenever it is looked at, since steps take long: what is answered meanwhile shows that a server is there.
TEST_F(ToldToPages, AServerWhoseStatusIsOldIsThereAsLongAsItAnswers) {
  struct Counting : Nobody {
    void status(const ServerStatus&, const std::optional<Figures>&) override { ++statuses; }
    void silent(double) override { ++silences; }
    std::atomic<int> statuses{0};
    std::atomic<int> silences{0};
  };
  std::atomic<bool> answers{true};
  fake::server().status.age = 30s;
  fake::server().poses = [&]() -> Result<Poses> {
    if (answers) return Poses{};
    return Error{ErrorCode::timeout, "no answer", ""};
  };
  Counting counting;
  const auto follower =
      Follower::start(*client, counting, {.frame = 1ms, .status = 1ms, .is_watched = [] { return true; }});
  ASSERT_TRUE(follower);
  const auto until = [](auto&& condition) {
    for (const Clock::time_point end = Clock::now() + 20s; !condition() && Clock::now() < end;)
      std::this_thread::sleep_for(1ms);
    return condition();
  };
  EXPECT_TRUE(until([&] { return counting.statuses >= 20; }));
  answers = false;
  EXPECT_TRUE(until([&] { return counting.silences > 0; }));
}

TEST_F(ToldToPages, FoxglovesContactIsAnArrowOfTwentyEightCentimetres) {
  Event event;
  event.kind = EventKind::began;
  event.a = "crate";
  event.b = "floor";
  event.world_time = 1'500ms;
  event.point = {1, 2, 3};
  event.normal = {1, 0, 0};
  const json arrow = json::parse(contact_update(std::vector<Event>{event}))["entities"][0]["arrows"][0];
  EXPECT_EQ(arrow["pose"],
            json::parse(R"({"position":{"x":1.0,"y":2.0,"z":3.0},"orientation":{"x":0.0,"y":0.0,"z":0.0,"w":1.0}})"));
  EXPECT_EQ(arrow["shaft_length"], 0.2);
  EXPECT_EQ(arrow["shaft_diameter"], 0.02);
  EXPECT_EQ(arrow["head_length"], 0.08);
  EXPECT_EQ(arrow["head_diameter"], 0.06);
}

TEST_F(ToldToPages, WhoComesLateIsToldStateTableContactsAndPosesInThisOrder) {
  PageFeed feed([](const WebMessage&) {});
  ServerStatus status;
  status.state = "ready";
  feed.status(status, std::nullopt);
  feed.objects(
      std::make_shared<const ShownObjects>(ShownObjects{.epoch = 1, .version = 2, .table_version = 3, .objects = {}}));
  feed.poses(Poses{});
  std::vector<Event> events(3);
  for (std::size_t i = 0; i < events.size(); ++i) {
    events[i].kind = i < 2 ? EventKind::began : EventKind::ended;
    events[i].a = i == 1 ? "crate" : "ball";
    events[i].a_id = i == 1 ? 2 : 1;
    events[i].b_id = 9;
  }
  feed.events(events);
  const std::vector<WebMessage> words = feed.first_words();
  ASSERT_EQ(words.size(), 4U);
  EXPECT_EQ(json::parse(*words[0].bytes)["state"], "ready");
  EXPECT_EQ(json::parse(*words[1].bytes)["type"], "table");
  const json contacts = json::parse(*words[2].bytes);
  EXPECT_EQ(contacts["type"], "contacts");
  ASSERT_EQ(contacts["contacts"].size(), 1U) << "the other has ended";
  EXPECT_EQ(contacts["contacts"][0]["a"], "crate");
  EXPECT_FALSE(words[3].is_text);
}

TEST_F(ToldToPages, RatesAreCountsOverTheTimeTheyTook) {
  const Figures recent{.up_ns = 2'000'000'000,
                       .steps = 10,
                       .step_durations = {{4'000'000, 10}},
                       .stages = {{"test", 500'000'000}},
                       .poses = {.applied = 300},
                       .questions = {{.kind = "ray", .answered = 5, .durations = {{4'000'000, 5}}}}};
  const json told = json::parse(status_text({}, recent))["recent"];
  EXPECT_EQ(told["steps"], 5);
  EXPECT_EQ(told["poses"], 150);
  EXPECT_EQ(told["step_p50"], 0.004);
  EXPECT_EQ(told["stages"], json::parse(R"([{"stage":"test","share":0.25}])"));
  EXPECT_EQ(told["asked"], json::parse(R"([{"kind":"ray","rate":2.5,"p50":0.004,"p99":0.004}])"));
}

std::string bytes_of_base64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t group = 0;
  int bits = 0;
  for (const char c : text.substr(0, text.find('='))) {
    group = group << 6 | static_cast<std::uint32_t>(digits.find(c));
    bits += 6;
    if (bits >= 8) bytes += static_cast<char>(group >> (bits -= 8) & 0xff);
  }
  return bytes;
}

// Poses and tables are packed by zlib, whose first byte is 0x78 and whose first two are a multiple of 31.
TEST_F(ToldToPages, ASavedRunHoldsItsWordsAsTheyAreAndItsBytesInBase64) {
  fake::server().status.state = "ready";
  fake::server().shapes = [](const ShapesOptions&) -> Result<ShownObjects> {
    return ShownObjects{.epoch = 1, .version = 1, .table_version = 1, .objects = {}};
  };
  // It ends after its third frame, however long these take.
  fake::server().poses = [version = 0]() mutable -> Result<Poses> {
    Poses poses;
    poses.epoch = poses.table_version = 1;
    poses.version = static_cast<std::uint64_t>(++version);
    if (version == 3) cli::stop_requested = true;
    return poses;
  };
  const ScratchFile file("run.html", "");
  ASSERT_EQ(collide("view --save " + file.path() + " --last 10min").code, 0);
  std::ifstream in(file.path());
  const std::string page((std::istreambuf_iterator<char>(in)), {});
  const std::string head = R"(<script type="application/json" id="run">)";
  const std::size_t begin = page.find(head) + head.size();
  const json run = json::parse(page.substr(begin, page.find("</script>", begin) - begin));
  std::map<std::string, int> kinds;
  for (const json& message : run["messages"]) {
    const std::string kind = message["kind"];
    const std::string data = message["data"];
    ++kinds[kind];
    if (kind == "text") {
      ++kinds[json::parse(data)["type"]];
    } else {
      EXPECT_EQ(data.size() % 4, 0U);
      const std::string packed = bytes_of_base64(data);
      ASSERT_GT(packed.size(), 8U);
      EXPECT_EQ(packed[0], 0x78);
      EXPECT_EQ((0x7800 + static_cast<unsigned char>(packed[1])) % 31, 0);
    }
  }
  EXPECT_EQ(kinds["hello"], 1);
  EXPECT_GE(kinds["status"], 1);
  EXPECT_EQ(kinds["objects"], 1);
  EXPECT_EQ(kinds["table"], 0) << "the table itself stands there";
  EXPECT_GE(kinds["poses"], 2);
}

}  // namespace
}  // namespace collided::view
