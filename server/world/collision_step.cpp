#include <algorithm>
#include <array>
#include <cassert>
#include <chrono>
#include <utility>

#include "server/exact_phase/ball_filter.hpp"
#include "server/geometry/float_environment.hpp"
#include "server/world/inner_edges.hpp"
#include "server/world/sweep.hpp"
#include "server/world/world_state.hpp"

namespace collided {
namespace {

using wire_contract::EndReason;
using wire_contract::kNoTriangle;

std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// With fewer movers than one in so many objects, each asks the grid for its own pairs. All pairs at once are cheaper by
/// the pair, but a hundred thousand resting objects in one place have five billion that nobody needs.
constexpr std::size_t kWalksForAllPairs = 16;

/// A step tests so many candidates for each contact that it may find: shapes that are apart cost time, never memory.
constexpr std::uint64_t kCandidatesAContact = 16;

/// An object that goes farther in a step than this share of its least width may leave behind what it passed through:
/// two that pass through each other go at least their two widths.
constexpr double kUnsweptShare = 0.5;

/// Tests that the sweep of one pair may take: some 20 ms, that the others wait for.
constexpr std::uint32_t kSweepTests = 10'000;

/// A gap is looked for that is used up after so many steps like this one, so that looking for it pays.
constexpr double kGapInSteps = 16;

/// Candidates that wait while what their first test needs comes from memory: neighbours in space are strangers there.
struct Waiting {
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
  Waiting waiting{};

  void end_removed();
  void fill_snapshot();
  void index_movers();
  void moving_against_static();
  void moving_against_moving();
  Lookers movers_to_look() const;
  bool look_around(std::uint32_t mover, bool all_look);
  bool wait_for(std::uint32_t first, std::uint32_t second);
  bool consider_waiting();
  bool consider(std::uint32_t first, std::uint32_t second);
  bool has_room() const;
  void look_again_at_open();
  void end_parted();

  bool has_moved(std::uint32_t slot) const { return s.motion[slot] != Motion::none; }
  Placed placed(std::uint32_t slot) const {
    return {.info = (*s.objects)[slot].get(), .frame = &s.frames[slot], .bounds = s.bounds[slot]};
  }
  std::optional<MovingSphere> way_of(std::uint32_t slot) const;
  void set_ball(std::uint32_t slot, const std::optional<MovingSphere>& way);
  bool stay_apart(std::uint32_t first, std::uint32_t second) const;
  bool has_lower_id(std::uint32_t slot, std::uint32_t than) const {
    return s.generations[slot] != s.generations[than] ? s.generations[slot] < s.generations[than] : slot < than;
  }
  bool is_bare_mesh(std::uint32_t slot) const {
    const ObjectInfo& info = *(*s.objects)[slot];
    return info.mesh && info.primitives.empty();
  }
  static std::uint32_t partner_of(std::size_t scene) { return kNoTriangle - static_cast<std::uint32_t>(scene); }
  void count_way(std::uint32_t slot);
  double gap_wanted_m(std::uint32_t slot) const;
  void look_for_gap(std::uint32_t first, std::uint32_t second);
  void look_for_gap(std::uint32_t mover, const StaticScene& scene, std::uint32_t partner);
  void remember_gap(std::uint32_t slot, std::uint32_t partner, double gap_m, bool there_is);
  bool is_fast(std::uint32_t slot) const;
  BodyWay body_way(std::uint32_t slot) const;
  SweepOptions sweep_options(std::uint32_t mover) const;
  std::optional<SweptTouch> sweep_between(std::uint32_t first, std::uint32_t second, std::uint32_t& mover);
  std::optional<SweptTouch> sweep_sphere(std::uint32_t mover, std::uint32_t other);
  SweptTouch sweep_bodies(std::uint32_t first, std::uint32_t second);
  void sweep_scene_parts(std::uint32_t mover, const StaticScene& scene);
  void sweep_sphere_parts(const MovingSphere& way, const ObjectInfo& mover, const StaticScene& scene);
  bool is_sweepable(const ObjectInfo& mover, const StaticScene& scene, std::uint32_t part) const;
  SweptTouch& part_sweep(std::uint32_t part);
  void test_pair(std::uint32_t first, std::uint32_t second);
  void test_scene(std::uint32_t mover, std::size_t scene_number);
  void test_mesh_against(const Placed& a, const StaticScene& scene);
  void report(ObjectId a, ObjectId b, const Touch& touch, const SweptTouch* sweep, std::uint32_t mover);
  void set_bracket(FoundContact& found, const SweptTouch* sweep, std::uint32_t mover) const;
  Vec3 velocity_at(const Vec3& point, std::uint32_t slot, double time) const;
};

/// Contacts of removed objects end before anything else is looked at: their slots may be used again from now on.
void Step::end_removed() {
  for (const auto& [id, reason] : s.removed) s.ledger.end_object(id, reason);
  s.removed.clear();
}

/// Only what changed since this ring state was last filled is copied: moving 100 of 100,000 objects costs 100 copies.
void Step::fill_snapshot() {
  for (const std::uint32_t slot : s.moved_slots) {
    s.changed[slot] = s.step_count;
    if (s.posed_ns[slot] == kPosedAtStep) s.posed_ns[slot] = world_time_ns;
  }
  const std::size_t known = next.changed.size();
  const std::size_t count = s.objects->size();
  next.poses.resize(count);
  next.frames.resize(count);
  next.bounds.resize(count);
  next.posed_ns.resize(count);
  next.stale.resize(count);
  next.changed.resize(count);
  for (std::size_t slot = 0; slot < count; ++slot) {
    if (slot < known && next.changed[slot] == s.changed[slot]) continue;
    next.poses[slot] = s.poses[slot];
    next.frames[slot] = s.frames[slot];
    next.bounds[slot] = s.bounds[slot];
    next.posed_ns[slot] = s.posed_ns[slot];
    next.stale[slot] = s.stale[slot];
    next.changed[slot] = s.changed[slot];
  }
  next.epoch = s.options.epoch;
  next.version = s.version;
  next.world_time_ns = world_time_ns;
  next.scenes = s.scenes;
  next.objects = s.objects;
  next.table_version = s.table_version;
  next.stale_count = s.stale_count;
  s.objects_shared = true;
}

/// The grid holds each mover's whole way since its last pose, so that pairs that met on the way are candidates.
void Step::index_movers() {
  if (s.moved_slots.empty() && s.ring.current().grid) {
    next.grid = s.ring.current().grid;
    return;
  }
  s.swept_bounds.assign(s.bounds.begin(), s.bounds.end());
  s.balls.resize(s.bounds.size());
  for (const std::uint32_t slot : s.moved_slots) {
    const std::optional<MovingSphere> way = way_of(slot);
    s.fast[slot] = is_fast(slot) ? 1 : 0;
    if (way) {
      s.swept_bounds[slot].extend(bounds(*way));
    } else if (s.fast[slot] != 0) {
      s.swept_bounds[slot].extend(bounds(*(*s.objects)[slot], body_way(slot), s.sizes[slot].reach_m));
    }
    set_ball(slot, way);
    count_way(slot);
  }
  if (!next.grid || next.grid.use_count() > 1) next.grid = std::make_shared<Grid>();
  next.grid->rebuild(s.swept_bounds);
}

/// What is remembered of meshes hangs on how far they go; that of a placed triangle is off by a rounding at either end.
void Step::count_way(std::uint32_t slot) {
  if (!(*s.objects)[slot] || !is_bare_mesh(slot)) return;
  if (s.motion[slot] != Motion::moved) {
    s.apart.placed(slot);
    return;
  }
  const double reach_m = (*s.objects)[slot]->mesh->radius_m;
  s.apart.moved(slot, longest_way_m(s.frames_before[slot], s.frames[slot], reach_m) * (1 + 0x1p-40) +
                          placement_slack(s.frames_before[slot], 0, reach_m) + placement_slack(s.frames[slot], 0, reach_m));
}

/// Of both together; not where one of them does not go on as it went.
double Step::gap_wanted_m(std::uint32_t slot) const {
  if (s.motion[slot] != Motion::moved) return 0;
  return kGapInSteps * longest_way_m(s.frames_before[slot], s.frames[slot], (*s.objects)[slot]->mesh->radius_m);
}

void Step::remember_gap(std::uint32_t slot, std::uint32_t partner, double gap_m, bool there_is) {
  if (there_is) s.apart.remember(slot, partner, gap_m);
  else s.apart.looked_in_vain(slot, partner);
}

void Step::look_for_gap(std::uint32_t first, std::uint32_t second) {
  const double gap_m = gap_wanted_m(first) + gap_wanted_m(second);
  if (!(gap_m > 0) || !s.apart.is_worth_looking(first, second)) return;
  bool there_is = true;
  const auto candidate = [](void* raw, std::uint32_t, std::uint32_t) { return *static_cast<bool*>(raw) = false; };
  walk_mesh_pairs(placed(first), placed(second), candidate, &there_is, walk, gap_m);
  remember_gap(first, second, gap_m, there_is);
}

void Step::look_for_gap(std::uint32_t mover, const StaticScene& scene, std::uint32_t partner) {
  const double gap_m = gap_wanted_m(mover);
  if (!(gap_m > 0) || !s.apart.is_worth_looking(mover, partner)) return;
  const ObjectInfo& info = *(*s.objects)[mover];
  bool there_is = true;
  const auto visit = [&](std::uint32_t triangle, const Triangle&, std::uint32_t, const Triangle&) {
    there_is = !may_meet(info.filter, scene.parts[scene.part_of(triangle)].filter);
    return there_is;
  };
  visit_scene_pairs(scene, *info.mesh, s.frames[mover], walk, visit, gap_m);
  remember_gap(mover, partner, gap_m, there_is);
}

/// The way of a lone sphere between its last two poses; nothing for other objects, new ones and teleported ones.
std::optional<MovingSphere> Step::way_of(std::uint32_t slot) const {
  const std::optional<Sphere>& sphere = s.lone_spheres[slot];
  if (!sphere || s.motion[slot] != Motion::moved) return std::nullopt;
  return MovingSphere{.start = place(s.frames_before[slot], sphere->center),
                      .end = place(s.frames[slot], sphere->center),
                      .radius_m = sphere->radius_m};
}

bool Step::is_fast(std::uint32_t slot) const {
  if (s.motion[slot] != Motion::moved) return false;
  const MoverSize& size = s.sizes[slot];
  return longest_way_m(s.frames_before[slot], s.frames[slot], size.reach_m) > kUnsweptShare * size.least_width_m;
}

/// The way of any object in this step; a lone sphere's is that of its centre.
BodyWay Step::body_way(std::uint32_t slot) const {
  const Frame& before = s.motion[slot] == Motion::moved ? s.frames_before[slot] : s.frames[slot];
  if (!s.lone_spheres[slot]) return {before, s.frames[slot]};
  BodyWay way{s.frames[slot], s.frames[slot]};
  const Vec3& center = s.lone_spheres[slot]->center;
  way.from.position = place(before, center) - (place(s.frames[slot], center) - s.frames[slot].position);
  way.travel = way.to.position - way.from.position;
  return way;
}

SweepOptions Step::sweep_options(std::uint32_t mover) const {
  const double way_s = static_cast<double>(s.posed_ns[mover] - s.posed_before_ns[mover]) * 1e-9;
  return {.width = std::clamp(s.options.sweep_width_s / way_s, 1e-12, 1e-3),
          .contacts = wishes.contacts,
          .most_tests = kSweepTests};
}

void Step::set_ball(std::uint32_t slot, const std::optional<MovingSphere>& way) {
  const std::optional<Sphere>& sphere = s.lone_spheres[slot];
  BallWay& ball = s.balls[slot];
  ball.radius_m = sphere ? sphere->radius_m : -1;
  if (!sphere) return;
  ball.end = way ? way->end : place(s.frames[slot], sphere->center);
  if (!way) return;
  ball.start = way->start;
  ball.displacement = s.frames[slot].position - s.frames_before[slot].position;
}

/// Two balls that certainly do not meet on their ways: most candidates, told from what lies in one place. The same way
/// as in sweep_between, which is exact for the rest.
bool Step::stay_apart(std::uint32_t first, std::uint32_t second) const {
  if (s.balls[first].radius_m < 0 || s.balls[second].radius_m < 0) return false;
  if (has_lower_id(second, first)) std::swap(first, second);
  const BallWay& a = s.balls[first];
  const BallWay& b = s.balls[second];
  MovingSphere way{.start = a.end, .end = a.end, .radius_m = a.radius_m};
  if (s.motion[first] != Motion::placed && s.motion[second] != Motion::placed) {
    if (s.motion[first] == Motion::moved) way.start = a.start;
    if (s.motion[second] == Motion::moved) way.start += b.displacement;
  }
  return kernel::surely_apart(way, {.center = b.end, .radius_m = b.radius_m});
}

void Step::moving_against_static() {
  for (const std::uint32_t slot : s.moved_slots) {
    for (std::size_t scene = 0; scene < s.scenes.size(); ++scene) {
      // Most movers of a large world are nowhere near a given scene.
      if (!overlaps(s.swept_bounds[slot], s.scenes[scene]->tree.bounds())) continue;
      const ObjectInfo* info = (*s.objects)[slot].get();
      if (info == nullptr || !info->moving) continue;
      if (!has_room()) {
        s.cost.truncated = true;
        return;
      }
      test_scene(slot, scene);
    }
  }
}

void Step::test_scene(std::uint32_t mover, std::size_t scene_number) {
  if (is_bare_mesh(mover) && s.apart.holds(mover, partner_of(scene_number))) {
    ++s.cost.kept_apart;
    return;
  }
  const StaticScene& scene = *s.scenes[scene_number];
  const Placed a = placed(mover);
  const auto allowed = [&](std::uint32_t part) { return may_meet(a.info->filter, scene.parts[part].filter); };
  s.part_touches.clear(wishes.contacts);
  const auto test = [&](const auto& part_of_a, std::uint32_t a_triangle) {
    visit_scene(scene, bounds(part_of_a), walk, allowed, [&](std::uint32_t triangle, std::uint32_t part, const Triangle& b) {
      Touch& touch = s.part_touches.of(part);
      if (!touch.done()) touch_parts(part_of_a, a_triangle, b, triangle - scene.parts[part].first_triangle, touch);
      return true;
    });
  };
  for (const Primitive& primitive : a.info->primitives) {
    std::visit([&](const auto& own) { test(place(*a.frame, own), kNoTriangle); }, primitive);
  }
  if (a.info->mesh && overlaps(a.bounds, scene.tree.bounds())) {
    test_mesh_against(a, scene);
  }
  s.part_sweeps.clear();
  if (const std::optional<MovingSphere> way = way_of(mover)) {
    sweep_sphere_parts(*way, *a.info, scene);
  } else if (s.fast[mover] != 0) {
    sweep_scene_parts(mover, scene);
  }
  // Parts that are met on the way but not at its end need a place in the list too.
  for (const PartSweep& sweep : s.part_sweeps) s.part_touches.of(sweep.part);
  for (PartTouch& found : s.part_touches.list()) {
    s.cost.exact_tests += found.touch.exact_tests;
    const auto sweep = std::find_if(s.part_sweeps.begin(), s.part_sweeps.end(),
                                    [&](const PartSweep& of) { return of.part == found.part; });
    report(a.info->id, scene.part_objects[found.part], found.touch,
           sweep != s.part_sweeps.end() ? &sweep->touch : nullptr, mover);
  }
  if (s.part_touches.list().empty() && is_bare_mesh(mover)) look_for_gap(mover, scene, partner_of(scene_number));
}

/// Contacts that hold need no time.
bool Step::is_sweepable(const ObjectInfo& mover, const StaticScene& scene, std::uint32_t part) const {
  const ObjectId id = scene.part_objects[part];
  return may_meet(mover.filter, scene.parts[part].filter) && !s.ledger.holds(std::min(mover.id, id), std::max(mover.id, id));
}

SweptTouch& Step::part_sweep(std::uint32_t part) {
  if (s.part_sweeps.empty() || s.part_sweeps.back().part != part) {
    const auto found = std::find_if(s.part_sweeps.begin(), s.part_sweeps.end(),
                                    [&](const PartSweep& sweep) { return sweep.part == part; });
    if (found != s.part_sweeps.end()) return found->touch;
    s.part_sweeps.push_back({.part = part, .touch = {}});
  }
  return s.part_sweeps.back().touch;
}

void Step::sweep_sphere_parts(const MovingSphere& way, const ObjectInfo& mover, const StaticScene& scene) {
  SphereSweep sweep{.mover = way, .width = s.options.sweep_width};
  visit_scene(scene, bounds(way), walk, [&](std::uint32_t part) { return is_sweepable(mover, scene, part); },
              [&](std::uint32_t triangle, std::uint32_t part, const Triangle& corners) {
                sweep.found = part_sweep(part);
                sweep_part(sweep, corners, triangle - scene.parts[part].first_triangle);
                part_sweep(part) = sweep.found;
                return true;
              });
}

void Step::sweep_scene_parts(std::uint32_t mover, const StaticScene& scene) {
  struct Context {
    Step& step;
    const ObjectInfo& mover;
    const StaticScene& scene;
  } context{*this, *(*s.objects)[mover], scene};
  const auto touch_of = [](void* raw, std::uint32_t triangle) -> SweptTouch* {
    const Context& c = *static_cast<Context*>(raw);
    const std::uint32_t part = c.scene.part_of(triangle);
    return c.step.is_sweepable(c.mover, c.scene, part) ? &c.step.part_sweep(part) : nullptr;
  };
  const SweptBody body(context.mover, body_way(mover));
  if (!sweep_scene(body, SweptBody(scene), sweep_options(mover), walk, touch_of, &context)) ++s.cost.sweeps_skipped;
  for (PartSweep& sweep : s.part_sweeps) sweep.touch.b_triangle -= sweep.touch.yes ? scene.parts[sweep.part].first_triangle : 0;
}

void Step::test_mesh_against(const Placed& a, const StaticScene& scene) {
  std::size_t open_parts = 0;
  for (const Part& part : scene.parts) open_parts += may_meet(a.info->filter, part.filter) ? 1 : 0;
  const auto visit = [&](std::uint32_t triangle, const Triangle& b, std::uint32_t a_triangle, const Triangle& own) {
    const std::uint32_t number = scene.part_of(triangle);
    const Part& part = scene.parts[number];
    if (!may_meet(a.info->filter, part.filter)) return true;
    Touch& touch = s.part_touches.of(number);
    if (touch.done()) return true;
    touch_parts(own, a_triangle, b, triangle - part.first_triangle, touch);
    if (touch.done()) --open_parts;
    return open_parts > 0;
  };
  visit_scene_pairs(scene, *a.info->mesh, *a.frame, walk, visit);
}

void Step::moving_against_moving() {
  const Lookers lookers = movers_to_look();
  if (lookers.slots.size() * kWalksForAllPairs < next.grid->size()) {
    for (const std::uint32_t slot : lookers.slots) {
      if (!look_around(slot, lookers.all)) return;
    }
    return;
  }
  const auto found = [](void* context, std::uint32_t first, std::uint32_t second) {
    return static_cast<Step*>(context)->wait_for(first, second);
  };
  next.grid->pairs(found, this, walk);
  consider_waiting();
}

Lookers Step::movers_to_look() const {
  Lookers lookers{.slots = {}, .all = s.looks_at_all};
  for (const std::uint32_t slot : s.moved_slots) {
    const ObjectInfo* info = (*s.objects)[slot].get();
    if (info == nullptr) continue;
    if (info->moving) {
      lookers.slots.push_back(slot);
    } else {
      lookers.all = true;
    }
  }
  if (!lookers.all) return lookers;
  lookers.slots.clear();
  for (std::uint32_t slot = 0; slot < s.objects->size(); ++slot) {
    if ((*s.objects)[slot] && (*s.objects)[slot]->moving) lookers.slots.push_back(slot);
  }
  return lookers;
}

/// The pairs of one mover; those of two that both look are left to the lower slot. False: there is no room for more.
bool Step::look_around(std::uint32_t mover, bool all_look) {
  struct Context {
    Step& step;
    std::uint32_t mover;
    bool all_look;
  } context{*this, mover, all_look};
  const auto found = [](void* raw, std::uint32_t other) {
    const Context& c = *static_cast<Context*>(raw);
    const bool looks_too = (*c.step.s.objects)[other]->moving && (c.all_look || c.step.has_moved(other));
    return other == c.mover || (looks_too && other < c.mover) || c.step.consider(c.mover, other);
  };
  next.grid->walk_box(s.swept_bounds[mover], found, &context, walk);
  return !s.cost.truncated;
}

/// False: there is no room for more, the search is over.
bool Step::wait_for(std::uint32_t first, std::uint32_t second) {
  for (const std::uint32_t slot : {first, second}) {
    const auto* ball = reinterpret_cast<const char*>(&s.balls[slot]);
    __builtin_prefetch(ball);
    __builtin_prefetch(ball + sizeof(BallWay) - 1);
  }
  waiting.pairs[waiting.count++] = {first, second};
  return waiting.count < Waiting::kSize || consider_waiting();
}

bool Step::consider_waiting() {
  const std::size_t count = std::exchange(waiting.count, 0);
  for (std::size_t i = 0; i < count; ++i) {
    if (!consider(waiting.pairs[i].first, waiting.pairs[i].second)) return false;
  }
  return true;
}

bool Step::consider(std::uint32_t first, std::uint32_t second) {
  if (!has_moved(first) && !has_moved(second) && !s.looks_at_all) return true;
  if (has_room() && stay_apart(first, second)) {
    ++s.cost.candidate_pairs;
    return true;
  }
  const ObjectInfo& a = *(*s.objects)[first];
  const ObjectInfo& b = *(*s.objects)[second];
  if (!(a.moving || b.moving) || !may_meet(a.filter, b.filter)) return true;
  s.cost.truncated = s.cost.truncated || !has_room();
  if (!s.cost.truncated) test_pair(first, second);
  return !s.cost.truncated;
}

bool Step::has_room() const {
  return s.cost.contacts < s.options.max_contacts &&
         s.cost.candidate_pairs < kCandidatesAContact * s.options.max_contacts;
}

/// A search that was cut short says nothing about contacts that it did not come to: each is tested by itself.
void Step::look_again_at_open() {
  for (std::size_t i = 0; i < s.ledger.open().size(); ++i) {
    if (s.ledger.found(i)) continue;
    const std::uint32_t a = slot_of(s.ledger.open()[i].a);
    const std::uint32_t b = slot_of(s.ledger.open()[i].b);
    if (!has_moved(a) && !has_moved(b)) continue;
    const bool a_is_part = (*s.objects)[a]->scene_part != kNoTriangle;
    const bool b_is_part = (*s.objects)[b]->scene_part != kNoTriangle;
    if (!a_is_part && !b_is_part) {
      test_pair(a, b);
      continue;
    }
    for (std::size_t scene = 0; scene < s.scenes.size(); ++scene) {
      if (s.scenes[scene]->name == (*s.objects)[a_is_part ? a : b]->scene) test_scene(a_is_part ? b : a, scene);
    }
  }
}

void Step::test_pair(std::uint32_t first, std::uint32_t second) {
  ++s.cost.candidate_pairs;
  // Lower id first: the contact's normal points from a to b.
  if ((*s.objects)[second]->id < (*s.objects)[first]->id) std::swap(first, second);
  const bool are_meshes = is_bare_mesh(first) && is_bare_mesh(second);
  if (are_meshes && s.apart.holds(first, second)) {
    ++s.cost.kept_apart;
    return;
  }
  const Placed a = placed(first);
  const Placed b = placed(second);
  Touch touch;
  touch.wanted = wishes.contacts;
  if (overlaps(a.bounds, b.bounds)) touch_objects(a, b, touch, walk);
  s.cost.exact_tests += touch.exact_tests;
  std::optional<SweptTouch> sweep;
  std::uint32_t mover = first;
  if (!s.ledger.holds(a.info->id, b.info->id)) sweep = sweep_between(first, second, mover);
  report(a.info->id, b.info->id, touch, sweep ? &*sweep : nullptr, has_moved(mover) ? mover : first + second - mover);
  if (are_meshes && touch.exact_tests == 0 && overlaps(a.bounds, b.bounds)) look_for_gap(first, second);
}

/// A lone sphere is swept whatever its speed, exactly, past anything that does not turn fast; other pairs where one of
/// the two is fast.
std::optional<SweptTouch> Step::sweep_between(std::uint32_t first, std::uint32_t second, std::uint32_t& mover) {
  if (s.motion[first] == Motion::placed || s.motion[second] == Motion::placed) return std::nullopt;
  const auto turns_fast = [&](std::uint32_t slot) {
    return s.fast[slot] != 0 && !s.lone_spheres[slot] && s.frames_before[slot].rotation != s.frames[slot].rotation;
  };
  if (!turns_fast(first) && !turns_fast(second)) {
    if (std::optional<SweptTouch> found = sweep_sphere(first, second)) return found;
    mover = second;
    if (const std::optional<SweptTouch> found = sweep_sphere(second, first)) return turned_round(*found);
  }
  mover = s.fast[first] != 0 ? first : second;
  if (s.fast[mover] == 0) return std::nullopt;
  return sweep_bodies(first, second);
}

SweptTouch Step::sweep_bodies(std::uint32_t first, std::uint32_t second) {
  SweptTouch touch;
  const SweptBody a(*(*s.objects)[first], body_way(first));
  const SweptBody b(*(*s.objects)[second], body_way(second));
  sweep(a, b, sweep_options(s.fast[first] != 0 ? first : second), walk, touch);
  return touch;
}

/// The mover's way as seen from the other object, which keeps its last orientation: its displacement is taken off.
std::optional<SweptTouch> Step::sweep_sphere(std::uint32_t mover, std::uint32_t other) {
  const std::optional<Sphere>& sphere = s.lone_spheres[mover];
  if (!sphere) return std::nullopt;
  const bool other_moved = s.motion[other] == Motion::moved;
  const Frame& before = s.motion[mover] == Motion::moved ? s.frames_before[mover] : s.frames[mover];
  SphereSweep sweep{.mover = {.start = place(before, sphere->center),
                        .end = place(s.frames[mover], sphere->center),
                        .radius_m = sphere->radius_m},
              .width = s.options.sweep_width};
  if (other_moved) sweep.mover.start += s.frames[other].position - s.frames_before[other].position;
  sweep_object(sweep, placed(other), walk);
  return sweep.found;
}

/// For contacts first, for the time between: began now, began and parted on the way, or nothing new.
void Step::report(ObjectId a, ObjectId b, const Touch& touch, const SweptTouch* sweep, std::uint32_t mover) {
  if (sweep != nullptr) {
    ++s.cost.swept;
    s.cost.exact_tests += sweep->exact_tests;
    if (sweep->undecided && !sweep->yes && !touch.yes) ++s.cost.sweeps_skipped;
  }
  if (touch.undecided && !touch.yes) ++s.cost.undecided;
  const bool passed = sweep != nullptr && sweep->yes && !touch.yes;
  if (!touch.yes && !passed) return;
  if (s.cost.truncated && !s.ledger.holds(std::min(a, b), std::max(a, b))) return;
  ++s.cost.contacts;
  FoundContact found{.a = a, .b = b, .a_triangle = touch.a_triangle, .b_triangle = touch.b_triangle,
                     .contact = passed ? sweep->contact : touch.contact};
  if (passed) {
    found.a_triangle = sweep->a_triangle;
    found.b_triangle = sweep->b_triangle;
  }
  if (found.b < found.a) {
    std::swap(found.a, found.b);
    std::swap(found.a_triangle, found.b_triangle);
    found.contact.normal = -found.contact.normal;
  }
  set_bracket(found, sweep, mover);
  const bool is_told = wishes.persisted || !s.ledger.holds(found.a, found.b);
  if (wishes.contacts && is_told) {
    const double time = passed ? sweep->bracket.high : 1;
    const Vec3& point = found.contact.point;
    found.relative_velocity = velocity_at(point, slot_of(found.b), time) - velocity_at(point, slot_of(found.a), time);
  }
  if (passed) {
    s.ledger.touched_and_parted(found);
  } else {
    s.ledger.touches(found);
  }
}

void Step::set_bracket(FoundContact& found, const SweptTouch* sweep, std::uint32_t mover) const {
  const double end_s = static_cast<double>(world_time_ns - s.posed_ns[mover]) * 1e-9;
  const double way_s = s.motion[mover] == Motion::moved
                           ? static_cast<double>(s.posed_ns[mover] - s.posed_before_ns[mover]) * 1e-9
                           : 0.0;
  const bool timed = sweep != nullptr && sweep->yes;
  found.bracket_low_s = std::max(0.0, end_s + way_s * (timed ? 1 - sweep->bracket.low : 1.0));
  found.bracket_high_s = std::max(0.0, end_s + way_s * (timed ? 1 - sweep->bracket.high : 0.0));
}

/// Of the object's point that is there at that time of its last way, m/s.
Vec3 Step::velocity_at(const Vec3& point, std::uint32_t slot, double time) const {
  const std::int64_t way_ns = s.posed_ns[slot] - s.posed_before_ns[slot];
  if (s.has_way[slot] == 0 || way_ns <= 0 || s.posed_before_ns[slot] == kPosedAtStep) return Vec3::Zero();
  // Whoever has not moved in this step is still under way for as long again as its last way took.
  if (!has_moved(slot) && world_time_ns - s.posed_ns[slot] > way_ns) return Vec3::Zero();
  const BodyWay way(s.frames_before[slot], s.frames[slot]);
  const Vec3 origin = has_moved(slot) ? way.at(time).position : way.to.position;
  const Vec3 turn = way.turn_rad * way.axis;
  return (way.travel + turn.cross(point - origin)) / (static_cast<double>(way_ns) * 1e-9);
}

/// A contact that was not found again although one of the two moved is over.
void Step::end_parted() {
  const auto reason = [&](const OpenContact& contact) {
    const Motion a = s.motion[slot_of(contact.a)];
    const Motion b = s.motion[slot_of(contact.b)];
    if (a == Motion::none && b == Motion::none) return EndReason::none;
    return std::max(a, b) == Motion::placed ? EndReason::teleported : EndReason::separated;
  };
  s.ledger.end_unfound(reason, static_cast<double>(world_time_ns - s.last_step_ns) * 1e-9);
}

}  // namespace

bool World::step(std::int64_t world_time_ns, std::uint64_t batches, const StepWishes& wishes) {
  const OwnFloatEnvironment own_floats;
  State& s = *state_;
  Snapshot* next = s.ring.writable();
  if (next == nullptr) return false;
  const std::int64_t started = now_ns();
  s.version += batches;
  ++s.step_count;
  s.cost = {.moved = static_cast<std::uint32_t>(s.moved_slots.size())};
  s.ledger.begin_step(world_time_ns, wishes.persisted);

  Step step{.s = s, .next = *next, .wishes = wishes, .world_time_ns = world_time_ns, .walk = {}};
  step.end_removed();
  step.fill_snapshot();
  const std::int64_t updated = now_ns();
  step.index_movers();
  const std::int64_t indexed = now_ns();
  if (!s.moved_slots.empty()) {
    step.moving_against_static();
    if (!s.cost.truncated) step.moving_against_moving();
    if (s.cost.truncated) step.look_again_at_open();
    step.end_parted();
    if (wishes.contacts) correct_inner_edges(s);
    s.looks_at_all = s.cost.truncated;
  } else {
    s.cost.truncated = s.looks_at_all;
  }
  next->contacts_truncated = s.cost.truncated;
  s.ledger.finish_step();
  s.apart.end_step();
  s.ring.publish();

  for (const std::uint32_t slot : s.moved_slots) {
    s.motion[slot] = Motion::none;
    s.fast[slot] = 0;
  }
  s.moved_slots.clear();
  s.free_slots.insert(s.free_slots.end(), s.freed_this_step.begin(), s.freed_this_step.end());
  s.freed_this_step.clear();
  s.last_step_ns = world_time_ns;
  s.cost.update_ns = updated - started;
  s.cost.broad_ns = indexed - updated;
  s.cost.exact_ns = now_ns() - indexed;
  return true;
}

}  // namespace collided
