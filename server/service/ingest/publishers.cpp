#include "server/service/ingest/publishers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "idl/clocks.hpp"
#include "server/service/questions/validation.hpp"

namespace collided::engine::service {
namespace {

std::size_t bytes_of(const PoseSample& sample) {
  return sizeof sample + sample.object_numbers.size() * sizeof(std::uint32_t) +
         (sample.poses.size() + sample.velocities.size()) * sizeof(double);
}

}  // namespace

// ---- which publishers are known

Publishers::Publisher* Publishers::find(std::uint64_t id) const {
  const auto found = publishers_.find(id);
  return found == publishers_.end() ? nullptr : found->second.get();
}

Publishers::Publisher* Publishers::add(std::uint64_t id) {
  auto publisher = std::make_unique<Publisher>();
  publisher->id = id;
  return publishers_.emplace(id, std::move(publisher)).first->second.get();
}

/// Finds the publisher of a sample, or adds it; none if the sample is late or there is no room. A greater incarnation
/// is a restart: the objects of the earlier run are removed.
Applied Publishers::meet(std::uint64_t id, std::uint64_t incarnation, Publisher*& met) {
  met = nullptr;
  Publisher* publisher = find(id);
  if (!publisher) {
    if (!has_room()) {
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
  parked_bytes_ -= std::exchange(publisher.parked_bytes, 0);
  publisher.parked.clear();
  publisher.parts.clear();
  publisher.said_again.clear();
  publisher.said_all = false;
  publisher.merged_poses = 0;
  publisher.watermark = {};
  publisher.clock = {};
  publisher.definitions_seen = 0;
  publisher.gap_ns = wire_contract::kDefaultGapNs;
  publisher.instant_ns = 0;
  publisher.long_periods = 0;
  world_.set_gap(publisher.id, publisher.gap_ns);
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
  if (meet(sample.publisher, sample.incarnation, publisher) == Applied::step_first) return Applied::step_first;
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

void Publishers::pop_parked(Publisher& publisher, std::size_t bytes) {
  publisher.parked.pop_front();
  publisher.parked_bytes -= bytes;
  parked_bytes_ -= bytes;
  --parked_count_;
}

/// The publisher that has parked the most loses its oldest batches, so that one cannot displace the batches of others.
void Publishers::make_room_to_park(std::size_t bytes) {
  while (parked_count_ > 0 && parked_bytes_ + bytes > limits_.parked_bytes) {
    const auto most =
        std::ranges::max_element(publishers_, {}, [](const auto& one) { return one.second->parked_bytes; });
    pop_parked(*most->second, bytes_of(most->second->parked.front()));
    ++counts_.batches_dropped;
  }
}

void Publishers::park(Publisher& publisher, const PoseSample& sample) {
  if (publisher.parked.size() >= limits_.parked_batches) {
    pop_parked(publisher, bytes_of(publisher.parked.front()));
    ++counts_.batches_dropped;
  }
  const std::size_t bytes = bytes_of(sample);
  make_room_to_park(bytes);
  // A copy: the sample's own vectors may be as large as the largest batch that they ever held.
  publisher.parked.push_back(sample);
  publisher.parked_bytes += bytes;
  parked_bytes_ += bytes;
  ++parked_count_;
  ++counts_.batches_parked;
}

Applied Publishers::release_parked(std::int64_t now_ns) {
  if (parked_count_ == 0) return Applied::done;
  for (auto& [id, publisher] : publishers_) {
    while (!publisher->parked.empty() && publisher->parked.front().definitions_through <= publisher->definitions_seen) {
      const std::size_t bytes = bytes_of(publisher->parked.front());
      if (take_batch(*publisher, publisher->parked.front(), now_ns) == Applied::step_first) return Applied::step_first;
      pop_parked(*publisher, bytes);
    }
  }
  return Applied::done;
}

/// Looks up the batch's records into records_. False: one of the objects was already defined or moved in this step.
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
  const bool more_follows = (sample.flags & wire_contract::kPosesMoreFollows) != 0;
  if (!more_follows || publisher.parts.size() >= limits_.parked_batches)
    return apply_instant(publisher, sample, now_ns);
  publisher.parts.push_back(std::move(sample));
  return Applied::done;
}

/// Applies all batches of an instant within one step, so that no question finds a robot's links half moved.
Applied Publishers::apply_instant(Publisher& publisher, const PoseSample& last, std::int64_t now_ns) {
  if (!publisher.said_again.empty() && last.sequence > 0 &&
      take_said_again(publisher, last.sequence) == Applied::step_first)
    return Applied::step_first;
  const bool is_alone = last.is_only_alive() && publisher.parts.empty();
  // An empty batch without a stamp has no time. From a publisher that never stamps, however, it means that its objects
  // have rested until now.
  const bool has_instant = !is_alone || (last.source_time_ns == 0 && publisher.clock.is_without_stamps());
  if (has_instant && (last.flags & wire_contract::kPosesBringsObjects) != 0) {
    publisher.brings_objects = true;
    world_.expect_objects(publisher.id);
  }
  if (has_instant && !publisher.entering.empty()) enter_with_instant(publisher, last.definitions_through);
  for (const PoseSample& part : publisher.parts) {
    if (!find_all(publisher, part)) return Applied::step_first;
  }
  if (!find_all(publisher, last)) return Applied::step_first;
  WorldStamp stamp;
  if (has_instant) stamp = publisher.clock.stamp(last.source_time_ns, last.received_ns);
  else note_alive(publisher, last);
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
  if (stamp.time_ns > 0) note_period(publisher, stamp.time_ns);
  counts_.stamps_late += stamp.kind == StampKind::late ? 1 : 0;
  counts_.stamps_jumped += stamp.kind == StampKind::jumped ? 1 : 0;
  counts_.stamps_missing += stamp.kind == StampKind::none ? 1 : 0;
  return Applied::done;
}

/// Applies the batch whose records find_all() looked up last.
void Publishers::apply_batch(Publisher& publisher, const PoseSample& sample, const WorldStamp& stamp,
                             std::int64_t now_ns) {
  if ((sample.flags & wire_contract::kPosesAllSaid) != 0) publisher.said_all = true;
  publisher.merged_poses += sample.merged;
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
    if (sample.merged > 0 && sample.merged_objects[i] != 0) note_merged(record->id, stamp.time_ns);
    ++accepted_count_;
  }
  const bool teleported = (sample.flags & wire_contract::kPosesTeleported) != 0 || stamp.kind == StampKind::jumped;
  const bool streamed = (sample.flags & wire_contract::kPosesStreamed) != 0;
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

/// Its objects may move on unreported, so they are known only up to one gap before.
void Publishers::note_alive(Publisher& publisher, const PoseSample& sample) {
  if (sample.source_time_ns == 0) return;
  SourceClock& clock = publisher.clock;
  // From its first message on a publisher has its own time, even if that message names no object.
  const std::optional<std::int64_t> time_ns = clock.has_started()
                                                  ? clock.alive_at(sample.source_time_ns, sample.received_ns)
                                                  : clock.stamp(sample.source_time_ns, sample.received_ns).time_ns;
  if (time_ns && world_.advance(publisher.id, *time_ns, true)) ++changes_;
}

/// One long pause is an object that rested; several in a row mean that the source is slower than its gap.
void Publishers::note_period(Publisher& publisher, std::int64_t time_ns) {
  constexpr std::uint32_t kSeveral = 3;
  const std::int64_t period_ns = time_ns - std::exchange(publisher.instant_ns, time_ns);
  const bool is_long = period_ns < time_ns && period_ns > publisher.gap_ns;
  publisher.long_periods = is_long ? publisher.long_periods + 1 : 0;
  if (publisher.long_periods < kSeveral || std::exchange(publisher.was_warned_of_gap, true)) return;
  notice(fmt::format(
      "publisher {} sends poses {:.3g} s apart, and its gap is {:.3g} s: after each pose its objects rest, and "
      "move only in the last {:.3g} s before the next. Publish with a longer gap",
      printable(publisher.name), static_cast<double>(period_ns) * wire_contract::kNanosecond_s,
      static_cast<double>(publisher.gap_ns) * wire_contract::kNanosecond_s,
      static_cast<double>(publisher.gap_ns) * wire_contract::kNanosecond_s));
}

void Publishers::note_merged(ObjectId id, std::int64_t until_ns) {
  const std::size_t slot = slot_of(id);
  if (slot >= merged_.size()) merged_.resize(slot + 1);
  merged_[slot] = {.step = step_, .until_ns = std::max(merged_[slot].until_ns, until_ns)};
}

void Publishers::refuse(const Publisher& publisher, const Record* record, const std::string& reason) {
  ++counts_.poses_refused;
  notice(fmt::format("pose of object {} of publisher {} refused: {}. Refused so far: {}.",
                     record ? printable(record->described->definition.name) : "?", printable(publisher.name), reason,
                     counts_.poses_refused));
}

/// Whether a pose is valid and newer than the known one; if so, the record holds it.
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
  const PublisherState heard = silent_ns > limits_.silent_after_ns ? PublisherState::silent : PublisherState::alive;
  // Its definitions were sent while there was no room for it, so they come only on request.
  const bool lacks_definitions =
      !publisher.parked.empty() && now_ns - publisher.parked.front().received_ns > limits_.asked_after_ns;
  const PublisherState here = lacks_definitions ? PublisherState::asked : heard;
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

bool Publishers::is_in_several_shards(std::uint64_t publisher) const {
  const Publisher* found = find(publisher);
  return found && found->brings_objects;
}

bool Publishers::is_complete(std::uint64_t publisher) const {
  const Publisher* found = find(publisher);
  return found && !found->lost && found->said_all;
}

std::uint64_t Publishers::applied_through(std::uint64_t publisher) const {
  const Publisher* found = find(publisher);
  return found ? found->watermark.through() : 0;
}

std::uint64_t Publishers::merged_poses(std::uint64_t publisher) const {
  const Publisher* found = find(publisher);
  return found ? found->merged_poses : 0;
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

std::size_t Publishers::left_out_count(std::uint64_t id) const {
  const Publisher* const publisher = find(id);
  if (publisher == nullptr) return 0;
  const auto& records = publisher->objects.records();
  return static_cast<std::size_t>(std::count_if(
      records.begin(), records.end(), [](const Record& record) { return !record.described->why_left_out.empty(); }));
}

}  // namespace collided::engine::service
