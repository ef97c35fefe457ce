#include "tests/studies/bench/whole_steps.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <variant>
#include <vector>

#include "server/broad_phase/grid/grid.hpp"
#include "server/world/world.hpp"
#include "tests/studies/bench/clock.hpp"
#include "tests/studies/bench/movers.hpp"
#include "tests/studies/bench/peers/step_peers.hpp"

namespace collided::bench {
using namespace engine;
namespace {

constexpr std::int64_t kPeriodNs = 10'000'000;  // 100 Hz
constexpr double kTurn_rad = 0.02;              // a step, at most
constexpr std::size_t kResting = 100'000;
constexpr double kRestingVolume_m3 = 2.7;  // a body: some 205,000 contacts
constexpr std::size_t kFew = 100;
constexpr std::size_t kLargestUnasked = 100'000;  // more with --only 'all move'

struct Crowd {
  const char* name;
  const char* arrangement;
  bool are_balls;
  bool turn;
};
constexpr Crowd kCrowds[] = {{"balls", "uniform", true, false},
                             {"boxes", "uniform", false, false},
                             {"boxes, turning", "uniform", false, true},
                             {"balls, clustered", "clustered", true, false},
                             {"boxes, clustered", "clustered", false, false},
                             {"balls, one giant", "one giant", true, false},
                             {"boxes, one giant", "one giant", false, false}};

/// Poses that depend on nothing but the number of steps, so that all methods that made as many steps are at the same.
class PosesOfCrowd {
 public:
  PosesOfCrowd(const Movers& movers, bool turn, std::mt19937_64& random) : movers_(movers), turn_(turn) {
    std::uniform_real_distribution<double> part(-1, 1);
    for (std::size_t i = 0; i < movers_.boxes().size(); ++i) {
      const double w = part(random), x = part(random), y = part(random), z = part(random);
      poses_.push_back({.position = Vec3::Zero(), .rotation = Quat(1 + w, x, y, z).normalized()});
      turns_.emplace_back(Eigen::AngleAxisd(kTurn_rad * w, Vec3(x, y, z + 2).normalized()));
    }
    // The giant is a box around the whole crowd, or the ball in it: as a turned box it would be a corner in a corner.
    if (!poses_.empty() && is_giant()) poses_.front().rotation.setIdentity(), turns_.front().setIdentity();
    take_places();
  }
  void step() {
    movers_.step();
    if (turn_) {
      for (std::size_t i = 0; i < poses_.size(); ++i)
        poses_[i].rotation = (poses_[i].rotation * turns_[i]).normalized();
    }
    take_places();
  }
  std::span<const Pose> poses() const { return poses_; }
  std::span<const Aabb> boxes() const { return movers_.boxes(); }

 private:
  bool is_giant() const {
    const Aabb& first = movers_.boxes().front();
    const Aabb& last = movers_.boxes().back();
    return (first.high - first.low).norm() > 2 * (last.high - last.low).norm();
  }
  void take_places() {
    for (std::size_t i = 0; i < poses_.size(); ++i)
      poses_[i].position = (movers_.boxes()[i].low + movers_.boxes()[i].high) / 2;
  }

  Movers movers_;
  bool turn_;
  std::vector<Pose> poses_;
  std::vector<Quat> turns_;
};

StepBodies bodies_of(const PosesOfCrowd& crowd, bool are_balls) {
  StepBodies bodies{.poses = {crowd.poses().begin(), crowd.poses().end()}, .moving = crowd.poses().size()};
  for (const Aabb& box : crowd.boxes()) {
    const Vec3 half = (box.high - box.low) / 2;
    if (are_balls) bodies.shapes.emplace_back(Sphere{Vec3::Zero(), half.x()});
    else bodies.shapes.emplace_back(Box{.center = Vec3::Zero(), .half_m = half});
  }
  return bodies;
}

/// Our world with a publisher of its own for the bodies that move.
class OurSteps final : public StepPeer {
 public:
  OurSteps(const StepBodies& bodies, StepOptions wanted)
      : wanted_(wanted), world_({.max_objects = static_cast<std::uint32_t>(bodies.shapes.size() + 10)}) {
    for (std::size_t i = 0; i < bodies.shapes.size(); ++i) {
      ObjectDefinition definition{
          .name = std::to_string(i), .scene = "", .shape = {}, .pose = bodies.poses[i], .filter = {}};
      definition.shape.primitives = {bodies.shapes[i]};
      definition.publisher = i < bodies.moving ? 1 : 0;
      const ObjectId id = std::get<ObjectId>(world_.define(definition));
      if (i < bodies.moving) ids_.push_back(id);
    }
    moved_ = std::make_unique<bool[]>(ids_.size());
    step_world();
  }
  std::string name() const override { return wanted_.contacts ? "collided" : "collided, yes or no"; }
  /// As the service does it: poses, the instant they are complete to, step.
  void step(std::span<const Pose> poses) override {
    time_ns_ += kPeriodNs;
    if (!ids_.empty()) {
      world_.move(ids_, poses.first(ids_.size()), time_ns_, false, std::span(moved_.get(), ids_.size()));
      world_.advance(1, time_ns_);
    }
    step_world();
  }
  std::size_t pairs() const override {
    const auto is_moving = [&](const OpenContact& open) {
      return slot_of(open.a) < ids_.size() || slot_of(open.b) < ids_.size();
    };
    return static_cast<std::size_t>(std::count_if(world_.contacts().begin(), world_.contacts().end(), is_moving));
  }
  const World& world() const { return world_; }

 private:
  void step_world() {
    if (!world_.step(time_ns_, 1, wanted_)) std::abort();
  }

  StepOptions wanted_;
  World world_;
  std::vector<ObjectId> ids_;
  std::unique_ptr<bool[]> moved_;
  std::int64_t time_ns_ = 1'000'000'000'000;
};

/// Bounds of the bodies as if they did not turn, without decisions, events or a snapshot: what the whole step adds to.
class BareIndex final : public StepPeer {
 public:
  explicit BareIndex(const StepBodies& bodies) {
    for (const Primitive& shape : bodies.shapes) {
      const auto* ball = std::get_if<Sphere>(&shape);
      half_m_.push_back(ball != nullptr ? Vec3::Constant(ball->radius_m) : std::get<Box>(shape).half_m);
    }
    boxes_.resize(half_m_.size());
  }
  std::string name() const override { return "collided, bare index"; }
  void step(std::span<const Pose> poses) override {
    for (std::size_t i = 0; i < boxes_.size(); ++i) {
      boxes_[i] = {poses[i].position - half_m_[i], poses[i].position + half_m_[i]};
    }
    grid_.rebuild(boxes_);
    pairs_ = 0;
    WalkCost cost;
    grid_.pairs([this](std::uint32_t, std::uint32_t) { return ++pairs_ > 0; }, cost);
  }
  std::size_t pairs() const override { return pairs_; }

 private:
  std::vector<Vec3> half_m_;
  std::vector<Aabb> boxes_;
  Grid grid_;
  std::size_t pairs_ = 0;
};

/// Ways of stepping, each with a copy of the crowd of its own.
class StepTable {
 public:
  StepTable(const PosesOfCrowd& crowd, int steps) : crowd_(crowd), steps_(steps) {}

  /// compares: its number of pairs means the same as ours, which comes first. A run before the measured ones counts.
  void add(const std::shared_ptr<StepPeer>& peer, bool compares = true) {
    const auto own_crowd = std::make_shared<PosesOfCrowd>(crowd_);
    std::size_t pairs = 0;
    for (int i = 0; i < steps_; ++i) {
      own_crowd->step();
      peer->step(own_crowd->poses());
      pairs += peer->pairs();
    }
    if (methods_.empty()) ours_ = pairs;
    const auto own_ns = [peer, own_crowd, steps = steps_] {
      double seconds = 0;
      for (int i = 0; i < steps; ++i) {
        own_crowd->step();
        const double started = thread_seconds();
        peer->step(own_crowd->poses());
        seconds += thread_seconds() - started;
      }
      return 1e9 * seconds / steps;
    };
    methods_.push_back({.name = peer->name(),
                        .own_ns = own_ns,
                        .equal = compares ? std::min(pairs, ours_) : 0,
                        .of = compares ? std::max(pairs, ours_) : 0});
  }
  void add_peers([[maybe_unused]] const StepBodies& bodies) {
#ifdef COLLIDED_BENCH_FCL
    add(fcl_steps(bodies, true));
    add(fcl_steps(bodies, false));
#endif
#ifdef COLLIDED_BENCH_BULLET
    add(bullet_steps(bodies));
#endif
  }
  void measure_as(const Options& options, Work work) {
    work.note = std::to_string(ours_ / static_cast<std::size_t>(steps_)) + " pairs a step" + work.note;
    measure(options, work, methods_);
  }

 private:
  const PosesOfCrowd& crowd_;
  int steps_;
  std::vector<Method> methods_;
  std::size_t ours_ = 0;
};

void run_crowd(const Options& options, const Crowd& kind, std::size_t count, std::mt19937_64& random) {
  if (!options.wants(kind.name, "all move")) return;
  const PosesOfCrowd crowd(Movers(count, kind.arrangement, Motion::flight, random), kind.turn, random);
  const StepBodies bodies = bodies_of(crowd, kind.are_balls);
  StepTable table(crowd, count > 10'000 ? 1 : 5);
  const auto whole = std::make_shared<OurSteps>(bodies, StepOptions{});
  table.add(whole);
  table.add(std::make_shared<OurSteps>(bodies, StepOptions{.contacts = false}));
  table.add(std::make_shared<BareIndex>(bodies), false);
  table.add_peers(bodies);
  table.measure_as(options, {.scene = kind.name, .size = count, .name = "all move"});
  const StepCost& cost = whole->world().cost();
  std::printf(
      "%s, %zu: %u candidates, %u exact tests, %u swept, %u undecided, %zu events; update %.2f, broad %.2f, exact %.2f "
      "ms\n",
      kind.name, count, cost.candidate_pairs, cost.exact_tests, cost.swept, cost.undecided,
      whole->world().events().size(), 1e-6 * static_cast<double>(cost.update_ns),
      1e-6 * static_cast<double>(cost.broad_ns), 1e-6 * static_cast<double>(cost.exact_ns));
}

/// Bodies at rest, touching each other all over, of which the first `moving` fly through the rest.
void run_resting(const Options& options, bool are_balls, std::size_t count, std::size_t moving,
                 std::mt19937_64& random) {
  const std::string scene = are_balls ? "balls at rest" : "boxes at rest";
  const std::string work = std::to_string(moving) + " move";
  if (!options.wants(scene, work)) return;
  const PosesOfCrowd crowd(Movers(count, "uniform", Motion::flight, random), false, random);
  StepBodies bodies = bodies_of(crowd, are_balls);
  const double growth = std::cbrt(10 / kRestingVolume_m3);  // Movers has ten cubic metres for each
  for (Primitive& shape : bodies.shapes) {
    if (auto* ball = std::get_if<Sphere>(&shape)) ball->radius_m *= growth;
    else std::get<Box>(shape).half_m *= growth;
  }
  bodies.moving = moving;
  StepTable table(crowd, moving == 0 ? 100 : 10);
  const auto whole = std::make_shared<OurSteps>(bodies, StepOptions{});
  const std::size_t at_rest = whole->world().contacts().size();
  table.add(whole);
  table.add_peers(bodies);
  table.measure_as(options,
                   {.scene = scene, .size = count, .name = work, .note = ", " + std::to_string(at_rest) + " contacts"});
}

}  // namespace

void run_whole_steps(const Options& options, std::mt19937_64& random) {
  for (const Crowd& kind : kCrowds) {
    for (const std::size_t count : {1'000, 10'000, 100'000, 1'000'000}) {
      if (count > (options.quick ? 1'000 : kLargestUnasked) && options.only != "all move") continue;
      run_crowd(options, kind, count, random);
    }
  }
  for (const std::size_t moving : {kFew, std::size_t{0}}) {
    for (const bool are_balls : {false, true})
      run_resting(options, are_balls, options.quick ? kResting / 10 : kResting, moving, random);
  }
}

}  // namespace collided::bench
