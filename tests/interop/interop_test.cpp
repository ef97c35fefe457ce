// Another vendor's DDS beside the client library: the same questions, poses and events, to the last bit.

#include <gtest/gtest.h>

#include <bit>
#include <chrono>
#include <cmath>
#include <cstring>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <collided/client.hpp>

#include "tests/oracle/seed.hpp"
#include "tests/service/server_fixture.hpp"

namespace collided {
namespace {

using namespace testing_support;

class Interop : public ServerTest {
 protected:
  ChildProcess peer(const std::string& command, const std::string& argument) {
    return ChildProcess({COLLIDED_FASTDDS_PEER, std::to_string(domain_), command, argument}, folder_.path(), command);
  }
  /// Lets something touch the wall until the watcher has heard of it: before that events may pass it by.
  static void let_hear(ChildProcess& watcher, Client& client) {
    const auto has_heard = [&] {
      EXPECT_TRUE(client.add({.name = "nudge", .shape = {SphereShape{.radius_m = 0.1}}}));
      EXPECT_TRUE(client.remove("nudge"));
      return watcher.says("ready", milliseconds(100));
    };
    ASSERT_TRUE(test::eventually(has_heard, seconds(20))) << watcher.errors();
  }
  static Event next_of_ball(Watch& watching) {
    for (;;) {
      Event event = next(watching);
      if (event.a.empty() || event.a == "fast/ball" || event.b == "fast/ball") return event;
    }
  }
  /// A tetrahedron: a mesh in a file.
  std::string tetrahedron() {
    return folder_.write("tetra.obj", "v -1 -1 -1\nv 1 1 -1\nv 1 -1 1\nv -1 1 1\nf 1 2 3\nf 1 3 4\nf 1 4 2\nf 2 4 3\n");
  }
};

struct Line {
  std::istringstream words;
  explicit Line(const std::string& text) : words(text) {}
  std::string word() {
    std::string next;
    words >> next;
    return next;
  }
  double number() { return std::strtod(word().c_str(), nullptr); }
};

std::vector<std::string> lines_of(const std::string& text, const std::string& beginning) {
  std::vector<std::string> found;
  std::istringstream all(text);
  for (std::string line; std::getline(all, line);) {
    if (line.rfind(beginning, 0) == 0) found.push_back(line);
  }
  return found;
}

bool is_same(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

TEST_F(Interop, TenThousandRaysHaveTheSameAnswersToTheLastBit) {
  start();
  Client client = connect();
  ChildProcess load = peer("load", tetrahedron());
  ASSERT_EQ(load.wait(seconds(30)), 0) << load.output() << load.errors();
  EXPECT_NE(load.output().find("\"triangles\":4"), std::string::npos) << load.output();

  std::mt19937_64 random = oracle::seeded(20261201);
  std::uniform_real_distribution<double> place(-5, 5), size(0.05, 0.4);
  for (int i = 0; i < 60; ++i) {
    const Shape shape = i % 2 == 0 ? Shape{SphereShape{.radius_m = size(random)}}
                                   : Shape{BoxShape{.half_m = {size(random), size(random), size(random)}}};
    ASSERT_TRUE(client.add({.name = "thing " + std::to_string(i),
                            .shape = shape,
                            .pose = {.position = {place(random), place(random), place(random)}}}));
  }
  std::vector<double> numbers;
  std::vector<RayQuestion> rays;
  for (int i = 0; i < 10'000; ++i) {
    const Vec3 from(place(random), place(random), place(random));
    const Vec3 to(place(random) / 3, place(random) / 3, place(random) / 3);
    rays.push_back({.origin = from, .direction = to - from, .length_m = i % 3 == 0 ? 4.0 : 100.0});
    for (const double n :
         {from.x(), from.y(), from.z(), (to - from).x(), (to - from).y(), (to - from).z(), rays.back().length_m})
      numbers.push_back(n);
  }
  const std::string file = folder_.write(
      "rays", std::string(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double)));
  ChildProcess asker = peer("ask", file);
  ASSERT_EQ(asker.wait(seconds(60)), 0) << asker.errors();
  const Result<Answers> ours = client.ask(rays, {.timeout = seconds(20)});
  ASSERT_TRUE(ours) << ours.error().message;

  const std::vector<std::string> lines = lines_of(asker.output(), "");
  ASSERT_EQ(lines.size(), rays.size()) << "answers were lost";
  int hits = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Line line(lines[i]);
    const Answer& answer = ours->answers[i];
    ASSERT_EQ(line.word(), std::to_string(static_cast<int>(answer.verdict))) << "ray " << i;
    const Hit hit = answer.hits.empty() ? Hit{} : answer.hits.front();
    hits += answer.hits.empty() ? 0 : 1;
    ASSERT_EQ(line.word(), std::to_string(hit.object_id)) << "ray " << i;
    for (const double n : {hit.distance_m, hit.error_m, hit.point.x(), hit.point.y(), hit.point.z()})
      ASSERT_TRUE(is_same(line.number(), n)) << "ray " << i << ": " << lines[i];
  }
  EXPECT_GT(hits, 1'000);
  EXPECT_LT(hits, 9'000);
}

TEST_F(Interop, TenThousandPosesAndAThousandEventsArriveWhole) {
  start({folder_.write("nothing.obj", "v 0 0 -50\nv 1 0 -50\nv 0 1 -50\nf 1 2 3\n")});
  Client client = connect();
  ASSERT_TRUE(client.add({.name = "wall", .shape = {BoxShape{.half_m = {0.2, 1, 1}}}}));
  Watch watching = watch(client);
  constexpr std::size_t kEvents = 1'000;
  ChildProcess watcher = peer("watch", std::to_string(kEvents));
  let_hear(watcher, client);
  ChildProcess publisher = peer("publish", "10000");
  ASSERT_TRUE(publisher.says("published 10000 poses", seconds(60))) << publisher.errors();
  const auto is_counted = [&] {
    const Result<ServerStatus> status = client.status();
    EXPECT_EQ(status ? status->poses_dropped : 0, 0U) << "more waited than the server keeps, so it left some out";
    return status && status->poses_applied == 10'000;
  };
  EXPECT_TRUE(test::eventually(is_counted)) << *client.command("figures", "{}");
  ASSERT_EQ(watcher.wait(seconds(30)), 0) << lines_of(watcher.output(), "event ").size() << " events; "
                                          << watcher.errors() << watcher.output().substr(0, 200);

  // The last pose, to the last bit.
  const Result<ObjectDetails> ball = client.get("fast/ball");
  ASSERT_TRUE(ball && ball->pose) << "no ball, or no pose of it";
  Line said(
      lines_of(publisher.output(), "published").front().substr(std::strlen("published 10000 poses, the last at ")));
  EXPECT_TRUE(is_same(said.number(), ball->pose->position.x()));
  EXPECT_TRUE(is_same(said.number(), ball->pose->position.y()));
  const std::vector<std::string> events = lines_of(watcher.output(), "event ");
  ASSERT_EQ(events.size(), kEvents);
  for (std::size_t i = 0; i < kEvents; ++i) {
    const Event event = next_of_ball(watching);
    Line line(events[i].substr(std::strlen("event ")));
    ASSERT_EQ(line.word(), std::to_string(event.sequence)) << "a gap, or an event twice";
    ASSERT_EQ(line.word(), event.kind == EventKind::began ? "0" : "2");
    ASSERT_EQ(line.word(), std::to_string(static_cast<int>(event.reason)));
    ASSERT_EQ(line.word(), event.a);
    ASSERT_EQ(line.word(), event.b);
    for (const double n : {event.depth_m, event.depth_error_m, event.bracket_low_s, event.bracket_high_s})
      ASSERT_TRUE(is_same(line.number(), n)) << events[i];
  }
}

TEST_F(Interop, ContactsThatHoldAreTheSame) {
  start({folder_.write("nothing.obj", "v 0 0 -50\nv 1 0 -50\nv 0 1 -50\nf 1 2 3\n")});
  Client client = connect();
  ASSERT_TRUE(client.add({.name = "wall", .shape = {BoxShape{.half_m = {0.2, 1, 1}}}}));
  Watch watching = watch(client);
  ChildProcess watcher = peer("watch", "1");
  let_hear(watcher, client);
  ChildProcess publisher = peer("publish", "19");  // it ends within the wall
  ASSERT_TRUE(publisher.says("published 19 poses", seconds(30))) << publisher.errors();
  ASSERT_EQ(watcher.wait(seconds(30)), 0) << watcher.errors();
  const Event began = next_of_ball(watching);
  const std::vector<std::string> contacts = lines_of(watcher.output(), "contact ");
  ASSERT_EQ(contacts.size(), 1U) << watcher.output();
  Line line(contacts.front().substr(std::strlen("contact ")));
  EXPECT_EQ(line.word(), began.a);
  EXPECT_EQ(line.word(), began.b);
  EXPECT_EQ(line.word(), std::to_string(began.episode));
  EXPECT_GT(line.number(), 0.0);
}

// Programs whose types are those of another version, under the same names.
TEST_F(Interop, SamplesOfAnotherLayoutAreLeftOutWithACountedWarning) {
  start({folder_.write("nothing.obj", "v 0 0 -50\nv 1 0 -50\nv 0 1 -50\nf 1 2 3\n")});
  Client client = connect();
  std::size_t told = 0;
  for (const std::string layout : {"lacks", "differs"}) {
    ChildProcess definer = peer("define", layout);
    const std::string warning =
        "Definition was left out: it cannot be read, so the program that wrote it has another "
        "version of idl/collided.idl. Left out so far: " +
        std::to_string(++told);
    EXPECT_TRUE(
        test::eventually([&] { return servers_.back()->errors().find(warning) != std::string::npos; }, seconds(20)))
        << layout << ": " << definer.errors() << servers_.back()->errors();
    EXPECT_FALSE(client.get("other/ball")) << layout;
    definer.signal(SIGTERM);
  }
  // Members after the last one say nothing: what comes before them is as this version has it.
  ChildProcess longer = peer("define", "more");
  EXPECT_TRUE(test::eventually([&] { return bool(client.get("other/ball")); }, seconds(20))) << longer.errors();
  longer.signal(SIGTERM);
  ASSERT_TRUE(client.add({.name = "wall", .shape = {BoxShape{.half_m = {0.2, 1, 1}}}, .pose = at(0, 9, 0)}));
  EXPECT_TRUE(client.get("wall")) << "the server goes on";
}

}  // namespace
}  // namespace collided
