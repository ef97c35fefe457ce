#include "tests/simulation/simulated_server.hpp"

#include <algorithm>
#include <vector>

#include "server/exact_phase/overlap/overlap.hpp"

namespace collided::simulation {
using namespace engine;

using service::Applied;
using service::WriterKind;
using wire_contract::ServerState;

namespace {

/// Of where things were; servers of a fleet compare that.
constexpr std::int64_t kMemoryNs = 5'000'000'000;

struct Ball {
  ObjectId id;
  const std::string* name;
  Sphere sphere;
};

std::vector<Ball> balls_of(const World& world) {
  const SnapshotRing::Lease newest = world.newest();
  std::vector<Ball> balls;
  for (const auto& info : newest->objects) {
    if (!info) continue;
    const auto& local = std::get<Sphere>(info->primitives.front());
    balls.push_back({info->id, &info->name, place(newest->frame(slot_of(info->id)), local)});
  }
  return balls;
}

template <class ContactSearch>
void each_touching_pair(const World& world, ContactSearch&& touch) {
  const std::vector<Ball> balls = balls_of(world);
  for (std::size_t i = 0; i < balls.size(); ++i) {
    for (std::size_t j = i + 1; j < balls.size(); ++j) {
      if (overlaps(balls[i].sphere, balls[j].sphere).yes()) touch(balls[i], balls[j]);
    }
  }
}

}  // namespace

SimulatedServer::SimulatedServer(std::uint64_t epoch, std::int64_t now_ns, std::FILE* to,
                                 RecordingEventWriter::Violation violation, Voice voice, bool lacks_nothing)
    : epoch_(epoch),
      started_ns_(now_ns),
      lacks_nothing_(lacks_nothing || epoch == 1),
      next_status_ns_(now_ns),
      violation_(violation),
      event_writer_(std::make_unique<RecordingEventWriter>(epoch, voice, to, violation)),
      world_(WorldOptions{.epoch = epoch, .memory = {.reach_ns = kMemoryNs}}),
      publishers_(world_, {.forget_after_ns = 300'000'000}),
      broadcast_(world_, *event_writer_, [](const std::string&) {}),
      digests_(world_) {
  event_writer_->set_time(now_ns);
  broadcast_.mark_all();
  broadcast_.publish([](ObjectId) { return false; });
}

template <class Apply>
void SimulatedServer::apply(std::int64_t now_ns, Apply&& once) {
  while (once() == Applied::step_first) step(now_ns);
}

void SimulatedServer::take(service::DefinitionSample& sample, std::int64_t now_ns) {
  apply(now_ns, [&] { return publishers_.define(sample, now_ns); });
  apply(now_ns, [&] { return publishers_.release_parked(now_ns); });
}

void SimulatedServer::take(service::PoseSample& sample, std::int64_t now_ns) {
  sample.received_ns = now_ns;
  apply(now_ns, [&] { return publishers_.move(sample, now_ns); });
}

void SimulatedServer::lost(std::uint64_t publisher, std::int64_t now_ns) {
  for (const WriterKind kind : {WriterKind::object, WriterKind::pose}) {
    apply(now_ns, [&] { return publishers_.writer_lost(publisher, kind, now_ns); });
  }
}

void SimulatedServer::tick(std::int64_t now_ns) {
  event_writer_->set_time(now_ns);
  changes_ += publishers_.take_changes();
  if (say_again_ns_ != 0 && now_ns >= say_again_ns_) {
    say_again_ns_ = 0;
    broadcast_.mark_all();
    changes_ = std::max<std::uint64_t>(1, changes_);
  }
  if (changes_ > 0) step(now_ns);
  if (now_ns < next_status_ns_) return;
  next_status_ns_ = now_ns + wire_contract::kStatusPeriodNs;
  publishers_.settle(now_ns);
  say_status(now_ns);
  digests_.make(now_ns, world_.settled_ns(now_ns));
}

void SimulatedServer::speak(std::int64_t now_ns, const service::SpokenBefore& before) {
  event_writer_->set_time(now_ns);
  event_writer_->speak(before);
  broadcast_.mark_all();
  step(now_ns);
  say_status(now_ns);
  constexpr std::int64_t kSoonNs = 300'000'000;
  say_again_ns_ = now_ns + kSoonNs;
}

void SimulatedServer::step(std::int64_t now_ns) {
  changes_ += publishers_.take_changes();
  if (!world_.step(now_ns, std::max<std::uint64_t>(1, changes_), {.contacts = true, .persisted = false})) {
    violation_("a step found no free state though nobody reads");
  }
  changes_ = 0;
  ++steps_;
  publishers_.stepped();
  broadcast_.publish([](ObjectId) { return false; });
}

void SimulatedServer::say_status(std::int64_t now_ns) {
  service::StatusColumns status;
  const bool recovering = !lacks_nothing_ && now_ns - started_ns_ < kRecoveryNs;
  status.state = recovering ? ServerState::recovering : ServerState::ready;
  status.last_event_sequence = world_.last_event_sequence();
  status.contact_count = static_cast<std::uint32_t>(world_.contacts().size());
  status.contact_hash = broadcast_.contact_hash();
  const bool is_stepped = changes_ == 0 && !publishers_.has_changes();
  status.settled_ns = is_stepped ? world_.settled_ns(now_ns) : world_.newest()->settled_ns;
  event_writer_->write_status(status);
}

void SimulatedServer::compare_with_all_pairs() {
  std::set<std::pair<ObjectId, ObjectId>> touch;
  each_touching_pair(world_, [&](const Ball& a, const Ball& b) { touch.insert(std::minmax(a.id, b.id)); });
  // Whether a lost publisher's frozen object has left what touched it nobody knows.
  const SnapshotRing::Lease newest = world_.newest();
  const auto is_stale = [&](ObjectId id) { return newest->stale[slot_of(id)] != 0; };
  bool same = true;
  for (const auto& [pair, episode] : event_writer_->open())
    same = same && (touch.erase(pair) > 0 || is_stale(pair.first) || is_stale(pair.second));
  if (!same || !touch.empty()) violation_("contacts are not those of all pairs after step " + std::to_string(steps_));
}

std::set<NamedPair> SimulatedServer::touching() const {
  std::set<NamedPair> pairs;
  for (const OpenContact& open : world_.contacts()) {
    if (open.doubt == Doubt::publisher_lost)
      pairs.insert(std::minmax(world_.info(open.a)->name, world_.info(open.b)->name));
  }
  each_touching_pair(world_, [&](const Ball& a, const Ball& b) { pairs.insert(std::minmax(*a.name, *b.name)); });
  return pairs;
}

}  // namespace collided::simulation
