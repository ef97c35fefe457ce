#include "server/service/ingest/inbox.hpp"

#include <algorithm>
#include <utility>

#include "idl/topics.hpp"

namespace collided::engine::service {

using wire_contract::kPoseNumbers;

namespace {

std::size_t bytes_of(const DefinitionSample& sample) { return sizeof sample + sample.shape_bytes.size(); }

}  // namespace

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

void Inbox::push_in_order(Arrival arrival) {
  ordered_.emplace_back(next_place_++, std::move(arrival));
  arrived_.notify_one();
}

void Inbox::push(std::unique_ptr<DefinitionSample> sample) {
  const std::lock_guard lock(mutex_);
  definition_bytes_ += bytes_of(*sample);
  push_in_order(std::move(sample));
}

/// Once some poses of a publisher are merged, its later ones must be merged too: merged ones come last, so an unmerged
/// newer pose would be applied before an older one.
bool Inbox::must_merge(const PublisherLine& line, std::size_t poses) const {
  if (line.is_merging) return true;
  const auto is_above = [&](std::size_t times) {
    return batch_count_ >= times * limits_.batches || pose_count_ + poses > times * limits_.poses;
  };
  return is_above(1) && (line.size() >= limits_.own_batches || is_above(2));
}

void Inbox::push(std::unique_ptr<PoseSample> sample) {
  const std::lock_guard lock(mutex_);
  if (lines_.size() > limits_.merged_publishers) forget_idle_lines();
  PublisherLine& line = lines_[sample->publisher];
  if (must_merge(line, sample->object_numbers.size())) {
    merging_lines_ += std::exchange(line.is_merging, true) ? 0 : 1;
    merge(*sample);
    spares_.push_back(std::move(sample));
  } else {
    ++batch_count_;
    pose_count_ += sample->object_numbers.size();
    if (line.empty()) busy_.push_back(&line);
    line.queue.push_back({next_place_++, std::move(sample)});
  }
  arrived_.notify_one();
}

void Inbox::push(const WriterNews& news) {
  const std::lock_guard lock(mutex_);
  push_in_order(news);
}

bool Inbox::push_job(Job job) {
  const std::lock_guard lock(mutex_);
  if (job_count_ >= limits_.jobs) return false;
  ++job_count_;
  push_in_order(std::move(job));
  return true;
}

void Inbox::push_own_job(Job job) {
  const std::lock_guard lock(mutex_);
  ++job_count_;
  push_in_order(std::move(job));
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
  has_replaced.clear();
  replaced = 0;
  source_time_ns = received_ns = 0;
  flags = 0;
}

void Inbox::merge(const PoseSample& sample) {
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
  // A restarted publisher: poses of its earlier run are obsolete.
  if (sample.incarnation > merged.incarnation) {
    counts_.poses_superseded += merged.numbers.size();
    merged_count_ -= merged.numbers.size();
    merged.clear();
    merged.incarnation = sample.incarnation;
  }
  merged.sequence = std::max(merged.sequence, sample.sequence);
  merged.definitions_through = std::max(merged.definitions_through, sample.definitions_through);
  merged.flags |= sample.flags & wire_contract::kPosesAllSaid;
  // A sign of life must not change the time of the poses before it, nor how their objects move.
  if (!sample.is_only_alive()) {
    merged.flags |= sample.flags & wire_contract::kPosesStreamed;
    merged.source_time_ns = sample.source_time_ns;
    merged.received_ns = sample.received_ns;
  }
  for (std::size_t i = 0; i < count; ++i) merge_pose(merged, sample, i);
}

void Inbox::merge_pose(Merged& merged, const PoseSample& sample, std::size_t index) {
  const std::uint32_t number = sample.object_numbers[index];
  std::uint32_t place = merged.index.find(number);
  if (place != NumberIndex::kNone) {
    ++counts_.poses_superseded;
    ++merged.replaced;
    merged.has_replaced[place] = 1;
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
    merged.has_replaced.push_back(0);
  }
  std::copy_n(&sample.poses[index * kPoseNumbers], kPoseNumbers, &merged.poses[place * kPoseNumbers]);
  // A teleport stays one even when its pose is superseded, or the step would sweep the object across the room.
  if ((sample.flags & wire_contract::kPosesTeleported) != 0) merged.teleported[place] = 1;
}

std::unique_ptr<PoseSample> Inbox::start_slice(std::uint64_t publisher, const Merged& merged, bool teleported) {
  std::unique_ptr<PoseSample> slice = spare_locked();
  slice->publisher = publisher;
  slice->incarnation = merged.incarnation;
  slice->sequence = merged.sequence;
  slice->definitions_through = merged.definitions_through;
  slice->source_time_ns = merged.source_time_ns;
  slice->received_ns = merged.received_ns;
  slice->merged = 0;
  slice->merged_objects.clear();
  slice->has_odd_columns = false;  // a spare sample still has its old value
  slice->flags = merged.flags | (teleported ? wire_contract::kPosesTeleported : 0);
  slice->object_numbers.clear();
  slice->poses.clear();
  slice->velocities.clear();
  return slice;
}

/// All slices of a publisher but its last are marked as followed by more, so they land in one step.
void Inbox::unpack(std::uint64_t publisher, Merged& merged, std::vector<Arrival>& arrivals) {
  PoseSample* last = nullptr;
  const auto put = [&](std::unique_ptr<PoseSample> slice) {
    if (last != nullptr) last->flags |= wire_contract::kPosesMoreFollows;
    last = slice.get();
    last->merged = std::exchange(merged.replaced, 0);
    arrivals.emplace_back(std::move(slice));
  };
  // The teleported flag is one of the whole batch, so teleported objects travel in slices of their own.
  for (const bool teleported : {false, true}) {
    std::unique_ptr<PoseSample> slice;
    for (std::size_t i = 0; i < merged.numbers.size(); ++i) {
      if ((merged.teleported[i] != 0) != teleported) continue;
      if (!slice) slice = start_slice(publisher, merged, teleported);
      slice->object_numbers.push_back(merged.numbers[i]);
      slice->merged_objects.push_back(merged.has_replaced[i]);
      const double* pose = &merged.poses[i * kPoseNumbers];
      slice->poses.insert(slice->poses.end(), pose, pose + kPoseNumbers);
      if (slice->object_numbers.size() == wire_contract::kMaxPosesPerBatch) put(std::exchange(slice, nullptr));
    }
    if (slice) put(std::move(slice));
  }
  merged_count_ -= merged.numbers.size();
  merged.clear();
}

void Inbox::unpack_merged(std::vector<Arrival>& arrivals) {
  constexpr std::size_t kMostKept = 64;  // publishers whose memory is kept; some of them may be gone
  if (merging_lines_ == 0 || !ordered_.empty()) return;
  for (auto& [publisher, line] : lines_) {
    if (!line.is_merging || !line.empty()) continue;
    const auto merged = merged_.find(publisher);
    if (merged != merged_.end()) unpack(publisher, merged->second, arrivals);
    line.is_merging = false;
    --merging_lines_;
  }
  if (merging_lines_ == 0 && merged_.size() > kMostKept) merged_.clear();
}

std::unique_ptr<PoseSample> Inbox::PublisherLine::pop() {
  std::unique_ptr<PoseSample> sample = std::move(queue[head++].sample);
  // The consumed part is erased once it is the greater one, so that each batch is moved at most once.
  if (2 * head >= queue.size()) {
    queue.erase(queue.begin(), queue.begin() + static_cast<std::ptrdiff_t>(head));
    head = 0;
  }
  return sample;
}

/// Takes each publisher's batches of one instant, if they came before the next definition, news or job.
void Inbox::take_instants(std::vector<Arrival>& arrivals) {
  const std::uint64_t until = ordered_.empty() ? next_place_ : ordered_.front().first;
  std::sort(busy_.begin(), busy_.end(),
            [](const PublisherLine* a, const PublisherLine* b) { return a->first_place() < b->first_place(); });
  for (PublisherLine* line : busy_) {
    for (bool more = true; more && !line->empty() && line->first_place() < until;) {
      std::unique_ptr<PoseSample> sample = line->pop();
      more = (sample->flags & wire_contract::kPosesMoreFollows) != 0;
      --batch_count_;
      pose_count_ -= sample->object_numbers.size();
      arrivals.emplace_back(std::move(sample));
    }
  }
  std::erase_if(busy_, [](const PublisherLine* line) { return line->empty(); });
}

/// Takes definitions, news and jobs that have no earlier poses waiting before them.
void Inbox::take_ordered(std::vector<Arrival>& arrivals) {
  std::uint64_t until = next_place_;
  for (const PublisherLine* line : busy_) until = std::min(until, line->first_place());
  while (!ordered_.empty() && ordered_.front().first < until) {
    Arrival arrival = std::move(ordered_.front().second);
    ordered_.pop_front();
    if (const auto* definition = std::get_if<std::unique_ptr<DefinitionSample>>(&arrival))
      definition_bytes_ -= bytes_of(**definition);
    if (std::holds_alternative<Job>(arrival)) --job_count_;
    arrivals.push_back(std::move(arrival));
  }
}

void Inbox::forget_idle_lines() {
  std::erase_if(lines_, [](const auto& line) { return line.second.empty() && !line.second.is_merging; });
}

void Inbox::take_round(std::chrono::steady_clock::time_point until, std::vector<Arrival>& arrivals) {
  arrivals.clear();
  std::unique_lock lock(mutex_);
  arrived_.wait_until(lock, until, [&] { return woken_ || !busy_.empty() || !ordered_.empty() || merging_lines_ > 0; });
  woken_ = false;
  take_instants(arrivals);
  take_ordered(arrivals);
  unpack_merged(arrivals);
}

InboxCounts Inbox::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

}  // namespace collided::engine::service
