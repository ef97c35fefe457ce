#include <cmath>
#include <map>
#include <sstream>

#include <nlohmann/json.hpp>

#include "server/intake/scene.hpp"
#include "server/world/world.hpp"
#include "tests/service/server_process.hpp"

// U4: three publishers, two subscribers and a client that asks, each a process of its own, over real DDS.
namespace collided::engine {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using testing_support::ChildProcess;

constexpr int kPublishers = 3;
constexpr int kBalls = 6;
constexpr int kFrames = 600;
constexpr double kRate = 150;
constexpr double kRadius = 0.25;

/// Balls of one publisher on its own stretch of floor: they bounce on it and swing through each other.
Vec3 ball_at(int publisher, int ball, int frame) {
  const double t = frame / kRate;
  const double phase = 0.7 * ball + 0.3 * publisher;
  return {100.0 * publisher + 0.8 * ball + 0.9 * std::sin(2.1 * t + phase), 0.2 * std::cos(1.3 * t + phase),
          0.45 + 0.4 * std::sin((5 + ball) * t + phase)};
}

std::string ball_name(int publisher, int ball) {
  return "p" + std::to_string(publisher) + "_ball" + std::to_string(ball);
}

/// Positions as the publisher reads them: the text is the input.
std::string poses_csv(int publisher) {
  std::ostringstream csv;
  csv.precision(17);
  csv << "t,name,x,y,z,qw,qx,qy,qz\n";
  for (int frame = 0; frame < kFrames; ++frame) {
    for (int ball = 0; ball < kBalls; ++ball) {
      const Vec3 p = ball_at(publisher, ball, frame);
      csv << frame / kRate << ',' << ball_name(publisher, ball) << ',' << p.x() << ',' << p.y() << ',' << p.z()
          << ",1,0,0,0\n";
    }
  }
  return csv.str();
}

std::string floors_obj() {
  std::ostringstream obj;
  for (int i = 0; i < kPublishers; ++i) {
    obj << "o floor" << i << '\n';
    for (const auto& [x, y] : {std::pair(-20, -20), std::pair(20, -20), std::pair(20, 20), std::pair(-20, 20)}) {
      obj << "v " << 100 * i + x << ' ' << y << " 0\n";
    }
    obj << "f " << 4 * i + 1 << ' ' << 4 * i + 2 << ' ' << 4 * i + 3 << '\n';
    obj << "f " << 4 * i + 1 << ' ' << 4 * i + 3 << ' ' << 4 * i + 4 << '\n';
  }
  return obj.str();
}

using Pair = std::pair<std::string, std::string>;
using History = std::map<Pair, std::vector<std::string>>;  // "began" and "ended" of a pair, in order

Pair named(const std::string& a, const std::string& b) { return a < b ? Pair(a, b) : Pair(b, a); }

/// The same poses through the engine in this process, one step a frame.
History expected(const std::string& floors_path) {
  History history;
  LoadReport report;
  for (int publisher = 0; publisher < kPublishers; ++publisher) {
    Scene scene = load_scene(floors_path, {}, report);
    World world{WorldOptions{}};
    world.add_scene(World::index_scene(scene, {}));
    std::vector<ObjectId> ids;
    std::map<ObjectId, std::string> names;
    for (int slot = 0; slot < static_cast<int>(world.objects().size()); ++slot) {
      names[world.objects()[slot]->id] = world.objects()[slot]->name;
    }
    const auto note = [&] {
      for (const Event& event : world.events()) {
        history[named(names[event.of.a], names[event.of.b])].push_back(event.kind == EventKind::began ? "began"
                                                                                                      : "ended");
      }
    };
    for (int ball = 0; ball < kBalls; ++ball) {
      ObjectDefinition definition;
      definition.name = ball_name(publisher, ball);
      definition.shape.primitives = {Sphere{.center = Vec3::Zero(), .radius_m = kRadius}};
      definition.pose.position = ball_at(publisher, ball, 0);
      ids.push_back(std::get<ObjectId>(world.define(definition)));
      names[ids.back()] = definition.name;
    }
    world.step(1, 1, {});
    note();
    for (int frame = 1; frame < kFrames; ++frame) {
      for (int ball = 0; ball < kBalls; ++ball) {
        world.move(ids[ball], {.position = ball_at(publisher, ball, frame), .rotation = Quat::Identity()}, frame,
                   false);
      }
      world.step(frame + 1, 1, {});
      note();
    }
    for (const ObjectId id : ids) world.remove(id, EndReason::removed);
    world.step(kFrames + 1, 1, {});
    note();
  }
  return history;
}

struct Heard {
  History history;
  std::vector<std::uint64_t> sequences;
};

Heard heard(const std::string& lines) {
  Heard all;
  std::istringstream in(lines);
  for (std::string line; std::getline(in, line);) {
    const json event = json::parse(line);
    if (event["a"] == "probe" || event["b"] == "probe") continue;
    all.history[named(event["a"], event["b"])].push_back(event["what"]);
    all.sequences.push_back(event["sequence"]);
  }
  return all;
}

class EndToEnd : public testing_support::ServerProcess {};

TEST_F(EndToEnd, EveryEventReachesEverySubscriberOnceInOrderAndEqualToTheOracle) {
  const std::string floors = folder_.write("floors.obj", floors_obj());
  start({floors});
  const std::string domain = std::to_string(domain_);
  const auto collide = [&](std::vector<std::string> words, const std::string& name) {
    words.insert(words.begin(), COLLIDED_CLI);
    for (const char* word : {"--domain", domain.c_str()}) words.push_back(word);
    return std::make_unique<ChildProcess>(words, folder_.path(), name);
  };
  std::vector<std::unique_ptr<ChildProcess>> watchers;
  for (int i = 0; i < 2; ++i) watchers.push_back(collide({"watch", "--json"}, "watch" + std::to_string(i)));
  // Both watchers are there once each has heard of a probe that touches the floor, and of its end.
  ASSERT_EQ(collide({"add", "probe", "sphere", "0.1", "--at", "19", "19", "0"}, "add")->wait(5s), 0);
  for (auto& watcher : watchers) ASSERT_TRUE(watcher->says("probe", 10s)) << watcher->errors();
  ASSERT_EQ(collide({"rm", "probe"}, "rm")->wait(5s), 0);
  for (auto& watcher : watchers) ASSERT_TRUE(watcher->says("\"why\":\"removed\"", 10s)) << watcher->errors();
  std::vector<std::unique_ptr<ChildProcess>> publishers;
  for (int i = 0; i < kPublishers; ++i) {
    const std::string csv = folder_.write("poses" + std::to_string(i) + ".csv", poses_csv(i));
    publishers.push_back(collide({"publish", csv, "--shape", "sphere:0.25", "--as", "publisher" + std::to_string(i)},
                                 "publish" + std::to_string(i)));
  }
  const auto ray = collide({"ray", "15", "15", "5", "0", "0", "-1", "--json"}, "ray");
  EXPECT_EQ(ray->wait(5s), 0) << ray->errors();
  const json answer = json::parse(ray->output());
  EXPECT_EQ(answer["object"], "floors/floor0");
  EXPECT_EQ(answer["distance"], 5.0);
  for (auto& publisher : publishers) EXPECT_EQ(publisher->wait(30s), 0) << publisher->errors();

  const History wanted = expected(floors);
  std::size_t wanted_events = 0;
  for (const auto& [pair, events] : wanted) wanted_events += events.size();
  ASSERT_GT(wanted_events, 200u) << "the scene must be worth testing";
  for (auto& watcher : watchers) {
    const auto until = std::chrono::steady_clock::now() + 10s;
    while (heard(watcher->output()).sequences.size() < wanted_events && std::chrono::steady_clock::now() < until) {
      std::this_thread::sleep_for(50ms);
    }
    watcher->signal(SIGINT);
    watcher->wait(5s);
    const Heard events = heard(watcher->output());
    for (std::size_t i = 0; i < events.sequences.size(); ++i) {
      ASSERT_EQ(events.sequences[i], i + 3) << "once, in order, without a gap";
    }
    EXPECT_EQ(events.sequences.size(), wanted_events);
    EXPECT_EQ(events.history, wanted);
  }
  EXPECT_EQ(heard(watchers[0]->output()).history, heard(watchers[1]->output()).history) << "both heard the same";
}

}  // namespace
}  // namespace collided::engine
