// Definitions of publishers' objects: which object has a name, and which are in the world.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "idl/clocks.hpp"
#include "server/service/ingest/publishers.hpp"
#include "server/service/ingest/same_shape.hpp"
#include "server/service/questions/validation.hpp"

namespace collided::engine::service {
namespace {

bool is_same(const Filter& a, const Filter& b) {
  return a.layers == b.layers && a.mask == b.mask && a.group == b.group;
}

bool is_same(const Pose& a, const Pose& b) {
  return a.position == b.position && a.rotation.coeffs() == b.rotation.coeffs();
}

}  // namespace

/// A sample counts as seen even if its definition is refused: batches must not wait for it for ever.
Applied Publishers::define(DefinitionSample& sample, std::int64_t now_ns) {
  Publisher* publisher = nullptr;
  if (meet(sample.publisher, sample.incarnation, publisher) == Applied::step_first) return Applied::step_first;
  if (!publisher) {
    ++counts_.definitions_late;
    return Applied::done;
  }
  heard(*publisher, WriterKind::object, now_ns);
  if (!sample.publisher_name.empty() && is_good_name(sample.publisher_name)) publisher->name = sample.publisher_name;
  if (sample.object_number == wire_contract::kObjectPublisherItself) {
    take_gap(*publisher, sample);
    publisher->definitions_seen = std::max(publisher->definitions_seen, sample.sequence);
    publisher->watermark.apply_definition(sample.sequence, now_ns);
    return Applied::done;
  }
  Record* record = publisher->objects.find(sample.object_number);
  if (record && sample.sequence <= record->definition_sequence) {
    ++counts_.definitions_late;
    return Applied::done;
  }
  const bool lacks_batches = publisher->watermark.through() + 1 < sample.sequence;
  if (record && lacks_batches && !sample.removed && !why_bad(sample) && is_said_again(*record, sample)) {
    wait_for_batches(*publisher, sample);
    publisher->definitions_seen = std::max(publisher->definitions_seen, sample.sequence);
    publisher->watermark.apply_definition(sample.sequence, now_ns);
    return Applied::done;
  }
  if (record && record->place == Place::in_world && record->touched_step == step_) return Applied::step_first;
  if (!record) {
    make_room_for_number();
    if (record_count_ >= limits_.object_numbers) {
      ++counts_.definitions_refused;
      notice(fmt::format("object {} of publisher {} refused: {} object numbers are in use, the limit",
                         printable(sample.name), printable(publisher->name), limits_.object_numbers));
    } else {
      ++record_count_;
      record = &publisher->objects.add(sample.object_number);
      record->number = sample.object_number;
    }
  }
  if (record) {
    record->definition_sequence = sample.sequence;
    apply_definition(*publisher, *record, sample);
  }
  publisher->definitions_seen = std::max(publisher->definitions_seen, sample.sequence);
  publisher->watermark.apply_definition(sample.sequence, now_ns);
  return Applied::done;
}

void Publishers::take_gap(Publisher& publisher, const DefinitionSample& sample) {
  const double gap_s = sample.pose[0];
  constexpr double kLeast_s = wire_contract::kLeastGapNs * wire_contract::kNanosecond_s;
  constexpr double kMost_s = wire_contract::kMostGapNs * wire_contract::kNanosecond_s;
  if (!(gap_s >= kLeast_s && gap_s <= kMost_s)) {
    ++counts_.definitions_refused;
    notice(fmt::format("gap of publisher {} refused: {} s; allowed {} to {}. It stays {} s. Refused so far: {}.",
                       printable(publisher.name), gap_s, kLeast_s, kMost_s,
                       static_cast<double>(publisher.gap_ns) * wire_contract::kNanosecond_s,
                       counts_.definitions_refused));
    return;
  }
  publisher.gap_ns = std::llround(gap_s * 1e9);
  world_.set_gap(publisher.id, publisher.gap_ns);
  ++counts_.definitions_applied;
}

std::optional<std::string> Publishers::why_bad(const DefinitionSample& sample) const {
  if (!sample.not_allowed.empty()) return sample.not_allowed;
  if (!is_good_name(sample.name)) return "its name is empty, too long or not text";
  if (!codes::is_known<LostPolicy>(sample.lost_policy))
    return fmt::format("lost policy {}; allowed 0 to {}", sample.lost_policy, codes::kCodeCount<LostPolicy> - 1);
  if (const auto* refusal = std::get_if<Refusal>(&sample.shape)) return refusal->reason;
  if (!sample.claims && std::get<Shape>(sample.shape).empty()) return "its shape is empty";
  const std::variant<Pose, Refusal> pose = checked_pose(sample.pose);
  if (const auto* refusal = std::get_if<Refusal>(&pose)) return refusal->reason;
  return std::nullopt;
}

/// Compares with the world too: a command may have moved the object while the publisher was away.
bool Publishers::is_posed_at(const Record& record, const Pose& pose) const {
  return is_same(pose, record.pose) && !world_.has_moved(record.id) &&
         is_same(pose, world_.newest()->poses[slot_of(record.id)]);
}

/// Whether the object is in the world exactly as the sample defines it.
bool Publishers::is_there_already(const Record& record, const DefinitionSample& sample) const {
  return is_said_again(record, sample) && is_posed_at(record, std::get<Pose>(checked_pose(sample.pose)));
}

/// The same, possibly at another pose.
bool Publishers::is_said_again(const Record& record, const DefinitionSample& sample) const {
  if (record.place != Place::in_world || record.is_claim || sample.claims) return false;
  if (world_.info(record.id) == nullptr) return false;  // a command has removed it
  const ObjectDefinition& there = record.described->definition;
  const bool is_kind_same = there.moving == sample.moving &&
                            there.lost_policy == static_cast<LostPolicy>(sample.lost_policy) &&
                            (there.solid != nullptr) == (sample.solid != nullptr) &&
                            (there.winding != nullptr) == (sample.winding != nullptr);
  return is_kind_same && there.name == sample.name && is_same(there.filter, sample.filter) &&
         is_same_shape(there.shape, std::get<Shape>(sample.shape));
}

/// A refused definition leaves the object as it was: a half-applied one would be worse than an old one.
void Publishers::apply_definition(Publisher& publisher, Record& record, DefinitionSample& sample) {
  if (sample.removed) {
    leave(record, EndReason::removed);
    record.place = Place::gone;
    *record.described = {};
    record.moving = false;
    ++counts_.definitions_applied;
    return;
  }
  if (const std::optional<std::string> reason = why_bad(sample)) {
    ++counts_.definitions_refused;
    record.described->definition.name = sample.name;
    record.described->why_left_out = *reason;
    notice(fmt::format("object {} of publisher {} refused: {}. Refused so far: {}.", printable(sample.name),
                       printable(publisher.name), *reason, counts_.definitions_refused));
    return;
  }
  // A publisher that was away briefly defines everything again; no subscriber should notice.
  if (is_there_already(record, sample)) {
    record.described->why_left_out.clear();
    ++counts_.definitions_applied;
    return;
  }
  // To subscribers a renamed object is a new one.
  const bool renamed = record.place == Place::in_world && record.described->definition.name != sample.name;
  leave(record, renamed ? EndReason::removed : EndReason::geometry_changed);
  record.pose = std::get<Pose>(checked_pose(sample.pose));
  record.moving = sample.moving || sample.claims;
  record.is_claim = sample.claims;
  record.described->definition = {.name = sample.name,
                                  .scene = {},
                                  .shape = std::move(std::get<Shape>(sample.shape)),
                                  .pose = record.pose,
                                  .filter = sample.filter,
                                  .moving = record.moving,
                                  .lost_policy = static_cast<LostPolicy>(sample.lost_policy),
                                  .publisher = publisher.id,
                                  .indexed = std::move(sample.indexed),
                                  .solid = std::move(sample.solid),
                                  .winding = std::move(sample.winding)};
  record.has_velocity = false;
  if (!sample.enters_with_instant) return enter(publisher, record);
  record.place = Place::waits_for_instant;
  publisher.entering.push_back(record.number);
  ++counts_.definitions_applied;
}

/// Puts objects that were in other shards into the world, at their publisher's last instant: the next one, which has
/// their definitions, is at hand.
void Publishers::enter_with_instant(Publisher& publisher, std::uint64_t definitions_through) {
  std::erase_if(publisher.entering, [&](std::uint32_t number) {
    Record* const record = publisher.objects.find(number);
    if (record == nullptr || record->place != Place::waits_for_instant) return true;
    if (record->definition_sequence > definitions_through) return false;
    --counts_.definitions_applied;  // counted again as it enters
    enter(publisher, *record);
    return true;
  });
}

/// Puts a defined object into the world, or lets it wait until its name is free. A claim takes over the object of that
/// name, or waits for one.
void Publishers::enter(Publisher& publisher, Record& record) {
  ObjectDefinition& definition = record.described->definition;
  definition.pose = record.pose;
  make_lost_give_way(definition.name);
  if (std::string why = why_waits(record); !why.empty()) return wait(publisher, record, std::move(why));
  make_room_for_object();
  const std::variant<ObjectId, Refusal> defined =
      record.is_claim ? take_over(*world_.find(definition.name), definition) : world_.define(definition);
  if (const auto* refusal = std::get_if<Refusal>(&defined)) {
    record.place = Place::gone;
    record.described->why_left_out = refusal->reason;
    ++counts_.definitions_refused;
    notice(fmt::format("object {} of publisher {} refused: {}. Refused so far: {}.", printable(definition.name),
                       printable(publisher.name), refusal->reason, counts_.definitions_refused));
    return;
  }
  record.place = Place::in_world;
  record.described->why_left_out.clear();
  record.id = std::get<ObjectId>(defined);
  record.touched_step = step_;
  if (record.is_claim) claims_.emplace_back(publisher.id, record.number);
  ++changes_;
  ++counts_.definitions_applied;
}

/// Why the object is not in the world for now; empty: nothing prevents it.
std::string Publishers::why_waits(const Record& record) const {
  const std::optional<ObjectId> holder = world_.find(record.described->definition.name);
  const ObjectInfo* const info = holder ? world_.info(*holder) : nullptr;
  if (!record.is_claim && info == nullptr) return {};
  if (info == nullptr) return "nothing of that name is in the world, to be claimed";
  const Publisher* const owner = info->publisher == 0 ? nullptr : find(info->publisher);
  if (owner != nullptr) return fmt::format("the name is taken, by publisher {}", printable(owner->name));
  if (record.is_claim && info->scene_part != kNoScenePart)
    return fmt::format("it is a part of the mesh of scene {}, which stands still", printable(info->rare->scene));
  if (record.is_claim && !info->moving) return "it was added as static; a scene is to be loaded as moving";
  const AttachedObject* const attached = record.is_claim ? world_.attachments().find(info->id) : nullptr;
  if (attached != nullptr)
    return fmt::format("it is attached to {}, and moves along with that", printable(attached->parent_name));
  if (record.is_claim) return {};
  return info->rare->scene.empty() ? std::string("the name is taken")
                                   : fmt::format("the name is taken, by scene {}", printable(info->rare->scene));
}

void Publishers::wait(const Publisher& publisher, Record& record, std::string why) {
  record.described->why_left_out = std::move(why);
  if (record.place == Place::waits_for_name) return;
  record.place = Place::waits_for_name;
  waiting_.emplace_back(publisher.id, record.number);
  ++counts_.name_conflicts;
  notice(fmt::format("object {} of publisher {} waits: {}. Conflicts so far: {}.",
                     printable(record.described->definition.name), printable(publisher.name),
                     record.described->why_left_out, counts_.name_conflicts));
}

/// Removes the object of a lost publisher in favour of one of the same name, which is mostly the same program,
/// restarted. A claimed object is released to the world.
void Publishers::make_lost_give_way(std::string_view name) {
  const std::optional<ObjectId> owner = world_.find(name);
  const ObjectInfo* info = owner ? world_.info(*owner) : nullptr;
  if (info == nullptr || info->publisher == 0) return;
  Publisher* const publisher = find(info->publisher);
  if (publisher == nullptr) {  // forgotten while its object stayed
    world_.remove(*owner, EndReason::publisher_lost);
    ++changes_;
    return;
  }
  if (!publisher->lost) return;
  std::unordered_map<ObjectId, std::uint32_t>& numbers = publisher->numbers_while_lost;
  if (numbers.empty()) {
    for (const Record& record : publisher->objects.records()) {
      if (record.place == Place::in_world) numbers.emplace(record.id, record.number);
    }
  }
  const auto found = numbers.find(*owner);
  if (found == numbers.end()) return;
  Record& record = *publisher->objects.find(found->second);
  leave(record, EndReason::publisher_lost);
  record.place = Place::taken_away;
}

/// Defines an existing object again, as one of the publisher: shape, filter and scene stay.
std::variant<ObjectId, Refusal> Publishers::take_over(ObjectId there, ObjectDefinition& definition) {
  ObjectDefinition taken = definition_of(*world_.info(there), definition.pose);
  taken.lost_policy = definition.lost_policy;
  taken.publisher = definition.publisher;
  definition = std::move(taken);
  world_.remove(there, EndReason::geometry_changed);
  return world_.define(definition);
}

/// The claimed object stays where it is, without a publisher.
void Publishers::give_back(const Record& record, EndReason reason) {
  const ObjectInfo* const info = world_.info(record.id);
  if (info == nullptr) return;  // a command has removed it
  ObjectDefinition released = definition_of(*info, record.pose);
  released.publisher = 0;
  world_.remove(record.id, reason);
  world_.define(released);  // its name and its place are free: it had them
}

void Publishers::leave(Record& record, EndReason reason) {
  if (record.place != Place::in_world) return;
  if (record.is_claim) give_back(record, reason);
  else world_.remove(record.id, reason);
  record.place = Place::gone;
  record.id = 0;
  ++changes_;
}

/// A claim outlives its object: an object removed by a command may return with its scene.
void Publishers::find_lost_claims() {
  std::erase_if(claims_, [this](const auto& claim) {
    Publisher* publisher = find(claim.first);
    Record* record = publisher ? publisher->objects.find(claim.second) : nullptr;
    if (!record || record->place != Place::in_world || !record->is_claim) return true;
    if (world_.info(record->id) != nullptr) return false;
    wait(*publisher, *record, why_waits(*record));
    return true;
  });
}

void Publishers::retry_names() {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> waiting;
  waiting.swap(waiting_);
  for (const auto& [id, number] : waiting) {
    Publisher* publisher = find(id);
    Record* record = publisher ? publisher->objects.find(number) : nullptr;
    if (!record || record->place != Place::waits_for_name) continue;
    if (!publisher->lost) enter(*publisher, *record);
    if (record->place == Place::waits_for_name) waiting_.emplace_back(id, number);
  }
}

}  // namespace collided::engine::service
