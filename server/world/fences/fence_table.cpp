#include "server/world/fences/fence_table.hpp"

#include <algorithm>
#include <cassert>
#include <functional>

#include "server/world/objects/contact_search.hpp"
#include "server/world/objects/part_index.hpp"
#include "server/world/solids/solid.hpp"

namespace collided::engine {
namespace {

std::size_t hash_of(const FenceRule& rule) {
  const std::hash<std::string> hash;
  return hash(rule.carrier) ^ (3 * hash(rule.only)) ^ (5 * hash(rule.skip)) ^
         (7 * ((std::size_t{rule.mask} << 8) | rule.detects)) ^ rule.owner ^
         (rule.band ? 11 * hash(rule.band->margin) + std::hash<double>{}(rule.band->within_m) : 0) ^
         (rule.nearest ? 13 * std::hash<double>{}(rule.nearest->within_m) : 0);
}

/// A fence described by one primitive needs no body of its own.
std::shared_ptr<const ObjectInfo> body_of(const FenceDefinition& definition, ObjectId id) {
  if (!definition.solid && definition.shape.primitives.size() == 1) return nullptr;
  auto body = std::make_shared<ObjectInfo>();
  body->id = id;
  body->primitives = SharedPrimitives(definition.shape.primitives);
  if (auto parts = index_parts(body->primitives)) body->rare.edit().parts = std::move(parts);
  if (definition.solid) body->rare.edit().solid = definition.solid;
  if (definition.solid) body->mesh = definition.solid->surface;
  return body;
}

}  // namespace

std::shared_ptr<const FenceRule> FenceTable::shared(const FenceRule& rule) {
  const std::size_t key = hash_of(rule);
  const auto [first, end] = rules_.equal_range(key);
  for (auto entry = first; entry != end;) {
    const auto here = entry++;
    const std::shared_ptr<const FenceRule> known = here->second.lock();
    if (known && *known == rule) return known;
    if (!known) rules_.erase(here);
  }
  auto added = std::make_shared<const FenceRule>(rule);
  rules_.emplace(key, added);
  return added;
}

std::uint32_t FenceTable::take_slot() {
  auto slot = static_cast<std::uint32_t>(fences_.size());
  if (!free_.empty()) {
    slot = free_.back();
    free_.pop_back();
    ++fences_[slot].generation;
  } else {
    fences_.emplace_back();
    bounds_.emplace_back();
  }
  return slot;
}

std::vector<std::uint32_t> FenceTable::take_slots(std::size_t count) {
  std::vector<std::uint32_t> slots;
  while (slots.size() < count) slots.push_back(take_slot());
  std::sort(slots.begin(), slots.end(), [&](std::uint32_t a, std::uint32_t b) { return id(a) < id(b); });
  return slots;
}

void FenceTable::add_band(std::uint32_t slot, std::uint32_t widest, const std::string& name, const FenceRule& rule,
                          std::shared_ptr<const ObjectInfo> about, std::uint32_t object) {
  FenceRow& fence = fences_[slot];
  fence.widest = widest;
  fence.name = name;
  fence.rule = shared(rule);
  fence.body = std::move(about);
  by_name_.insert(slot);
  carried_.insert(slot);
  bind(slot, object);
}

ObjectId FenceTable::add(const FenceDefinition& definition) {
  const std::uint32_t slot = take_slot();
  FenceRow& fence = fences_[slot];
  fence.name = definition.name;
  fence.rule = shared({.carrier = definition.carrier,
                       .only = definition.only,
                       .skip = definition.skip,
                       .mask = definition.mask,
                       .detects = definition.detects,
                       .owner = definition.owner,
                       .nearest = definition.nearest});
  fence.body = body_of(definition, id(slot));
  if (!fence.body) fence.primitive = primitives_.shared(definition.shape.primitives);
  scratch_slot_ = kNone;
  by_name_.insert(slot);
  if (is_carried(slot)) carried_.insert(slot);
  else if (has_bounds(slot)) set_bounds(slot, bounds_of(body(slot), Frame{}));
  return id(slot);
}

void FenceTable::remove(std::uint32_t slot) {
  unbind(slot);
  carried_.erase(slot);
  by_name_.erase(slot);
  FenceRow& fence = fences_[slot];
  fence.rule.reset();
  fence.body.reset();
  fence.primitive = {};
  free_.push_back(slot);
  set_bounds(slot, Aabb{});
}

std::optional<std::uint32_t> FenceTable::find(std::string_view name) const {
  const auto found = by_name_.find(name);
  if (found == by_name_.end()) return std::nullopt;
  return *found;
}

const ObjectInfo& FenceTable::body(std::uint32_t slot) {
  const FenceRow& fence = fences_[slot];
  if (fence.body) return *fence.body;
  if (scratch_slot_ != slot) {
    scratch_.id = id(slot);
    scratch_.primitives = fence.primitive;
    scratch_slot_ = slot;
  }
  return scratch_;
}

ObjectInfo FenceTable::described(std::uint32_t slot) const {
  if (fences_[slot].body) return *fences_[slot].body;
  ObjectInfo info;
  info.id = id(slot);
  info.primitives = fences_[slot].primitive;
  return info;
}

std::uint32_t FenceTable::carrier(std::uint32_t slot) const {
  const auto found = carrier_of_.find(slot);
  return found == carrier_of_.end() ? kNone : found->second;
}

std::span<const std::uint32_t> FenceTable::carried_by(std::uint32_t object) const {
  const auto found = carried_by_.find(object);
  if (found == carried_by_.end()) return {};
  return found->second;
}

void FenceTable::bind(std::uint32_t slot, std::uint32_t object) {
  assert(is_carried(slot) && carrier(slot) == kNone && "a fence has one carrier at a time");
  carrier_of_.emplace(slot, object);
  carried_by_[object].push_back(slot);
}

void FenceTable::unbind(std::uint32_t slot) {
  const auto found = carrier_of_.find(slot);
  if (found == carrier_of_.end()) return;
  const auto carried = carried_by_.find(found->second);
  std::erase(carried->second, slot);
  if (carried->second.empty()) carried_by_.erase(carried);
  carrier_of_.erase(found);
  set_bounds(slot, Aabb{});
}

std::vector<std::uint32_t> FenceTable::waiting_for(std::string_view carrier_name) const {
  std::vector<std::uint32_t> waiting;
  for (const std::uint32_t slot : carried_) {
    if (rule(slot).carrier == carrier_name && carrier(slot) == kNone) waiting.push_back(slot);
  }
  std::sort(waiting.begin(), waiting.end());
  return waiting;
}

void FenceTable::set_bounds(std::uint32_t slot, const Aabb& bounds) {
  bounds_[slot] = bounds;
  changed_.push_back(slot);
}

bool FenceTable::update_index() {
  if (changed_.empty()) return false;
  auto next = std::make_unique<Grid>(Grid::Use::pairs);
  next->update(*index_, bounds_, changed_);
  index_ = std::move(next);
  changed_.clear();
  return true;
}

std::size_t FenceTable::bytes() const {
  constexpr std::size_t kNameEntry = 40;  // entry of by_name_: a node with its hash, and a bucket
  std::size_t bytes = fences_.size() * sizeof(FenceRow) + bounds_.capacity() * sizeof(Aabb) + index_->bytes() +
                      by_name_.size() * kNameEntry + changed_.capacity() * sizeof(std::uint32_t);
  const std::size_t in_place = std::string().capacity();
  for (const FenceRow& fence : fences_) bytes += fence.name.capacity() > in_place ? fence.name.capacity() + 1 : 0;
  return bytes;
}

}  // namespace collided::engine
