#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "server/world/world.hpp"
#include "tests/oracle/meeting_oracle.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine {

using oracle::Instant;
using oracle::MovingBody;

inline constexpr std::int64_t kStart = 1'000'000'000'000;
inline constexpr std::int64_t kMs = 1'000'000;

inline Shape shape_of(const MovingBody& body) {
  Shape shape;
  if (const double* radius = std::get_if<double>(&body.form)) {
    shape.primitives.emplace_back(Sphere{Vec3::Zero(), *radius});
  } else {
    shape.primitives.emplace_back(Box{.center = Vec3::Zero(), .half_m = std::get<Vec3>(body.form)});
  }
  return shape;
}

/// An event as a subscriber knows it, in the publishers' time.
struct Told {
  EventKind kind = EventKind::began;
  EndReason reason = EndReason::none;
  std::int64_t low_ns = 0;
  std::int64_t high_ns = 0;
  std::uint64_t depth_bits = 0;
  std::array<std::uint64_t, 3> velocity_bits{};
  bool operator==(const Told&) const = default;
};

using Story = std::map<std::string, std::vector<Told>>;  // by pair

/// Publishers' batches as they come to the engine; publisher k has the bodies with owner k.
class Arrivals {
 public:
  explicit Arrivals(std::vector<std::pair<std::size_t, MovingBody>> bodies, bool streamed = false)
      : bodies_(std::move(bodies)), streamed_(streamed) {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      for (const Instant& instant : bodies_[i].second.instants)
        batches_[bodies_[i].first][instant.time_ns].push_back(i);
    }
  }

  std::vector<std::size_t> publishers() const {
    std::vector<std::size_t> all;
    for (const auto& [publisher, batches] : batches_) all.insert(all.end(), batches.size(), publisher);
    return all;
  }

  /// order: whose next batch comes; a step after a batch where the generator says so, and where an object would move twice.
  Story tell(const std::vector<std::size_t>& order, std::mt19937_64& random, double step_chance) {
    World world{WorldOptions{}};
    std::vector<ObjectId> ids;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      ObjectDefinition definition;
      definition.name = "body" + std::to_string(i);
      definition.shape = shape_of(bodies_[i].second);
      definition.publisher = bodies_[i].first + 1;
      definition.pose.position = bodies_[i].second.instants.front().position;
      ids.push_back(std::get<ObjectId>(world.define(definition)));
    }
    Story story;
    std::int64_t now_ns = kStart;
    const auto step = [&] {
      EXPECT_TRUE(world.step(++now_ns, 1, {}));
      for (const Event& event : world.events()) note(world, event, now_ns, story);
    };
    step();
    std::map<std::size_t, std::map<std::int64_t, std::vector<std::size_t>>::const_iterator> next;
    for (const auto& [publisher, batches] : batches_) next[publisher] = batches.begin();
    for (const std::size_t publisher : order) {
      const auto& [time_ns, members] = *next[publisher]++;
      if (std::any_of(members.begin(), members.end(), [&](std::size_t i) { return world.has_moved(ids[i]); })) step();
      give(world, ids, publisher, time_ns, members);
      if (std::bernoulli_distribution(step_chance)(random)) step();
    }
    step();
    return story;
  }

 private:
  void give(World& world, const std::vector<ObjectId>& ids, std::size_t publisher, std::int64_t time_ns,
            const std::vector<std::size_t>& members) {
    std::vector<ObjectId> moved_ids;
    std::vector<Pose> poses;
    for (const std::size_t i : members) {
      const auto& instants = bodies_[i].second.instants;
      const auto at =
          std::find_if(instants.begin(), instants.end(), [&](const Instant& x) { return x.time_ns == time_ns; });
      // Who rests may be left out.
      if (at != instants.begin() && at->position == std::prev(at)->position) continue;
      moved_ids.push_back(ids[i]);
      poses.push_back({.position = at->position});
    }
    std::array<bool, 64> moved{};
    world.move(moved_ids, poses, time_ns, false, std::span(moved).first(moved_ids.size()), streamed_);
    world.advance(publisher + 1, time_ns);
  }

  static void note(const World& world, const Event& event, std::int64_t now_ns, Story& story) {
    const auto time = [&](double seconds_ago) { return now_ns - std::llround(seconds_ago * 1e9); };
    Told told{.kind = event.kind,
              .reason = event.reason,
              .low_ns = time(event.bracket_low_s),
              .high_ns = time(event.bracket_high_s)};
    told.depth_bits = std::bit_cast<std::uint64_t>(event.of.contact.depth_m);
    for (int k = 0; k < 3; ++k) {
      told.velocity_bits[static_cast<std::size_t>(k)] = std::bit_cast<std::uint64_t>(event.relative_velocity[k] + 0.0);
    }
    story[world.info(event.of.a)->name + " " + world.info(event.of.b)->name].push_back(told);
  }

  std::vector<std::pair<std::size_t, MovingBody>> bodies_;
  bool streamed_;
  std::map<std::size_t, std::map<std::int64_t, std::vector<std::size_t>>> batches_;  // by publisher, by time
};

/// Straight through `at` with that velocity (m/s) at `through_ns`, posed every period from kStart + phase.
inline MovingBody flight(double radius_m, const Vec3& at, const Vec3& velocity, std::int64_t through_ns,
                         std::int64_t phase_ns, std::int64_t period_ns, int count) {
  MovingBody body{.form = radius_m, .instants = {}};
  for (int i = 0; i < count; ++i) {
    const std::int64_t time_ns = kStart + phase_ns + i * period_ns;
    body.instants.push_back({time_ns, at + velocity * (1e-9 * static_cast<double>(time_ns - through_ns))});
  }
  return body;
}

inline std::vector<Told> only_story(const Story& story) {
  EXPECT_EQ(story.size(), 1u);
  return story.empty() ? std::vector<Told>() : story.begin()->second;
}

inline Story two_flights(const MovingBody& a, const MovingBody& b, double step_chance = 1) {
  Arrivals arrivals({{0, a}, {1, b}});
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < a.instants.size(); ++i) order.insert(order.end(), {0, 1});
  std::mt19937_64 random(1);
  return arrivals.tell(order, random, step_chance);
}

}  // namespace collided::engine
