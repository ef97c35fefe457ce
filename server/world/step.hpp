#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "server/world/sweep.hpp"
#include "server/world/world_state.hpp"

namespace collided {

/// A step tests so many candidates for each contact that it may find: shapes that are apart cost time, never memory.
inline constexpr std::uint64_t kCandidatesAContact = 16;

/// Candidates that wait while what their first test needs comes from memory: neighbours in space are strangers there.
struct WaitingCandidates {
  static constexpr std::size_t kSize = 32;
  std::array<std::pair<std::uint32_t, std::uint32_t>, kSize> pairs;
  std::size_t count = 0;
};

/// Movers such that each pair to be tested has one of them: those that moved, or all of them where something that does
/// not move was placed.
struct Lookers {
  std::vector<std::uint32_t> slots;
  bool all = false;
};

/// One step at work: the writer's state, the snapshot that is being filled, and what subscribers want.
struct Step {
  World::State& s;
  Snapshot& next;
  StepWishes wishes;
  std::int64_t world_time_ns;
  WalkCost walk;
  WaitingCandidates waiting{};

  // collision_step.cpp: from the last state to the next
  void end_removed();
  void fill_snapshot();
  void index_movers();
  void report(ObjectId a, ObjectId b, const Touch& touch, const SweptTouch* sweep, std::uint32_t mover);
  void set_bracket(FoundContact& found, const SweptTouch* sweep, std::uint32_t mover) const;
  Vec3 velocity_at(const Vec3& point, std::uint32_t slot, double time) const;
  void end_parted();

  // step_static.cpp: movers against the scenes
  void moving_against_static();
  void test_scene(std::uint32_t mover, std::size_t scene_number);
  void test_mesh_against(const Placed& a, const StaticScene& scene);
  void sweep_scene_parts(std::uint32_t mover, const StaticScene& scene);
  void sweep_sphere_parts(const MovingSphere& way, const ObjectInfo& mover, const StaticScene& scene);
  bool is_sweepable(const ObjectInfo& mover, const StaticScene& scene, std::uint32_t part) const;
  SweptTouch& part_sweep(std::uint32_t part);

  // step_movers.cpp: movers against each other
  void moving_against_moving();
  Lookers movers_to_look() const;
  bool look_around(std::uint32_t mover, bool all_look);
  bool wait_for(std::uint32_t first, std::uint32_t second);
  bool consider_waiting();
  bool consider(std::uint32_t first, std::uint32_t second);
  bool stay_apart(std::uint32_t first, std::uint32_t second) const;
  void test_pair(std::uint32_t first, std::uint32_t second);
  void look_again_at_open();
  bool has_room() const {
    return s.cost.contacts < s.options.max_contacts &&
           s.cost.candidate_pairs < kCandidatesAContact * s.options.max_contacts;
  }

  // step_ways.cpp: what happens between two poses
  std::optional<MovingSphere> way_of(std::uint32_t slot) const;
  void set_ball(std::uint32_t slot, const std::optional<MovingSphere>& way);
  bool is_fast(std::uint32_t slot) const;
  BodyWay body_way(std::uint32_t slot) const;
  SweepOptions sweep_options(std::uint32_t mover) const;
  std::optional<SweptTouch> sweep_between(std::uint32_t first, std::uint32_t second, std::uint32_t& mover);
  std::optional<SweptTouch> sweep_sphere(std::uint32_t mover, std::uint32_t other);
  SweptTouch sweep_bodies(std::uint32_t first, std::uint32_t second);

  // step_gaps.cpp: meshes that need no test for a while
  void count_way(std::uint32_t slot);
  double gap_wanted_m(std::uint32_t slot) const;
  void look_for_gap(std::uint32_t first, std::uint32_t second);
  void look_for_gap(std::uint32_t mover, const StaticScene& scene, std::uint32_t partner);
  void remember_gap(std::uint32_t slot, std::uint32_t partner, double gap_m, bool there_is);
  bool is_bare_mesh(std::uint32_t slot) const {
    const ObjectInfo& info = *(*s.objects)[slot];
    return info.mesh && info.primitives.empty();
  }
  /// A scene's number where ApartMemory wants a slot.
  static std::uint32_t partner_of(std::size_t scene) {
    return wire_contract::kNoTriangle - static_cast<std::uint32_t>(scene);
  }

  bool has_moved(std::uint32_t slot) const { return s.motion[slot] != Motion::none; }
  Placed placed(std::uint32_t slot) const {
    return {.info = (*s.objects)[slot].get(), .frame = &s.frames[slot], .bounds = s.bounds[slot]};
  }
  bool has_lower_id(std::uint32_t slot, std::uint32_t than) const {
    return s.generations[slot] != s.generations[than] ? s.generations[slot] < s.generations[than] : slot < than;
  }
};

}  // namespace collided
