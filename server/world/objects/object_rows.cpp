#include "server/world/objects/object_rows.hpp"

#include <algorithm>
#include <functional>

#include "server/geometry/tolerance.hpp"
#include "server/world/objects/column.hpp"
#include "server/world/objects/contact_search.hpp"

namespace collided::engine {
namespace {

std::uint32_t tag_of(std::string_view name) { return static_cast<std::uint32_t>(std::hash<std::string_view>{}(name)); }

}  // namespace

void ObjectRows::set_info(std::uint32_t slot, ObjectTable::Entry info) {
  table_.set(slot, std::move(info));
  definitions_.note(slot, size());
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
    table_.add_slot();
    add_to_column(motion_, Motion::none);
    add_to_column(news_, std::uint8_t{0});
    add_to_column(generations_, 1U);
    add_to_column(source_, Sources::kResting);
  }
  make_row(slot);
  return id(slot);
}

void ObjectRows::make_row(std::uint32_t slot) {
  used_rows_ = std::max<std::size_t>(used_rows_, slot + 1);
  if (slot >= rows_.size()) resize_column(rows_, slot + 1);
}

void ObjectRows::put(std::shared_ptr<const ObjectInfo> info) {
  const std::uint32_t slot = slot_of(info->id);
  names_.add(tag_of(info->name), slot);
  set_info(slot, std::move(info));
  mark(slot, Motion::placed);
}

void ObjectRows::put(std::shared_ptr<const ObjectInfo> info, const Pose& pose, std::uint32_t source,
                     std::int64_t born_ns) {
  ObjectRow& row = rows_[slot_of(info->id)];
  source_[slot_of(info->id)] = source;
  row.movable = generation_of(info->id);
  row.pose = pose;
  row.pose_before = pose;
  take_extent(slot_of(info->id), *info, Vec3::Zero());
  row.has_motion = false;
  row.posed_ns = row.posed_before_ns = row.said_before_ns = row.born_ns = info->moving ? born_ns : 0;
  news_[slot_of(info->id)] = kDefined;
  put(std::move(info));
}

void ObjectRows::take_extent(std::uint32_t slot, const ObjectInfo& info, const Vec3& pivot) {
  ObjectRow& row = rows_[slot];
  row.has_pivot = !pivot.isZero(0);
  const std::optional<Sphere> sphere = row.has_pivot ? std::nullopt : engine::lone_sphere(info);
  row.lone_radius_m = sphere ? sphere->radius_m : -1;
  row.is_centred_sphere = sphere && sphere->center.isZero(0);
  row.reach_m = reach_of(info) + 2 * pivot.stableNorm() * (1 + kBoundSlack);
}

void ObjectRows::set_pivot(std::uint32_t slot, const Vec3& pivot) {
  if (this->pivot(slot) == pivot) return;
  if (pivot.isZero(0)) pivots_.erase(slot);
  else pivots_[slot] = pivot;
  take_extent(slot, *info(slot), pivot);
  mark(slot, Motion::placed);
}

void ObjectRows::remove(ObjectId id, bool keeps_slot) {
  const std::uint32_t slot = slot_of(id);
  if (rows_[slot].has_pivot) pivots_.erase(slot);
  names_.remove(tag_of(info(slot)->name), slot);
  set_info(slot, nullptr);
  // A scene's part may use this slot next, and a part has no pose, age or motion.
  rows_[slot] = ObjectRow{};
  source_[slot] = Sources::kResting;
  if (!keeps_slot) freed_.push_back(slot);
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
  if (slot >= used_rows_ || rows_[slot].movable != generation_of(id) || rows_[slot].movable == 0) return false;
  ObjectRow& row = rows_[slot];
  if (!is_posed(slot)) {
    row.pose_before = row.pose;
    row.said_before_ns = row.posed_ns;
    row.posed_before_ns = row.posed_ns == kPosedAtStep ? row.posed_ns : std::max(row.posed_ns, at.since_ns);
  }
  row.pose = pose;
  // An object's time does not go back, even if its publisher's clock does: brackets are measured in it.
  row.posed_ns = std::max(row.posed_ns, at.time_ns);
  news_[slot] |= kPosed;
  row.has_motion = how == Motion::moved;
  mark(slot, how);
  return true;
}

void ObjectRows::prefetch(std::uint32_t slot) const {
  if (slot >= used_rows_) return;
  const char* row = reinterpret_cast<const char*>(&rows_[slot]);
  static_assert(sizeof(ObjectRow) > 128 && sizeof(ObjectRow) <= 192, "or other lines are to be prefetched");
  __builtin_prefetch(row, 1);
  __builtin_prefetch(row + 64, 1);
  __builtin_prefetch(row + 128, 1);
  __builtin_prefetch(row + sizeof(ObjectRow) - 1, 1);
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

void ObjectRows::stamp_changes(std::int64_t world_time_ns, const Sources& sources) {
  for (const std::uint32_t slot : moved_) {
    note_change(slot);
    ObjectRow& row = rows_[slot];
    if (row.born_ns != kPosedAtStep) continue;
    row.born_ns = source_[slot] != Sources::kResting ? sources[source_[slot]].known_ns : world_time_ns;
    row.posed_ns = std::max(row.posed_ns, row.born_ns);
  }
}

Aabb ObjectRows::bounds(std::uint32_t slot) const {
  const ObjectRow& row = rows_[slot];
  if (row.movable == 0) return {};
  if (row.is_centred_sphere) return engine::bounds(Sphere{placed_center(row.pose, Vec3::Zero()), row.lone_radius_m});
  return bounds_of(*info(slot), row.frame());
}

void ObjectRows::copy_changes(Snapshot& to) {
  const std::size_t count = row_count();
  resize_column(to.poses, count);
  resize_column(to.posed_ns, count);
  resize_column(to.stale, count);
  // Copying a run with most of its rows costs less than half as many scattered rows.
  const auto changed = changes_.since(to.changes_seen, count / 2);
  const std::uint32_t* const slots = changed ? changed->data() : nullptr;
  const std::size_t copies = changed ? changed->size() : count;
  // Locals, since writes in the loop might alias the members.
  Pose* const poses = to.poses.data();
  std::int64_t* const posed_ns = to.posed_ns.data();
  std::uint8_t* const stale = to.stale.data();
  const ObjectRow* const rows = rows_.data();
  for (std::size_t i = 0; i < copies; ++i) {
    const std::size_t slot = changed ? slots[i] : i;
    const ObjectRow& row = rows[slot];
    poses[slot] = row.pose;
    posed_ns[slot] = row.posed_ns;
    stale[slot] = row.is_stale ? 1 : 0;
  }
  to.changes_seen = changes_.count();
  to.objects.follow(table_, count, definitions_.since(to.definitions_seen, count / 2));
  to.definitions_seen = definitions_.count();
}

void ObjectRows::end_step() {
  for (const std::uint32_t slot : moved_) {
    motion_[slot] = Motion::none;
    news_[slot] = 0;
  }
  moved_.clear();
  free_slots_.insert(free_slots_.end(), freed_.begin(), freed_.end());
  freed_.clear();
  constexpr std::size_t kKept = 1'024;
  while (used_rows_ > 0 && info(static_cast<std::uint32_t>(used_rows_ - 1)) == nullptr) --used_rows_;
  if (rows_.size() - used_rows_ > rows_.size() / 8 + kKept) give_rows_back();
}

void ObjectRows::give_rows_back() {
  resize_column(rows_, used_rows_);
  // New objects take low slots first, so that a few of them do not let rows grow to their former number.
  std::sort(free_slots_.begin(), free_slots_.end(), std::greater<>());
  // Slots without a row are among them; every copy takes the whole state once.
  changes_.forget();
}

std::optional<ObjectId> ObjectRows::find(std::string_view name) const {
  const auto has_name = [&](std::uint32_t slot) { return info(slot)->name == name; };
  const std::uint32_t slot = names_.find(tag_of(name), has_name);
  return slot == TagIndex::kNone ? std::nullopt : std::optional(id(slot));
}

}  // namespace collided::engine
