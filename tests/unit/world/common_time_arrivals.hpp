#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/world/fences/fences.hpp"
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

/// An event as a subscriber receives it, in the publishers' time.
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

/// The owner of a body that stands still: the server's own, and in no batch.
inline constexpr std::size_t kStanding = static_cast<std::size_t>(-1);

/// What a world has besides its bodies, and what batches contain.
struct Setting {
  std::optional<FenceDefinition> standing = {};  // a fence, margin or nearest; its events are noted, and no contacts
  std::uint32_t group = 0;                       // of all bodies; other than 0: contacts of two are ignored
  std::size_t copies = 1;    // primitives of a body, in one place: several do not count as one convex body
  bool is_streamed = false;  // each body comes at its own times, and a missing pose does not mean rest
  bool sends_rests = false;  // a batch contains bodies that have not moved since the batch before
  bool sends_firsts = true;  // a body's first pose is sent, although it was defined there
};

/// Publishers' batches as they come to the engine; publisher k has the bodies with owner k. Body i is named "body<i>".
class Arrivals {
 public:
  /// Called with each event.
  using Note = std::function<void(const World&, const Event&, const Told&)>;

  explicit Arrivals(std::vector<std::pair<std::size_t, MovingBody>> bodies, Setting setting = {})
      : bodies_(std::move(bodies)), setting_(std::move(setting)) {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      if (bodies_[i].first == kStanding) continue;
      for (const Instant& instant : bodies_[i].second.instants)
        batches_[bodies_[i].first][instant.time_ns].push_back(i);
    }
  }

  /// The publisher of each batch, in a random order.
  std::vector<std::size_t> shuffled(std::mt19937_64& random) const {
    std::vector<std::size_t> order;
    for (const auto& [publisher, batches] : batches_) order.insert(order.end(), batches.size(), publisher);
    std::shuffle(order.begin(), order.end(), random);
    return order;
  }

  /// All events by pair, or by body and fence. order: the publisher of each batch.
  Story tell(const std::vector<std::size_t>& order, std::mt19937_64& random, double step_chance) const {
    Story story;
    run(order, random, step_chance, [&](const World& world, const Event& event, const Told& told) {
      story[world.info(event.of.a)->name + " " + world.info(event.of.b)->name].push_back(told);
    });
    return story;
  }

  /// The world steps after a batch with that chance, and before a batch that moves a body for the second time.
  void run(const std::vector<std::size_t>& order, std::mt19937_64& random, double step_chance, const Note& note) const {
    World world{WorldOptions{}};
    const std::vector<ObjectId> ids = defined(world);
    std::int64_t now_ns = kStart;
    std::uint64_t last_sequence = 0;
    const auto step = [&] {
      EXPECT_TRUE(world.step(++now_ns, 1, {}));
      EXPECT_TRUE(setting_.group == 0 || world.events().empty());
      bool is_joined = false;
      for (const Event& event : setting_.standing ? world.fences()->events() : world.events()) {
        EXPECT_EQ(event.sequence, is_joined ? last_sequence : ++last_sequence);
        is_joined = event.joins_next;
        note(world, event, told_of(event, now_ns));
      }
      EXPECT_FALSE(is_joined);
    };
    step();
    std::map<std::size_t, std::map<std::int64_t, std::vector<std::size_t>>::const_iterator> next;
    for (const auto& [publisher, batches] : batches_) next[publisher] = batches.begin();
    for (const std::size_t publisher : order) {
      const auto& [time_ns, members] = *next[publisher]++;
      std::vector<ObjectId> moved_ids;
      std::vector<Pose> poses;
      for (const std::size_t i : members) {
        const std::optional<Vec3> at = sent(bodies_[i].second.instants, time_ns);
        if (!at) continue;
        moved_ids.push_back(ids[i]);
        poses.push_back({.position = *at});
      }
      if (std::any_of(moved_ids.begin(), moved_ids.end(), [&](ObjectId id) { return world.has_moved(id); })) step();
      std::array<bool, 64> moved{};
      world.move(moved_ids, poses, time_ns, false, std::span(moved).first(moved_ids.size()), setting_.is_streamed);
      world.advance(publisher + 1, time_ns);
      if (std::bernoulli_distribution(step_chance)(random)) step();
    }
    step();
  }

 private:
  std::vector<ObjectId> defined(World& world) const {
    std::vector<ObjectId> ids;
    for (const auto& [owner, body] : bodies_) {
      ObjectDefinition definition;
      definition.name = "body" + std::to_string(ids.size());
      definition.shape = shape_of(body);
      definition.shape.primitives.resize(setting_.copies, definition.shape.primitives.front());
      definition.publisher = owner == kStanding ? 0 : owner + 1;
      definition.moving = owner != kStanding;
      definition.pose.position = body.instants.front().position;
      definition.filter.group = setting_.group;
      ids.push_back(std::get<ObjectId>(world.define(definition)));
    }
    EXPECT_TRUE(!setting_.standing || std::holds_alternative<ObjectId>(world.add_fence(*setting_.standing)));
    return ids;
  }

  /// The position that the batch of that time has of a body, if any.
  std::optional<Vec3> sent(const std::vector<Instant>& instants, std::int64_t time_ns) const {
    const auto at =
        std::find_if(instants.begin(), instants.end(), [&](const Instant& x) { return x.time_ns == time_ns; });
    const bool is_rest = at == instants.begin() ? !setting_.sends_firsts : at->position == std::prev(at)->position;
    return is_rest && !setting_.sends_rests ? std::nullopt : std::optional(at->position);
  }

  static Told told_of(const Event& event, std::int64_t now_ns) {
    const auto time = [&](double seconds_ago) { return now_ns - std::llround(seconds_ago * 1e9); };
    Told told{.kind = event.kind,
              .reason = event.reason,
              .low_ns = time(event.bracket_low_s),
              .high_ns = time(event.bracket_high_s)};
    told.depth_bits = std::bit_cast<std::uint64_t>(event.of.contact.depth_m);
    for (int k = 0; k < 3; ++k) {
      told.velocity_bits[static_cast<std::size_t>(k)] = std::bit_cast<std::uint64_t>(event.relative_velocity[k] + 0.0);
    }
    return told;
  }

  std::vector<std::pair<std::size_t, MovingBody>> bodies_;
  Setting setting_;
  std::map<std::size_t, std::map<std::int64_t, std::vector<std::size_t>>> batches_;  // by publisher, by time
};

/// Each `began` with the `ended` that follows it.
template <typename Reported>
std::vector<oracle::ToldMeeting> meetings_of(const std::vector<Reported>& events) {
  std::vector<oracle::ToldMeeting> meetings;
  for (const Told& event : events) {
    if (event.kind == EventKind::began) meetings.push_back({.began = {event.low_ns, event.high_ns}, .ended = {}});
    else meetings.back().ended = {event.low_ns, event.high_ns};
  }
  return meetings;
}

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
