#include <utility>

#include "server/exact_phase/ball_filter.hpp"
#include "server/world/step.hpp"

namespace collided {
namespace {

using wire_contract::kNoTriangle;

/// With fewer movers than one in so many objects, each asks the grid for its own pairs. All pairs at once are cheaper by
/// the pair, but a hundred thousand resting objects in one place have five billion that nobody needs.
constexpr std::size_t kWalksForAllPairs = 16;

}  // namespace

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
  return waiting.count < WaitingCandidates::kSize || consider_waiting();
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
  if (!(a.moving || b.moving)) return true;
  if (!may_meet(a.filter, b.filter)) {
    ++s.cost.filtered;
    return true;
  }
  s.cost.truncated = s.cost.truncated || !has_room();
  if (!s.cost.truncated) test_pair(first, second);
  return !s.cost.truncated;
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

}  // namespace collided
