#include "server/world/step/candidates.hpp"

#include <algorithm>
#include <utility>

#include "server/world/step/long_ways.hpp"

namespace collided::engine {
namespace {

/// With fewer query movers than one in this many objects, each queries the grid for its own pairs. Finding all pairs at
/// once is cheaper per pair, but a hundred thousand resting objects in one place have five billion pairs that no
/// decision needs.
constexpr std::size_t kWalksForAllPairs = 16;

}  // namespace

void Candidates::decide_scenes() {
  for (const std::uint32_t slot : rows_.moved()) {
    for (std::size_t scene = 0; scene < step_.scenes.size(); ++scene) {
      // Most movers of a large world are nowhere near a given scene.
      if (!overlaps(step_.motion.bounds()[slot], step_.scenes[scene]->tree.bounds())) continue;
      const ObjectInfo* info = rows_.info(slot);
      if (info == nullptr || !info->moving) continue;
      const bool goes_on = is_shared_ ? shared_->add({.first = slot, .scene = static_cast<std::uint32_t>(scene)})
                                      : decide_scene(slot, scene);
      if (!goes_on) return;
    }
  }
  // Whether further pairs are examined depends on what was found.
  if (is_shared_) shared_->settle();
}

/// False: there is no room for its findings.
bool Candidates::decide_scene(std::uint32_t mover, std::size_t scene) {
  if (!decisions_.has_room()) {
    cost_.truncated = true;
    return false;
  }
  decisions_.decide_scene(mover, scene);
  decided_ += kSceneWeight;
  look_whether_worth_sharing();
  return true;
}

bool Candidates::decide(std::span<const StepItem> items) {
  for (const StepItem& item : items) {
    const bool goes_on =
        item.scene == StepItem::kPair ? wait_for(item.first, item.second) : decide_scene(item.first, item.scene);
    if (!goes_on) return false;
  }
  return consider_waiting();
}

void Candidates::decide_pairs(const Grid& grid) {
  const QueryMovers query_movers = find_query_movers();
  if (query_movers.slots.size() * kWalksForAllPairs < grid.size()) {
    for (const std::uint32_t slot : query_movers.slots) {
      if (!look_around(grid, slot, query_movers.all)) return;
    }
    if (consider_waiting() && is_shared_) shared_->settle();
    return;
  }
  const auto found = [&](std::uint32_t first, std::uint32_t second) { return wait_for(first, second); };
  LongWays long_ways(step_);
  const std::uint32_t parts = long_ways.part_count(grid.size());
  if (parts > 1) long_ways.pairs(parts, found, walk_);
  else grid.pairs(found, walk_);
  if (consider_waiting() && is_shared_) shared_->settle();
}

Candidates::QueryMovers Candidates::find_query_movers() const {
  QueryMovers query_movers{.slots = {}, .all = step_.looks_at_all};
  for (const std::uint32_t slot : rows_.moved()) {
    const ObjectInfo* info = rows_.info(slot);
    if (info == nullptr) continue;
    if (info->moving) {
      query_movers.slots.push_back(slot);
    } else {
      query_movers.all = true;
    }
  }
  if (!query_movers.all) {
    const auto add = [&](std::uint32_t slot) {
      if (!rows_.has_moved(slot)) query_movers.slots.push_back(slot);
    };
    // Objects with undecided time look for partners even if they did not move in this step.
    std::for_each(step_.motion.young().begin(), step_.motion.young().end(), add);
    const std::vector<std::uint32_t>& travelling = step_.motion.history().travelling();
    std::for_each(travelling.begin(), travelling.end(), add);
    return query_movers;
  }
  query_movers.slots.clear();
  for (std::uint32_t slot = 0; slot < rows_.size(); ++slot) {
    if (rows_.info(slot) != nullptr && rows_.info(slot)->moving) query_movers.slots.push_back(slot);
  }
  return query_movers;
}

/// Passes on the pairs of one mover; a pair of two query movers is left to the lower slot. False: there is no room for
/// more.
bool Candidates::look_around(const Grid& grid, std::uint32_t mover, bool all_look) {
  const auto found = [&](std::uint32_t other) {
    // Tests first what is near in memory: the descriptions of most others are not read yet.
    const bool looks_too =
        (all_look || rows_.has_moved(other) || step_.motion.is_open(other)) && rows_.info(other)->moving;
    return other == mover || (looks_too && other < mover) || wait_for(mover, other);
  };
  const std::optional<StraightWay> way = way_of(step_, mover);
  const std::uint32_t parts = way ? parts_of(*way) : 1;
  if (parts > 1) look_along(grid, *way, parts, found);
  else grid.walk_box(step_.motion.bounds()[mover], found, walk_);
  return !cost_.truncated;
}

/// Passes on what the parts of a long path meet, each once.
void Candidates::look_along(const Grid& grid, const StraightWay& way, std::uint32_t parts, Grid::BoxFound found) {
  bool goes_on = true;
  for (std::uint32_t part = 0; goes_on && part < parts; ++part) {
    const auto box_of = [&](std::uint32_t i) {
      return way.between(static_cast<double>(i) / parts, static_cast<double>(i + 1) / parts);
    };
    const auto found_here = [&](std::uint32_t other) {
      for (std::uint32_t earlier = 0; earlier < part; ++earlier) {
        if (overlaps(box_of(earlier), step_.motion.bounds()[other])) return true;
      }
      return goes_on = found(other);
    };
    grid.walk_box(box_of(part), found_here, walk_);
  }
}

/// Queues a pair and prefetches its data. False: there is no room for more, and the search ends.
bool Candidates::wait_for(std::uint32_t first, std::uint32_t second) {
  if (is_shared_) return shared_->add({.first = first, .second = second});
  for (const std::uint32_t slot : {first, second}) {
    const auto* ball = reinterpret_cast<const char*>(&step_.motion.ball(slot));
    __builtin_prefetch(ball);
    __builtin_prefetch(ball + sizeof(BallMotion) - 1);
  }
  waiting_.pairs[waiting_.count++] = {first, second};
  return waiting_.count < Waiting::kSize || consider_waiting();
}

/// Passes on the queued pairs; false as in wait_for().
bool Candidates::consider_waiting() {
  const std::size_t count = std::exchange(waiting_.count, 0);
  // Balls are mostly decided by prefetched data; for all others a decision reads rows, descriptions and contacts.
  const auto are_balls_of = [&](std::size_t i) { return are_balls(waiting_.pairs[i].first, waiting_.pairs[i].second); };
  for (std::size_t i = 0; i < count; ++i) {
    if (!are_balls_of(i)) decisions_.prefetch_pair(waiting_.pairs[i].first, waiting_.pairs[i].second);
  }
  for (std::size_t i = 0; i < count; ++i) {
    for (const std::uint32_t slot : {waiting_.pairs[i].first, waiting_.pairs[i].second}) {
      if (step_.motion.ball(slot).radius_m >= 0) continue;
      rows_.prefetch(slot);
      step_.motion.prefetch_bounds(slot);
      __builtin_prefetch(rows_.info(slot));
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (!are_balls_of(i)) decisions_.prefetch_contact(waiting_.pairs[i].first, waiting_.pairs[i].second);
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (!consider(waiting_.pairs[i].first, waiting_.pairs[i].second)) return false;
  }
  look_whether_worth_sharing();
  return true;
}

/// Decides a pair, unless neither side changed or a filter excludes it; false as in wait_for().
bool Candidates::consider(std::uint32_t first, std::uint32_t second) {
  const bool on_common_time = step_.sources.need_common_time() && decisions_.are_on_common_time(first, second);
  if (!on_common_time && !rows_.has_moved(first) && !rows_.has_moved(second) && !step_.looks_at_all) return true;
  if (!on_common_time && decisions_.has_room() && decisions_.stay_apart(first, second)) {
    ++cost_.candidate_pairs;
    return true;
  }
  const ObjectInfo& a = *rows_.info(first);
  const ObjectInfo& b = *rows_.info(second);
  if (!(a.moving || b.moving)) return true;
  if (!may_meet(a, b)) {
    ++cost_.filtered;
    return true;
  }
  cost_.truncated = cost_.truncated || !decisions_.has_room();
  if (cost_.truncated) return false;
  if (shared_ != nullptr) decided_ += are_balls(first, second) ? 1 : a.mesh && b.mesh ? kMeshWeight : kShapeWeight;
  if (on_common_time) {
    decisions_.decide_on_common_time(first, second);
  } else {
    decisions_.decide_pair(first, second);
  }
  return !cost_.truncated;
}

}  // namespace collided::engine
