#include "client/library/recordings/replayed_publishers.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <thread>

#include <nlohmann/json.hpp>

#include "client/library/commands/command.hpp"
#include "client/library/connection/wait_until.hpp"
#include "idl/clocks.hpp"
#include "idl/commands.hpp"

namespace collided::client {
namespace {

constexpr std::int64_t kPatienceNs = 2'000'000'000;
/// Batches of all publishers that the world has not applied: the server keeps 512, and others publish as well.
constexpr std::size_t kMostWaiting = 256;
/// With an authority that waits for the end of the old primary's lease, a failover takes 3 to 4 s.
constexpr std::int64_t kTakeOverPatienceNs = 6'000'000'000;

}  // namespace

ReplayedPublishers::Publisher::Publisher(const ReplayedPublishers& owner, std::uint64_t recorded)
    : number(random_number()),
      incarnation(static_cast<std::uint64_t>(wire_contract::since_1970_ns())),
      recorded_incarnation(recorded),
      object_writer(owner.object_topic_, {.lease_ns = wire_contract::kPublisherLeaseNs}),
      pose_writer(owner.pose_topic_, {.lease_ns = wire_contract::kPublisherLeaseNs}) {}

ReplayedPublishers::ReplayedPublishers(Connection& connection)
    : connection_(connection),
      object_topic_(connection.participant(), connection.options().name_space),
      pose_topic_(connection.participant(), connection.options().name_space),
      step_topic_(connection.participant(), connection.options().name_space, wire_contract::kStepTopic) {
  observer_ = connection.pulse().observe([this](const wire::Status& status) { hear(status); });
  step_reader_ = std::make_unique<dds::Reader<wire::Status>>(
      step_topic_, dds::ReaderOptions<wire::Status>{.data = [this](dds::Taker<wire::Status> taker) {
        while (true) {
          const auto loans = taker.take_loans();
          if (loans.size() == 0) return;
          for (std::size_t i = 0; i < loans.size(); ++i) {
            if (loans.info(i).valid_data) hear(loans[i]);
          }
        }
      }});
}

ReplayedPublishers::~ReplayedPublishers() {
  step_reader_.reset();
  connection_.pulse().stop_observing(observer_);
  // All publishers send before any wait: after a failover the dead server's reader acknowledges nothing, and the leases
  // of the others would run out meanwhile.
  for (auto& [recorded, publisher] : publishers_) remove_objects(*publisher);
  const Clock::time_point deadline = Clock::now() + std::chrono::nanoseconds(wire_contract::kPublisherLeaseNs);
  for (auto& [recorded, publisher] : publishers_) wait_until_heard(*publisher, deadline);
}

void ReplayedPublishers::leave(Publisher& publisher) {
  remove_objects(publisher);
  wait_until_heard(publisher, Clock::now() + std::chrono::nanoseconds(wire_contract::kPublisherLeaseNs));
}

void ReplayedPublishers::remove_objects(Publisher& publisher) {
  try {
    dds::Sample<wire::Definition> definition;
    definition->publisher = publisher.number;
    definition->incarnation = publisher.incarnation;
    definition->removed = true;
    for (const std::uint32_t object : publisher.objects) {
      definition->object_number = object;
      definition->sequence_number = ++publisher.sequence;
      if (!publisher.object_writer.write(*definition)) break;
    }
  } catch (const dds::DdsError&) {}  // the lease runs out instead
}

void ReplayedPublishers::wait_until_heard(Publisher& publisher, Clock::time_point deadline) {
  const std::chrono::nanoseconds left = deadline - Clock::now();
  try {
    publisher.object_writer.wait_for_acknowledgements(std::max<std::int64_t>(0, left.count()));
  } catch (const dds::DdsError&) {}
}

void ReplayedPublishers::expect(std::uint64_t recorded, std::uint64_t incarnation) {
  std::unique_ptr<Publisher>& publisher = publishers_[recorded];
  if (!publisher) publisher = std::make_unique<Publisher>(*this, incarnation);
}

bool ReplayedPublishers::is_read(const Publisher& publisher) {
  return publisher.pose_writer.matched_readers() > 0 && publisher.object_writer.matched_readers() > 0;
}

void ReplayedPublishers::wait_until_read() {
  const Clock::time_point deadline = Clock::now() + std::chrono::nanoseconds(kPatienceNs);
  client::wait_until(deadline, [&] {
    keep_alive();
    return std::ranges::all_of(publishers_, [](const auto& entry) { return is_read(*entry.second); });
  });
}

ReplayedPublishers::Publisher* ReplayedPublishers::meet(std::uint64_t recorded, std::uint64_t incarnation) {
  std::unique_ptr<Publisher>& publisher = publishers_[recorded];
  if (publisher && incarnation < publisher->recorded_incarnation) return nullptr;
  if (publisher && incarnation > publisher->recorded_incarnation) {
    leave(*publisher);
    publisher.reset();
  }
  expect(recorded, incarnation);
  if (publisher->was_read) return publisher.get();
  // Batches are volatile: a batch written before the server's reader is matched would be lost.
  const Clock::time_point deadline = Clock::now() + std::chrono::nanoseconds(kPatienceNs);
  publisher->was_read = client::wait_until(deadline, [&] { return is_read(*publisher); });
  if (!publisher->was_read) throw dds::DdsError("replay: the server reads no poses");
  return publisher.get();
}

bool ReplayedPublishers::publish(wire::Definition& definition) {
  Publisher* publisher = meet(definition.publisher, definition.incarnation);
  if (publisher == nullptr) return false;
  const auto [known, is_new] = publisher->defined.try_emplace(definition.object_number, definition.sequence_number);
  if (!is_new && definition.sequence_number <= known->second) return false;
  known->second = definition.sequence_number;
  if (definition.removed) {
    publisher->objects.erase(definition.object_number);
  } else {
    publisher->objects.insert(definition.object_number);
  }
  definition.publisher = publisher->number;
  definition.incarnation = publisher->incarnation;
  definition.sequence_number = publisher->definitions_through = ++publisher->sequence;
  if (!publisher->object_writer.write(definition)) throw dds::DdsError("replay: the server takes no more definitions");
  return true;
}

bool ReplayedPublishers::publish(wire::PoseBatch& batch, std::uint64_t log_time, std::int64_t source_time_ns) {
  Publisher* publisher = meet(batch.publisher, batch.incarnation);
  if (publisher == nullptr) return false;
  // A batch that only advances time has no number.
  const bool has_number = batch.sequence_number > 0;
  if (has_number && batch.sequence_number < publisher->posed) return false;
  if (has_number && batch.sequence_number == publisher->posed && log_time != publisher->posed_at) return false;
  if (has_number) publisher->posed = batch.sequence_number;
  if (has_number) publisher->posed_at = log_time;
  batch.publisher = publisher->number;
  batch.incarnation = publisher->incarnation;
  batch.sequence_number = has_number ? ++publisher->sequence : 0;
  batch.definitions_through = publisher->definitions_through;
  batch.source_time_ns = source_time_ns;
  if (!wait_for_room(*publisher)) throw dds::DdsError("replay: the server takes no more poses");
  if (!publisher->pose_writer.write(batch)) throw dds::DdsError("replay: the server takes no more poses");
  publisher->unacknowledged.note_written(
      publisher->sequence, dds::view(batch.positions).size_bytes() + dds::view(batch.orientations).size_bytes());
  return true;
}

/// The server queues a limited number of acknowledged batches; beyond that it keeps only each object's newest pose.
/// Events would be missed if a replay is faster than the world's steps. After a failover the new server's status shows
/// what it has, while DDS still waits for the dead server's reader. A server that does not list a publisher accepts
/// none of its poses.
bool ReplayedPublishers::wait_for_room(Publisher& publisher) {
  const Clock::time_point began = Clock::now();
  std::unique_lock lock(mutex_);
  while (true) {
    std::size_t waiting = 0;
    for (auto& [recorded, other] : publishers_) {
      other->unacknowledged.note_known(applied_[other->number]);
      if (listed_.count(other->number) > 0) other->is_listed = true;
      waiting += other->unacknowledged.batches();
    }
    if (!publisher.unacknowledged.is_full() && waiting < kMostWaiting) return true;
    const Clock::time_point now = Clock::now();
    if (now - began >= std::chrono::nanoseconds(kTakeOverPatienceNs)) return false;
    if (now - began >= std::chrono::nanoseconds(kPatienceNs)) {
      for (auto& [recorded, other] : publishers_) {
        if (!other->is_listed) other->unacknowledged.note_all_known();
      }
    }
    came_.wait_until(lock, now + std::chrono::milliseconds(100));
    lock.unlock();
    keep_alive();
    lock.lock();
  }
}

void ReplayedPublishers::lose(std::uint64_t recorded) {
  const auto found = publishers_.find(recorded);
  if (found == publishers_.end()) return;
  leaving_.insert(found->second->number);
  publishers_.erase(found);
}

void ReplayedPublishers::keep_alive() {
  for (auto& [recorded, publisher] : publishers_) {
    publisher->object_writer.assert_liveliness();
    publisher->pose_writer.assert_liveliness();
  }
}

void ReplayedPublishers::hear(const wire::Status& status) {
  const auto publishers = dds::view(status.publishers);
  const auto applied = dds::view(status.applied_sequences);
  const auto states = dds::view(status.publisher_states);
  const std::lock_guard lock(mutex_);
  listed_.clear();
  for (std::size_t i = 0; i < std::min({publishers.size(), applied.size(), states.size()}); ++i) {
    std::uint64_t& newest = applied_[publishers[i]];
    newest = std::max(newest, applied[i]);
    listed_.insert(publishers[i]);
    if (states[i] == static_cast<std::uint8_t>(wire_contract::PublisherState::lost)) lost_.insert(publishers[i]);
  }
  came_.notify_all();
}

bool ReplayedPublishers::all_applied() const {
  for (const auto& [recorded, publisher] : publishers_) {
    const auto found = applied_.find(publisher->number);
    if (publisher->sequence > 0 && (found == applied_.end() || found->second < publisher->sequence)) return false;
  }
  return std::all_of(leaving_.begin(), leaving_.end(),
                     [&](std::uint64_t number) { return lost_.count(number) > 0 || listed_.count(number) == 0; });
}

bool ReplayedPublishers::wait_applied(std::chrono::nanoseconds wait) {
  const Clock::time_point deadline = Clock::now() + wait;
  std::unique_lock lock(mutex_);
  while (!all_applied()) {
    if (Clock::now() >= deadline) return false;
    came_.wait_until(lock, std::min(deadline, Clock::now() + std::chrono::milliseconds(100)));
    lock.unlock();
    keep_alive();
    lock.lock();
  }
  return true;
}

std::string ReplayedPublishers::why_refused() const {
  for (const auto& [recorded, publisher] : publishers_) {
    const Result<std::string> answer = command(connection_, wire_contract::command::kLeftOut,
                                               {{"publisher", publisher->number}}, std::chrono::seconds(1));
    const nlohmann::json found = nlohmann::json::parse(answer ? *answer : std::string(), nullptr, false);
    if (std::string why = found.is_object() ? found.value("refused", "") : ""; !why.empty()) return why;
  }
  return {};
}

}  // namespace collided::client
