// Objects go to and fro across the borders of four shards, and the same ones in one server that holds everything:
//   border_crossings SERVER CROSSINGS [SEED [SPLITS [KILLS [CUTS]]]]
// Two publishers with instants of their own tell both worlds the same poses at the same times; one of the two speaks 4 to 100
// times as often as the other, by the seed. What a watch of the shards
// tells must be what a watch of the one server tells: for each pair the same events in the same order at the same times.
// With one split a shard is split on the way, with two one of those in its place later, at the second attempt; and rays are
// asked of both worlds all the while, whose answers about a settled instant must be the same.
// KILLS: so often a shard's primary is killed amid the crossings, and its standby takes its place. The publishers, the watch
// and a client that asks go on; no answer may be wrong, and none undecided once the standby is there.
// CUTS: other than 0, the shards get each motion in two pieces of the same way, cut at a random instant. A way with more
// poses is the same way, so that the events are the same and their brackets share a time.
// Prints the figures, and exits 1 where an event was lost, told twice, told otherwise or out of order.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <future>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "collided/fleet.hpp"
#include "collided/shards.hpp"
#include "idl/shards/shard_map.hpp"
#include "tests/service/child_process.hpp"
#include "tests/service/endurance/measuring.hpp"
#include "tests/shards/same_answers.hpp"

namespace collided::testing_support {
namespace {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;

constexpr int kObjects = 48;  // of each publisher
constexpr double kMostTimesSlower = 100;
constexpr double kRange = 2;  // m, about the point where all shards meet
constexpr auto kPatience = 60s;
constexpr auto kTick = 15ms;
constexpr int kMostShown = 10;
constexpr std::int64_t kCrossingsInRound = 10'000;
// Beyond a publisher's gap (1.5 s by default) an object does not go straight.
constexpr auto kLongestCut = 1s;
// While a shard is being replaced, frames come as from a publisher of 200 a second.
constexpr auto kFrame = 5ms;
constexpr auto kReplacing = 600ms;

// Four quarters about the z axis.
constexpr const char* kMap = R"({"margin_m": 0.5, "shards": [
  {"name": "a", "low": [null, null, null], "high": [0, 0, null]},
  {"name": "b", "low": [0, null, null], "high": [null, 0, null]},
  {"name": "c", "low": [null, 0, null], "high": [0, null, null]},
  {"name": "d", "low": [0, 0, null], "high": [null, null, null]}]})";

// One quarter in two, askew of where all meet, and then one of the two again.
constexpr const char* kSplit = R"({"margin_m": 0.5, "shards": [
  {"name": "a", "low": [null, null, null], "high": [0, 0, null]},
  {"name": "b", "low": [0, null, null], "high": [null, 0, null]},
  {"name": "c", "low": [null, 0, null], "high": [0, null, null]},
  {"name": "d1", "low": [0, 0, null], "high": [0.7, null, null]},
  {"name": "d2", "low": [0.7, 0, null], "high": [null, null, null]}]})";
constexpr const char* kSplitAgain = R"({"margin_m": 0.5, "shards": [
  {"name": "a", "low": [null, null, null], "high": [0, 0, null]},
  {"name": "b", "low": [0, null, null], "high": [null, 0, null]},
  {"name": "c", "low": [null, 0, null], "high": [0, null, null]},
  {"name": "d1", "low": [0, 0, null], "high": [0.7, null, null]},
  {"name": "d21", "low": [0.7, 0, null], "high": [null, 1.1, 0.2]},
  {"name": "d22", "low": [0.7, 0, 0.2], "high": [null, 1.1, null]},
  {"name": "d23", "low": [0.7, 1.1, null], "high": [null, null, null]}]})";

constexpr const char* kFloor = "v -9 -9 0\nv 9 -9 0\nv 9 9 0\nv -9 9 0\nf 1 2 3\nf 1 3 4\n";

/// An event of a pair, whose names are in order.
struct ToldEvent {
  EventKind kind = EventKind::began;
  EndReason reason = EndReason::none;
  nanoseconds at{0};
  nanoseconds bracket{0};  // the change happened at most so long before
  Vec3 point = Vec3::Zero();
  double depth_m = 0;
  double depth_error_m = 0;
};
using Told = std::map<std::pair<std::string, std::string>, std::vector<ToldEvent>>;

nanoseconds bracket_of(const Event& event) {
  return nanoseconds(std::llround((event.bracket_low_s - event.bracket_high_s) * 1e9));
}

void note(const Event& event, Told& told) {
  told[std::minmax(event.a, event.b)].push_back({.kind = event.kind,
                                                 .reason = event.reason,
                                                 .at = happened(event),
                                                 .bracket = bracket_of(event),
                                                 .point = event.point,
                                                 .depth_m = event.depth_m,
                                                 .depth_error_m = event.depth_error_m});
}

/// An object that goes from wall to wall, turning at random.
struct Walker {
  Vec3 position;
  Vec3 speed;  // m a tick
  Quat rotation = Quat::Identity();
  Publisher::Object whole = 0;
  ShardedPublisher::Object sharded = 0;

  void go(std::mt19937_64& random) {
    std::normal_distribution<> turn(0, 0.01);
    for (int axis = 0; axis < 3; ++axis) {
      const double range = axis == 2 ? kRange / 6 : kRange;
      position[axis] += speed[axis];
      if (std::abs(position[axis]) > range) speed[axis] = -std::copysign(speed[axis], position[axis]);
    }
    rotation = (rotation * Quat(1, turn(random), turn(random), turn(random))).normalized();
  }
};

class BorderCrossings {
 public:
  BorderCrossings(std::string server, std::uint64_t seed, int kills, bool cuts)
      : server_(std::move(server)), random_(seed), domain_(own_domain()), kills_(kills), cuts_(cuts) {
    slow_ = static_cast<int>(random_() % 2);
    slow_period_ = static_cast<int>(
        std::lround(std::exp(std::uniform_real_distribution<>(std::log(4.0), std::log(kMostTimesSlower))(random_))));
    std::printf("publisher %d speaks every %d ticks, the other one every tick\n", slow_, slow_period_);
    const std::string file = write(kMap, "map.json");
    std::ofstream(folder_.path() + "/floor.obj") << kFloor;
    whole_server_ = start({"--namespace", "whole"});
    for (std::size_t i = 0; i < map_.size(); ++i) start_shard(file, map_.at(i).name);
    whole_.emplace(value_of(Client::connect({.domain = domain_, .name_space = "whole", .wait = 20s}), "connect"));
    sharded_.emplace(
        value_of(ShardedClient::connect(file, {.domain = domain_, .name_space = "city", .wait = 20s}), "connect"));
    whole_watch_.emplace(value_of(whole_->watch({.capacity = 1 << 22}), "watch"));
    sharded_watch_.emplace(value_of(sharded_->watch({.capacity = 1 << 22}), "watch"));
    if (!wait_until([&] { return whole_watch_->in_step(); }, kPatience))
      std::printf("the watch does not come in step\n");
    for (int publisher = 0; publisher < 2; ++publisher) add_publisher(publisher);
  }

  /// Returns the number of faults.
  int run(std::int64_t wanted, int splits) {
    const auto started = SteadyClock::now();
    const std::int64_t in_round = kills_ > 0 ? std::max<std::int64_t>(1, wanted / (kills_ + 1)) : kCrossingsInRound;
    if (splits > 0) {
      go_until(wanted / 3);
      split("map.json", kSplit, "split.json", "d", {"d1", "d2"});
    }
    if (splits > 1) {
      go_until(std::max(crossings_ + 1, 2 * wanted / 3));
      split("split.json", kSplitAgain, "again.json", "d2", {"d21", "d22", "d23"}, true);
    }
    while (crossings_ < wanted) {
      if (killed_ < kills_) fail_over();
      go_until(std::min(wanted, crossings_ + in_round));
      compare();
    }
    const double seconds = std::chrono::duration<double>(SteadyClock::now() - started).count();
    std::printf(
        "crossings=%lld ticks=%lld cuts=%lld events=%zu lost=%d extra=%d differing=%d out_of_order=%d "
        "at_another_step=%d "
        "gaps=%llu copies=%zu of %d kills=%d crossed_then=%lld asked=%d undecided=%d unanswered=%d wrong=%d in %.1f "
        "s\n",
        static_cast<long long>(crossings_), static_cast<long long>(ticks_), static_cast<long long>(cut_count_),
        whole_count_, lost_, extra_, differing_, out_of_order_, at_another_step_,
        static_cast<unsigned long long>(sharded_watch_->gaps()),
        sources_[0].sharded->copies() + sources_[1].sharded->copies(), 2 * kObjects, killed_,
        static_cast<long long>(crossed_amid_kills_), asked_, undecided_, unanswered_, wrong_, seconds);
    if (splits > 0)
      std::printf("splits=%d rays=%d hit=%d undecided=%d differing=%d\n", splits, ray_count_, hit_count_,
                  undecided_count_, differing_answers_);
    faults_ += static_cast<int>(cuts_ && cut_count_ == 0);
    faults_ += differing_answers_ + static_cast<int>(splits > 0 && sharded_watch_->gaps() > 0);
    return wrong_ + faults_ + lost_ + extra_ + differing_ + out_of_order_;
  }

 private:
  struct Source {
    std::optional<Publisher> whole;
    std::optional<ShardedPublisher> sharded;
    std::vector<Walker> walkers;
    nanoseconds instant{0};
    int period = 1;  // ticks
  };

  std::string write(const char* map, const std::string& name) {
    std::ofstream(folder_.path() + '/' + name) << map;
    return folder_.path() + '/' + name;
  }

  void start_shard(const std::string& file, const std::string& name) {
    shard_servers_[name] = start({"--namespace", "city", "--shard", file + ':' + name});
  }

  std::unique_ptr<ChildProcess> start(const std::vector<std::string>& options) {
    const std::string name = "server_" + std::to_string(started_++);
    std::vector<std::string> words{server_,       folder_.path() + "/floor.obj", "--domain", std::to_string(domain_),
                                   "--state-dir", folder_.path() + '/' + name,   "--member", name};
    words.insert(words.end(), options.begin(), options.end());
    auto process = std::make_unique<ChildProcess>(words, folder_.path(), name);
    if (!process->says("ready:", 20s)) std::printf("%s\n", process->errors().c_str());
    return process;
  }

  // ---- a standby takes a shard's place

  /// Kills the server of a shard that has a standby, and goes on while that takes its place.
  void fail_over() {
    const std::size_t shard = random_() % map_.size();
    const std::string name = "server_" + std::to_string(started_);
    std::unique_ptr<ChildProcess> standby =
        start({"--standby-of", "city", "--shard", folder_.path() + "/map.json:" + map_.at(shard).name});
    // While the two have not found their worlds the same, it would not take the place.
    const auto patience_over = SteadyClock::now() + kPatience;
    const auto pause = std::chrono::milliseconds(100 + random_() % 200);
    do frames_for(pause, shard);
    while (!is_ready(shard, name) && SteadyClock::now() < patience_over);
    if (SteadyClock::now() >= patience_over) {
      std::printf("the standby of shard '%s' does not become ready: %s\n", map_.at(shard).name.c_str(),
                  standby->errors().c_str());
      ++faults_;
    }
    const std::int64_t crossings = crossings_;
    shard_servers_[map_.at(shard).name]->signal(SIGKILL);
    ++killed_;
    frames_for(kReplacing, shard);
    shard_servers_[map_.at(shard).name] = std::move(standby);
    crossed_amid_kills_ += crossings_ - crossings;
    if (!wait_until([&] { return ask(shard); }, kPatience)) {
      std::printf("nobody answers in the place of shard '%s': %s\n", map_.at(shard).name.c_str(),
                  shard_servers_[map_.at(shard).name]->errors().c_str());
      ++faults_;
    }
  }

  void frames_for(nanoseconds time, std::size_t shard) {
    for (const auto end = SteadyClock::now() + time; SteadyClock::now() < end; ++ticks_) {
      tick_all();
      take();
      ask(shard);
      std::this_thread::sleep_for(kFrame);
    }
  }

  bool is_ready(std::size_t shard, const std::string& name) const {
    const Result<Fleet> all =
        fleet({.domain = domain_, .name_space = shards::shard_namespace("city", map_.at(shard).name)});
    if (!all) return false;
    const auto found = std::ranges::find(all->members, name, &FleetMember::name);
    return found != all->members.end() && found->state == "ready" && found->hash_time != 0s;
  }

  /// Asks for a ray down to the floor in a shard, outside of where things move. True: it is decided.
  bool ask(std::size_t shard) {
    const shards::ShardBox& box = map_.at(shard).box;
    const Vec3 origin{std::isinf(box.low[0]) ? -7.0 : 7.0, std::isinf(box.low[1]) ? -7.0 : 7.0, 5};
    const Result<Answer> answer =
        sharded_->ask(RayQuestion{.origin = origin, .direction = -Vec3::UnitZ(), .length_m = 10});
    ++asked_;
    if (!answer || answer->verdict == Verdict::undecided) {
      ++(answer ? undecided_ : unanswered_);
      return false;
    }
    if (answer->verdict != Verdict::hit || answer->hits.at(0).distance_m != 5) {
      std::printf("the ray in shard '%s' is answered wrongly\n", map_.at(shard).name.c_str());
      ++wrong_;
    }
    return true;
  }

  void add_publisher(int number) {
    Source& source = sources_.emplace_back();
    // What the first one moves may be far beyond a border when its pairs with the second one's objects are decided.
    if (number == slow_) source.period = slow_period_;
    const std::string name = "publisher_" + std::to_string(number);
    source.whole.emplace(value_of(whole_->publish(name, {.lease = 60s}), "publish"));
    source.sharded.emplace(value_of(sharded_->publish(name, {.lease = 60s}), "publish"));
    // Before a publisher's first instant its objects live by the server's clock, which is ahead of the stamps.
    value_of(source.whole->add(
                 {.name = name, .shape = {SphereShape{.radius_m = 0.1}}, .pose = {.position = {9.0 * number, 0, 9}}}),
             "add");
    flush(source);
    wait_applied(*source.whole);
    std::this_thread::sleep_for(100ms);
    flush(source);
    std::uniform_real_distribution<> somewhere(-1, 1);
    for (int i = 0; i < kObjects; ++i) {
      // Apart from everything at first: when an object's life begins, its server's clock says.
      const int place = number * kObjects + i;
      Walker walker{.position = {-kRange + 0.7 * (place % 10), -kRange + 0.7 * (place / 10), 0.45},
                    .speed = 0.2 * Vec3(somewhere(random_), somewhere(random_), somewhere(random_) / 6)};
      Shape shape{SphereShape{.radius_m = 0.15}};
      if (i % 3 == 1) shape = {BoxShape{.half_m = {0.2, 0.1, 0.15}}};
      if (i % 3 == 2) shape = {CapsuleShape{.a = {-0.2, 0, 0}, .b = {0.2, 0, 0}, .radius_m = 0.1}};
      const ObjectOptions options{.name = name + "_" + std::to_string(i), .shape = shape, .pose = pose_of(walker)};
      walker.whole = value_of(source.whole->add(options), "add");
      walker.sharded = value_of(source.sharded->add(options), "add");
      source.walkers.push_back(walker);
    }
    flush(source);
    wait_applied(*source.whole);
    wait_applied(*source.sharded);
  }

  static Pose pose_of(const Walker& walker) { return {.position = walker.position, .rotation = walker.rotation}; }

  static nanoseconds next_instant(const Source& source) { return std::max(wire_now(), source.instant + 1ms); }

  void flush(Source& source) {
    source.instant = next_instant(source);
    flush_both(source);
  }

  static void flush_both(Source& source) {
    value_of(source.whole->flush(source.instant), "flush");
    value_of(source.sharded->flush(source.instant), "flush");
  }

  static nanoseconds wire_now() { return std::chrono::system_clock::now().time_since_epoch(); }

  /// Goes on until so many borders were crossed, and until everything is decided and told up to a last instant, at which
  /// everything rests.
  void go_until(std::int64_t crossings) {
    go_while([&] { return crossings_ < crossings; });
  }

  template <class GoesOn>
  void go_while(const GoesOn& goes_on) {
    for (; goes_on(); ++ticks_) {
      tick_all();
      take();
      if (ticks_ % 20 == 0) wait_applied();
      if (ticks_ % 20 == 0 && shard_servers_.size() > map_.size()) ask_rays(*sharded_);
    }
    for (int i = 0; i < 2; ++i) {
      for (Source& source : sources_) tick(source, true);
    }
    wait_applied();
    const nanoseconds last = std::max(sources_[0].instant, sources_[1].instant);
    const auto is_settled = [&] {
      if (sharded_watch_->settled() >= last) return true;
      for (Source& source : sources_) flush(source);
      return false;
    };
    if (!wait_until(is_settled, kPatience, 20ms)) {
      std::printf("the shards do not decide up to the last instant\n");
      ++faults_;
    }
    quieten();
  }

  /// Splits a shard while everything goes on, and ends its server. Others are connected by the map of before then.
  void split(const std::string& file, const char* next, const std::string& next_file, const std::string& shard,
             const std::vector<std::string>& into, bool is_cut_short = false) {
    const std::string next_path = write(next, next_file);
    for (const std::string& name : into) start_shard(next_path, name);
    const ConnectOptions options{.domain = domain_, .name_space = "city", .wait = 20s};
    struct CutShort : std::exception {};
    auto done = std::async(std::launch::async, [&] {
      // As one that dies when everything is ready for the next map: it says so before it tells anybody.
      const auto dies = [](const std::string& said) {
        if (said.starts_with("the next map holds")) throw CutShort();
      };
      try {
        if (is_cut_short)
          static_cast<void>(
              split_shard(folder_.path() + '/' + file, next_path, options, {.patience = kPatience, .said = dies}));
      } catch (const CutShort&) { std::printf("  cut short\n"); }
      return split_shard(
          folder_.path() + '/' + file, next_path, options,
          {.patience = kPatience, .said = [](const std::string& said) { std::printf("  %s\n", said.c_str()); }});
    });
    // At the pace of publishers, since what takes time here are waits.
    go_while([&] { return done.wait_for(kTick) != std::future_status::ready; });
    const Result<ShardSplitReport> report = done.get();
    if (!report) {
      std::printf("split: %s\n", report.error().message.c_str());
      ++faults_;
      return;
    }
    std::printf("  split %s: %llu objects, %zu watches, %.1f s\n", shard.c_str(),
                static_cast<unsigned long long>(report->objects), report->watches,
                std::chrono::duration<double>(report->took).count());
    shard_servers_.at(shard)->signal(SIGTERM);
    shard_servers_.at(shard)->wait(10s);
    ShardedClient late = value_of(
        ShardedClient::connect(folder_.path() + '/' + file, {.domain = domain_, .name_space = "city", .wait = 2s}),
        "connect");
    if (late.shards().size() != sharded_->shards().size()) ++faults_;
    for (int i = 0; i < 20; ++i) ask_rays(late);
    compare();
  }

  /// About an instant that every shard has decided, and of the one server about the same.
  void ask_rays(ShardedClient& client) {
    std::uniform_real_distribution<> somewhere(-1.3 * kRange, 1.3 * kRange);
    std::vector<RayQuestion> rays(20);
    for (RayQuestion& ray : rays) {
      ray.origin = Vec3(somewhere(random_), somewhere(random_), 0.6);
      ray.direction = Vec3(somewhere(random_), somewhere(random_), somewhere(random_) / 8);
    }
    const Result<Answers> sharded = client.ask(rays, {.timeout = kPatience, .as_of = {.kind = Instant::Kind::settled}});
    const Instant then{.kind = Instant::Kind::at, .time = sharded ? sharded->world_time : nanoseconds(0)};
    const Result<Answers> whole = whole_->ask(rays, {.timeout = kPatience, .as_of = then});
    if (!sharded || !whole) {
      if (++differing_answers_ <= kMostShown)
        std::printf("a question failed: %s\n", (sharded ? whole : sharded).error().message.c_str());
      return;
    }
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Answer& one = whole->answers[i];
      const Answer& all = sharded->answers[i];
      ++ray_count_;
      hit_count_ += one.verdict == Verdict::hit ? 1 : 0;
      undecided_count_ += one.verdict == Verdict::undecided ? 1 : 0;
      if (are_equal(one, all)) continue;
      if (++differing_answers_ > kMostShown) continue;
      std::printf("a ray differs: verdict %d reason %d, of the shards %d reason %d\n", static_cast<int>(one.verdict),
                  static_cast<int>(one.reason), static_cast<int>(all.verdict), static_cast<int>(all.reason));
    }
  }

  void tick_all() {
    for (Source& source : sources_) {
      if (ticks_ % source.period == 0) tick(source);
    }
  }

  void tick(Source& source, bool rests = false) {
    std::vector<std::pair<const Walker*, Pose>> went;  // from where
    for (Walker& walker : source.walkers) {
      // Some rest for a while, as things do.
      if (rests || random_() % 8 == 0) continue;
      const std::size_t before = owner(walker);
      went.emplace_back(&walker, pose_of(walker));
      walker.go(random_);
      crossings_ += owner(walker) != before ? 1 : 0;
      value_of(source.whole->move(walker.whole, pose_of(walker)), "move");
    }
    const nanoseconds from = source.instant;
    source.instant = next_instant(source);
    if (cuts_ && !rests && source.instant - from < kLongestCut) go_part_of_the_way(source, went, from);
    for (const auto& [walker, before] : went) value_of(source.sharded->move(walker->sharded, pose_of(*walker)), "move");
    flush_both(source);
  }

  void go_part_of_the_way(Source& source, const std::vector<std::pair<const Walker*, Pose>>& went, nanoseconds from) {
    const auto whole_ns = static_cast<double>((source.instant - from).count());
    const nanoseconds cut(std::uniform_int_distribution<std::int64_t>(1, (source.instant - from).count() - 1)(random_));
    const double share = static_cast<double>(cut.count()) / whole_ns;
    for (const auto& [walker, before] : went) {
      const Vec3 way = walker->position - before.position;
      const Pose there{.position = before.position + share * way,
                       .rotation = before.rotation.slerp(share, walker->rotation)};
      value_of(source.sharded->move(walker->sharded, there), "move");
    }
    value_of(source.sharded->flush(from + cut), "flush");
    ++cut_count_;
  }

  std::size_t owner(const Walker& walker) const {
    return map_.owner_of({walker.position.x(), walker.position.y(), walker.position.z()});
  }

  void wait_applied() {
    for (Source& source : sources_) {
      wait_applied(*source.whole);
      wait_applied(*source.sharded);
    }
    take();
  }

  /// A server that is short of time is silent for a moment, and so is a shard that is being replaced.
  template <class AnyPublisher>
  static void wait_applied(AnyPublisher& publisher) {
    Result<void> applied;
    const auto is_over = [&] {
      applied = publisher.wait_applied(kPatience);
      return applied || applied.error().code != ErrorCode::disconnected;
    };
    wait_until(is_over, kPatience);
    value_of(applied, "wait");
  }

  void take() {
    while (const std::optional<Event> event = whole_watch_->next(0s)) {
      note(*event, whole_told_);
      ++whole_count_;
    }
    while (const std::optional<Event> event = sharded_watch_->next(0s)) {
      note(*event, sharded_told_);
      if (happened(*event) + 2ns < newest_) ++out_of_order_;
      newest_ = std::max(newest_, happened(*event));
    }
  }

  /// Until nothing has come for a while, which is long beside a step and two rounds of the watch.
  void quieten() {
    std::size_t count = 0;
    do {
      count = whole_count_;
      std::this_thread::sleep_for(500ms);
      take();
    } while (count != whole_count_);
  }

  void compare() {
    for (const auto& [names, whole] : whole_told_) compare(names, whole, sharded_told_[names]);
    for (const auto& [names, sharded] : sharded_told_) {
      if (!whole_told_.contains(names)) compare(names, {}, sharded);
    }
    whole_told_.clear();
    sharded_told_.clear();
  }

  void compare(const std::pair<std::string, std::string>& names, const std::vector<ToldEvent>& whole,
               const std::vector<ToldEvent>& sharded) {
    std::size_t i = 0;
    std::size_t j = 0;
    const auto is_same = [](const ToldEvent& a, const ToldEvent& b) {
      // Each server's time is rounded once, and within its bracket.
      const nanoseconds apart = std::max(a.bracket, b.bracket) + 2ns;
      return a.kind == b.kind && a.reason == b.reason && a.at - b.at <= apart && b.at - a.at <= apart;
    };
    while (i < whole.size() || j < sharded.size()) {
      if (i < whole.size() && j < sharded.size() && is_same(whole[i], sharded[j])) {
        // The numbers are those of the poses up to which a server has come when it finds the event.
        if (std::abs(whole[i].depth_m - sharded[j].depth_m) > whole[i].depth_error_m + sharded[j].depth_error_m)
          ++at_another_step_;
        ++i;
        ++j;
        continue;
      }
      const bool both = i < whole.size() && j < sharded.size();
      if (both && whole[i].kind == sharded[j].kind) {
        say(names, "differs", &whole[i++], &sharded[j++], differing_);
      } else if (j == sharded.size() || (both && whole[i].at <= sharded[j].at)) {
        say(names, "lost", &whole[i++], nullptr, lost_);
      } else {
        say(names, "extra", nullptr, &sharded[j++], extra_);
      }
    }
  }

  void say(const std::pair<std::string, std::string>& names, const char* what, const ToldEvent* whole,
           const ToldEvent* sharded, int& count) {
    if (++count > kMostShown) return;
    const auto words = [&](const ToldEvent* told) {
      if (told == nullptr) return std::string("-");
      char text[200];
      std::snprintf(text, sizeof(text), "kind %d reason %d at %.9f s before the end, at (%.3f %.3f %.3f)",
                    static_cast<int>(told->kind), static_cast<int>(told->reason),
                    std::chrono::duration<double>(sources_[0].instant - told->at).count(), told->point.x(),
                    told->point.y(), told->point.z());
      return std::string(text);
    };
    std::printf("%s and %s: %s: one server: %s; shards: %s\n", names.first.c_str(), names.second.c_str(), what,
                words(whole).c_str(), words(sharded).c_str());
  }

  const std::string server_;
  std::mt19937_64 random_;
  const int domain_;
  const int kills_;
  const bool cuts_;
  const shards::ShardMap map_ = shards::ShardMap::parse(kMap);
  ScratchFolder folder_;
  std::unique_ptr<ChildProcess> whole_server_;
  std::map<std::string, std::unique_ptr<ChildProcess>> shard_servers_;
  int started_ = 0;
  std::optional<Client> whole_;
  std::optional<ShardedClient> sharded_;
  std::optional<Watch> whole_watch_;
  std::optional<ShardedWatch> sharded_watch_;
  std::vector<Source> sources_;
  int slow_ = 0;         // publisher
  int slow_period_ = 1;  // ticks
  Told whole_told_;
  Told sharded_told_;
  std::size_t whole_count_ = 0;
  std::int64_t crossings_ = 0;
  std::int64_t ticks_ = 0;
  nanoseconds newest_{0};
  std::int64_t cut_count_ = 0;
  int killed_ = 0;
  std::int64_t crossed_amid_kills_ = 0;
  int asked_ = 0;
  int undecided_ = 0;
  int unanswered_ = 0;
  int wrong_ = 0;
  int faults_ = 0;
  int lost_ = 0;
  int extra_ = 0;
  int differing_ = 0;
  int out_of_order_ = 0;
  int at_another_step_ = 0;
  int ray_count_ = 0;
  int hit_count_ = 0;
  int undecided_count_ = 0;
  int differing_answers_ = 0;
};

}  // namespace
}  // namespace collided::testing_support

int main(int count, char** words) {
  if (count < 3) {
    std::fprintf(stderr, "usage: border_crossings SERVER CROSSINGS [SEED [SPLITS [KILLS [CUTS]]]]\n");
    return 2;
  }
  const std::uint64_t seed = count > 3 ? std::strtoull(words[3], nullptr, 10) : 28;
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
  const int splits = count > 4 ? std::atoi(words[4]) : 0;
  const int kills = count > 5 ? std::atoi(words[5]) : 0;
  collided::testing_support::BorderCrossings crossings(words[1], seed, kills, count > 6 && std::atoi(words[6]) != 0);
  return crossings.run(std::strtoll(words[2], nullptr, 10), splits) == 0 ? 0 : 1;
}
