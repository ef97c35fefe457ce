#include "server/service/ingest/publishers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "server/service/questions/validation.hpp"

namespace collided::engine::service {

// ---- which publishers are known

Publishers::Publisher* Publishers::find(std::uint64_t id) const {
  const auto found = publishers_.find(id);
  return found == publishers_.end() ? nullptr : found->second.get();
}

bool Publishers::make_room(std::int64_t now_ns) {
  if (publishers_.size() < limits_.publishers) return true;
  forget_lost(now_ns);
  return publishers_.size() < limits_.publishers;
}

Publishers::Publisher* Publishers::add(std::uint64_t id) {
  auto publisher = std::make_unique<Publisher>();
  publisher->id = id;
  return publishers_.emplace(id, std::move(publisher)).first->second.get();
}

/// Finds the publisher of a sample, or adds it; none where the sample is late or there is no room. A greater
/// incarnation is a restart: the objects of the earlier run are removed.
Applied Publishers::meet(std::uint64_t id, std::uint64_t incarnation, std::int64_t now_ns, Publisher*& met) {
  met = nullptr;
  Publisher* publisher = find(id);
  if (!publisher) {
    if (!make_room(now_ns)) {
      ++counts_.publishers_refused;
      notice(fmt::format("publisher {:016x} refused: {} are there, the limit", id, limits_.publishers));
      return Applied::done;
    }
    publisher = add(id);
    publisher->incarnation = incarnation;
  }
  if (incarnation < publisher->incarnation) return Applied::done;
  if (incarnation > publisher->incarnation) {
    if (any_touched(*publisher)) return Applied::step_first;
    retire(*publisher);
    publisher->incarnation = incarnation;
  }
  met = publisher;
  return Applied::done;
}

void Publishers::heard(Publisher& publisher, WriterKind kind, std::int64_t now_ns) {
  publisher.heard_ns = now_ns;
  (kind == WriterKind::object ? publisher.object_writer : publisher.pose_writer) = true;
  if (publisher.lost) back_alive(publisher);
}

bool Publishers::any_touched(const Publisher& publisher) const {
  return std::any_of(publisher.objects.records().begin(), publisher.objects.records().end(), [&](const Record& record) {
    return record.place == Place::in_world && record.touched_step == step_;
  });
}

void Publishers::retire(Publisher& publisher) {
  for (Record& record : publisher.objects.records()) leave(record, EndReason::publisher_lost);
  record_count_ -= publisher.objects.records().size();
  publisher.objects.clear();
  publisher.numbers_while_lost.clear();
  parked_count_ -= publisher.parked.size();
  publisher.parked.clear();
  publisher.parts.clear();
  publisher.said_again.clear();
  publisher.said_all = false;
  publisher.watermark = {};
  publisher.clock = {};
  publisher.definitions_seen = 0;
}

// ---- poses

std::optional<std::string> Publishers::why_malformed(const PoseSample& sample) const {
  const std::size_t count = sample.object_numbers.size();
  if (count > wire_contract::kMaxPosesPerBatch) {
    return fmt::format("{} objects, allowed {}", count, wire_contract::kMaxPosesPerBatch);
  }
  if (sample.has_odd_columns)
    return "its positions and orientations, or its velocities, are of different numbers of objects";
  if (sample.poses.size() != count * wire_contract::kPoseNumbers) {
    return fmt::format("{} objects with {} numbers of poses, {} are needed", count, sample.poses.size(),
                       count * wire_contract::kPoseNumbers);
  }
  if (!sample.velocities.empty() && sample.velocities.size() != count * wire_contract::kVelocityNumbers) {
    return fmt::format("{} objects with {} numbers of velocities, {} or none are needed", count,
                       sample.velocities.size(), count * wire_contract::kVelocityNumbers);
  }
  return std::nullopt;
}

Applied Publishers::move(PoseSample& sample, std::int64_t now_ns) {
  Publisher* publisher = nullptr;
  if (meet(sample.publisher, sample.incarnation, now_ns, publisher) == Applied::step_first) return Applied::step_first;
  if (!publisher) {
    counts_.poses_late += sample.object_numbers.size();
    return Applied::done;
  }
  heard(*publisher, WriterKind::pose, now_ns);
  if (const std::optional<std::string> reason = why_malformed(sample)) {
    ++counts_.batches_malformed;
    publisher->watermark.apply_pose(sample.sequence, now_ns);
    notice(fmt::format("batch of poses of publisher {} refused: {}. Refused so far: {}.", printable(publisher->name),
                       *reason, counts_.batches_malformed));
    return Applied::done;
  }
  // Definitions have a topic of their own, so they may come later than poses that need them.
  if (sample.definitions_through > publisher->definitions_seen) {
    park(*publisher, sample);
    return Applied::done;
  }
  return take_batch(*publisher, sample, now_ns);
}

void Publishers::park(Publisher& publisher, PoseSample& sample) {
  if (publisher.parked.size() >= limits_.parked_batches) {
    publisher.parked.pop_front();
    --parked_count_;
    ++counts_.batches_dropped;
  }
  publisher.parked.push_back(std::move(sample));
  ++parked_count_;
  ++counts_.batches_parked;
}

Applied Publishers::release_parked(std::int64_t now_ns) {
  if (parked_count_ == 0) return Applied::done;
  for (auto& [id, publisher] : publishers_) {
    while (!publisher->parked.empty() && publisher->parked.front().definitions_through <= publisher->definitions_seen) {
      if (take_batch(*publisher, publisher->parked.front(), now_ns) == Applied::step_first) return Applied::step_first;
      publisher->parked.pop_front();
      --parked_count_;
    }
  }
  return Applied::done;
}

/// Looks up the batch's records into records_. False: one of the objects was defined or moved in this step already.
bool Publishers::find_all(Publisher& publisher, const PoseSample& sample) {
  const std::vector<std::uint32_t>& numbers = sample.object_numbers;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    records_[i] = publisher.objects.find(numbers[i]);
    if (records_[i]) __builtin_prefetch(records_[i], 1);
  }
  return std::none_of(records_.begin(), records_.begin() + static_cast<std::ptrdiff_t>(numbers.size()),
                      [&](const Record* record) {
                        return record && record->place == Place::in_world && record->touched_step == step_;
                      });
}

/// Keeps the batches of one instant until the last of them comes, then applies them together.
Applied Publishers::take_batch(Publisher& publisher, PoseSample& sample, std::int64_t now_ns) {
  const bool more_follows = (sample.flags & wire_contract::kMoreFollows) != 0;
  if (!more_follows || publisher.parts.size() >= limits_.parked_batches)
    return apply_instant(publisher, sample, now_ns);
  publisher.parts.push_back(std::move(sample));
  return Applied::done;
}

/// Applies all batches of an instant within one step, so that no question sees a robot's links half moved.
Applied Publishers::apply_instant(Publisher& publisher, const PoseSample& last, std::int64_t now_ns) {
  if (!publisher.said_again.empty() && last.sequence > 0 &&
      take_said_again(publisher, last.sequence) == Applied::step_first)
    return Applied::step_first;
  const bool has_instant = last.source_time_ns != 0 || publisher.clock.is_without_stamps();
  if (has_instant && (last.flags & wire_contract::kBringsObjects) != 0) world_.expect_objects(publisher.id);
  if (has_instant && !publisher.entering.empty()) enter_with_instant(publisher, last.definitions_through);
  for (const PoseSample& part : publisher.parts) {
    if (!find_all(publisher, part)) return Applied::step_first;
  }
  if (!find_all(publisher, last)) return Applied::step_first;
  // An empty batch without a stamp is only a sign of life and has no time. A publisher that never stamps, however, says
  // with it that its objects have rested until now.
  const bool is_sign_of_life = last.source_time_ns == 0 && last.object_numbers.empty() && publisher.parts.empty() &&
                               !publisher.clock.is_without_stamps();
  WorldStamp stamp;
  if (!is_sign_of_life) stamp = publisher.clock.stamp(last.source_time_ns, last.received_ns);
  if (!publisher.parts.empty()) {
    for (const PoseSample& part : publisher.parts) {
      find_all(publisher, part);
      apply_batch(publisher, part, stamp, now_ns);
    }
    publisher.parts.clear();
    find_all(publisher, last);
  }
  apply_batch(publisher, last, stamp, now_ns);
  if (stamp.time_ns > 0 && world_.advance(publisher.id, stamp.time_ns)) ++changes_;
  counts_.stamps_late += stamp.kind == StampKind::late ? 1 : 0;
  counts_.stamps_jumped += stamp.kind == StampKind::jumped ? 1 : 0;
  counts_.stamps_missing += stamp.kind == StampKind::none ? 1 : 0;
  return Applied::done;
}

/// Applies the batch whose records find_all() looked up last.
void Publishers::apply_batch(Publisher& publisher, const PoseSample& sample, const WorldStamp& stamp,
                             std::int64_t now_ns) {
  if ((sample.flags & wire_contract::kAllSaid) != 0) publisher.said_all = true;
  ++batch_;
  accepted_count_ = 0;
  for (std::size_t i = 0; i < sample.object_numbers.size(); ++i) {
    Record* record = records_[i];
    if (!accept(publisher, sample, i, record)) continue;
    if (record->place != Place::in_world) {
      ++counts_.poses_unknown;
      continue;
    }
    accepted_[accepted_count_] = record;
    ids_[accepted_count_] = record->id;
    poses_[accepted_count_] = record->pose;
    ++accepted_count_;
  }
  const bool teleported = (sample.flags & wire_contract::kTeleported) != 0 || stamp.kind == StampKind::jumped;
  const bool streamed = (sample.flags & wire_contract::kStreamed) != 0;
  const std::uint64_t before = counts_.poses_applied;
  world_.move(std::span(ids_).first(accepted_count_), std::span(poses_).first(accepted_count_), stamp.time_ns,
              teleported, moved_, streamed);
  for (std::size_t i = 0; i < accepted_count_; ++i) {
    if (moved_[i]) accepted_[i]->touched_step = step_;
    ++(moved_[i] ? counts_.poses_applied : counts_.poses_unknown);
  }
  if (sample.sequence > 0) publisher.watermark.apply_pose(sample.sequence, now_ns);
  ++counts_.batches_applied;
  if (counts_.poses_applied != before) ++changes_;
}

void Publishers::refuse(const Publisher& publisher, const Record* record, const std::string& reason) {
  ++counts_.poses_refused;
  notice(fmt::format("pose of object {} of publisher {} refused: {}. Refused so far: {}.",
                     record ? printable(record->described->definition.name) : "?", printable(publisher.name), reason,
                     counts_.poses_refused));
}

/// Whether a pose is valid and newer than what is known; if so, the record holds it.
bool Publishers::accept(const Publisher& publisher, const PoseSample& sample, std::size_t index, Record* record) {
  if (!record || record->place == Place::gone) {
    ++counts_.poses_unknown;
    return false;
  }
  // A pose older than the definition was meant for the object that had the number before.
  if (sample.sequence <= record->pose_sequence || sample.sequence < record->definition_sequence) {
    if (record->batch == batch_) {
      refuse(publisher, record, "the object stands twice in one batch");
    } else {
      ++counts_.poses_late;
    }
    return false;
  }
  const double* numbers = &sample.poses[index * wire_contract::kPoseNumbers];
  Pose pose;
  if (!read_pose(numbers, pose)) {
    refuse(publisher, record, std::get<Refusal>(checked_pose({numbers, wire_contract::kPoseNumbers})).reason);
    return false;
  }
  if (!record->moving) {
    refuse(publisher, record, "it was defined as not moving");
    return false;
  }
  record->batch = batch_;
  record->pose_sequence = sample.sequence;
  record->pose = pose;
  record->has_velocity = !sample.velocities.empty();
  if (record->has_velocity) {
    auto& velocity = record->described->velocity;
    std::copy_n(&sample.velocities[index * velocity.size()], velocity.size(), velocity.begin());
  }
  return true;
}

// ---- readings

std::uint64_t Publishers::take_changes() { return std::exchange(changes_, 0); }

void Publishers::notice(std::string sentence) {
  constexpr std::size_t kMost = 8;
  if (notices_.size() < kMost) {
    notices_.push_back(std::move(sentence));
  } else {
    ++unsaid_;
  }
}

std::vector<std::string> Publishers::take_notices() {
  if (unsaid_ > 0) notices_.push_back(fmt::format("and {} more of the kind", std::exchange(unsaid_, 0)));
  return std::exchange(notices_, {});
}

PublisherView Publishers::view(const Publisher& publisher, std::int64_t now_ns) const {
  using wire_contract::PublisherState;
  const std::int64_t silent_ns = now_ns - publisher.heard_ns;
  const PublisherState here = silent_ns > limits_.silent_after_ns ? PublisherState::silent : PublisherState::alive;
  return {.publisher = publisher.id,
          .name = publisher.name,
          .silent_ns = silent_ns,
          .state = publisher.lost ? PublisherState::lost : here,
          .behind_ns = publisher.clock.behind_ns()};
}

bool Publishers::is_live(std::uint64_t publisher) const {
  const Publisher* found = find(publisher);
  return found && !found->lost;
}

bool Publishers::is_complete(std::uint64_t publisher) const {
  const Publisher* found = find(publisher);
  return found && !found->lost && found->said_all;
}

std::uint64_t Publishers::applied_through(std::uint64_t publisher) const {
  const Publisher* found = find(publisher);
  return found ? found->watermark.through() : 0;
}

void Publishers::list_applied(std::vector<std::pair<std::uint64_t, std::uint64_t>>& applied) const {
  applied.clear();
  for (const auto& [id, publisher] : publishers_) applied.emplace_back(id, publisher->watermark.through());
}

std::optional<std::array<double, 6>> Publishers::velocity(ObjectId id) const {
  const ObjectInfo* info = world_.info(id);
  const Publisher* publisher = info ? find(info->publisher) : nullptr;
  if (!publisher) return std::nullopt;
  for (const Record& record : publisher->objects.records()) {
    if (record.place == Place::in_world && record.id == id && record.has_velocity) return record.described->velocity;
  }
  return std::nullopt;
}

std::vector<std::uint64_t> Publishers::waiting_for(std::string_view name) const {
  std::vector<std::uint64_t> waiting;
  for (const auto& [id, number] : waiting_) {
    Publisher* publisher = find(id);
    const Record* record = publisher ? publisher->objects.find(number) : nullptr;
    if (record && record->place == Place::waits_for_name && record->described->definition.name == name)
      waiting.push_back(id);
  }
  return waiting;
}

std::vector<Publishers::LeftOut> Publishers::left_out(std::uint64_t id, std::size_t most) const {
  std::vector<LeftOut> objects;
  const Publisher* const publisher = find(id);
  if (publisher == nullptr) return objects;
  for (const Record& record : publisher->objects.records()) {
    if (record.described->why_left_out.empty()) continue;
    if (objects.size() == most) break;
    objects.push_back({record.described->definition.name, record.described->why_left_out});
  }
  return objects;
}

}  // namespace collided::engine::service
