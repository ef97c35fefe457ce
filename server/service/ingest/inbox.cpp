#include "server/service/ingest/inbox.hpp"

#include <algorithm>
#include <utility>

#include "idl/topics.hpp"

namespace collided::engine::service {

using wire_contract::kPoseNumbers;

std::unique_ptr<PoseSample> Inbox::spare_locked() {
  if (spares_.empty()) return std::make_unique<PoseSample>();
  std::unique_ptr<PoseSample> sample = std::move(spares_.back());
  spares_.pop_back();
  return sample;
}

std::unique_ptr<PoseSample> Inbox::spare() {
  const std::lock_guard lock(mutex_);
  return spare_locked();
}

void Inbox::give_back(std::unique_ptr<PoseSample> sample) {
  const std::lock_guard lock(mutex_);
  if (spares_.size() < limits_.batches) spares_.push_back(std::move(sample));
}

bool Inbox::has_room_for_definitions() const {
  const std::lock_guard lock(mutex_);
  return definition_bytes_ < limits_.definition_bytes;
}

void Inbox::push(std::unique_ptr<DefinitionSample> sample) {
  const std::lock_guard lock(mutex_);
  definition_bytes_ += sizeof *sample + sample->shape_bytes.size();
  arrivals_.emplace_back(std::move(sample));
  arrived_.notify_one();
}

void Inbox::push(std::unique_ptr<PoseSample> sample) {
  const std::lock_guard lock(mutex_);
  const bool full = batch_count_ >= limits_.batches || pose_count_ + sample->object_numbers.size() > limits_.poses;
  // Once some poses are merged, later ones must be merged too: merged poses are drained last, so an unmerged newer pose
  // would be applied before an older one.
  if (full || merging_) {
    merge(*sample);
    spares_.push_back(std::move(sample));
  } else {
    ++batch_count_;
    pose_count_ += sample->object_numbers.size();
    arrivals_.emplace_back(std::move(sample));
  }
  arrived_.notify_one();
}

void Inbox::push(const WriterNews& news) {
  const std::lock_guard lock(mutex_);
  arrivals_.emplace_back(news);
  arrived_.notify_one();
}

bool Inbox::push_job(Job job) {
  const std::lock_guard lock(mutex_);
  if (job_count_ >= limits_.jobs) return false;
  ++job_count_;
  arrivals_.emplace_back(std::move(job));
  arrived_.notify_one();
  return true;
}

void Inbox::wake() {
  const std::lock_guard lock(mutex_);
  woken_ = true;
  arrived_.notify_one();
}

void Inbox::Merged::clear() {
  index.forget(numbers);
  numbers.clear();
  poses.clear();
  teleported.clear();
  incarnation = sequence = definitions_through = 0;
}

void Inbox::merge(const PoseSample& sample) {
  merging_ = true;
  const std::size_t count = sample.object_numbers.size();
  const bool one_too_many = merged_.size() >= limits_.merged_publishers && !merged_.contains(sample.publisher);
  if (sample.poses.size() != count * kPoseNumbers || one_too_many) {
    counts_.poses_dropped += count;
    return;
  }
  Merged& merged = merged_[sample.publisher];
  if (sample.incarnation < merged.incarnation) {
    counts_.poses_superseded += count;
    return;
  }
  // A restarted publisher: poses of its earlier run mean nothing any more.
  if (sample.incarnation > merged.incarnation) {
    counts_.poses_superseded += merged.numbers.size();
    merged_count_ -= merged.numbers.size();
    merged.clear();
    merged.incarnation = sample.incarnation;
  }
  merged.sequence = std::max(merged.sequence, sample.sequence);
  merged.definitions_through = std::max(merged.definitions_through, sample.definitions_through);
  merged.source_time_ns = sample.source_time_ns;
  merged.received_ns = sample.received_ns;
  for (std::size_t i = 0; i < count; ++i) merge_pose(merged, sample, i);
}

void Inbox::merge_pose(Merged& merged, const PoseSample& sample, std::size_t index) {
  const std::uint32_t number = sample.object_numbers[index];
  std::uint32_t place = merged.index.find(number);
  if (place != NumberIndex::kNone) {
    ++counts_.poses_superseded;
  } else if (merged_count_ >= limits_.merged_objects) {
    ++counts_.poses_dropped;
    return;
  } else {
    ++merged_count_;
    place = static_cast<std::uint32_t>(merged.numbers.size());
    merged.index.set(number, place);
    merged.numbers.push_back(number);
    merged.poses.resize(merged.poses.size() + kPoseNumbers);
    merged.teleported.push_back(0);
  }
  std::copy_n(&sample.poses[index * kPoseNumbers], kPoseNumbers, &merged.poses[place * kPoseNumbers]);
  // A teleport stays one even when its pose is superseded, or the step would sweep the object across the room.
  if ((sample.flags & wire_contract::kTeleported) != 0) merged.teleported[place] = 1;
}

std::unique_ptr<PoseSample> Inbox::start_slice(std::uint64_t publisher, const Merged& merged, bool teleported) {
  std::unique_ptr<PoseSample> slice = spare_locked();
  slice->publisher = publisher;
  slice->incarnation = merged.incarnation;
  slice->sequence = merged.sequence;
  slice->definitions_through = merged.definitions_through;
  slice->source_time_ns = merged.source_time_ns;
  slice->received_ns = merged.received_ns;
  slice->has_odd_columns = false;  // a spare sample still says what it was
  slice->flags = teleported ? wire_contract::kTeleported : 0;
  slice->object_numbers.clear();
  slice->poses.clear();
  slice->velocities.clear();
  return slice;
}

void Inbox::unpack_merged(std::vector<Arrival>& arrivals) {
  constexpr std::size_t kMostKept = 64;  // publishers whose memory is kept; some of them may be gone
  for (auto& [publisher, merged] : merged_) {
    PoseSample* last = nullptr;
    // All slices of a publisher but its last are marked as followed by more, so they land in one step.
    const auto put = [&](std::unique_ptr<PoseSample> slice) {
      if (last != nullptr) last->flags |= wire_contract::kMoreFollows;
      last = slice.get();
      arrivals.emplace_back(std::move(slice));
    };
    // The teleported flag is one of the whole batch, so teleported objects travel in slices of their own.
    for (const bool teleported : {false, true}) {
      std::unique_ptr<PoseSample> slice;
      for (std::size_t i = 0; i < merged.numbers.size(); ++i) {
        if ((merged.teleported[i] != 0) != teleported) continue;
        if (!slice) slice = start_slice(publisher, merged, teleported);
        slice->object_numbers.push_back(merged.numbers[i]);
        const double* pose = &merged.poses[i * kPoseNumbers];
        slice->poses.insert(slice->poses.end(), pose, pose + kPoseNumbers);
        if (slice->object_numbers.size() == wire_contract::kMaxPosesPerBatch) put(std::exchange(slice, nullptr));
      }
      if (slice) put(std::move(slice));
    }
    merged.clear();
  }
  if (merged_.size() > kMostKept) merged_.clear();
  merging_ = false;
  merged_count_ = 0;
}

void Inbox::drain(std::chrono::steady_clock::time_point until, std::vector<Arrival>& arrivals) {
  arrivals.clear();
  std::unique_lock lock(mutex_);
  arrived_.wait_until(lock, until, [&] { return woken_ || !arrivals_.empty() || merging_; });
  woken_ = false;
  arrivals_.swap(arrivals);
  unpack_merged(arrivals);
  batch_count_ = 0;
  pose_count_ = 0;
  job_count_ = 0;
  definition_bytes_ = 0;
}

InboxCounts Inbox::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

}  // namespace collided::engine::service
