#include "server/world/objects/object_rows.hpp"

#include <algorithm>
#include <functional>

#include "server/world/objects/column.hpp"
#include "server/world/objects/contact_search.hpp"

namespace collided::engine {
namespace {

std::uint32_t tag_of(std::string_view name) { return static_cast<std::uint32_t>(std::hash<std::string_view>{}(name)); }

}  // namespace

ObjectTable& ObjectRows::table_to_change() {
  ++table_version_;
  if (table_is_shared_) {
    table_ = std::make_shared<ObjectTable>(*table_);
    table_is_shared_ = false;
  }
  return *table_;
}

void ObjectRows::mark(std::uint32_t slot, Motion how) {
  if (motion_[slot] == Motion::none) moved_.push_back(slot);
  motion_[slot] = std::max(motion_[slot], how);
}

ObjectId ObjectRows::take_slot() {
  std::uint32_t slot = static_cast<std::uint32_t>(size());
  if (!free_slots_.empty()) {
    slot = free_slots_.back();
    free_slots_.pop_back();
    ++generations_[slot];
  } else {
    table_to_change().emplace_back();
    motion_.push_back(Motion::none);
    news_.push_back(0);
    generations_.push_back(1);
    source_.push_back(Sources::kResting);
  }
  make_row(slot);
  return id(slot);
}

void ObjectRows::make_row(std::uint32_t slot) {
  if (slot < rows_.size()) return;
  // By an eighth, not twofold: a row takes 240 bytes.
  if (slot >= rows_.capacity()) rows_.reserve(slot + slot / 8 + 16);
  rows_.resize(slot + 1);
}

void ObjectRows::put(std::shared_ptr<const ObjectInfo> info) {
  const std::uint32_t slot = slot_of(info->id);
  names_.add(tag_of(info->name), slot);
  table_to_change()[slot] = std::move(info);
  mark(slot, Motion::placed);
}

void ObjectRows::put(std::shared_ptr<const ObjectInfo> info, const Pose& pose, std::uint32_t source,
                     std::int64_t born_ns) {
  ObjectRow& row = rows_[slot_of(info->id)];
  source_[slot_of(info->id)] = source;
  row.movable = info->id;
  row.pose = pose;
  row.pose_before = pose;
  row.bounds = bounds_of(*info, row.frame());
  const std::optional<Sphere> sphere = engine::lone_sphere(*info);
  row.lone_radius_m = sphere ? sphere->radius_m : -1;
  row.is_centred_sphere = sphere && sphere->center.isZero(0);
  row.reach_m = reach_of(*info);
  row.has_motion = false;
  row.posed_ns = row.posed_before_ns = row.said_before_ns = row.born_ns = info->moving ? born_ns : 0;
  news_[slot_of(info->id)] = kDefined;
  put(std::move(info));
}

void ObjectRows::remove(ObjectId id) {
  const std::uint32_t slot = slot_of(id);
  names_.remove(tag_of(info(slot)->name), slot);
  table_to_change()[slot].reset();
  // A scene's part may use this slot next, and a part has no pose, age or motion.
  rows_[slot] = ObjectRow{};
  source_[slot] = Sources::kResting;
  freed_.push_back(slot);
  mark(slot, Motion::placed);
}

void ObjectRows::begin(std::uint32_t source, std::int64_t time_ns) {
  for (const std::uint32_t slot : moved_) {
    ObjectRow& row = rows_[slot];
    if (source_[slot] != source || row.born_ns != kPosedAtStep) continue;
    row.born_ns = time_ns;
    row.posed_ns = std::max(row.posed_ns, time_ns);
  }
}

bool ObjectRows::move(ObjectId id, const Pose& pose, const PoseTime& at, Motion how) {
  const std::uint32_t slot = slot_of(id);
  if (slot >= rows_.size() || rows_[slot].movable != id || id == 0) return false;
  ObjectRow& row = rows_[slot];
  if (!is_posed(slot)) {
    row.pose_before = row.pose;
    row.said_before_ns = row.posed_ns;
    row.posed_before_ns = row.posed_ns == kPosedAtStep ? row.posed_ns : std::max(row.posed_ns, at.since_ns);
  }
  row.pose = pose;
  row.bounds = row.is_centred_sphere ? bounds(Sphere{placed_center(pose, Vec3::Zero()), row.lone_radius_m})
                                     : bounds_of(*info(slot), row.frame());
  // An object's time does not go back, even if its publisher's clock does: brackets are measured in it.
  row.posed_ns = std::max(row.posed_ns, at.time_ns);
  news_[slot] |= kPosed;
  row.has_motion = how == Motion::moved;
  mark(slot, how);
  return true;
}

void ObjectRows::prefetch(std::uint32_t slot) const {
  if (slot >= rows_.size()) return;
  const char* row = reinterpret_cast<const char*>(&rows_[slot]);
  for (std::size_t byte = 0; byte < sizeof(ObjectRow); byte += 64) __builtin_prefetch(row + byte, 1);
}

void ObjectRows::place_all_movers_again() {
  for (std::uint32_t slot = 0; slot < size(); ++slot) {
    if (info(slot) != nullptr && info(slot)->moving) mark(slot, Motion::placed);
  }
}

void ObjectRows::look_again(std::uint32_t slot) {
  if (motion_[slot] == Motion::none) mark(slot, Motion::placed);
}

void ObjectRows::set_stale(std::uint32_t slot, bool is_stale) {
  rows_[slot].is_stale = is_stale;
  note_change(slot);
}

void ObjectRows::follow_source(std::uint32_t slot, std::uint32_t source, std::int64_t known_ns,
                               std::int64_t decided_ns) {
  ObjectRow& row = rows_[slot];
  source_[slot] = source;
  row.joined_ns = std::max(row.joined_ns, decided_ns);
  row.born_ns = known_ns;
  row.posed_ns = row.posed_before_ns = row.said_before_ns = std::max(row.posed_ns, known_ns);
  row.pose_before = row.pose;
  row.has_motion = false;
  news_[slot] = kDefined;
  mark(slot, Motion::placed);
}

void ObjectRows::note_change(std::uint32_t slot) {
  if (changes_.size() > size()) {
    forgotten_changes_ += changes_.size();
    changes_.clear();
  }
  changes_.push_back(slot);
}

void ObjectRows::stamp_changes(std::int64_t world_time_ns, const Sources& sources) {
  for (const std::uint32_t slot : moved_) {
    note_change(slot);
    ObjectRow& row = rows_[slot];
    if (row.born_ns != kPosedAtStep) continue;
    row.born_ns = source_[slot] != Sources::kResting ? sources[source_[slot]].known_ns : world_time_ns;
    row.posed_ns = std::max(row.posed_ns, row.born_ns);
  }
}

void ObjectRows::copy_row(std::uint32_t slot, Snapshot& to) const {
  const ObjectRow& row = rows_[slot];
  to.poses[slot] = row.pose;
  to.bounds[slot] = row.bounds;
  to.posed_ns[slot] = row.posed_ns;
  to.stale[slot] = row.is_stale ? 1 : 0;
}

void ObjectRows::copy_changes(Snapshot& to) {
  const std::size_t count = row_count();
  resize_column(to.poses, count);
  resize_column(to.bounds, count);
  resize_column(to.posed_ns, count);
  resize_column(to.stale, count);
  const std::uint64_t change_count = forgotten_changes_ + changes_.size();
  // Most rows in a row cost less than as many here and there.
  if (to.changes_seen < forgotten_changes_ || change_count - to.changes_seen > count / 2) {
    for (std::uint32_t slot = 0; slot < count; ++slot) copy_row(slot, to);
  } else {
    for (std::size_t i = to.changes_seen - forgotten_changes_; i < changes_.size(); ++i) copy_row(changes_[i], to);
  }
  to.changes_seen = change_count;
  to.objects = table_;
  to.table_version = table_version_;
  table_is_shared_ = true;
}

void ObjectRows::end_step() {
  for (const std::uint32_t slot : moved_) {
    motion_[slot] = Motion::none;
    news_[slot] = 0;
  }
  moved_.clear();
  free_slots_.insert(free_slots_.end(), freed_.begin(), freed_.end());
  freed_count_ += freed_.size();
  freed_.clear();
  // Looking through all costs a few steps for each object that was removed.
  if (4 * freed_count_ > rows_.size()) give_rows_back();
}

void ObjectRows::give_rows_back() {
  freed_count_ = 0;
  std::size_t used = rows_.size();
  while (used > 0 && info(static_cast<std::uint32_t>(used - 1)) == nullptr) --used;
  if (used > rows_.size() / 2) return;
  resize_column(rows_, used);
  // New objects take low slots first, so that rows do not grow to their old number for a few.
  std::sort(free_slots_.begin(), free_slots_.end(), std::greater<>());
  // Slots without a row are among them: every state is copied as a whole once.
  forgotten_changes_ += changes_.size();
  changes_ = {};
}

const ObjectInfo* ObjectRows::find(ObjectId id) const {
  const std::uint32_t slot = slot_of(id);
  const ObjectInfo* found = slot < size() ? info(slot) : nullptr;
  return found != nullptr && found->id == id ? found : nullptr;
}

std::optional<ObjectId> ObjectRows::find(std::string_view name) const {
  const auto has_name = [&](std::uint32_t slot) { return info(slot)->name == name; };
  const std::uint32_t slot = names_.find(tag_of(name), has_name);
  return slot == TagIndex::kNone ? std::nullopt : std::optional(id(slot));
}

}  // namespace collided::engine
