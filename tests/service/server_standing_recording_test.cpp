// Standing questions in recordings: what is read back is what a watch reported, none of it is there where there were none, and
// where they stood is on channels of their own.
#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "collided/recording.hpp"
#include "idl/mcap/reader.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/service/standing_fixture.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;
using testing_support::ChildProcess;
using Lines = std::vector<std::string>;

/// All that an event says, so that two are equal where their lines are.
std::string line_of(const StandingEvent& e) {
  return nlohmann::json{static_cast<int>(e.kind),
                        static_cast<int>(e.form),
                        static_cast<int>(e.reason),
                        static_cast<int>(e.doubt),
                        e.resync,
                        e.standing,
                        e.object,
                        e.other,
                        e.band_m,
                        e.object_id,
                        e.epoch,
                        e.sequence,
                        e.episode,
                        e.world_time.count(),
                        e.entered.count(),
                        e.bracket_low_s,
                        e.bracket_high_s,
                        e.left_low_s,
                        e.left_high_s,
                        e.distance_m,
                        e.distance_error_m,
                        e.closing_mps,
                        e.contact_in ? e.contact_in->low_s : -1.0,
                        e.point.x()}
      .dump();
}
Lines lines_of(const std::vector<StandingEvent>& events) {
  Lines lines;
  for (const StandingEvent& event : events) lines.push_back(line_of(event));
  return lines;
}

class ServerStandingRecording : public testing_support::StandingTest {
 protected:
  std::string path(const std::string& name) const { return folder_.path() + "/" + name; }
  ConnectOptions here() const { return {.domain = domain_, .name_space = "collided", .wait = 10s}; }

  /// `collide record`, which a process that is connected already could not do.
  std::unique_ptr<ChildProcess> record_beside(const std::string& file) const {
    return std::make_unique<ChildProcess>(
        std::vector<std::string>{COLLIDED_CLI, "--domain", std::to_string(domain_), "record", file}, folder_.path(),
        "record");
  }
  static void end(ChildProcess& recorder) {
    recorder.signal(SIGINT);
    EXPECT_EQ(recorder.wait(10s), 0) << recorder.errors();
    EXPECT_NE(recorder.errors().find(" 0 lost"), std::string::npos) << recorder.errors();
  }
  /// How many messages each channel has, and the texts of those in JSON.
  struct File {
    std::map<std::string, std::size_t> counts;
    std::map<std::string, Lines> texts;
  };
  static File read(const std::string& file) {
    File found;
    if (!std::filesystem::exists(file)) return found;
    const std::vector<std::byte> bytes = mcap::read_file(file, 1 << 30);
    const mcap::Contents contents = mcap::read(bytes);
    for (const auto& [number, channel] : contents.channels) found.counts[channel.topic];
    for (const mcap::Message& message : contents.messages) {
      const mcap::Channel& channel = contents.channels.at(message.head.channel);
      ++found.counts[channel.topic];
      if (channel.encoding == "json")
        found.texts[channel.topic].emplace_back(reinterpret_cast<const char*>(message.data.data()),
                                                message.data.size());
    }
    return found;
  }
  static bool listens(const std::string& file) {
    return test::eventually([&] { return read(file).counts["collided/status_v3"] > 0; }, 20s);
  }

  static Standing ball_about(const std::string& name, const Vec3& center, double radius_m) {
    return {.name = name, .of = Region{.shape = {SphereShape{.radius_m = radius_m, .center = center}}}};
  }
  static Standing ball_on(const std::string& name, const std::string& to) {
    return {.name = name, .of = Region{.shape = {SphereShape{.radius_m = 1.5}}, .to = to}};
  }
  static void add_all(Client& client) {
    for (const Standing& one :
         {ball_about("dock", {0, 0, 2}, 2), ball_on("around", "ball 0"),
          Standing{.name = "close",
          .only = "ball*",
          .of = Bands{.around = "ball 0", .bands_m = {2, 0.5}, .hysteresis_m = 0.01}},
          Standing{.name = "next", .only = "ball *", .of = Nearest{.to = "ball 1", .within_m = 50}}})
      EXPECT_TRUE(client.add(kept(one))) << one.name;
  }
  /// Balls that fly about, so that much is reported of everything.
  static std::vector<Publisher::Object> add_balls(Publisher& publisher) {
    std::vector<Publisher::Object> balls;
    for (int i = 0; i < 6; ++i)
      balls.push_back(add_ball(publisher, "ball " + std::to_string(i), at(20 + 5 * i, 20, 2)));
    EXPECT_TRUE(publisher.flush());
    return balls;
  }
  static void fly(Publisher& publisher, const std::vector<Publisher::Object>& balls, int rounds) {
    std::mt19937_64 random = oracle::seeded(27);
    std::uniform_real_distribution<double> place(-4, 4);
    for (int round = 0; round < rounds; ++round) {
      for (const Publisher::Object ball : balls) EXPECT_TRUE(publisher.move(ball, at(place(random), place(random), 2)));
      EXPECT_TRUE(publisher.flush());
      EXPECT_TRUE(publisher.wait_applied(20s));
    }
  }
  /// All that a watch has reported.
  static Lines drained(StandingWatch& watch) {
    Lines lines;
    while (const auto event = watch.next(1s)) lines.push_back(line_of(*event));
    EXPECT_EQ(watch.lost(), 0U);
    EXPECT_EQ(watch.resyncs(), 0U);
    return lines;
  }
};

TEST_F(ServerStandingRecording, WhatIsReadIsWhatAWatchReported) {
  start();
  const std::string file = path("run.mcap");
  Client client = connect();
  const auto recorder = record_beside(file);
  ASSERT_TRUE(listens(file));
  StandingWatch watch = watch_standing(client);
  add_all(client);
  Publisher publisher = publish(client, "pilot");
  const std::vector<Publisher::Object> balls = add_balls(publisher);
  fly(publisher, balls, 100);
  EXPECT_EQ(*client.remove_standing("dock"), 1U);
  const Lines reported = drained(watch);
  ASSERT_TRUE(test::eventually([&] { return read(file).texts["/fences"].size() >= 2; }, 20s));
  end(*recorder);

  const Result<RecordedStandingEvents> recorded = recorded_standing_events(file);
  ASSERT_TRUE(recorded) << recorded.error().message;
  for (const std::string& warning : recorded->warnings) ADD_FAILURE() << warning;
  EXPECT_EQ(recorded->lost, 0U);
  EXPECT_EQ(lines_of(recorded->events), reported);
  std::map<StandingForm, std::size_t> counts;
  std::size_t of_dock = 0;
  for (const StandingEvent& event : recorded->events) {
    ++counts[event.form];
    of_dock += event.standing == "dock" ? 1 : 0;
  }
  EXPECT_GT(counts[StandingForm::region], 100U);
  EXPECT_GT(counts[StandingForm::bands], 50U);
  EXPECT_GT(counts[StandingForm::nearest], 20U);
  // One of the names.
  const Result<RecordedStandingEvents> docked = recorded_standing_events(file, {.only = "dock"});
  ASSERT_TRUE(docked);
  EXPECT_EQ(docked->events.size(), of_dock);
  for (const StandingEvent& event : docked->events) EXPECT_EQ(event.standing, "dock");
}

// Each of the topics' messages is there and what was drawn of it, at the beginning and after a change.
TEST_F(ServerStandingRecording, WhereTheyStoodIsOnChannelsOfTheirOwn) {
  start();
  const std::string file = path("run.mcap");
  Client client = connect();
  Publisher publisher = publish(client, "pilot");
  const std::vector<Publisher::Object> balls = add_balls(publisher);
  move(publisher, balls[0], at(7, 0, 2));
  ASSERT_TRUE(publisher.wait_applied(20s));
  ASSERT_TRUE(client.add(kept(ball_on("before", "ball 0"))));
  const auto recorder = record_beside(file);
  // It was there before; the recording has heard no command.
  ASSERT_TRUE(test::eventually([&] { return read(file).texts["/fences"].size() >= 1; }, 20s));
  add_all(client);
  ASSERT_TRUE(
      test::eventually([&] { return read(file).texts["/fences"].back().find("dock") != std::string::npos; }, 20s));
  move(publisher, balls[0], at(1, 0, 2));
  ASSERT_TRUE(test::eventually([&] { return read(file).counts["collided/standing_event_v3"] > 0; }, 20s));
  ASSERT_EQ(*client.remove_standing("*"), 5U);
  ASSERT_TRUE(test::eventually(
      [&] { return read(file).texts["collided/standing"].back() == R"({"standing":[],"type":"standing"})"; }, 20s))
      << read(file).texts["collided/standing"].back();
  end(*recorder);

  File all = read(file);
  for (const char* topic : {"standing_event_v3", "standing_state_v3", "standing"})
    EXPECT_GT(all.counts["collided/" + std::string(topic)], 0U) << topic;
  const auto named = [](const nlohmann::json& list, const char* key, const std::string& name) {
    for (const nlohmann::json& one : list) {
      if (one.at(key) == name) return one;
    }
    ADD_FAILURE() << name << " is not in " << list.dump();
    return nlohmann::json();
  };
  const nlohmann::json first = nlohmann::json::parse(all.texts["collided/standing"].front());
  const nlohmann::json before = named(first.at("standing"), "name", "before");
  EXPECT_EQ(before.at("to"), "ball 0");
  EXPECT_EQ(before.at("kind"), "sphere");
  EXPECT_EQ(before.at("keep"), true);
  // The scene is in the world: about where its carrier was.
  const nlohmann::json scene = nlohmann::json::parse(all.texts["/fences"].front());
  const nlohmann::json drawn = named(scene.at("entities"), "id", "before");
  EXPECT_EQ(drawn.at("frame_id"), "world");
  ASSERT_FALSE(drawn.at("lines").empty());
  for (const nlohmann::json& point : drawn.at("lines").at(0).at("points")) {
    const Vec3 from = Vec3(point.at("x"), point.at("y"), point.at("z")) - Vec3(7, 0, 2);
    EXPECT_NEAR(from.norm(), 1.5, 1e-9);
  }
  std::set<std::string> ever;
  for (const std::string& text : all.texts["collided/standing"]) {
    const nlohmann::json list = nlohmann::json::parse(text);
    for (const nlohmann::json& one : list.at("standing")) ever.insert(one.at("name"));
  }
  EXPECT_EQ(ever, (std::set<std::string>{"around", "before", "close", "dock", "next"}));
}

// Not even a channel, and of the status of standing questions, which the server writes for its readers only, no reader.
TEST_F(ServerStandingRecording, WithoutAnyThereIsNothingOfThem) {
  start();
  const std::string file = path("run.mcap"), last = path("last.mcap");
  Client client = connect();
  const auto recorder = record_beside(file);
  ASSERT_TRUE(listens(file));
  Publisher publisher = publish(client, "pilot");
  fly(publisher, add_balls(publisher), 20);
  EXPECT_EQ(names(client), Names());
  ASSERT_TRUE(test::eventually([&] { return read(file).counts["collided/event_v3"] > 0; }, 20s));
  end(*recorder);
  ASSERT_TRUE(fetch_recording(here(), 20s, last));
  for (const std::string& one : {file, last}) {
    for (const auto& [topic, count] : read(one).counts)
      EXPECT_TRUE(topic.find("fence") == std::string::npos && topic.find("standing") == std::string::npos)
          << topic << " in " << one;
    const Result<RecordedStandingEvents> recorded = recorded_standing_events(one);
    ASSERT_TRUE(recorded);
    EXPECT_TRUE(recorded->events.empty() && recorded->warnings.empty());
  }
}

// What was in before the window is `inside` at its begin, and what came since is reported as a watch did.
TEST_F(ServerStandingRecording, TheFlightRecorderHasThem) {
  // Far more than passes between what it reports at the end and the file, on a busy machine as well.
  start({"--flight-recorder", "5s"});
  const std::string file = path("last.mcap");
  Client client = connect();
  add_all(client);
  Publisher publisher = publish(client, "pilot");
  const std::vector<Publisher::Object> balls = add_balls(publisher);
  move(publisher, balls[2], at(0.5, 0.5, 2));
  ASSERT_TRUE(publisher.wait_applied(20s));
  const auto fetched = [&] {
    EXPECT_TRUE(fetch_recording(here(), 5s, file));
    Result<RecordedStandingEvents> recorded = recorded_standing_events(file);
    EXPECT_TRUE(recorded);
    RecordedStandingEvents read = recorded ? *recorded : RecordedStandingEvents{};
    std::erase_if(read.events, [](const StandingEvent& event) { return event.form != StandingForm::region; });
    return read;
  };
  // Until its coming in has left the window.
  ASSERT_TRUE(test::eventually(
      [&] {
        const RecordedStandingEvents read = fetched();
        return read.events.size() == 1 && read.events[0].kind == StandingEventKind::inside;
      },
      20s));
  StandingWatch watch = watch_standing(client, {.form = StandingForm::region});
  EXPECT_EQ(next(watch).kind, StandingEventKind::inside);
  move(publisher, balls[2], at(9, 9, 2));
  move(publisher, balls[3], at(0.5, 0.5, 2));
  Lines live;
  for (int i = 0; i < 2; ++i) live.push_back(line_of(next(watch)));
  const RecordedStandingEvents read = fetched();
  ASSERT_EQ(read.events.size(), 3U);
  EXPECT_EQ(read.events[0].kind, StandingEventKind::inside);
  EXPECT_EQ(read.events[0].object, "ball 2");
  EXPECT_EQ((Lines{line_of(read.events[1]), line_of(read.events[2])}), live);
  for (const std::string& warning : read.warnings) ADD_FAILURE() << warning;
}

/// What stands in a server and where, without what the server itself numbers and what it holds.
std::map<std::string, nlohmann::json> standing(Client& client) {
  std::map<std::string, nlohmann::json> all;
  for (const bool are_outlines : {false, true}) {
    const nlohmann::json asked{{"name", ""}, {"outlines", are_outlines}, {"lines", are_outlines}};
    const Result<std::string> text = client.command("fences", asked.dump());
    EXPECT_TRUE(text) << text.error().message;
    const nlohmann::json answer = text ? nlohmann::json::parse(*text) : nlohmann::json::object();
    for (nlohmann::json row : answer.value("standing", nlohmann::json::array())) {
      for (const char* own : {"id", "holds", "cut_short"}) row.erase(own);
      if (!are_outlines) all[row.at("name")] = row;
      else if (row.at("form") == "region") all[row.at("name")]["lines"] = row.at("lines");
    }
  }
  return all;
}

std::vector<std::string> names_of(const std::map<std::string, nlohmann::json>& all) {
  std::vector<std::string> names;
  for (const auto& [name, row] : all) names.push_back(name);
  return names;
}

class ReplayedStanding : public ServerStandingRecording {
 protected:
  void stop() {
    servers_.back()->signal(SIGTERM);
    EXPECT_EQ(servers_.back()->wait(15s), 0);
  }
  /// Fetches the flight recording over the client's own connection: the first question of another one may pass before a
  /// recorder hears it, and would be counted as lost.
  static void fetch_over(Client& client, const std::string& file) {
    const auto ask = [&](const nlohmann::json& arguments) {
      const Result<std::string> answer = client.command("recording", arguments.dump());
      EXPECT_TRUE(answer) << answer.error().message;
      return answer ? *answer : std::string();
    };
    const nlohmann::json made = nlohmann::json::parse(ask({{"last_s", 0}}), nullptr, false);
    ASSERT_TRUE(made.is_object() && made.contains("bytes")) << made;
    std::string bytes;
    while (bytes.size() < made["bytes"]) {
      const std::string page = ask({{"number", made["number"]}, {"offset", bytes.size()}});
      ASSERT_FALSE(page.empty()) << "at byte " << bytes.size() << " of " << made["bytes"];
      bytes += page;
    }
    std::ofstream(file, std::ios::binary) << bytes;
  }
  /// Replays quickly; returns what stood at the replay's end.
  std::map<std::string, nlohmann::json> replayed(const std::string& file, std::uint64_t count) {
    std::map<std::string, nlohmann::json> at_end;
    const Result<ReplayReport> report =
        replay(here(), {.path = file, .rate = 1e6, .at_end = [&](std::chrono::nanoseconds) {
                          Client client = connect();
                          at_end = standing(client);
                        }});
    EXPECT_TRUE(report) << report.error().message;
    if (!report) return at_end;
    EXPECT_EQ(report->standing, count);
    for (const std::string& warning : report->warnings) ADD_FAILURE() << warning;
    return at_end;
  }
  static void add_own(Client& client) {
    for (const Standing& one :
         {box("[mine]", {-1, -2, -3}, {1, 2, 3}),
          Standing{.name = "my gap", .only = "b", .of = Bands{.around = "a", .bands_m = {1}}},
          Standing{.name = "my next", .only = "ball*", .of = Nearest{.point = Vec3(1, 2, 3), .within_m = 5}}})
      EXPECT_TRUE(client.add(one)) << one.name;
  }
};

// Of those that stood before the recording, that came in it, one by one and many at once, and that went: by name, and with
// the client that they belonged to.
TEST_F(ReplayedStanding, StandAsTheyStoodWhereARecordingIsReplayed) {
  start();
  const std::string file = path("run.mcap"), last = path("last.mcap");
  std::map<std::string, nlohmann::json> before, after;
  {
    Client client = connect();
    std::optional<Client> other = connect();
    add_all(client);
    add_own(*other);
    const auto recorder = record_beside(file);
    ASSERT_TRUE(listens(file));
    EXPECT_EQ(*client.remove_standing("arou*"), 1U);
    std::vector<Standing> many;
    for (int i = 0; i < 300; ++i)
      many.push_back(kept(ball_about("cell " + std::to_string(i), {1.0 / 3 * i, 0, 2}, 0.5)));
    ASSERT_TRUE(client.add(many));
    const Prism prism{.corners = {{0, 0}, {1, 0}, {0, 1}}, .low_m = 0, .high_m = 2};
    ASSERT_TRUE(client.add(Standing{.name = "late", .keep = true, .of = Region{.prism = prism}}));
    before = standing(client);
    ASSERT_EQ(before.size(), 3U + 3U + 301U);
    fetch_over(client, last);
    other.reset();
    ASSERT_TRUE(test::eventually([&] { return standing(client).size() == 304; }));
    after = standing(client);
    // Until what the server said of it is on the disk.
    ASSERT_TRUE(test::eventually(
        [&] { return read(file).texts["collided/standing"].back().find("[mine]") == std::string::npos; }, 20s));
    end(*recorder);
  }
  stop();
  start({"--fresh"}, "again");
  EXPECT_EQ(replayed(last, 307), before);
  Client client = connect();
  // What was kept stays, the rest goes with the replay.
  ASSERT_TRUE(test::eventually([&] { return standing(client).size() == 304; }, 20s));
  EXPECT_EQ(standing(client), after);
  EXPECT_TRUE(client.remove_standing("*"));
  EXPECT_EQ(replayed(file, 308), after);
  EXPECT_EQ(standing(client), after);
}

// Where a name is taken already, the report says so, and the others are made.
TEST_F(ReplayedStanding, ANameThatIsTakenIsReported) {
  start();
  Client client = connect();
  add_all(client);
  ASSERT_TRUE(fetch_recording(here(), 20s, path("last.mcap")));
  ASSERT_TRUE(client.remove_standing("next"));
  ASSERT_TRUE(client.remove_standing("close"));
  const Result<ReplayReport> report = replay(here(), {.path = path("last.mcap")});
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report->standing, 2U);
  ASSERT_EQ(report->warnings.size(), 2U);
  EXPECT_NE(report->warnings[0].find("dock"), std::string::npos);
  EXPECT_NE(report->warnings[0].find("the name is taken"), std::string::npos);
  EXPECT_EQ(names_of(standing(client)), (std::vector<std::string>{"around", "close", "dock", "next"}));
}

// The server carries the kept commands out again by itself; the recorder has them with no client and no answer.
TEST_F(ReplayedStanding, StandAlsoWhereTheServerHadMadeThemAgainAfterARestart) {
  start();
  std::map<std::string, nlohmann::json> before;
  {
    Client client = connect();
    add_all(client);
    before = standing(client);
  }
  servers_.back()->signal(SIGKILL);
  servers_.back()->wait(15s);
  start({}, "restarted");
  {
    Client client = connect();
    ASSERT_TRUE(test::eventually([&] { return standing(client) == before; }));
    ASSERT_TRUE(fetch_recording(here(), 20s, path("last.mcap")));
  }
  stop();
  start({"--fresh"}, "again");
  EXPECT_EQ(replayed(path("last.mcap"), 4), before);
}

}  // namespace
}  // namespace collided
