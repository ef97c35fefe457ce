#pragma once

#include <cmath>
#include <cstdlib>
#include <memory>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "server/world/query/query.hpp"
#include "server/world/world.hpp"
#include "tests/studies/bench/clock.hpp"

namespace collided::bench {
using namespace engine;

/// A world of one publisher in which little changes at a time. Every call returns processor seconds.
class ChangingWorld {
 public:
  explicit ChangingWorld(std::size_t most) : world_({.max_objects = static_cast<std::uint32_t>(most)}) {}

 protected:
  void define(const std::string& name, const Primitive& shape, const Vec3& at, std::uint64_t publisher = 1) {
    ObjectDefinition definition{.name = name, .scene = "", .shape = {}, .pose = {}, .filter = {}};
    definition.shape.primitives = {shape};
    definition.pose.position = at;
    definition.publisher = publisher;
    poses_.push_back(definition.pose);
    ids_.push_back(std::get<ObjectId>(world_.define(definition)));
  }
  void step(std::uint64_t publishers = 1) {
    time_ns_ += kPeriodNs;
    for (std::uint64_t publisher = 1; publisher <= publishers; ++publisher) world_.advance(publisher, time_ns_);
    if (!world_.step(time_ns_, 1, {})) std::abort();
  }
  template <class Work>
  static double seconds_of(const Work& work) {
    const double started = thread_seconds();
    work();
    return thread_seconds() - started;
  }

  static constexpr std::int64_t kPeriodNs = 10'000'000;  // 100 Hz

  World world_;
  std::vector<ObjectId> ids_;
  std::vector<Pose> poses_;
  std::int64_t time_ns_ = 1'000'000'000'000;
};

/// Balls with names like paths, far apart, of which some join and leave; rays ask all of them, or those of a pattern.
class JoiningCrowd : public ChangingWorld {
 public:
  JoiningCrowd(std::size_t count, std::mt19937_64 random)
      : ChangingWorld(2 * count + 100'000), random_(random), side_m_(10 * std::cbrt(static_cast<double>(count))) {
    for (std::size_t i = 0; i < count; ++i) join_one();
    step();
    // The next step indexes them anew where they are now.
    join();
    ask({});
  }
  /// One joins, the world steps, and a ray asks.
  double join() {
    return seconds_of([&] {
      join_one();
      step();
      ask({});
    });
  }
  /// The one that joined last leaves, the world steps, and a ray asks.
  double leave() {
    return seconds_of([&] {
      if (!world_.remove(ids_.back(), EndReason::removed)) std::abort();
      ids_.pop_back();
      step();
      ask({});
    });
  }
  /// A ray for each of two patterns.
  double ask_in_turn() {
    return seconds_of([&] {
      ask("fleet/*/cart1*");
      ask("fleet/*/cart2*");
    });
  }
  /// The first ray of a pattern after one has joined.
  double ask_after_join() {
    ask("fleet/*/cart1*");
    join_one();
    step();
    return seconds_of([&] { ask("fleet/*/cart1*"); });
  }

 private:
  void join_one() {
    std::uniform_real_distribution<double> along(0, side_m_);
    const double x = along(random_), y = along(random_), z = along(random_);
    const std::string number = std::to_string(joined_++);
    define("fleet/row" + number.substr(0, 1) + "/cart" + number, Sphere{Vec3::Zero(), 0.5}, {x, y, z});
  }
  void ask(std::string_view only) {
    const double ray[] = {0.4 * side_m_, 0.6 * side_m_, 2 * side_m_, 0, 0, -1, 4 * side_m_};
    Questions asked;
    asked.only = only;
    asked.numbers = ray;
    const SnapshotRing::Lease state = world_.newest();
    answer(*state, asked, answers_, scratch_);
  }

  std::mt19937_64 random_;
  double side_m_;
  std::size_t joined_ = 0;
  Answers answers_;
  QueryScratch scratch_;
};

/// Boxes that all touch each other.
class BoxPile : public ChangingWorld {
 public:
  BoxPile(std::size_t count, std::mt19937_64 random) : ChangingWorld(count) {
    std::uniform_real_distribution<double> along(0, 1);
    for (std::size_t i = 0; i < count; ++i) {
      const double x = along(random), y = along(random), z = along(random);
      define("box " + std::to_string(i), Box{.center = Vec3::Zero(), .half_m = Vec3::Ones()}, {x, y, z});
    }
    step();
    move_one();
  }
  /// One of them moves by a millimetre, and the world steps.
  double move_one() {
    poses_[0].position.x() += 0.001;
    return seconds_of([&] {
      if (!world_.move(ids_[0], poses_[0], time_ns_ + kPeriodNs, false)) std::abort();
      step();
    });
  }
};

}  // namespace collided::bench
