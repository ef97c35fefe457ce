// One long-lived server, asked and told over DDS in a random order by two publishers, commands, watches and probes, beside boxes in
// a map: whatever it says at any time is what the map says.
#include <gtest/gtest.h>

#include <csignal>
#include <nlohmann/json.hpp>

#include "tests/model/client_plain_boxes.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/service/server_fixture.hpp"

namespace collided::model {
namespace {

using nlohmann::json;
using namespace std::chrono_literals;

constexpr double kTolerance_m = 1e-9;

/// A publisher and what it has of its own.
struct Feed {
  std::string name;
  std::vector<std::string> pool;  // the names that its objects may have
  std::optional<Publisher> publisher;
  std::map<std::string, Publisher::Object> objects;
};

class ServerTwin : public testing_support::ServerTest {
 protected:
  static int rounds_asked() {
    const char* asked = std::getenv("COLLIDED_SERVER_TWIN_ROUNDS");
    return asked != nullptr ? std::atoi(asked) : 150;
  }
  void SetUp() override {
    floor_ = folder_.write("floor.obj", sheet({-64, -64}, {64, 64}, -24));
    begin();
    PlainObject floor;
    floor.parts = {{Lattice{0, 0, -24}, Lattice{64, 64, 0}}};
    floor.is_scene = true;
    plain_.objects["floor/sheet"] = floor;
    for (Feed& feed : feeds_) feed.publisher.emplace(publish(*client_, feed.name));
    watch_.emplace(watch(*client_));
  }
  void begin() {
    start({floor_}, "server" + std::to_string(servers_.size()));
    if (!client_) client_.emplace(connect());
  }

  // ---- chance
  int below(int count) { return static_cast<int>(random_() % static_cast<unsigned>(count)); }
  bool chance(int percent) { return below(100) < percent; }
  int between(int low, int high) { return low + below(high - low + 1); }
  template <class Items>
  auto one_of(const Items& items) {
    return *std::next(items.begin(), below(static_cast<int>(items.size())));
  }
  Lattice place() { return {between(-20, 20), between(-20, 20), between(-20, 20)}; }
  PlainObject any_object() {
    PlainObject object;
    for (int part = chance(30) ? 2 : 1; part > 0; --part) {
      object.parts.push_back({Lattice{between(-4, 4), between(-4, 4), between(-4, 4)},
                              Lattice{between(1, 7), between(1, 7), between(1, 7)}});
    }
    object.origin = place();
    object.layers = 1U << below(3);
    object.mask = chance(50) ? 0xffffffffU : 5U;
    object.group = chance(75) ? 0U : 1U;
    return object;
  }
  AskOptions any_options() {
    const std::vector<std::string> globs{"", "", "c*", "*o*", "d?p", "[ce]*", "floor*", "*t", "sky*"};
    AskOptions options{.mask = chance(50) ? 0xffffffffU : 1U << below(3),
                       .only = one_of(globs),
                       .skip = one_of(globs),
                       .timeout = 20s,
                       .fresh = true};
    if (options.only == options.skip) options.skip.clear();
    return options;
  }

  // ---- as the library says it
  static Shape shape_of(const PlainObject& object) {
    Shape shape;
    for (const auto& [center, half] : object.parts)
      shape.push_back(BoxShape{.half_m = metres(half), .center = metres(center)});
    return shape;
  }
  static json pose_of(const Lattice& at) {
    const Vec3 p = metres(at);
    return {p.x(), p.y(), p.z(), 1, 0, 0, 0};
  }

  // ---- what is done
  void define(Feed& feed) {
    const std::string name = one_of(feed.pool);
    if (feed.objects.contains(name)) remove(feed, name);
    const PlainObject object = any_object();
    const Result<Publisher::Object> added = feed.publisher->add({.name = name,
                                                                 .shape = shape_of(object),
                                                                 .pose = {.position = metres(object.origin)},
                                                                 .layers = object.layers,
                                                                 .mask = object.mask,
                                                                 .group = object.group});
    ASSERT_TRUE(added) << added.error().message;
    feed.objects[name] = *added;
    plain_.objects[name] = object;
  }
  void remove(Feed& feed, const std::string& name) {
    ASSERT_TRUE(feed.publisher->remove(feed.objects.at(name)));
    feed.objects.erase(name);
    plain_.objects.erase(name);
  }
  void move_some(Feed& feed) {
    for (int batch = between(1, 3); batch > 0; --batch) {
      for (const auto& [name, object] : feed.objects) {
        if (chance(40)) continue;
        Lattice& origin = plain_.objects.at(name).origin;
        origin = chance(30)
                     ? place()
                     : Lattice{origin[0] + between(-2, 2), origin[1] + between(-2, 2), origin[2] + between(-2, 2)};
        ASSERT_TRUE(feed.publisher->move(object, {.position = metres(origin)}, chance(20)));
      }
      ASSERT_TRUE(feed.publisher->flush());
    }
  }
  void leave_and_come_back(Feed& feed) {
    for (const auto& [name, object] : feed.objects) plain_.objects.erase(name);
    feed.objects.clear();
    feed.publisher.reset();
    feed.publisher.emplace(publish(*client_, feed.name));
  }
  void command(const char* name, const json& arguments, const Shape& shape = {}) {
    const Result<std::string> done = client_->command(name, arguments.dump(), shape, 20s);
    ASSERT_TRUE(done) << name << " " << arguments << ": " << done.error().message;
  }
  void command_an_object() {
    const std::string name = one_of(std::vector<std::string>{"egg", "elk"});
    const bool is_there = plain_.objects.contains(name);
    if (is_there && chance(40)) {
      command("remove", {{"name", name}});
      plain_.objects.erase(name);
    } else if (is_there) {
      Lattice& origin = plain_.objects.at(name).origin = place();
      command("move", {{"name", name}, {"pose", pose_of(origin)}, {"teleport", chance(50)}});
    } else {
      const PlainObject object = plain_.objects[name] = any_object();
      command("add",
              {{"name", name},
               {"pose", pose_of(object.origin)},
               {"layers", object.layers},
               {"mask", object.mask},
               {"group", object.group}},
              shape_of(object));
    }
  }
  void load_or_clear() {
    const std::string scene = one_of(std::vector<std::string>{"sky", "street"});
    const std::string object = scene + "/sheet";
    const bool is_there = plain_.objects.contains(object);
    if (is_there && chance(50)) {
      command("clear", {{"scene", scene}});
      plain_.objects.erase(object);
      return;
    }
    const Lattice half{between(4, 20), between(4, 20), 0};
    const Lattice center{between(-6, 6), between(-6, 6), between(-20, 20)};
    const std::string file = folder_.write(
        scene + std::to_string(++files_) + ".obj",
        sheet({center[0] - half[0], center[1] - half[1]}, {center[0] + half[0], center[1] + half[1]}, center[2]));
    command("load", {{"path", file}, {"name", scene}, {"replace", is_there}});
    PlainObject made;
    made.parts = {{center, half}};
    made.is_scene = true;
    plain_.objects[object] = made;
  }
  void probe() {
    const std::string name = one_of(std::vector<std::string>{"front", "rear"});
    if (probes_.contains(name) && chance(40)) {
      EXPECT_EQ(*client_->remove_probes(name), 1U);
      probes_.erase(name);
      return;
    }
    Probe made{.name = name,
               .object = one_of(std::vector<std::string>{"cup", "cot", "dot", "egg"}),
               .origin = metres(Lattice{between(-2, 2), between(-2, 2), 0}),
               .direction = {0, 0, -1},
               .reach_m = chance(50) ? 1.53 : 10.03,
               .back_m = chance(50) ? 0.03 : 0.53};
    ASSERT_TRUE(client_->add_probe(made));
    probes_[name] = made;
  }
  /// It comes back with all that it was told to keep; publishers define their objects anew.
  void kill_the_server() {
    servers_.back()->signal(SIGKILL);
    servers_.back()->wait(10s);
    const std::uint64_t epoch = client_->status()->epoch;
    begin();
    ASSERT_TRUE(becomes([&] { return client_->status()->epoch > epoch && client_->status()->state == "ready"; }));
  }
  void live_on() {
    Feed& feed = one_of_feeds();
    switch (below(12)) {
      case 0:
      case 1:
      case 2: return define(feed);
      case 3:
      case 4:
      case 5: return move_some(feed);
      case 6: return feed.objects.empty() ? define(feed) : remove(feed, one_of(feed.objects).first);
      case 7: return command_an_object();
      case 8: return load_or_clear();
      case 9: return probe();
      case 10:
        if (chance(30)) return leave_and_come_back(feed);
        return move_some(feed);
      default:
        if (!chance(30)) return command_an_object();
        watch_.reset();
        held_.clear();
        watch_.emplace(watch(*client_));
    }
  }
  Feed& one_of_feeds() { return feeds_[static_cast<std::size_t>(below(2))]; }

  // ---- what is said of it
  void keep_alive() {
    for (Feed& feed : feeds_) EXPECT_TRUE(feed.publisher->keep_alive());
  }
  bool becomes(const std::function<bool()>& condition, std::chrono::milliseconds most = 20s) {
    return test::eventually(
        [&] {
          keep_alive();
          return condition();
        },
        most);
  }
  void settle() {
    for (Feed& feed : feeds_) {
      ASSERT_TRUE(becomes([&] { return static_cast<bool>(feed.publisher->wait_applied(200ms)); })) << feed.name;
    }
  }
  void hear() {
    while (const std::optional<Event> event = watch_->next(0ns)) {
      if (event->kind == EventKind::persisted) continue;
      const PlainBoxes::Pair pair = std::minmax(event->a, event->b);
      held_[pair] += event->kind == EventKind::ended ? -1 : 1;
      EXPECT_TRUE(held_[pair] == 0 || held_[pair] == 1)
          << pair.first << " and " << pair.second << " began or ended twice";
      if (held_[pair] == 0) held_.erase(pair);
    }
  }
  void compare_contacts() {
    const std::set<PlainBoxes::Pair> expected = plain_.contacts();
    std::set<PlainBoxes::Pair> held;
    const bool are_told = becomes([&] {
      hear();
      held.clear();
      for (const auto& [pair, count] : held_) held.insert(pair);
      return held == expected;
    });
    if (are_told) return;
    for (const auto& [a, b] : expected)
      EXPECT_TRUE(held.contains({a, b})) << a << " and " << b << " touch, and nobody was told";
    for (const auto& [a, b] : held) EXPECT_TRUE(expected.contains({a, b})) << a << " and " << b << " do not touch";
  }
  void compare_objects() {
    const Result<ShownObjects> shown = client_->shapes({.timeout = 20s});
    ASSERT_TRUE(shown) << shown.error().message;
    std::map<std::string, const ShownObject*> there;
    for (const ShownObject& object : shown->objects) there[object.name] = &object;
    EXPECT_EQ(there.size(), plain_.objects.size());
    for (const auto& [name, object] : plain_.objects) {
      ASSERT_TRUE(there.contains(name)) << name;
      const ShownObject& told = *there.at(name);
      if (object.is_scene) continue;
      EXPECT_EQ(told.pose.position, metres(object.origin)) << name;
      EXPECT_EQ(told.layers, object.layers) << name;
      EXPECT_EQ(told.mask, object.mask) << name;
      EXPECT_EQ(told.group, object.group) << name;
      EXPECT_EQ(told.parts.size(), object.parts.size()) << name;
      EXPECT_FALSE(told.stale) << name;
    }
  }

  /// The answer names what is nearest, as far as it is; where several are, any of them.
  static void expect_nearest(const Answer& answer, const std::map<std::string, double>& distances, double at_most,
                             const std::string& question) {
    double nearest = INFINITY;
    for (const auto& [name, distance] : distances) nearest = std::min(nearest, distance);
    ASSERT_EQ(answer.verdict, !distances.empty() && nearest <= at_most ? Verdict::hit : Verdict::miss) << question;
    if (answer.verdict != Verdict::hit) return;
    const Hit& hit = answer.hits.at(0);
    EXPECT_NEAR(hit.distance_m, nearest, kTolerance_m) << question;
    ASSERT_TRUE(distances.contains(hit.object)) << question << ": " << hit.object;
    EXPECT_NEAR(distances.at(hit.object), nearest, kTolerance_m) << question;
  }
  void ask_ray() {
    AxisRay ray{.origin = metres(place()),
                .axis = below(3),
                .sign = chance(50) ? 1 : -1,
                .length_m = chance(50) ? INFINITY : 2.53};
    ray.origin[ray.axis] += 0.03;
    AskOptions options = any_options();
    options.mode = one_of(std::vector{HitMode::closest, HitMode::any, HitMode::all, HitMode::verdict});
    std::map<std::string, double> entries;
    for (const auto& [name, boxes] : plain_.allowed(options)) {
      for (const PlainBox& box : boxes) {
        const std::optional<double> at = entry(ray, box);
        if (at && (!entries.contains(name) || *at < entries[name])) entries[name] = *at;
      }
    }
    const Result<Answer> answer =
        client_->ask(RayQuestion{ray.origin, ray.sign * Vec3::Unit(ray.axis), ray.length_m}, options);
    ASSERT_TRUE(answer) << answer.error().message;
    if (options.mode == HitMode::closest) return expect_nearest(*answer, entries, INFINITY, "ray");
    EXPECT_EQ(answer->verdict, entries.empty() ? Verdict::miss : Verdict::hit);
    std::map<std::string, double> told;
    for (const Hit& hit : answer->hits)
      told.emplace(hit.object, hit.distance_m);  // the first of each, which is its nearest
    for (const auto& [name, at] : told) {
      ASSERT_TRUE(entries.contains(name)) << name;
      if (options.mode == HitMode::any) continue;
      EXPECT_NEAR(at, entries.at(name), kTolerance_m) << name;
    }
    const std::size_t most = options.mode == HitMode::verdict ? 0 : options.mode == HitMode::any ? 1 : entries.size();
    EXPECT_EQ(told.size(), std::min(most, entries.size()));
  }
  void ask_near() {
    const Vec3 point = metres(place());
    const double within = chance(50) ? INFINITY : 1.03;
    const AskOptions options = any_options();
    std::map<std::string, double> gaps;
    for (const auto& [name, boxes] : plain_.allowed(options)) {
      gaps[name] = INFINITY;
      for (const PlainBox& box : boxes) gaps[name] = std::min(gaps[name], gap(point, box));
    }
    const Result<Answer> answer = client_->ask(NearQuestion{point, within}, options);
    ASSERT_TRUE(answer) << answer.error().message;
    expect_nearest(*answer, gaps, within, "near");
  }
  static std::set<std::string> names_of(const Answer& answer) {
    std::set<std::string> names;
    for (const Hit& hit : answer.hits) names.insert(hit.object);
    return names;
  }
  void ask_overlaps() {
    const AskOptions options = any_options();
    const Lattice center = place(), half{between(0, 6), between(0, 6), between(0, 6)};
    const PlainBox asked{metres(center) - metres(half), metres(center) + metres(half)};
    const double radius = kStep_m * between(0, 9);
    std::set<std::string> in_box, in_ball;
    for (const auto& [name, boxes] : plain_.allowed(options)) {
      for (const PlainBox& box : boxes) {
        if (share_a_point(asked, box)) in_box.insert(name);
        const Vec3 apart = (box.low - metres(center)).cwiseMax(metres(center) - box.high).cwiseMax(Vec3::Zero());
        if (apart.squaredNorm() <= radius * radius) in_ball.insert(name);  // exact: squares of eighths
      }
    }
    const Result<Answer> box = client_->ask(BoxQuestion{metres(center), metres(half)}, options);
    const Result<Answer> ball = client_->ask(SphereQuestion{metres(center), radius}, options);
    ASSERT_TRUE(box && ball);
    EXPECT_EQ(names_of(*box), in_box);
    EXPECT_EQ(box->verdict, in_box.empty() ? Verdict::miss : Verdict::hit);
    EXPECT_EQ(names_of(*ball), in_ball);
    EXPECT_EQ(ball->verdict, in_ball.empty() ? Verdict::miss : Verdict::hit);
  }
  void ask_sweep() {
    const AskOptions options = any_options();
    const Vec3 half = metres({between(1, 4), between(1, 4), between(1, 4)}) + Vec3::Constant(1.0 / 64);
    const Vec3 from = metres(place()) + Vec3::Constant(1.0 / 128);
    const int axis = below(3);
    const double motion = kStep_m * between(1, 24) * (chance(50) ? 1 : -1);
    std::map<std::string, double> times;
    for (const auto& [name, boxes] : plain_.allowed(options)) {
      for (const PlainBox& box : boxes) {
        const std::optional<double> at = first_contact({from - half, from + half}, axis, motion, box);
        if (at && (!times.contains(name) || *at < times[name])) times[name] = *at;
      }
    }
    const std::vector<SweepQuestion> motions{{{.position = from}, {.position = from + motion * Vec3::Unit(axis)}}};
    const Result<Answers> answers = client_->sweep({BoxShape{.half_m = half}}, motions, options);
    ASSERT_TRUE(answers) << answers.error().message;
    const Answer& answer = answers->answers.at(0);
    ASSERT_EQ(answer.verdict, times.empty() ? Verdict::miss : Verdict::hit);
    if (times.empty()) return;
    const double first = std::min_element(times.begin(), times.end(), [](const auto& a, const auto& b) {
                           return a.second < b.second;
                         })->second;
    const Hit& hit = answer.hits.at(0);
    EXPECT_LE(hit.time_low, first);
    EXPECT_GE(hit.time_high, first);
    EXPECT_LT(hit.time_high - hit.time_low, 1e-6);
    ASSERT_TRUE(times.contains(hit.object)) << hit.object;
    EXPECT_NEAR(times.at(hit.object), first, 1e-6);
  }
  void ask_pair() {
    const std::string a = one_of(plain_.objects).first, b = one_of(plain_.objects).first;
    if (a == b) return;
    const PlainObject& of_a = plain_.objects.at(a);
    const PlainObject& of_b = plain_.objects.at(b);
    double apart = INFINITY, deepest = 0;
    for (const PlainBox& one : of_a.boxes()) {
      for (const PlainBox& other : of_b.boxes()) {
        apart = std::min(apart, gap(one, other));
        if (share_a_point(one, other)) deepest = std::max(deepest, depth(one, other));
      }
    }
    const Result<PairAnswer> answer = client_->pair(a, b);
    ASSERT_TRUE(answer) << a << " and " << b << ": " << answer.error().message;
    const bool meet = share_a_point(of_a, of_b);
    ASSERT_EQ(answer->verdict, meet ? Verdict::hit : Verdict::miss) << a << " and " << b;
    if (!meet) {
      EXPECT_NEAR(answer->distance_m, apart, kTolerance_m) << a << " and " << b;
    } else if (!of_a.is_scene &&
               !of_b.is_scene) {  // a sheet's two triangles overlap a box less deep than the sheet does
      EXPECT_NEAR(answer->depth_m, deepest, kTolerance_m) << a << " and " << b;
    }
  }
  void read_probes() {
    const Result<std::vector<ProbeReading>> readings = client_->probes();
    ASSERT_TRUE(readings) << readings.error().message;
    ASSERT_EQ(readings->size(), probes_.size());
    for (const ProbeReading& reading : *readings) {
      const Probe& probe = probes_.at(reading.probe);
      const auto holder = plain_.objects.find(probe.object);
      if (holder == plain_.objects.end()) {
        EXPECT_EQ(reading.state, Clearance::absent) << reading.probe;
        continue;
      }
      const AxisRay ray{.origin = metres(holder->second.origin) + probe.origin + Vec3(0, 0, probe.back_m),
                        .axis = 2,
                        .sign = -1,
                        .length_m = probe.back_m + probe.reach_m};
      double nearest = INFINITY;
      for (const auto& [name, object] : plain_.objects) {
        if (name == probe.object || !may_meet(object, holder->second)) continue;
        for (const PlainBox& box : object.boxes()) nearest = std::min(nearest, entry(ray, box).value_or(INFINITY));
      }
      if (std::isinf(nearest)) {
        EXPECT_EQ(reading.state, Clearance::nothing) << reading.probe;
      } else if (nearest == 0) {
        EXPECT_EQ(reading.state, Clearance::deeper) << reading.probe;
      } else {
        const double clearance = nearest - probe.back_m;
        EXPECT_NEAR(reading.clearance_m, clearance, kTolerance_m) << reading.probe;
        // Origins and faces lie on the lattice: nearer than a step is the same place.
        const bool is_touching = std::abs(clearance) < kTolerance_m;
        EXPECT_EQ(reading.state, is_touching     ? Clearance::touching
                                 : clearance > 0 ? Clearance::gap
                                                 : Clearance::collision)
            << reading.probe;
      }
    }
  }
  void compare() {
    settle();
    compare_contacts();
    compare_objects();
    keep_alive();
    for (int i = 0; i < 3 && !HasFailure(); ++i) {
      ask_ray();
      ask_near();
      ask_overlaps();
      ask_sweep();
      ask_pair();
      keep_alive();
    }
    read_probes();
  }

  std::mt19937_64 random_ = oracle::seeded(1'107);
  std::string floor_;
  int files_ = 0;
  PlainBoxes plain_;
  std::map<std::string, Probe> probes_;
  std::optional<Client> client_;
  std::array<Feed, 2> feeds_{Feed{"first", {"cup", "cap", "cot"}, {}, {}},
                             Feed{"second", {"dot", "dip", "dam"}, {}, {}}};
  std::optional<Watch> watch_;
  std::map<PlainBoxes::Pair, int> held_;
};

TEST_F(ServerTwin, WhateverWasDoneToItWhatItSaysIsWhatIsThere) {
  const int rounds = rounds_asked();
  for (int round = 0; round < rounds && !HasFailure(); ++round) {
    SCOPED_TRACE("round " + std::to_string(round));
    live_on();
    if (round % 60 == 59) kill_the_server();
    if (!HasFailure()) compare();
  }
}

}  // namespace
}  // namespace collided::model
