#include "server/world/query/pose_memory.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "idl/clocks.hpp"
#include "server/world/objects/contact_search.hpp"
#include "server/world/objects/object_rows.hpp"
#include "server/world/objects/column.hpp"
#include "server/world/objects/sources.hpp"
#include "server/world/step/step_motion.hpp"

namespace collided::engine {
namespace {

/// Two objects may have used one slot at the instant, if the later one's publisher lags in time: the second gets a new
/// slot.
std::uint32_t add_slot(std::vector<ObjectTable::Entry>& objects, Snapshot& state) {
  const auto slot = static_cast<std::uint32_t>(objects.size());
  objects.emplace_back();
  state.poses.resize(objects.size());
  state.frames.resize(objects.size());
  state.posed_ns.resize(objects.size());
  state.stale.resize(objects.size());
  return slot;
}

/// The same object under an id with another slot.
std::shared_ptr<const ObjectInfo> named_by_slot(const std::shared_ptr<const ObjectInfo>& info, std::uint32_t slot) {
  if (slot_of(info->id) == slot) return info;
  auto copy = std::make_shared<ObjectInfo>(*info);
  copy->id = info->id - slot_of(info->id) + slot;
  return copy;
}

}  // namespace

void PoseMemory::note(const Step& step) {
  if (!is_on()) return;
  const std::lock_guard lock(mutex_);
  const std::int64_t now_ns = step.snapshot.world_time_ns;
  if (to_ns_ == 0) from_ns_ = now_ns;
  to_ns_ = std::max(to_ns_, now_ns);
  epoch_ = step.snapshot.epoch;
  version_ = step.snapshot.version;
  stale_objects_ = step.stale_objects;
  covers_without_places_ = step.snapshot.covers_without_places;
  if (pair_rules_ != step.snapshot.pair_rules) pair_rules_ = step.snapshot.pair_rules;
  if (parents_ != step.snapshot.parents) parents_ = step.snapshot.parents;
  if (scenes_ != step.scenes || covers_ != step.snapshot.covers) {
    scenes_ = step.scenes;
    covers_ = step.snapshot.covers;
    from_ns_ = to_ns_;
  }
  move_floor();
  resize_column(lives_, step.rows.row_count());
  for (const std::uint32_t slot : step.rows.moved()) note_object(step, slot);
  forget_in_turn();
  sources_.resize(step.sources.size());
  for (std::uint32_t i = 0; i < step.sources.size(); ++i) {
    const Source& source = step.sources[i];
    sources_[i] = {.is_streamed = source.is_streamed,
                   .gap_ns = source.gap_ns,
                   .known_ns = source.known_ns,
                   .streamed_ns = source.streamed_ns};
  }
}

/// Moves the start of the reach: by age, and in small steps if the poses exceed the memory limit.
void PoseMemory::move_floor() {
  from_ns_ = std::max(from_ns_, to_ns_ - options_.reach_ns);
  if (is_over_limit()) from_ns_ += (to_ns_ - from_ns_) / 64;
  while (!gone_.empty() && gone_.front().gone_ns <= from_ns_) {
    move_count_ -= gone_.front().moves.size();
    gone_.pop_front();
  }
}

void PoseMemory::note_object(const Step& step, std::uint32_t slot) {
  Life& life = lives_[slot];
  const std::shared_ptr<const ObjectInfo>& info = step.rows.table()[slot];
  // Mostly it is the same info as before, which then needs no reading.
  if (life.info && life.info != info && (!info || info->id != life.info->id)) end(life);
  if (!info) return;
  const ObjectRow& row = step.rows[slot];
  if (!life.info) {
    const std::uint32_t source = step.rows.source(slot);
    life = {.info = info,
            .born_ns = source != Sources::kResting ? row.born_ns : to_ns_,
            .source = source,
            .first = row.pose,
            .moves = {},
            .pivots = {}};
  }
  life.source = step.rows.source(slot);  // an attached object has its parent's source
  if (!step.rows.is_posed(slot)) return;
  const bool has_source = life.source != Sources::kResting;
  const MotionTimes times =
      motion_times(row, step.rows.is_new(slot), has_source ? &step.sources[life.source] : nullptr);
  life.note_pivot(times.to_ns, step.rows.pivot(slot));
  add_move(life, {.from_ns = times.from_ns, .to_ns = times.to_ns, .pose = row.pose});
}

void PoseMemory::Life::note_pivot(std::int64_t to_ns, const Vec3& pivot) {
  constexpr std::size_t kMost = 64;  // an object is rarely attached more often within the memory's reach
  const Vec3 before = pivots.empty() ? Vec3::Zero() : pivots.back().point;
  if (before == pivot) return;
  if (pivots.size() == kMost) pivots.erase(pivots.begin());
  pivots.push_back({.from_ns = to_ns, .point = pivot});
}

Vec3 PoseMemory::Life::pivot_of(const Move& move) const {
  const auto later =
      std::find_if(pivots.begin(), pivots.end(), [&](const Pivot& pivot) { return pivot.from_ns > move.to_ns; });
  return later == pivots.begin() ? Vec3::Zero() : std::prev(later)->point;
}

/// A lone sphere's centre moves straight, unless it rotates about another point.
BodyMotion PoseMemory::motion_to(const Life& life, const Frame& before, const Move& move) {
  const Vec3 pivot = life.pivot_of(move);
  const std::optional<Sphere> ball = pivot.isZero(0) ? lone_sphere(*life.info) : std::nullopt;
  return motion_between(ball, before, frame_of(move.pose), pivot);
}

void PoseMemory::add_move(Life& life, const Move& move) {
  if (is_over_limit()) forget(life);
  else if (life.moves.is_full()) forget_blocks(life);
  const double travel_m = (move.pose.position - life.last().position).norm();
  const double motion_s = wire_contract::kNanosecond_s * static_cast<double>(move.to_ns - move.from_ns);
  if (motion_s > 0) life.largest_mps = std::max(life.largest_mps, travel_m / motion_s);
  life.moves.push_back(move);
  ++move_count_;
}

/// Forgets whole blocks of moves that ended before the reach. Searching for single ones at each move would load memory
/// into the cache that nothing else needs.
void PoseMemory::forget_blocks(Life& life) {
  for (const Move* end = life.moves.end_of_first_block(); end != nullptr && end->to_ns <= from_ns_;
       end = life.moves.end_of_first_block()) {
    life.first = end->pose;
    move_count_ -= life.moves.pop_block();
  }
}

/// Forgets moves that ended before the reach: the last of them becomes the object's first pose.
void PoseMemory::forget(Life& life) {
  for (; !life.moves.empty() && life.moves.front().to_ns <= from_ns_; --move_count_) {
    life.first = life.moves.front().pose;
    life.moves.pop_front();
  }
}

/// Forgets older moves that blocks still hold, and those of objects at rest, a few objects per step.
void PoseMemory::forget_in_turn() {
  const std::size_t count = std::min<std::size_t>(64, lives_.size());
  for (std::size_t i = 0; i < count; ++i, ++turn_) {
    if (turn_ >= lives_.size()) turn_ = 0;
    forget(lives_[turn_]);
  }
}

/// The object existed up to the time that its publisher had reached.
void PoseMemory::end(Life& life) {
  const bool has_source = life.source != Sources::kResting;
  life.gone_ns = has_source ? std::min(to_ns_, std::max(sources_[life.source].known_ns, life.last_ns()) + 1) : to_ns_;
  gone_.push_back(std::exchange(life, Life{}));
}

PoseMemory::Reach PoseMemory::reach() const {
  const std::lock_guard lock(mutex_);
  return {from_ns_, to_ns_};
}

std::size_t PoseMemory::bytes() const {
  const std::lock_guard lock(mutex_);
  return move_count_ * sizeof(Move);
}

std::shared_ptr<const Snapshot> PoseMemory::at(std::int64_t time_ns) const {
  auto state = std::make_shared<Snapshot>();
  {
    const std::lock_guard lock(mutex_);
    if (!is_on() || time_ns < from_ns_ || time_ns > to_ns_) return nullptr;
    state->epoch = epoch_;
    state->version = version_;
    state->world_time_ns = time_ns;
    state->scenes = scenes_;
    state->covers = covers_;
    state->covers_without_places = covers_without_places_;
    // Pair rules and attachments are not remembered: the present ones apply to any instant.
    state->pair_rules = pair_rules_;
    state->parents = parents_;
    state->poses.resize(lives_.size());
    state->frames.resize(lives_.size());
    state->posed_ns.resize(lives_.size());
    state->stale.resize(lives_.size());
    std::vector<ObjectTable::Entry> objects(lives_.size());
    const auto take = [&](const Life& life) {
      if (!life.was_there(time_ns)) return;
      std::uint32_t slot = slot_of(life.info->id);
      if (slot >= objects.size() || objects[slot]) slot = add_slot(objects, *state);
      objects[slot] = named_by_slot(life.info, slot);
      put(life, slot, time_ns, *state);
    };
    std::for_each(gone_.begin(), gone_.end(), take);
    std::for_each(lives_.begin(), lives_.end(), take);
    state->objects = ObjectTable(std::move(objects));
  }
  std::vector<Aabb> bounds(state->frames.size());
  for (std::size_t slot = 0; slot < state->frames.size(); ++slot) {
    bounds[slot] = state->bounds(static_cast<std::uint32_t>(slot));
  }
  state->grid = std::make_shared<Grid>();
  state->grid->rebuild(bounds);
  return state;
}

std::optional<PoseMemory::RememberedPath> PoseMemory::path_of(ObjectId id) const {
  const std::lock_guard lock(mutex_);
  const std::uint32_t slot = slot_of(id);
  if (!is_on() || slot >= lives_.size() || !lives_[slot].info || lives_[slot].info->id != id) return std::nullopt;
  const Life& life = lives_[slot];
  const bool is_resting = life.source == Sources::kResting;
  RememberedPath path{.from_ns = std::max(from_ns_, life.born_ns),
                      .to_ns = is_resting ? to_ns_ : std::min(to_ns_, known_of(life)),
                      .first = frame_of(life.first),
                      .pieces = {}};
  Frame before = path.first;
  life.moves.for_each([&](const Move& move) {
    path.pieces.push_back({.from_ns = move.from_ns, .to_ns = move.to_ns, .motion = motion_to(life, before, move)});
    before = frame_of(move.pose);
  });
  return path;
}

void PoseMemory::put(const Life& life, std::uint32_t slot, std::int64_t time_ns, Snapshot& state) const {
  state.frames[slot] = frame_at(life, time_ns);
  state.has_given_poses = false;
  state.poses[slot] = {.position = state.frames[slot].position, .rotation = Quat(state.frames[slot].rotation)};
  if (life.source == Sources::kResting) return;
  const std::int64_t known_ns = known_of(life);
  state.posed_ns[slot] = std::min(known_ns, time_ns);
  if (known_ns >= time_ns) return;
  state.stale[slot] = 1;
  state.stale_objects.push_back({.id = life.info->id - slot_of(life.info->id) + slot,
                                 .position = state.frames[slot].position,
                                 .reach_m = reach_of(*life.info),
                                 .speed_mps = life.largest_mps,
                                 .posed_ns = known_ns});
}

/// Nothing is known about a lost publisher's object after its last pose, and everything about a removed one.
std::int64_t PoseMemory::known_of(const Life& life) const {
  if (life.gone_ns != Life::kStillThere) return kForEver;
  for (const StaleObject& stale : stale_objects_) {
    if (stale.id == life.info->id) return stale.posed_ns;
  }
  const Known& known = sources_[life.source];
  if (!known.is_streamed) return known.known_ns;
  return std::max({life.last_ns(), known.known_ns - known.gap_ns, known.streamed_ns});
}

Frame PoseMemory::frame_at(const Life& life, std::int64_t time_ns) const {
  const auto [before, next] = life.moves.around(time_ns);
  const Frame rested = frame_of(before != nullptr ? before->pose : life.first);
  if (next == nullptr || time_ns <= next->from_ns) return rested;
  const double part = static_cast<double>(time_ns - next->from_ns) / static_cast<double>(next->to_ns - next->from_ns);
  return motion_to(life, rested, *next).at(part);
}

}  // namespace collided::engine
