// Fences, margins and questions for the nearest in recordings: what is read back is what watches were told, none of it is
// there where there were none, and where they stood is on channels of their own.
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
#include "tests/service/server_fixture.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;
using testing_support::ChildProcess;
using Lines = std::vector<std::string>;

/// All that an event says, so that two are equal where their lines are.
std::string line_of(const FenceEvent& e) {
  return nlohmann::json{"fence",
                        static_cast<int>(e.kind),
                        static_cast<int>(e.reason),
                        static_cast<int>(e.doubt),
                        e.resync,
                        e.object,
                        e.fence,
                        e.object_id,
                        e.fence_id,
                        e.epoch,
                        e.sequence,
                        e.episode,
                        e.world_time.count(),
                        e.entered.count(),
                        e.bracket_low_s,
                        e.bracket_high_s,
                        e.left_low_s,
                        e.left_high_s,
                        e.point.x()}
      .dump();
}
std::string line_of(const MarginEvent& e) {
  return nlohmann::json{"margin",
                        static_cast<int>(e.kind),
                        static_cast<int>(e.reason),
                        static_cast<int>(e.doubt),
                        e.resync,
                        e.margin,
                        e.object,
                        e.around,
                        e.band_m,
                        e.object_id,
                        e.epoch,
                        e.sequence,
                        e.episode,
                        e.world_time.count(),
                        e.entered.count(),
                        e.bracket_low_s,
                        e.bracket_high_s,
                        e.distance_m,
                        e.closing_mps,
                        e.contact_in ? e.contact_in->low_s : -1.0}
      .dump();
}
std::string line_of(const NearestEvent& e) {
  return nlohmann::json{"nearest",
                        static_cast<int>(e.kind),
                        static_cast<int>(e.reason),
                        static_cast<int>(e.doubt),
                        e.resync,
                        e.nearest,
                        e.from,
                        e.to,
                        e.epoch,
                        e.sequence,
                        e.world_time.count(),
                        e.bracket_low_s,
                        e.bracket_high_s,
                        e.distance_m,
                        e.distance_error_m,
                        e.point.x()}
      .dump();
}
template <class Of>
Lines lines_of(const std::vector<Of>& events) {
  Lines lines;
  for (const Of& event : events) lines.push_back(line_of(event));
  return lines;
}

class ServerFenceRecording : public testing_support::ServerTest {
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
    return test::eventually([&] { return read(file).counts["collided/status_v2"] > 0; }, 20s);
  }

  static void add_all(Client& client) {
    EXPECT_TRUE(
        client.add_fence({.name = "dock", .shape = {SphereShape{.radius_m = 2, .center = {0, 0, 2}}}, .keep = true}));
    EXPECT_TRUE(
        client.add_fence({.name = "around", .shape = {SphereShape{.radius_m = 1.5}}, .to = "ball 0", .keep = true}));
    EXPECT_TRUE(client.add_margin({.name = "close",
                                   .around = "ball 0",
                                   .only = "ball*",
                                   .bands_m = {2, 0.5},
                                   .hysteresis_m = 0.01,
                                   .keep = true}));
    EXPECT_TRUE(client.add_nearest({.name = "next", .only = "ball *", .to = "ball 1", .within_m = 50, .keep = true}));
  }
  /// Balls that fly about, so that much of everything is told.
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
      EXPECT_TRUE(publisher.wait_applied(5s));
    }
  }
  /// All that a watch has been told.
  template <class EventWatch>
  static Lines drained(EventWatch& watch) {
    Lines lines;
    while (const auto event = watch.next(1s)) lines.push_back(line_of(*event));
    EXPECT_EQ(watch.lost(), 0U);
    EXPECT_EQ(watch.resyncs(), 0U);
    return lines;
  }
};

TEST_F(ServerFenceRecording, WhatIsReadIsWhatWatchesWereTold) {
  start();
  const std::string file = path("run.mcap");
  Client client = connect();
  const auto recorder = record_beside(file);
  ASSERT_TRUE(listens(file));
  Result<FenceWatch> fences = client.watch_fences();
  Result<MarginWatch> margins = client.watch_margins();
  Result<NearestWatch> nearest = client.watch_nearest();
  ASSERT_TRUE(fences && margins && nearest);
  ASSERT_TRUE(test::eventually([&] { return fences->in_step() && margins->in_step() && nearest->in_step(); }));
  add_all(client);
  Publisher publisher = publish(client, "pilot");
  const std::vector<Publisher::Object> balls = add_balls(publisher);
  fly(publisher, balls, 100);
  EXPECT_EQ(*client.remove_fences("dock"), 1U);
  const Lines of_fences = drained(*fences), of_margins = drained(*margins), of_nearest = drained(*nearest);
  ASSERT_GT(of_fences.size(), 100U);
  ASSERT_GT(of_margins.size(), 50U);
  ASSERT_GT(of_nearest.size(), 20U);
  ASSERT_TRUE(test::eventually([&] { return read(file).texts["/fences"].size() >= 2; }, 20s));
  end(*recorder);

  const Result<RecordedFenceEvents> told = recorded_fence_events(file);
  ASSERT_TRUE(told) << told.error().message;
  for (const std::string& warning : told->warnings) ADD_FAILURE() << warning;
  EXPECT_EQ(told->lost, 0U);
  EXPECT_EQ(lines_of(told->fences), of_fences);
  EXPECT_EQ(lines_of(told->margins), of_margins);
  EXPECT_EQ(lines_of(told->nearest), of_nearest);
  // One of the names.
  const Result<RecordedFenceEvents> docked = recorded_fence_events(file, {.only = "dock"});
  ASSERT_TRUE(docked);
  EXPECT_TRUE(docked->margins.empty());
  EXPECT_TRUE(docked->nearest.empty());
  EXPECT_EQ(lines_of(docked->fences).size(),
            static_cast<std::size_t>(std::count_if(told->fences.begin(), told->fences.end(),
                                                   [](const FenceEvent& event) { return event.fence == "dock"; })));
}

// Each of the topics' messages is there and what was drawn of it, at the beginning and after a change.
TEST_F(ServerFenceRecording, WhereTheyStoodIsOnChannelsOfTheirOwn) {
  start();
  const std::string file = path("run.mcap");
  Client client = connect();
  Publisher publisher = publish(client, "pilot");
  const std::vector<Publisher::Object> balls = add_balls(publisher);
  move(publisher, balls[0], at(7, 0, 2));
  ASSERT_TRUE(publisher.wait_applied(5s));
  ASSERT_TRUE(
      client.add_fence({.name = "before", .shape = {SphereShape{.radius_m = 1.5}}, .to = "ball 0", .keep = true}));
  const auto recorder = record_beside(file);
  // It was there before; the recording has heard no command.
  ASSERT_TRUE(test::eventually([&] { return read(file).texts["/fences"].size() >= 1; }, 20s));
  add_all(client);
  ASSERT_TRUE(
      test::eventually([&] { return read(file).texts["/fences"].back().find("dock") != std::string::npos; }, 20s));
  move(publisher, balls[0], at(1, 0, 2));
  ASSERT_TRUE(test::eventually([&] { return read(file).counts["collided/fence_event_v2"] > 0; }, 20s));
  ASSERT_EQ(*client.remove_fences("*"), 3U);
  ASSERT_EQ(*client.remove_margins("*"), 1U);
  ASSERT_EQ(*client.remove_nearest("*"), 1U);
  ASSERT_TRUE(test::eventually(
      [&] { return read(file).texts["collided/fences"].back() == R"({"fences":[],"type":"fences"})"; }, 20s))
      << read(file).texts["collided/fences"].back();
  end(*recorder);

  File all = read(file);
  for (const char* topic : {"fence_event_v2", "fence_state_v2", "fence_status_v2", "fences"})
    EXPECT_GT(all.counts["collided/" + std::string(topic)], 0U) << topic;
  const auto named = [](const nlohmann::json& list, const char* key, const std::string& name) {
    for (const nlohmann::json& one : list) {
      if (one.at(key) == name) return one;
    }
    ADD_FAILURE() << name << " is not in " << list.dump();
    return nlohmann::json();
  };
  const nlohmann::json first = nlohmann::json::parse(all.texts["collided/fences"].front());
  const nlohmann::json before = named(first.at("fences"), "name", "before");
  EXPECT_EQ(before.at("to"), "ball 0");
  EXPECT_EQ(before.at("definition").at("kind"), "sphere");
  EXPECT_EQ(before.at("definition").at("keep"), "true");
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
  for (const std::string& text : all.texts["collided/fences"]) {
    const nlohmann::json list = nlohmann::json::parse(text);
    for (const nlohmann::json& one : list.at("fences")) ever.insert(one.at("name"));
  }
  EXPECT_EQ(ever, (std::set<std::string>{"around", "before", "close", "dock", "next"}));
}

// Not even a channel, and of the status of fences, which the server writes for its readers only, no reader.
TEST_F(ServerFenceRecording, WithoutAnyThereIsNothingOfThem) {
  start();
  const std::string file = path("run.mcap"), last = path("last.mcap");
  Client client = connect();
  const auto recorder = record_beside(file);
  ASSERT_TRUE(listens(file));
  Publisher publisher = publish(client, "pilot");
  fly(publisher, add_balls(publisher), 20);
  EXPECT_EQ(client.fences()->size(), 0U);
  ASSERT_TRUE(test::eventually([&] { return read(file).counts["collided/event_v2"] > 0; }, 20s));
  end(*recorder);
  ASSERT_TRUE(fetch_recording(here(), 20s, last));
  for (const std::string& one : {file, last}) {
    for (const auto& [topic, count] : read(one).counts)
      EXPECT_EQ(topic.find("fence"), std::string::npos) << topic << " in " << one;
    const Result<RecordedFenceEvents> told = recorded_fence_events(one);
    ASSERT_TRUE(told);
    EXPECT_TRUE(told->fences.empty() && told->margins.empty() && told->nearest.empty() && told->warnings.empty());
  }
}

// Who was in before the window is `inside` at its begin, and what came since is told as watches were.
TEST_F(ServerFenceRecording, TheFlightRecorderHasThem) {
  start({"--flight-recorder", "2s"});
  const std::string file = path("last.mcap");
  Client client = connect();
  add_all(client);
  Publisher publisher = publish(client, "pilot");
  const std::vector<Publisher::Object> balls = add_balls(publisher);
  move(publisher, balls[2], at(0.5, 0.5, 2));
  ASSERT_TRUE(publisher.wait_applied(5s));
  const auto fetched = [&] {
    EXPECT_TRUE(fetch_recording(here(), 2s, file));
    const Result<RecordedFenceEvents> told = recorded_fence_events(file);
    EXPECT_TRUE(told);
    return told ? *told : RecordedFenceEvents{};
  };
  // Until its coming in has left the window.
  ASSERT_TRUE(test::eventually(
      [&] {
        const RecordedFenceEvents told = fetched();
        return told.fences.size() == 1 && told.fences[0].kind == FenceEventKind::inside;
      },
      20s));
  Result<FenceWatch> fences = client.watch_fences();
  ASSERT_TRUE(fences);
  ASSERT_TRUE(test::eventually([&] { return fences->in_step(); }));
  EXPECT_EQ(fences->next(5s)->kind, FenceEventKind::inside);
  move(publisher, balls[2], at(9, 9, 2));
  move(publisher, balls[3], at(0.5, 0.5, 2));
  Lines live;
  for (int i = 0; i < 2; ++i) {
    const std::optional<FenceEvent> event = fences->next(5s);
    ASSERT_TRUE(event);
    live.push_back(line_of(*event));
  }
  const RecordedFenceEvents told = fetched();
  ASSERT_EQ(told.fences.size(), 3U);
  EXPECT_EQ(told.fences[0].kind, FenceEventKind::inside);
  EXPECT_EQ(told.fences[0].object, "ball 2");
  EXPECT_EQ((Lines{line_of(told.fences[1]), line_of(told.fences[2])}), live);
  for (const std::string& warning : told.warnings) ADD_FAILURE() << warning;
}

/// What stands in a server and where, without what the server itself numbers and who is in.
std::map<std::string, nlohmann::json> standing(Client& client) {
  std::map<std::string, nlohmann::json> all;
  for (const char* kind : {"fences", "margins", "nearest"}) {
    nlohmann::json asked{{"name", ""}};
    asked[std::string(kind) == "fences" ? "outlines" : kind] = true;
    const Result<std::string> text = client.command("fences", asked.dump());
    EXPECT_TRUE(text) << text.error().message;
    const nlohmann::json answer = text ? nlohmann::json::parse(*text) : nlohmann::json::object();
    for (nlohmann::json row : answer.value(kind, nlohmann::json::array())) {
      for (const char* own : {"id", "inside", "in_doubt", "pairs", "object", "since_ns", "cut_short"}) row.erase(own);
      const char* key = std::string(kind) == "fences" ? "fence" : std::string(kind) == "margins" ? "margin" : "nearest";
      all[row.at(key)] = row;
    }
  }
  return all;
}

std::vector<std::string> names_of(const std::map<std::string, nlohmann::json>& all) {
  std::vector<std::string> names;
  for (const auto& [name, row] : all) names.push_back(name);
  return names;
}

class ReplayedFences : public ServerFenceRecording {
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
  std::map<std::string, nlohmann::json> replayed(const std::string& file, std::uint64_t fences) {
    std::map<std::string, nlohmann::json> at_end;
    const Result<ReplayReport> report =
        replay(here(), {.path = file, .rate = 1e6, .at_end = [&](std::chrono::nanoseconds) {
                          Client client = connect();
                          at_end = standing(client);
                        }});
    EXPECT_TRUE(report) << report.error().message;
    if (!report) return at_end;
    EXPECT_EQ(report->fences, fences);
    for (const std::string& warning : report->warnings) ADD_FAILURE() << warning;
    return at_end;
  }
  static void add_own(Client& client) {
    EXPECT_TRUE(client.add_fence({.name = "[mine]", .shape = {BoxShape{.half_m = {1, 2, 3}}}}));
    EXPECT_TRUE(client.add_margin({.name = "my gap", .around = "a", .only = "b", .bands_m = {1}}));
    EXPECT_TRUE(client.add_nearest({.name = "my next", .only = "ball*", .point = Vec3(1, 2, 3), .within_m = 5}));
  }
};

// Of those that stood before the recording, that came in it, one by one and many at once, and that went: by name, and with
// whom they belonged to.
TEST_F(ReplayedFences, StandAsTheyStoodWhereARecordingIsReplayed) {
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
    EXPECT_EQ(*client.remove_fences("arou*"), 1U);
    std::vector<Fence> many;
    for (int i = 0; i < 300; ++i)
      many.push_back({.name = "cell " + std::to_string(i),
                      .shape = {SphereShape{.radius_m = 0.5, .center = {1.0 / 3 * i, 0, 2}}},
                      .keep = true});
    ASSERT_TRUE(client.add_fences(many));
    ASSERT_TRUE(client.add_fence(
        {.name = "late", .prism = Prism{.corners = {{0, 0}, {1, 0}, {0, 1}}, .low_m = 0, .high_m = 2}, .keep = true}));
    before = standing(client);
    ASSERT_EQ(before.size(), 3U + 3U + 301U);
    fetch_over(client, last);
    other.reset();
    ASSERT_TRUE(test::eventually([&] { return standing(client).size() == 304; }));
    after = standing(client);
    // Until what the server said of it is on the disk.
    ASSERT_TRUE(test::eventually(
        [&] { return read(file).texts["collided/fences"].back().find("[mine]") == std::string::npos; }, 20s));
    end(*recorder);
  }
  stop();
  start({}, "again");
  EXPECT_EQ(replayed(last, 307), before);
  Client client = connect();
  // What was kept stays, the rest goes with the replay.
  ASSERT_TRUE(test::eventually([&] { return standing(client).size() == 304; }, 20s));
  EXPECT_EQ(standing(client), after);
  for (const auto remove : {&Client::remove_fences, &Client::remove_margins, &Client::remove_nearest})
    EXPECT_TRUE((client.*remove)("*"));
  EXPECT_EQ(replayed(file, 308), after);
  EXPECT_EQ(standing(client), after);
}

// Where one has the name already, that is said, and the others are made.
TEST_F(ReplayedFences, ANameThatIsTakenIsTold) {
  start();
  Client client = connect();
  add_all(client);
  ASSERT_TRUE(fetch_recording(here(), 20s, path("last.mcap")));
  ASSERT_TRUE(client.remove_nearest("next"));
  ASSERT_TRUE(client.remove_margins("close"));
  const Result<ReplayReport> report = replay(here(), {.path = path("last.mcap")});
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report->fences, 2U);
  ASSERT_EQ(report->warnings.size(), 2U);
  EXPECT_NE(report->warnings[0].find("dock"), std::string::npos);
  EXPECT_NE(report->warnings[0].find("the name is taken"), std::string::npos);
  EXPECT_EQ(names_of(standing(client)), (std::vector<std::string>{"around", "close", "dock", "next"}));
}

// The server carries the kept commands out again by itself; the recorder has them with no client and no answer.
TEST_F(ReplayedFences, StandAlsoWhereTheServerHadMadeThemAgainAfterARestart) {
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
  start({}, "again");
  EXPECT_EQ(replayed(path("last.mcap"), 4), before);
}

}  // namespace
}  // namespace collided
