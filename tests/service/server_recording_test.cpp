#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <random>

#include "collided/recording.hpp"
#include "idl/cdr.hpp"
#include "idl/mcap/reader.hpp"
#include "idl/recording/recorded_topics.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/service/server_fixture.hpp"
#include "tests/service/wire/network.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;
using testing_support::ChildProcess;

class ServerRecording : public testing_support::ServerTest {
 protected:
  std::string path(const std::string& name) const { return folder_.path() + "/" + name; }
  std::string domain() const { return std::to_string(domain_); }
  ConnectOptions here() const { return {.domain = domain_, .name_space = "collided", .wait = 10s}; }

  /// `collide record`, which a process that is connected already could not do.
  ChildProcess& record_beside(const std::string& file, const std::vector<std::string>& more = {},
                              const std::string& before = {}) {
    std::vector<std::string> words{COLLIDED_CLI, "--domain", domain(), "record", file};
    words.insert(words.end(), more.begin(), more.end());
    if (!before.empty()) {
      std::string line = before;
      for (const std::string& word : words) line += " '" + word + "'";
      words = {"/bin/bash", "-c", line};
    }
    children_.push_back(
        std::make_unique<ChildProcess>(words, folder_.path(), "record" + std::to_string(children_.size())));
    return *children_.back();
  }
  static bool is_owners_alone(const std::string& path) {
    using std::filesystem::perms;
    return (std::filesystem::status(path).permissions() & (perms::group_all | perms::others_all)) == perms::none;
  }
  /// Until so many samples of the topic are in chunks on the disk.
  static bool has(const std::string& file, const std::string& topic, std::size_t count) {
    std::error_code error;
    if (!std::filesystem::exists(file, error)) return false;
    const std::vector<std::byte> bytes = mcap::read_file(file, 1 << 30);
    const mcap::Contents contents = mcap::read(bytes);
    std::size_t found = 0;
    for (const mcap::Message& message : contents.messages)
      found += contents.channels.at(message.head.channel).topic == topic ? 1 : 0;
    return found >= count;
  }
  /// Until the answers to so many questions are.
  static bool has_answers(const std::string& file, std::size_t count) {
    const std::vector<std::byte> bytes = mcap::read_file(file, 1 << 30);
    const mcap::Contents contents = mcap::read(bytes);
    std::size_t found = 0;
    for (const mcap::Message& message : contents.messages) {
      dds::Sample<wire::Reply> reply;
      const bool is_reply = contents.channels.at(message.head.channel).topic == "collided/reply_v2";
      if (is_reply && wire::read_cdr(message.data, reply)) found += reply->answers._length;
    }
    return found >= count;
  }
  static bool listens(const std::string& file) {
    return test::eventually([&] { return has(file, "collided/status_v3", 1); }, 20s);
  }

  /// A run with something of everything: balls that move at random, one that was there before and rests, one that is
  /// removed, questions of every kind between, commands.
  void live_through(Client& client, Publisher& publisher, int rounds) {
    std::mt19937_64 random = oracle::seeded(3);
    std::uniform_real_distribution<double> x(0, 9), turn(-1, 1);
    std::vector<Publisher::Object> balls;
    for (int i = 0; i < 5; ++i)
      balls.push_back(add_ball(publisher, "ball " + std::to_string(i), at(x(random), x(random), 1)));
    EXPECT_TRUE(
        client.command("add", R"({"name":"post","pose":[3,3,1,1,0,0,0]})", {BoxShape{.half_m = {0.1, 0.1, 1}}}));
    EXPECT_TRUE(publisher.wait_applied(20s));
    for (int round = 0; round < rounds; ++round) {
      for (const Publisher::Object ball : balls)
        EXPECT_TRUE(publisher.move(ball, at(x(random), x(random), 1 + turn(random))));
      EXPECT_TRUE(publisher.flush());
      EXPECT_TRUE(client.pair("ball 0", round % 2 == 0 ? "ball 1" : "post", {.certificate = true}));
      std::vector<RayQuestion> rays;
      for (int i = 0; i < 20; ++i)
        rays.push_back({{x(random), x(random), 1}, {turn(random), turn(random), 0.1 * turn(random)}});
      EXPECT_TRUE(
          client.ask(std::span<const RayQuestion>(rays), {.mode = round % 2 == 0 ? HitMode::all : HitMode::closest}));
      EXPECT_TRUE(client.ask(NearQuestion{{x(random), x(random), 1}}, {.fresh = true}));
      EXPECT_TRUE(client.ask(SphereQuestion{{x(random), x(random), 1}, 1.5}));
      const std::vector<SweepQuestion> motions{{at(x(random), x(random), 1), at(x(random), x(random), 1)}};
      EXPECT_TRUE(client.sweep({SphereShape{.radius_m = 0.2}}, motions));
      if (round == rounds / 2) {
        EXPECT_TRUE(publisher.remove(balls.back()));
        balls.pop_back();
        EXPECT_TRUE(client.command("move", R"({"name":"post","pose":[6,6,1,1,0,0,0]})"));
      }
    }
  }

  std::vector<std::unique_ptr<ChildProcess>> children_;
};

// Who says every second that he is there has been heard after a second; it waits for a second one only where nobody was.
TEST_F(ServerRecording, BeginsAsSoonAsEverybodyWasHeard) {
  start();
  std::chrono::nanoseconds quickest = 1h;
  for (int i = 0; i < 3 && quickest > 2s; ++i) {
    const auto asked = std::chrono::steady_clock::now();
    ASSERT_TRUE(record(here(), path("quick" + std::to_string(i) + ".mcap")));
    quickest = std::min<std::chrono::nanoseconds>(quickest, std::chrono::steady_clock::now() - asked);
  }
  EXPECT_LT(quickest, 2s);
}

// Counted by the file: every channel's samples, and of a quiet run nothing lost.
TEST_F(ServerRecording, WhatIsCountedIsWhatIsInTheFile) {
  start();
  Result<Recording> recording = record(here(), path("own.mcap"));
  ASSERT_TRUE(recording) << recording.error().message;
  Client client = connect();
  Publisher publisher = publish(client, "cell");
  const Publisher::Object ball = add_ball(publisher, "ball", at(4, 4, 1));
  move(publisher, ball, at(4, 4, 2));
  ASSERT_TRUE(publisher.wait_applied(20s));
  ASSERT_TRUE(test::eventually([&] { return recording->counts().samples >= 10; }));
  const Result<RecordingCounts> counts = recording->finish();
  ASSERT_TRUE(counts) << counts.error().message;
  EXPECT_EQ(counts->lost, 0U);
  const std::vector<std::byte> bytes = mcap::read_file(path("own.mcap"), 1 << 30);
  const mcap::Contents contents = mcap::read(bytes);
  EXPECT_EQ(counts->samples, contents.messages.size());
  EXPECT_EQ(counts->bytes, bytes.size());
  std::map<std::string, std::uint64_t> in_file, counted;
  for (const mcap::Message& message : contents.messages) ++in_file[contents.channels.at(message.head.channel).topic];
  for (const RecordedChannel& channel : counts->channels) {
    EXPECT_EQ(channel.lost, 0U) << channel.topic;
    if (channel.samples > 0) counted["collided/" + channel.topic] = channel.samples;
  }
  EXPECT_EQ(counted, in_file);
  EXPECT_GE(counted["collided/object_v2"], 1U);
  EXPECT_GE(counted["collided/pose_v2"], 1U);
}

// A recording of one server's life, asked of another: every answer has the same bits. The other is changed then, by one box
// in the way, and answers are told that differ.
TEST_F(ServerRecording, EveryAnswerIsTheSameAgain) {
  start();
  const std::string file = path("run.mcap");
  {
    Client client = connect();
    Publisher before = publish(client, "before");
    const Publisher::Object resting = add_ball(before, "resting", at(1, 1, 1));
    move(before, resting, at(4, 4, 1));  // its newest pose lies before the recording
    ASSERT_TRUE(before.wait_applied(20s));
    std::atomic<bool> done{false};
    std::thread alive([&] {
      while (!done) {
        EXPECT_TRUE(before.keep_alive());
        std::this_thread::sleep_for(100ms);
      }
    });
    ChildProcess& recorder = record_beside(file);
    ASSERT_TRUE(listens(file));
    Publisher publisher = publish(client, "moving");
    live_through(client, publisher, 20);
    EXPECT_TRUE(test::eventually([&] { return has_answers(file, 20U * 23U); }, 20s));
    recorder.signal(SIGINT);
    EXPECT_EQ(recorder.wait(10s), 0) << recorder.errors();
    EXPECT_NE(recorder.errors().find(" 0 lost"), std::string::npos) << recorder.errors();
    done = true;
    alive.join();
  }
  servers_.back()->signal(SIGTERM);
  EXPECT_EQ(servers_.back()->wait(15s), 0);
  start({"--fresh"}, "again");
  const Result<ReplayReport> again = replay(here(), {.path = file, .ask = true});
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(again->questions, 20U * 24U);
  EXPECT_EQ(again->equal, again->questions);
  for (const std::string& difference : again->differences) ADD_FAILURE() << difference;
  for (const std::string& warning : again->warnings) ADD_FAILURE() << warning;
  EXPECT_EQ(again->not_compared, 0U);
  EXPECT_EQ(again->commands, 2U);

  Client client = connect();
  ASSERT_TRUE(client.command("remove", R"({"name":"post"})"));
  ASSERT_TRUE(client.command("add", R"({"name":"post","pose":[3,3,1,1,0,0,0]})", {BoxShape{.half_m = {0.2, 0.1, 1}}}));
  ASSERT_TRUE(client.command("add", R"({"name":"screen","pose":[5,5,1,1,0,0,0]})", {BoxShape{.half_m = {0.05, 3, 1}}}));
  const Result<ReplayReport> other = replay(here(), {.path = file, .ask = true});
  ASSERT_TRUE(other) << other.error().message;
  EXPECT_LT(other->equal, other->questions);
  ASSERT_FALSE(other->differences.empty());
  EXPECT_NE(other->differences.front().find(": then "), std::string::npos);
  // The post that they are about is another.
  EXPECT_TRUE(std::any_of(other->differences.begin(), other->differences.end(), [](const std::string& difference) {
    return difference.find(", pair 0: then ") != std::string::npos;
  }));
}

// A recorder listens for a second before it asks what is there, so that nothing is missing: what is done meanwhile it has
// heard twice over, and what was done before and after once.
TEST_F(ServerRecording, WhatIsDoneWhileARecordingBeginsIsInItOnce) {
  start();
  const std::string file = path("run.mcap");
  std::map<std::string, std::size_t> objects;
  std::size_t added = 0;
  {
    Client client = connect();
    const auto add_next = [&] {
      const std::string crate = "crate " + std::to_string(added++);
      ASSERT_TRUE(client.add({.name = crate, .shape = {SphereShape{.radius_m = 0.1}}}));
      ASSERT_TRUE(client.add(
          Standing{.name = "fence of " + crate, .keep = true, .of = Region{.shape = {SphereShape{.radius_m = 1}}}}));
      if (added % 3 == 0) ASSERT_TRUE(client.remove(crate));
      else objects[crate] = 1;
      std::this_thread::sleep_for(10ms);
    };
    add_next();
    ChildProcess& recorder = record_beside(file);
    ASSERT_TRUE(test::eventually([&] { return add_next(), has(file, "collided/status_v3", 1); }, 30s));
    const std::size_t while_it_began = added;
    for (int i = 0; i < 10; ++i) add_next();
    ASSERT_TRUE(test::eventually([&] { return has(file, "collided/query_v2", while_it_began + 20); }, 20s));
    recorder.signal(SIGINT);
    ASSERT_EQ(recorder.wait(10s), 0) << recorder.errors();
  }
  // The adding of each, in the opening or as it was heard. What was removed before the opening need not be in it.
  std::map<std::string, std::size_t> adds, fences;
  const std::vector<std::byte> bytes = mcap::read_file(file, 1 << 30);
  for (const mcap::Message& message : mcap::read(bytes).messages) {
    dds::Sample<wire::Query> query;
    if (message.head.channel != static_cast<std::uint16_t>(recording::Recorded::query) ||
        !wire::read_cdr(message.data, query) ||
        query->kind != static_cast<std::uint8_t>(wire_contract::QuestionKind::command))
      continue;
    const nlohmann::json text = nlohmann::json::parse(query->text);
    if (text.at("command") == "add") ++adds[text.at("name")];
    if (text.at("command") == "fence") ++fences[text.at("name")];
  }
  EXPECT_EQ(fences.size(), added);
  for (const auto& [name, count] : fences) EXPECT_EQ(count, 1U) << name;
  for (const auto& [name, count] : adds) EXPECT_EQ(count, 1U) << name;
  for (const auto& [name, count] : objects) EXPECT_EQ(adds[name], count) << name;
  servers_.back()->signal(SIGTERM);
  ASSERT_EQ(servers_.back()->wait(15s), 0);
  start({"--fresh"}, "again");
  const Result<ReplayReport> again = replay(here(), {.path = file, .rate = 100});
  ASSERT_TRUE(again) << again.error().message;
  for (const std::string& warning : again->warnings) ADD_FAILURE() << warning;
  Client client = connect();
  const Result<std::string> listed = client.command("list", R"({"name":"crate*"})");
  ASSERT_TRUE(listed) << listed.error().message;
  const nlohmann::json answer = nlohmann::json::parse(*listed);
  std::map<std::string, std::size_t> made;
  for (const nlohmann::json& object : answer.at("objects")) ++made[object.at("name")];
  EXPECT_EQ(made, objects);
  EXPECT_EQ(client.standing()->size(), added);
}

// What the server itself remembered says the same, from before anybody thought of recording.
TEST_F(ServerRecording, TheFlightRecorderHasItAll) {
  start();
  const std::string file = path("last.mcap");
  {
    Client client = connect();
    Publisher publisher = publish(client, "moving");
    live_through(client, publisher, 10);
    const Result<std::uint64_t> bytes = fetch_recording(here(), 20s, file);
    ASSERT_TRUE(bytes) << bytes.error().message;
    EXPECT_EQ(*bytes, std::filesystem::file_size(file));
  }
  servers_.back()->signal(SIGTERM);
  EXPECT_EQ(servers_.back()->wait(15s), 0);
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
    EXPECT_TRUE(entry.path().extension() != ".mcap" || entry.path() == file) << entry.path() << " was left behind";
  }
  start({"--fresh"}, "again");
  const Result<ReplayReport> again = replay(here(), {.path = file, .ask = true});
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(again->questions, 10U * 24U);
  EXPECT_EQ(again->equal, again->questions);
  for (const std::string& difference : again->differences) ADD_FAILURE() << difference;
  EXPECT_EQ(again->not_compared, 0U);
}

// Rules and what is attached came long before; the parent has moved since, so the place in its frame is what counts.
TEST_F(ServerRecording, RulesAndAttachmentsFromBeforeAreInTheFlightRecorderToo) {
  start();
  const std::string file = path("opening.mcap");
  nlohmann::json lid_was;
  nlohmann::json rules_were;
  const auto get = [](Client& client, const std::string& name) {
    const Result<std::string> answer = client.command("get", nlohmann::json{{"name", name}}.dump());
    EXPECT_TRUE(answer);
    return answer ? nlohmann::json::parse(*answer).at("pose") : nlohmann::json();
  };
  const auto rules = [](Client& client) {
    const Result<std::string> answer = client.command("allowed", "{}");
    EXPECT_TRUE(answer);
    return answer ? nlohmann::json::parse(*answer).at("rules") : nlohmann::json();
  };
  {
    Client client = connect();
    Publisher publisher = publish(client, "moving");
    const Publisher::Object crate = add_ball(publisher, "crate", at(3, 3, 1));
    ASSERT_TRUE(publisher.wait_applied(20s));
    for (const char* name : {"lid", "loose"})
      ASSERT_TRUE(client.command("add", nlohmann::json{{"name", name}, {"pose", {3, 3, 2, 1, 0, 0, 0}}}.dump(),
                                 {BoxShape{.half_m = {0.1, 0.1, 0.1}}}));
    for (const char* name : {"lid", "loose"})
      ASSERT_TRUE(client.command("attach", nlohmann::json{{"child", name}, {"parent", "crate"}}.dump()));
    ASSERT_TRUE(client.command("allow", R"({"a":"lid","b":"*"})"));
    ASSERT_TRUE(client.command("deny", R"({"a":"lid","b":"loose"})"));
    move(publisher, crate, at(5, 6, 1));
    ASSERT_TRUE(publisher.wait_applied(20s));
    ASSERT_TRUE(client.command("detach", R"({"child":"loose"})"));
    move(publisher, crate, at(6, 6, 1));
    ASSERT_TRUE(publisher.wait_applied(20s));
    lid_was = get(client, "lid");
    rules_were = rules(client);
    EXPECT_EQ(lid_was, (nlohmann::json{6.0, 6.0, 2.0, 1.0, 0.0, 0.0, 0.0}));
    EXPECT_EQ(get(client, "loose"), (nlohmann::json{5.0, 6.0, 2.0, 1.0, 0.0, 0.0, 0.0}));
    ASSERT_TRUE(fetch_recording(here(), 0s, file));
  }
  servers_.back()->signal(SIGTERM);
  EXPECT_EQ(servers_.back()->wait(15s), 0);
  start({"--fresh"}, "again");
  const Result<ReplayReport> again = replay(here(), {.path = file, .ask = true});
  ASSERT_TRUE(again) << again.error().message;
  for (const std::string& difference : again->differences) ADD_FAILURE() << difference;
  for (const std::string& warning : again->warnings) ADD_FAILURE() << warning;
  Client client = connect();
  // The last poses of the replayed publisher come by another way than what the replay waits for.
  EXPECT_TRUE(test::eventually([&] { return get(client, "lid") == lid_was; })) << get(client, "lid");
  EXPECT_EQ(get(client, "loose"), (nlohmann::json{5.0, 6.0, 2.0, 1.0, 0.0, 0.0, 0.0}));
  EXPECT_EQ(rules(client), rules_were);
}

// In time: the poses come as they came, so the same contacts begin and end.
TEST_F(ServerRecording, PosesComeAgainInTime) {
  start();
  const std::string file = path("run.mcap");
  {
    Client client = connect();
    Publisher publisher = publish(client, "moving");
    const Publisher::Object ball = add_ball(publisher, "ball", at(4, 4, 2));
    for (const double z : {1.0, 0.05, 1.0}) {
      move(publisher, ball, at(4, 4, z));
      ASSERT_TRUE(publisher.wait_applied(20s));
      std::this_thread::sleep_for(100ms);
    }
    ASSERT_TRUE(fetch_recording(here(), 20s, file));
  }
  Client client = connect();
  Watch contacts = watch(client);
  const auto begin = std::chrono::steady_clock::now();
  const Result<ReplayReport> again = replay(here(), {.path = file, .rate = 0.5});
  const auto took = std::chrono::steady_clock::now() - begin;
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(again->samples, 1U + 3U) << "a definition and three poses";
  EXPECT_GE(took, 400ms) << "0.2 s and more at half the rate";
  const Event began = next(contacts);
  EXPECT_EQ(began.kind, EventKind::began);
  EXPECT_EQ(next(contacts).kind, EventKind::ended);
}

/// What an event says and when, for comparisons of what two heard.
std::string words_of(const Event& event) {
  return std::to_string(event.sequence) + (event.kind == EventKind::began ? " began " : " ended ") + event.a + " " +
         event.b + " " + std::to_string(event.world_time.count());
}

// One ball lies there before the time asked for, one falls and rises before the watch begins, one while it does and after: who
// has watched from the start heard the same, each once.
TEST_F(ServerRecording, AWatchSinceATimeTellsWhatWasAndWhatComesEachOnce) {
  start();
  Client client = connect();
  Watch reference = watch(client);
  Publisher publisher = publish(client, "moving");
  const Publisher::Object lying = add_ball(publisher, "lying", at(1, 1, 2));
  const Publisher::Object before = add_ball(publisher, "before", at(2, 4, 2));
  const Publisher::Object during = add_ball(publisher, "during", at(6, 4, 2));
  move(publisher, lying, at(1, 1, 0.05));
  const Event down = next(reference);
  const std::chrono::nanoseconds since = std::chrono::system_clock::now().time_since_epoch();
  for (const double z : {2.0, 0.05, 2.0}) move(publisher, before, at(2, 4, z));
  ASSERT_TRUE(publisher.wait_applied(20s));
  std::atomic<bool> done{false};
  std::thread bouncing([&] {
    for (double z = 0.05; !done; z = 2.05 - z) {
      move(publisher, during, at(6, 4, z));
      std::this_thread::sleep_for(2ms);
    }
  });
  Result<Watch> joined = client.watch({.since = since});
  const bool is_joined = joined && test::eventually([&] { return joined->in_step(); });
  const std::uint64_t joined_at = client.status()->last_event_sequence;
  EXPECT_TRUE(test::eventually([&] { return client.status()->last_event_sequence > joined_at + 20; }));
  done = true;
  bouncing.join();
  ASSERT_TRUE(is_joined) << (joined ? "" : joined.error().message);
  EXPECT_EQ(joined->tells_since(), since);
  ASSERT_TRUE(publisher.wait_applied(20s));
  move(publisher, lying, at(1, 1, 2));

  std::vector<std::string> heard, told;
  for (Event event = down; event.sequence == 1 || event.a != down.a || event.b != down.b;
       heard.push_back(words_of(event)))
    event = next(reference);
  const Event open = next(*joined);
  EXPECT_EQ(open.kind, EventKind::open);
  EXPECT_EQ(open.episode, down.episode);
  for (Event event = open; event.kind != EventKind::ended || event.episode != down.episode;
       told.push_back(words_of(event))) {
    event = next(*joined);
    EXPECT_FALSE(event.resync);
  }
  EXPECT_GT(heard.size(), 22U);
  EXPECT_EQ(told, heard);
  EXPECT_EQ(joined->resyncs(), 0U);
}

// What held is known however long ago it began; what happened only as far as the recorder goes back.
TEST_F(ServerRecording, AWatchSinceATimeBeforeTheRecorderSaysFromWhenOn) {
  start({"--flight-recorder", "1s"});
  Client client = connect();
  Watch reference = watch(client);
  Publisher publisher = publish(client, "moving");
  const Publisher::Object ball = add_ball(publisher, "ball", at(4, 4, 2));
  move(publisher, ball, at(4, 4, 0.05));
  const Event down = next(reference);
  const std::chrono::nanoseconds since = down.world_time - 1h;
  ASSERT_TRUE(test::eventually(
      [&] {
        EXPECT_TRUE(publisher.keep_alive());
        Result<Watch> early = client.watch({.since = since});
        return early && early->tells_since() > down.world_time;
      },
      20s));
  Result<Watch> joined = client.watch({.since = since});
  ASSERT_TRUE(joined) << joined.error().message;
  const Event open = next(*joined);
  EXPECT_EQ(open.kind, EventKind::open);
  EXPECT_EQ(open.episode, down.episode);
  EXPECT_EQ(open.began, happened(down));
  EXPECT_GT(joined->tells_since(), down.world_time);
  EXPECT_LT(joined->tells_since(), std::chrono::system_clock::now().time_since_epoch());
}

TEST_F(ServerRecording, AKilledRecordingIsReadUpToItsLastChunk) {
  start();
  const std::string file = path("killed.mcap");
  ChildProcess& recorder = record_beside(file);
  ASSERT_TRUE(listens(file));
  recorder.signal(SIGKILL);
  EXPECT_EQ(recorder.wait(5s), 128 + SIGKILL);
  const Result<ReplayReport> report = replay(here(), {.path = file});
  ASSERT_TRUE(report) << report.error().message;
  ASSERT_FALSE(report->warnings.empty());
  EXPECT_NE(report->warnings.front().find("its writer was stopped"), std::string::npos) << report->warnings.front();
}

// A limit of the file's size stands for a disk that is full.
TEST_F(ServerRecording, AFullDiskIsSaidAndWhatWasWrittenStays) {
  start();
  const std::string file = path("full.mcap");
  ChildProcess& recorder = record_beside(file, {}, "trap '' XFSZ; ulimit -f 3000;");  // kB
  ASSERT_TRUE(listens(file));
  {
    Client client = connect();
    Publisher publisher = publish(client, "moving");
    std::vector<Publisher::Object> balls;
    for (int i = 0; i < 100; ++i) balls.push_back(add_ball(publisher, "ball " + std::to_string(i), at(20 + i, 0, 0)));
    const auto end = std::chrono::steady_clock::now() + 20s;
    while (recorder.wait(0ms) == -1 && std::chrono::steady_clock::now() < end) {
      for (std::size_t i = 0; i < balls.size(); ++i)
        EXPECT_TRUE(publisher.move(balls[i], at(20.0 + static_cast<double>(i), 1, 0)));
      EXPECT_TRUE(publisher.flush());
      std::this_thread::sleep_for(5ms);
    }
  }
  EXPECT_EQ(recorder.wait(1s), 5);
  EXPECT_NE(recorder.errors().find("recording stopped: " + file + ": File too large"), std::string::npos)
      << recorder.errors();
  EXPECT_NE(recorder.errors().find("what was written before can be read"), std::string::npos) << recorder.errors();
  const Result<ReplayReport> report = replay(here(), {.path = file, .rate = 100});
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_GT(report->samples, 100U);
}

// More batches than the server keeps would be merged to each object's newest pose, and events between would be missed.
TEST_F(ServerRecording, ARecordingGivenFasterThanTheWorldStepsLosesNoPose) {
  constexpr int kPublishers = 4, kBalls = 20, kFlushes = 400;
  const std::string file = path("fast.mcap");
  const auto where = [](std::size_t publisher, int ball, int round) {
    return at(0.05 * ball, 0.1 * static_cast<double>(publisher), 0.001 * round);  // they overlap: a step takes a while
  };
  std::uint64_t told = 0, applied = 0;
  start();
  {
    Result<Recording> recording = record(here(), file);
    ASSERT_TRUE(recording) << recording.error().message;
    Client client = connect();
    std::vector<Publisher> publishers;
    std::vector<std::vector<Publisher::Object>> balls(kPublishers);
    for (std::size_t p = 0; p < kPublishers; ++p) {
      publishers.push_back(publish(client, "mover " + std::to_string(p)));
      for (int i = 0; i < kBalls; ++i)
        balls[p].push_back(
            add_ball(publishers[p], "ball " + std::to_string(p) + "/" + std::to_string(i), where(p, i, 0)));
    }
    const auto all_applied = [&] { return (applied = client.status()->poses_applied) == told; };
    for (int round = 0; round < kFlushes; ++round) {
      for (std::size_t p = 0; p < kPublishers; ++p) {
        for (int i = 0; i < kBalls; ++i)
          EXPECT_TRUE(publishers[p].move(balls[p][static_cast<std::size_t>(i)], where(p, i, round)));
        EXPECT_TRUE(publishers[p].flush());
      }
      told += kPublishers * kBalls;
      if (round % 20 != 19) continue;
      ASSERT_TRUE(test::eventually(all_applied)) << client.status()->poses_dropped << " dropped";
    }
    ASSERT_TRUE(recording->finish());
  }
  servers_.back()->signal(SIGTERM);
  ASSERT_EQ(servers_.back()->wait(15s), 0);
  start({"--fresh"}, "again");
  const Result<ReplayReport> again = replay(here(), {.path = file, .rate = 1'000});
  ASSERT_TRUE(again) << again.error().message;
  Client client = connect();
  EXPECT_TRUE(test::eventually([&] { return client.status()->poses_applied == applied; }))
      << client.status()->poses_applied << " of " << applied << " applied, " << client.status()->poses_dropped
      << " dropped";
  EXPECT_EQ(client.status()->poses_dropped, 0U);
}

TEST_F(ServerRecording, ASignalWritesTheFlightRecorder) {
  ChildProcess& server = start({"--flight-recorder", "12s"});
  server.signal(SIGUSR1);
  ASSERT_TRUE(test::eventually([&] { return server.errors().find("flight recorder: ") != std::string::npos; }, 10s));
  const std::string said = server.errors();
  EXPECT_NE(said.find(" messages of the last 12.0 s, "), std::string::npos) << said;
  const std::size_t begin = said.find(folder_.path(), said.find("flight recorder: "));
  ASSERT_NE(begin, std::string::npos) << said;
  const std::string file = said.substr(begin, said.find(".mcap", begin) + 5 - begin);
  const std::vector<std::byte> bytes = mcap::read_file(file, 1 << 30);
  EXPECT_TRUE(mcap::read(bytes).complete);
  EXPECT_TRUE(is_owners_alone(file));
}

// With keys the traffic is encrypted; the files held it in the clear for every user of the machine.
TEST_F(ServerRecording, AStateFolderThatTheServerMakesIsItsUsersAlone) {
  const std::string folder = path("made");
  ChildProcess server({COLLIDED_SERVER, "--domain", domain(), "--state-dir", folder}, folder_.path(), "made_by");
  ASSERT_TRUE(server.says("ready:", 20s)) << server.errors();
  EXPECT_TRUE(is_owners_alone(folder));
  for (const auto& entry : std::filesystem::directory_iterator(folder)) EXPECT_TRUE(is_owners_alone(entry.path()));
}

TEST_F(ServerRecording, AServerThatFailsLeavesAFile) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "the sanitizer has these signals for itself";
#endif
  ChildProcess& server = start();
  {
    Client client = connect();
    EXPECT_TRUE(client.ask(RayQuestion{{0, 0, 5}, {0, 0, -1}}));
  }
  server.signal(SIGSEGV);
  EXPECT_EQ(server.wait(10s), 128 + SIGSEGV);
  std::string file;
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
    if (entry.path().string().ends_with("_crash.mcap")) file = entry.path();
  }
  ASSERT_NE(file, "");
  EXPECT_TRUE(is_owners_alone(file));
  EXPECT_TRUE(has(file, "collided/query_v2", 2)) << "hello and a ray";
  EXPECT_TRUE(has(file, "collided/reply_v2", 2));
}

// The pages that carry a recording to whoever asked are traffic too; a recorder that kept them would double each time.
TEST_F(ServerRecording, ARecordingHoldsNoneOfThoseFetchedBefore) {
  start();
  const std::string file = path("again.mcap");
  const auto fetched = [&] {
    const Result<std::uint64_t> bytes = fetch_recording(here(), 30s, file);
    EXPECT_TRUE(bytes) << bytes.error().message;
    return bytes ? *bytes : 0;
  };
  const std::uint64_t first = fetched();
  EXPECT_GT(first, 0U);
  std::uint64_t last = first;
  for (int i = 0; i < 6; ++i) last = fetched();
  EXPECT_LT(last, 2 * first) << "first " << first << " bytes";
}

// What was written is handed out in pages for as long as it is kept and can be read; each refusal says what is allowed.
TEST_F(ServerRecording, PagesOfARecordingAreThoseOfItsFile) {
  start();
  Client client = connect();
  const auto refusal = [&](const std::string& arguments) {
    const Result<std::string> answer = client.command("recording", arguments);
    EXPECT_FALSE(answer) << arguments;
    return answer ? std::string() : answer.error().message + "; " + answer.error().hint;
  };
  const Result<std::string> made = client.command("recording", R"({"last_s": 30})");
  ASSERT_TRUE(made) << made.error().message;
  const auto told = nlohmann::json::parse(*made);
  const std::string file = told["path"];
  const std::string number = told["number"].dump();
  std::ifstream in(file, std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(in), {});
  EXPECT_EQ(told["bytes"], bytes.size());
  EXPECT_EQ(told["dropped"], 0);
  EXPECT_GE(told["messages"], 1);
  EXPECT_EQ(told["to_ns"].get<std::int64_t>() - told["from_ns"].get<std::int64_t>(), 30'000'000'000);
  const auto page = [&](const std::string& offset) {
    const Result<std::string> bytes_from =
        client.command("recording", R"({"number": )" + number + R"(, "offset": )" + offset + "}");
    return bytes_from ? *bytes_from : bytes_from.error().message;
  };
  EXPECT_TRUE(page("0") == bytes.substr(0, 1 << 20));
  EXPECT_TRUE(page("7") == bytes.substr(7, 1 << 20));
  EXPECT_EQ(page("1099511627776"), "") << "behind the end";
  EXPECT_EQ(refusal(R"({"number": )" + number + R"(, "offset": 1099511627777})"),
            "server refused: recording: 'offset' is 1099511627777; allowed: a whole number from 0 to 1099511627776; ");
  EXPECT_EQ(refusal(R"({"last_s": 86401})"), "server refused: recording: last_s is a time from 0 to a day; ");
  EXPECT_EQ(refusal(R"({"last_s": -1})"), "server refused: recording: last_s is a time from 0 to a day; ");
  EXPECT_EQ(refusal(R"({"number": 77})"),
            "server refused: recording 77 is not kept; the newest 4 are; ask for a new one");
  std::filesystem::remove(file);
  EXPECT_EQ(refusal(R"({"number": )" + number + "}"),
            "server refused: recording: " + file + " cannot be read any more; ask for a new one");
}

TEST_F(ServerRecording, WithoutAFlightRecorderTheServerSaysSo) {
  start({"--flight-recorder", "off"});
  const Result<std::uint64_t> bytes = fetch_recording(here(), 20s, path("last.mcap"));
  ASSERT_FALSE(bytes);
  EXPECT_EQ(bytes.error().code, ErrorCode::refused);
  EXPECT_NE(bytes.error().message.find("keeps no flight recorder"), std::string::npos);
  Client client = connect();
  const Result<Watch> since = client.watch({.since = 1s});
  ASSERT_FALSE(since);
  EXPECT_EQ(since.error().code, ErrorCode::refused);
}

TEST_F(ServerRecording, OtherFilesAreRefused) {
  const auto refused = [&](const std::string& file) {
    const Result<ReplayReport> report = replay(here(), {.path = file});
    EXPECT_FALSE(report);
    return report ? std::string() : report.error().message;
  };
  EXPECT_NE(refused(folder_.write("poses.csv", "t,name,x\n")).find("is no MCAP file. Nothing was replayed"),
            std::string::npos);
  EXPECT_NE(refused(path("missing.mcap")).find("No such file"), std::string::npos);
  EXPECT_NE(refused(folder_.path()).find("is no file"), std::string::npos);
}

}  // namespace
}  // namespace collided
