#include "server/service/world_loop.hpp"

#include <algorithm>
#include <bit>
#include <thread>

#include "server/geometry/float_environment.hpp"
#include "server/intake/scene_file.hpp"

namespace collided::service {

using wire_contract::EndReason;
using wire_contract::EventKind;
using wire_contract::ServerState;

namespace {

void count_objects(const Snapshot& state, StatusColumns& status) {
  status.scenes.clear();
  status.static_triangles = 0;
  for (const auto& scene : state.scenes) {
    status.static_triangles += scene->mesh.triangles.size();
    status.scenes += (status.scenes.empty() ? "" : "\n") + scene->name;
  }
  status.object_count = status.moving_count = 0;
  for (const auto& info : *state.objects) {
    status.object_count += info ? 1 : 0;
    status.moving_count += info && info->moving ? 1 : 0;
  }
}

}  // namespace

void WorldLoop::stop() {
  stopping_.store(true);
  around_.inbox.wake();
}

std::chrono::steady_clock::time_point WorldLoop::next_wake() const {
  std::int64_t next_ns = next_status_ns_;
  if (pending_changes_ > 0) next_ns = std::min(next_ns, next_step_ns_);
  return std::chrono::steady_clock::time_point(std::chrono::nanoseconds(next_ns));
}

void WorldLoop::run() {
  // Every shard is written once, so that who waits for all of them need not guess which are empty.
  dirty_shards_.assign(wire_contract::kContactShards, 1);
  publish();
  next_status_ns_ = steady_ns();
  next_step_ns_ = next_status_ns_;
  while (!stopping_.load()) {
    around_.inbox.drain(next_wake(), arrivals_);
    if (restore_float_environment()) ++around_.questions.float_repairs;
    for (Arrival& arrival : arrivals_) {
      take(arrival);
      keep_time();
    }
    apply([&] { return publishers_.release_parked(around_.clock.now_ns()); });
    step_if_due();
    // Samples that changed nothing need no step, but somebody may wait for them.
    if (pending_changes_ == 0) let_fences_pass();
    keep_time();
  }
  end_contacts();
  write_status(ServerState::stopping);
}

/// Ten times a second, however much has come: who hears no status for 0.3 s takes the server for dead.
void WorldLoop::keep_time() {
  if (steady_ns() < next_status_ns_) return;
  next_status_ns_ = steady_ns() + wire_contract::kStatusPeriodNs;
  publishers_.settle(around_.clock.now_ns());
  if (steady_ns() >= recovered_ns_) recovering_.store(false);
  write_status(recovering() ? ServerState::recovering : ServerState::ready);
  around_.tick();
  say_notices();
}

/// Offers a sample until it is applied, with steps between where it asks for them.
template <class Apply>
void WorldLoop::apply(Apply&& once) {
  while (once() == Applied::step_first) step_now();
}

void WorldLoop::take(Arrival& arrival) {
  const std::int64_t now_ns = around_.clock.now_ns();
  if (auto* definition = std::get_if<std::unique_ptr<DefinitionSample>>(&arrival)) {
    take(**definition);
  } else if (auto* poses = std::get_if<std::unique_ptr<PoseSample>>(&arrival)) {
    apply([&] { return publishers_.move(**poses, now_ns); });
    around_.inbox.give_back(std::move(*poses));
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

void WorldLoop::take(DefinitionSample& sample) {
  const std::int64_t now_ns = around_.clock.now_ns();
  if (!sample.removed) {
    DecodedShape decoded = decode_shape(std::as_bytes(std::span(sample.shape_bytes)));
    if (decoded.shape) {
      sample.shape = std::move(*decoded.shape);
    } else {
      sample.shape = Refusal{std::move(decoded.refusal)};
    }
  }
  apply([&] { return publishers_.define(sample, now_ns); });
  // Poses that waited for this definition come before whatever its publisher sent after them.
  apply([&] { return publishers_.release_parked(now_ns); });
}

void WorldLoop::step_if_due() {
  pending_changes_ += publishers_.take_changes() + std::exchange(own_changes_, 0);
  if (pending_changes_ == 0) return;
  const std::int64_t now_ns = steady_ns();
  if (now_ns < next_step_ns_) return;
  step_now();
  if (options_.step_ns > 0) {
    // From the last tick, not from now: the period holds on average.
    next_step_ns_ = std::max(next_step_ns_ + options_.step_ns, now_ns - options_.step_ns);
  } else {
    // A pause as long as the step itself: the batches that one tick of a publisher is cut into then share a step.
    constexpr std::int64_t kLongestPauseNs = 5'000'000;
    const std::int64_t end_ns = steady_ns();
    next_step_ns_ = end_ns + std::min(end_ns - now_ns, kLongestPauseNs);
  }
}

void WorldLoop::step_now() {
  pending_changes_ += publishers_.take_changes() + std::exchange(own_changes_, 0);
  const StepWishes wishes{.contacts = around_.outlet.contacts_wanted(), .persisted = around_.outlet.persisted_wanted()};
  while (!around_.world.step(around_.clock.now_ns(), std::max<std::uint64_t>(1, pending_changes_), wishes)) {
    // Readers hold every free state. Workers let theirs go within an answer's time, requests in chunks within 2 s.
    ++counts_.stalled_steps;
    around_.leases.expire(steady_ns());
    std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
  pending_changes_ = 0;
  ++counts_.steps;
  say_skipped_sweeps();
  publishers_.stepped();
  publish();
}

void WorldLoop::publish() {
  const SnapshotRing::Lease state = around_.world.newest();
  const Stamp stamp{.version = state->version, .world_time_ns = state->world_time_ns};
  publish_events(stamp);
  publish_contacts(stamp);
  let_fences_pass();
}

/// Frames before shards: who joins between the two finds an event twice rather than never.
void WorldLoop::publish_events(const Stamp& stamp) {
  const auto name_of = [&](ObjectId id) { return names_.name(id); };
  const auto send = [&](EventColumns& frame, bool persisted) {
    if (frame.size() == 0) return;
    frame.named.fill(name_of);
    if (persisted) {
      around_.outlet.write_persisted(frame, stamp);
    } else {
      around_.outlet.write_events(frame, stamp);
    }
    frame.clear();
  };
  events_.clear();
  persisted_.clear();
  for (const Event& event : around_.world.events()) {
    const bool persisted = event.kind == EventKind::persisted;
    if (!persisted) {
      const std::uint64_t hash = wire_contract::contact_hash(event.of.a, event.of.b, event.of.episode);
      contact_hash_ += event.kind == EventKind::began ? hash : 0 - hash;
      dirty_shards_[wire_contract::contact_shard(event.of.a, event.of.b)] = 1;
      if (event.kind == EventKind::began) names_.note(event.of, around_.world);
    }
    EventColumns& frame = persisted ? persisted_ : events_;
    frame.add(event, names_);
    if (frame.size() == wire_contract::kMaxEventsPerFrame) send(frame, persisted);
  }
  send(events_, false);
  send(persisted_, true);
  for (const Event& event : around_.world.events()) {
    if (event.kind == EventKind::ended) names_.forget(event.of);
  }
}

void WorldLoop::publish_contacts(const Stamp& stamp) {
  if (std::find(dirty_shards_.begin(), dirty_shards_.end(), 1) == dirty_shards_.end()) return;
  const std::vector<OpenContact>& open = around_.world.contacts();
  shard_of_.clear();
  for (const OpenContact& contact : open) shard_of_.push_back(wire_contract::contact_shard(contact.a, contact.b));
  const auto name_of = [&](ObjectId id) { return names_.name(id); };
  for (std::uint32_t shard = 0; shard < dirty_shards_.size(); ++shard) {
    if (dirty_shards_[shard] == 0) continue;
    dirty_shards_[shard] = 0;
    contacts_.clear();
    contacts_.shard = static_cast<std::uint8_t>(shard);
    for (std::size_t i = 0; i < open.size(); ++i) {
      if (shard_of_[i] == shard) contacts_.add(open[i], names_);
    }
    contacts_.named.fill(name_of);
    // DDS delivers no larger message. Names can be missed, contacts cannot.
    constexpr std::size_t kRoom = wire_contract::kMaxMessageBytes - 4'096;
    if (contacts_.bytes() > kRoom) contacts_.named.clear();
    if (contacts_.bytes() > kRoom) {
      around_.notice("more contacts hold than the contact topic carries; who joins now will not learn them all");
      continue;
    }
    around_.outlet.write_contacts(contacts_, stamp, around_.world.last_event_sequence());
  }
}

void WorldLoop::let_fences_pass() {
  publishers_.list_applied(applied_);
  around_.fences.update(applied_);
  for (AskPointer& ask : around_.fences.take_ready()) around_.admit(std::move(ask));
}

void WorldLoop::write_status(ServerState state) {
  const SnapshotRing::Lease newest = around_.world.newest();
  const InboxCounts inbox = around_.inbox.counts();
  const PublisherCounts& counts = publishers_.counts();
  status_.stamp = {.version = newest->version, .world_time_ns = newest->world_time_ns};
  status_.state = state;
  status_.last_event_sequence = around_.world.last_event_sequence();
  status_.contact_count = static_cast<std::uint32_t>(around_.world.contacts().size());
  status_.contact_hash = contact_hash_;
  status_.contacts_truncated = newest->contacts_truncated;
  status_.poses_applied = counts.poses_applied;
  status_.poses_dropped =
      counts.poses_late + counts.poses_unknown + counts.poses_refused + inbox.poses_superseded + inbox.poses_dropped;
  status_.questions_answered = around_.questions.answered.load();
  status_.questions_refused = around_.questions.refused.load();
  status_.undecided_answers = around_.questions.undecided.load();
  count_objects(*newest, status_);
  list_publishers();
  around_.outlet.write_status(status_);
}

void WorldLoop::list_publishers() {
  for (auto* column : {&status_.publishers, &status_.applied_sequences}) column->clear();
  status_.silent_ns.clear();
  for (auto* column : {&status_.publisher_states, &status_.publisher_names}) column->clear();
  const std::lock_guard lock(publisher_names_mutex_);
  publisher_names_.clear();
  auto applied = applied_.begin();
  publishers_.for_each(around_.clock.now_ns(), [&](const PublisherView& view) {
    publisher_names_.emplace(view.publisher, view.name);
    status_.publishers.push_back(view.publisher);
    // What is in a published state, not what waits for the next step. Both lists are in the publishers' order.
    applied = std::find_if(applied, applied_.end(), [&](const auto& entry) { return entry.first >= view.publisher; });
    const bool found = applied != applied_.end() && applied->first == view.publisher;
    status_.applied_sequences.push_back(found ? applied->second : 0);
    status_.silent_ns.push_back(view.silent_ns);
    status_.publisher_states.push_back(static_cast<std::uint8_t>(view.state));
    status_.publisher_names.insert(status_.publisher_names.end(), view.name.begin(), view.name.end());
    status_.publisher_names.push_back(0);
  });
}

std::string WorldLoop::publisher_name(std::uint64_t publisher) const {
  const std::lock_guard lock(publisher_names_mutex_);
  const auto found = publisher_names_.find(publisher);
  return found == publisher_names_.end() ? std::string() : found->second;
}

/// Contacts end when one of their objects goes; a part of a scene cannot go alone, its partner can.
void WorldLoop::end_contacts() {
  std::vector<ObjectId> objects;
  for (const OpenContact& contact : around_.world.contacts()) {
    objects.push_back(contact.a);
    objects.push_back(contact.b);
  }
  std::sort(objects.begin(), objects.end());
  objects.erase(std::unique(objects.begin(), objects.end()), objects.end());
  for (const ObjectId id : objects) {
    const ObjectInfo* info = around_.world.info(id);
    if (info && info->moving) around_.world.remove(id, EndReason::server_stopping);
  }
  if (!objects.empty()) step_now();
}

/// At the first and whenever there are twice as many: a line a step would bury the log.
void WorldLoop::say_skipped_sweeps() {
  const std::uint64_t before = counts_.sweeps_skipped;
  counts_.sweeps_skipped += around_.world.cost().sweeps_skipped;
  if (std::bit_width(before) == std::bit_width(counts_.sweeps_skipped)) return;
  around_.notice("the ways of " + std::to_string(counts_.sweeps_skipped) +
                 " pairs could not be followed from pose to pose to their end; contacts between two poses may be missing");
}

void WorldLoop::say_notices() {
  for (const std::string& sentence : publishers_.take_notices()) around_.notice(sentence);
}

}  // namespace collided::service
