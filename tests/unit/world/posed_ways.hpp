#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "server/world/fences/fences.hpp"
#include "server/world/objects/indexed_mesh.hpp"
#include "server/world/solids/solid.hpp"
#include "server/world/world.hpp"

namespace collided::engine {

/// An object's pose at a time, nanoseconds since the begin of the story.
struct PoseAt {
  std::int64_t time_ns = 0;
  Pose pose;
};

/// An object with all its poses, in order. Publisher 0: the server's own, with one pose.
struct Actor {
  std::string name;
  Shape shape;
  std::uint64_t publisher = 1;
  std::vector<PoseAt> poses;
  bool is_solid = false;
  bool is_moving = true;
};

/// What happens to a pair, in order, with the bracket in nanoseconds since the begin of the story.
struct PairEvent {
  EventKind kind = EventKind::began;
  EndReason reason = EndReason::none;
  Doubt doubt = Doubt::none;
  std::int64_t low_ns = 0;
  std::int64_t high_ns = 0;
  std::uint64_t sequence = 0;
};
using PairEvents = std::map<std::string, std::vector<PairEvent>>;  // by "name name" in order of ids

inline constexpr std::int64_t kStoryBegin_ns = 1'000'000'000'000;

/// Has a world decide the actors' ways; each publisher's batches arrive in order of time, and those of one time before the
/// same step.
inline PairEvents story_of(const std::vector<Actor>& actors, const WorldOptions& options = {},
                           const std::vector<FenceDefinition>& fences = {}) {
  World world(options);
  std::vector<ObjectId> ids;
  // What is there before its publisher's first instant moves from that instant on.
  std::int64_t now_ns = kStoryBegin_ns - 1000;
  for (const Actor& actor : actors) {
    ObjectDefinition definition{.name = actor.name,
                                .scene = {},
                                .shape = actor.shape,
                                .pose = actor.poses.front().pose,
                                .filter = {},
                                .moving = actor.is_moving,
                                .publisher = actor.publisher};
    if (actor.shape.mesh) {
      definition.indexed = indexed_mesh(definition.shape.mesh,
                                        Bvh::build(*actor.shape.mesh, {.threads = 1, .progress = {}, .cancelled = {}}));
      SolidFindings findings;
      if (actor.is_solid) definition.solid = solid_within(definition.indexed, findings);
      EXPECT_EQ(definition.solid != nullptr, actor.is_solid) << findings.refusal;
    }
    ids.push_back(std::get<ObjectId>(world.define(definition)));
  }
  for (const FenceDefinition& fence : fences) EXPECT_TRUE(std::holds_alternative<ObjectId>(world.add_fence(fence)));
  PairEvents story;
  const auto step = [&] {
    EXPECT_TRUE(world.step(now_ns, 1, {}));
    const auto note = [&](const Event& event, const std::string& of_b) {
      const auto time = [&](double ago_s) { return now_ns - kStoryBegin_ns - std::llround(ago_s * 1e9); };
      story[world.info(event.of.a)->name + " " + of_b].push_back({.kind = event.kind,
                                                                  .reason = event.reason,
                                                                  .doubt = event.of.doubt,
                                                                  .low_ns = time(event.bracket_low_s),
                                                                  .high_ns = time(event.bracket_high_s),
                                                                  .sequence = event.sequence});
    };
    for (const Event& event : world.events()) note(event, world.info(event.of.b)->name);
    if (world.fences() == nullptr) return;
    for (const Event& event : world.fences()->events()) note(event, world.fences()->table().name(slot_of(event.of.b)));
  };
  step();
  std::map<std::int64_t, std::map<std::uint64_t, std::vector<std::size_t>>> batches;
  std::map<std::pair<std::size_t, std::int64_t>, Pose> pose_of;
  for (std::size_t i = 0; i < actors.size(); ++i) {
    if (actors[i].publisher == 0) continue;
    for (const PoseAt& at : actors[i].poses) {
      batches[at.time_ns][actors[i].publisher].push_back(i);
      pose_of[{i, at.time_ns}] = at.pose;
    }
  }
  for (const auto& [time_ns, publishers] : batches) {
    for (const auto& [publisher, members] : publishers) {
      for (const std::size_t i : members)
        EXPECT_TRUE(world.move(ids[i], pose_of[{i, time_ns}], kStoryBegin_ns + time_ns, false));
      world.advance(publisher, kStoryBegin_ns + time_ns);
    }
    now_ns = kStoryBegin_ns + time_ns;
    step();
  }
  return story;
}

}  // namespace collided::engine
