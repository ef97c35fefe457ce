#include "server/service/world_loop.hpp"

#include <pthread.h>

#include <algorithm>
#include <bit>
#include <new>
#include <thread>

#include "idl/columns.hpp"
#include "server/geometry/float_environment.hpp"
#include "server/intake/scene_file/scene_file.hpp"
#include "server/service/questions/validation.hpp"
#include "server/service/runtime/out_of_memory.hpp"
#include "server/world/fences/fences.hpp"
#include "server/world/solids/declared.hpp"

namespace collided::engine::service {

using wire_contract::ServerState;

namespace {

void count_objects(const Snapshot& state, StatusColumns& status) {
  status.scenes.clear();
  status.static_triangles = 0;
  for (const auto& scene : state.scenes) {
    status.static_triangles += scene->mesh.triangles.size();
    status.scenes += (status.scenes.empty() ? "" : "\n") + scene->name;
  }
  status.object_count = state.objects.counts().objects;
  status.moving_count = state.objects.counts().moving;
}

}  // namespace

void WorldLoop::stop() {
  stopping_.store(true);
  with_.inbox.wake();
}

std::chrono::steady_clock::time_point WorldLoop::next_wake() const {
  std::int64_t next_ns = next_status_ns_;
  if (with_.event_writer.watermarks_wanted()) next_ns = std::min(next_ns, next_watermark_ns_);
  if (pending_changes_ > 0) next_ns = std::min(next_ns, next_step_ns_);
  return std::chrono::steady_clock::time_point(std::chrono::nanoseconds(next_ns));
}

void WorldLoop::run() {
  pthread_setname_np(pthread_self(), "world");
  thread_.store(std::this_thread::get_id());
  try {
    serve();
  } catch (const std::bad_alloc&) { end_out_of_memory("the world's thread"); }
}

void WorldLoop::serve() {
  // Every shard is written once, even the empty ones, so that a client that waits for all of them need not guess.
  broadcast_.mark_all();
  publish();
  next_status_ns_ = steady_ns();
  next_step_ns_ = next_status_ns_;
  while (!stopping_.load()) {
    with_.inbox.take_round(next_wake(), arrivals_);
    if (restore_float_environment()) ++with_.questions.float_repairs;
    take_arrivals();
    step_if_due();
    // Samples that changed nothing need no step, but a question may wait for them.
    if (pending_changes_ == 0) release_passed_barriers();
    keep_time();
  }
  end_contacts();
  write_status(ServerState::stopping);
}

void WorldLoop::take_arrivals() {
  taking_since_ns_ = steady_ns();
  for (Arrival& arrival : arrivals_) {
    const std::size_t known = publishers_.size();
    take(arrival);
    if (publishers_.size() > known && with_.has_new_publisher) with_.has_new_publisher();
    keep_time();
  }
  apply([&] { return publishers_.release_parked(with_.clock.now_ns()); });
  count_taking(steady_ns());
  taking_since_ns_ = 0;
}

/// Counts the time since the last reading as spent on taking samples, if any are being taken: a step may come between.
void WorldLoop::count_taking(std::int64_t now_ns) {
  if (taking_since_ns_ == 0) return;
  taken_ns_ += now_ns - taking_since_ns_;
  sums_.take_ns.add(static_cast<std::uint64_t>(now_ns - taking_since_ns_));
  taking_since_ns_ = now_ns;
}

/// Writes a status twenty times a second, half as often while it has no reader, regardless of how much has arrived.
/// During a longer step the heartbeat repeats it. Rarer tasks are done every tenth of a second.
void WorldLoop::keep_time() {
  constexpr std::int64_t kTickNs = 100'000'000;
  const std::int64_t now_ns = steady_ns();
  if (now_ns >= next_watermark_ns_) write_watermark();
  if (now_ns < next_status_ns_) return;
  next_status_ns_ = now_ns + with_.event_writer.status_period_ns();
  publishers_.settle(with_.clock.now_ns());
  if (recovering() && has_recovered()) recovering_.store(false);
  write_status(state());
  settled_lately_ns_.store(status_.settled_ns, std::memory_order_release);
  if (now_ns < next_tick_ns_) return;
  next_tick_ns_ = now_ns + kTickNs;
  // An entry into a band is reported once it has lasted, and the nearest once all are known, even if nothing moves.
  if (const Fences* fences = with_.world.fences(); fences != nullptr && fences->waits_for_time()) note_change();
  // The space that a lost publisher's objects may have reached grows with time, and more becomes undecided.
  if (!with_.world.newest()->stale_objects.empty()) note_change();
  if (say_again_ns_ != 0 && now_ns >= say_again_ns_) {
    say_again_ns_ = 0;
    broadcast_.mark_all();
    standing_broadcast_.mark_all();
    note_change();
  }
  with_.tick();
  say_notices();
}

/// Whether the recovery is over: objects added by commands are restored and, after a crash, the publishers from before
/// it are back. A lease must have passed too, for a publisher that came just before the crash and was not stored. The
/// wait for publishers has a limit.
bool WorldLoop::has_recovered() const {
  if (with_.is_adding_again && with_.is_adding_again()) return false;
  if (options_.recovery_ns == 0) return true;
  const std::int64_t waited_ns = steady_ns() - started_ns_;
  const bool is_early = waited_ns < wire_contract::kPublisherLeaseNs;
  if (!is_early && with_.has_all_back && with_.has_all_back()) return true;
  if (waited_ns < options_.recovery_ns) return false;
  with_.notice("not every publisher from before the crash has come back; ready without them");
  return true;
}

/// Offers a sample until it is applied, and steps whenever it requires a step first.
template <class Apply>
void WorldLoop::apply(Apply&& once) {
  while (once() == Applied::step_first) step_now();
}

void WorldLoop::take(Arrival& arrival) {
  const std::int64_t now_ns = with_.clock.now_ns();
  if (auto* definition = std::get_if<std::unique_ptr<DefinitionSample>>(&arrival)) {
    take(**definition);
  } else if (auto* poses = std::get_if<std::unique_ptr<PoseSample>>(&arrival)) {
    apply([&] { return publishers_.move(**poses, now_ns); });
    with_.inbox.give_back(std::move(*poses));
  } else if (const auto* news = std::get_if<WriterNews>(&arrival)) {
    if (news->alive) {
      publishers_.writer_alive(news->publisher, news->kind, now_ns);
    } else {
      apply([&] { return publishers_.writer_lost(news->publisher, news->kind, now_ns); });
    }
  } else {
    std::get<Job>(arrival)();
  }
}

/// Makes a publisher's mesh solid, if there is one, or has the definition refused.
void WorldLoop::declare_solid(DefinitionSample& sample, bool by_winding) const {
  const auto& mesh = std::get<Shape>(sample.shape).mesh;
  if (!mesh) return;
  DeclaredMesh declared = declare_solid_at_once(mesh, by_winding ? SolidBy::winding : SolidBy::closing);
  if (!declared.solid && !declared.winding) {
    sample.shape = Refusal{"it is not solid: " + declared.refusal};
    return;
  }
  if (!declared.warning.empty()) with_.notice("object " + printable(sample.name) + ": " + declared.warning);
  sample.indexed = std::move(declared.indexed);
  sample.solid = std::move(declared.solid);
  sample.winding = std::move(declared.winding);
}

void WorldLoop::take(DefinitionSample& sample) {
  const std::int64_t now_ns = with_.clock.now_ns();
  if (!sample.removed && !sample.claims) {
    DecodedShape decoded = decode_shape(std::as_bytes(std::span(sample.shape_bytes)));
    if (decoded.shape) {
      sample.shape = std::move(*decoded.shape);
      if (decoded.is_solid) declare_solid(sample, decoded.by_winding);
    } else {
      sample.shape = Refusal{std::move(decoded.refusal)};
    }
  }
  apply([&] { return publishers_.define(sample, now_ns); });
  // Poses that waited for this definition are applied before anything sent later by their publisher.
  apply([&] { return publishers_.release_parked(now_ns); });
}

/// Steps if something has changed and the period since the last step is over.
void WorldLoop::step_if_due() {
  pending_changes_ += publishers_.take_changes() + std::exchange(own_changes_, 0);
  if (pending_changes_ == 0) return;
  const std::int64_t now_ns = steady_ns();
  if (now_ns < next_step_ns_) return;
  step_now();
  if (options_.step_ns > 0) {
    // Counted from the due time, not from now, so that the period holds on average.
    next_step_ns_ = std::max(next_step_ns_ + options_.step_ns, now_ns - options_.step_ns);
  } else {
    // A pause as long as the step itself, so that the batches of one tick of a publisher share a step.
    constexpr std::int64_t kLongestPauseNs = 5'000'000;
    const std::int64_t end_ns = steady_ns();
    next_step_ns_ = end_ns + std::min(end_ns - now_ns, kLongestPauseNs);
  }
}

void WorldLoop::speak(const SpokenBefore& before) {
  const std::uint64_t first = with_.event_writer.speak(before);
  const std::uint64_t from = first != 0 ? first : with_.world.last_event_sequence() + 1;
  // If it was kept from publishing, it also publishes earlier events once it may.
  told_from_ = told_from_ == 0 ? from : std::min(told_from_, from);
  broadcast_.mark_all();
  standing_broadcast_.mark_all();
  step_now();
  write_status(state());
  // Clients that still followed the old primary ignored these messages; send them again shortly.
  constexpr std::int64_t kSoonNs = 300'000'000;
  say_again_ns_ = steady_ns() + kSoonNs;
}

WriteBarriers::Applied WorldLoop::say_last_words() {
  step_now();
  write_status(ServerState::stopping);
  with_.event_writer.fall_silent();
  WriteBarriers::Applied applied;
  publishers_.list_applied(applied);
  return applied;
}

void WorldLoop::step_now() {
  const std::int64_t started_ns = steady_ns();
  count_taking(started_ns);
  pending_changes_ += publishers_.take_changes() + std::exchange(own_changes_, 0);
  const bool leaves_out = with_.leaves_out_details && with_.leaves_out_details();
  settled_before_ns_ = with_.world.newest()->settled_ns;
  const StepOptions step_options{.contacts = with_.event_writer.contacts_wanted(),
                                 .persisted = with_.event_writer.persisted_wanted() && !leaves_out};
  while (!with_.world.step(with_.clock.now_ns(), std::max<std::uint64_t>(1, pending_changes_), step_options)) {
    // Readers hold every free state. Workers release theirs within an answer's time, requests in chunks within 2 s.
    ++counts_.stalled_steps;
    sums_.stalled_steps.add(1);
    with_.leases.expire(steady_ns());
    std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
  pending_changes_ = 0;
  ++counts_.steps;
  say_skipped_sweeps();
  publishers_.stepped();
  const std::int64_t stepped_ns = steady_ns();
  publish();
  sum_up(started_ns, stepped_ns);
}

/// Adds a step to the sums and traces, which any thread may read.
void WorldLoop::sum_up(std::int64_t started_ns, std::int64_t stepped_ns) {
  const std::int64_t ended_ns = steady_ns();
  const StepCost& cost = with_.world.cost();
  sums_.steps.add(1);
  sums_.update_ns.add(static_cast<std::uint64_t>(cost.update_ns));
  sums_.index_ns.add(static_cast<std::uint64_t>(cost.broad_ns));
  sums_.test_ns.add(static_cast<std::uint64_t>(cost.exact_ns));
  sums_.events_ns.add(static_cast<std::uint64_t>(cost.events_ns));
  sums_.publish_ns.add(static_cast<std::uint64_t>(ended_ns - stepped_ns));
  sums_.poses.applied.set(publishers_.counts().poses_applied);
  sums_.pairs.moved.add(cost.moved);
  sums_.pairs.candidates.add(cost.candidate_pairs);
  sums_.pairs.filtered.add(cost.filtered);
  sums_.pairs.exact_tests.add(cost.exact_tests);
  sums_.pairs.undecided.add(cost.undecided);
  sums_.pairs.in_doubt.set(with_.world.doubt_count());
  sums_.pairs.swept.add(cost.swept);
  sums_.pairs.kept_apart.add(cost.kept_apart);
  sum_up_fences();
  sums_.durations.add(ended_ns - started_ns);
  const SnapshotRing::Lease state = with_.world.newest();
  traces_.add({.version = state->version,
               .world_time_ns = state->world_time_ns,
               .take_ns = taken_ns_,
               .update_ns = cost.update_ns,
               .index_ns = cost.broad_ns,
               .test_ns = cost.exact_ns,
               .events_ns = cost.events_ns,
               .publish_ns = ended_ns - stepped_ns,
               .whole_ns = taken_ns_ + ended_ns - started_ns,
               .moved = cost.moved,
               .candidates = cost.candidate_pairs,
               .exact_tests = cost.exact_tests,
               .contacts = cost.contacts,
               .events = static_cast<std::uint32_t>(with_.world.events().size())});
  taken_ns_ = 0;
  if (taking_since_ns_ != 0) taking_since_ns_ = ended_ns;
}

void WorldLoop::sum_up_fences() {
  const Fences* fences = with_.world.fences();
  if (fences == nullptr) return;
  for (const Event& event : fences->events()) {
    if (event.kind == EventKind::began) ++objects_in_[event.of.b];
    if (event.kind != EventKind::ended) continue;
    const auto found = objects_in_.find(event.of.b);
    if (found != objects_in_.end() && --found->second == 0) objects_in_.erase(found);
  }
  sums_.fences.count.set(fences->table().count());
  sums_.fences.entered.set(objects_in_.size());
  sums_.fences.inside.set(fences->inside().size());
  sums_.fences.events.set(fences->last_sequence());
  sums_.fences.cut_short.set(fences->cut_short());
}

void WorldLoop::sum_up_poses() {
  const InboxCounts inbox = with_.inbox.counts();
  const PublisherCounts& counts = publishers_.counts();
  sums_.poses.late.set(counts.poses_late);
  sums_.poses.unknown.set(counts.poses_unknown);
  sums_.poses.refused.set(counts.poses_refused);
  sums_.poses.superseded.set(inbox.poses_superseded);
  sums_.poses.dropped.set(inbox.poses_dropped);
  sums_.stamps.late.set(counts.stamps_late);
  sums_.stamps.jumped.set(counts.stamps_jumped);
  sums_.stamps.missing.set(counts.stamps_missing);
}

void WorldLoop::publish() {
  const auto is_merged = [this](ObjectId id) { return publishers_.is_merged(id, settled_before_ns_); };
  const std::uint64_t told = std::exchange(told_sequence_, with_.world.last_event_sequence());
  broadcast_.publish(is_merged);
  if (told == told_sequence_) write_watermark();
  standing_broadcast_.publish(is_merged);
  if (!probes_.empty() && with_.event_writer.probes_wanted()) {
    const SnapshotRing::Lease state = with_.world.newest();
    publish_probes({.version = state->version, .world_time_ns = state->world_time_ns});
  }
  release_passed_barriers();
  if (with_.event_writer.steps_wanted()) write_step();
}

/// Beside frames of events and statuses, which have it too: watches of several shards wait for each shard's.
void WorldLoop::write_watermark() {
  if (!with_.event_writer.watermarks_wanted()) return;
  next_watermark_ns_ = steady_ns() + wire_contract::kWatermarkPeriodNs;
  const SnapshotRing::Lease newest = with_.world.newest();
  with_.event_writer.write_watermark(
      with_.world.last_event_sequence() + 1,
      {.version = newest->version, .world_time_ns = newest->world_time_ns, .settled_ns = settled_ns()});
}

std::int64_t WorldLoop::settled_ns() const {
  const bool is_stepped = pending_changes_ == 0 && own_changes_ == 0 && !publishers_.has_changes();
  return is_stepped ? with_.world.settled_ns(with_.clock.now_ns()) : with_.world.newest()->settled_ns;
}

const std::vector<ProbeReading>& WorldLoop::read_probes() {
  probes_.read(
      *with_.world.newest(), [&](std::string_view name) { return with_.world.find(name); }, probe_readings_);
  return probe_readings_;
}

/// Writes the probes' readings, in frames of kMaxProbesPerFrame.
void WorldLoop::publish_probes(const Stamp& stamp) {
  const auto name_of = [&](ObjectId id) {
    const ObjectInfo* info = with_.world.info(id);
    return info ? std::string_view(info->name) : std::string_view();
  };
  const auto send = [&] {
    put_names(probe_columns_, name_of);
    with_.event_writer.write_probes(probe_columns_, stamp);
    wire::clear(probe_columns_);
  };
  const std::vector<ProbeReading>& readings = read_probes();
  wire::clear(probe_columns_);
  for (std::size_t i = 0; i < readings.size(); ++i) {
    probe_columns_.add(probes_.definition(i).name, readings[i]);
    if (probe_columns_.size() == wire_contract::kMaxProbesPerFrame) send();
  }
  if (probe_columns_.size() > 0) send();
}

void WorldLoop::release_passed_barriers() {
  publishers_.list_applied(applied_);
  with_.write_barriers.update(applied_);
  for (AskPointer& ask : with_.write_barriers.take_ready()) with_.admit(std::move(ask));
}

void WorldLoop::write_status(ServerState state) {
  const SnapshotRing::Lease newest = with_.world.newest();
  const InboxCounts inbox = with_.inbox.counts();
  const PublisherCounts& counts = publishers_.counts();
  status_.stamp = {.version = newest->version, .world_time_ns = newest->world_time_ns};
  status_.state = state;
  status_.last_event_sequence = with_.world.last_event_sequence();
  status_.settled_ns = settled_ns();
  status_.heir_of = with_.place.predecessor();
  status_.told_from = told_from_;
  status_.contact_count = static_cast<std::uint32_t>(with_.world.contacts().size());
  status_.contact_hash = broadcast_.contact_hash();
  status_.contacts_truncated = newest->contacts_truncated;
  status_.poses_applied = counts.poses_applied;
  status_.poses_dropped =
      counts.poses_late + counts.poses_unknown + counts.poses_refused + inbox.poses_superseded + inbox.poses_dropped;
  status_.questions_answered = with_.questions.answered.load();
  status_.questions_refused = with_.questions.refused.load();
  status_.undecided_answers = with_.questions.undecided.load();
  count_objects(*newest, status_);
  list_publishers(true);
  sum_up_poses();
  with_.event_writer.write_status(status_);
  standing_broadcast_.publish_sum(state);
}

/// Writes only values that change with every step, so it costs little more than listing the publishers.
void WorldLoop::write_step() {
  const SnapshotRing::Lease newest = with_.world.newest();
  status_.stamp = {.version = newest->version, .world_time_ns = newest->world_time_ns};
  list_publishers(false);
  with_.event_writer.write_step(status_);
}

void WorldLoop::list_publishers(bool with_names) {
  wire::clear(status_);
  auto applied = applied_.begin();
  const bool asks = steady_ns() < asks_until_ns_.load(std::memory_order_relaxed);
  publishers_.for_each(with_.clock.now_ns(), [&](const PublisherView& view) {
    status_.publishers.push_back(view.publisher);
    // Only samples in a published state count, not those that wait for the next step. Both lists are ascending by
    // publisher.
    applied = std::find_if(applied, applied_.end(), [&](const auto& entry) { return entry.first >= view.publisher; });
    const bool found = applied != applied_.end() && applied->first == view.publisher;
    status_.applied_sequences.push_back(found ? applied->second : 0);
    status_.silent_ns.push_back(view.silent_ns);
    const bool is_asked = asks && view.state != wire_contract::PublisherState::lost;
    status_.publisher_states.push_back(
        static_cast<std::uint8_t>(is_asked ? wire_contract::PublisherState::asked : view.state));
  });
  if (with_names) list_publisher_names();
}

void WorldLoop::ask_publishers_again() {
  constexpr std::int64_t kLongNs = 1'000'000'000;
  asks_until_ns_.store(steady_ns() + kLongNs, std::memory_order_relaxed);
}

void WorldLoop::list_publisher_names() {
  const std::lock_guard lock(publisher_names_mutex_);
  publisher_names_.clear();
  publisher_clocks_.clear();
  publishers_.for_each(with_.clock.now_ns(), [&](const PublisherView& view) {
    publisher_names_.emplace(view.publisher, view.name);
    status_.publisher_names.insert(status_.publisher_names.end(), view.name.begin(), view.name.end());
    status_.publisher_names.push_back(0);
    if (view.state == wire_contract::PublisherState::alive && view.behind_ns)
      publisher_clocks_.push_back({std::string(view.name), *view.behind_ns});
  });
}

std::vector<PublisherClock> WorldLoop::publisher_clocks() const {
  const std::lock_guard lock(publisher_names_mutex_);
  return publisher_clocks_;
}

std::string WorldLoop::publisher_name(std::uint64_t publisher) const {
  const std::lock_guard lock(publisher_names_mutex_);
  const auto found = publisher_names_.find(publisher);
  return found == publisher_names_.end() ? std::string() : found->second;
}

/// Ends all contacts, and empties all fences, by removing their moving objects: a contact ends with either of its
/// objects, and a part of a scene cannot be removed alone.
void WorldLoop::end_contacts() {
  std::vector<ObjectId> objects;
  for (const OpenContact& contact : with_.world.contacts()) {
    objects.push_back(contact.a);
    objects.push_back(contact.b);
  }
  for (const OpenContact& inside : standing_broadcast_.open()) objects.push_back(inside.a);
  std::sort(objects.begin(), objects.end());
  objects.erase(std::unique(objects.begin(), objects.end()), objects.end());
  for (const ObjectId id : objects) {
    const ObjectInfo* info = with_.world.info(id);
    if (info && info->moving) with_.world.remove(id, EndReason::server_stopping);
  }
  if (!objects.empty()) step_now();
}

/// Reports skipped sweeps at the first one and whenever their number has doubled: a line for each step would flood the
/// log.
void WorldLoop::say_skipped_sweeps() {
  const std::uint64_t before = counts_.sweeps_skipped;
  counts_.sweeps_skipped += with_.world.cost().sweeps_skipped;
  if (std::bit_width(before) == std::bit_width(counts_.sweeps_skipped)) return;
  with_.notice(
      "the motions of " + std::to_string(counts_.sweeps_skipped) +
      " pairs could not be followed from pose to pose to their end; contacts between two poses may be missing");
}

void WorldLoop::say_notices() {
  for (const std::string& sentence : publishers_.take_notices()) with_.notice(sentence);
}

}  // namespace collided::engine::service
