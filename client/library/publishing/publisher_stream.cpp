#include <algorithm>
#include <utility>

#include "client/library/connection/errors.hpp"
#include "client/library/publishing/publisher.hpp"
#include "idl/clocks.hpp"
#include "idl/columns.hpp"

namespace collided {

using client::Clock;
using client::PublishedObject;
using client::PublishedObjects;
using wire_contract::kMaxPosesPerBatch;
using wire_contract::kPoseNumbers;

namespace {

constexpr std::int64_t kAcknowledgementNs = 1'000'000'000;
// For this long after everything was defined again each batch is marked so, since the first ones may be sent before the
// new server's reader is matched.
constexpr std::chrono::milliseconds kSaysSo{2'000};
// Several status periods after the last message; one of the statuses must have counted it.
constexpr std::chrono::milliseconds kBehind{500};
// Short compared with the lease: a skipped assertion must not lose a publisher that calls rarely.
constexpr std::chrono::nanoseconds kAssertionPeriod(wire_contract::kPublisherLeaseNs / 100);

double* put_pose(const Pose& pose, double* numbers) {
  numbers = std::copy_n(pose.position.data(), 3, numbers);
  *numbers++ = pose.rotation.w();
  return std::copy_n(pose.rotation.vec().data(), 3, numbers);
}

Error not_taken() {
  return {ErrorCode::timeout, "publish: the server takes nothing more", "what was not sent waits for the next flush"};
}

// DDS throws; the public interface returns errors.
template <class Write>
std::optional<Error> guarded(const Write& write) {
  try {
    return write();
  } catch (const dds::DdsError& failed) { return client::failure_of(failed); }
}

}  // namespace

std::optional<Error> Publisher::State::say_alive() {
  if (objects_.size() > 0 && is_lost()) note_loss();
  if (is_asked_again() || is_forgotten() || is_behind()) { return define_all(); }
  // Each assertion costs two datagrams, so it is not sent with every pose.
  return Clock::now() - last_word_ < kAssertionPeriod ? std::nullopt : assert_liveliness();
}

std::optional<Error> Publisher::State::assert_liveliness() {
  return guarded([&]() -> std::optional<Error> {
    object_writer_.assert_liveliness();
    pose_writer_.assert_liveliness();
    last_word_ = Clock::now();
    return std::nullopt;
  });
}

// True once per request of the server: a new server requests it if it has missed earlier poses.
bool Publisher::State::is_asked_again() {
  const auto view = connection_->pulse().publisher(publisher_);
  const bool is_asked = view && view->asked;
  const bool was_asked = std::exchange(was_asked_, is_asked);
  return is_asked && !was_asked;
}

/// By its own clock or by the server's status. A status from before everything was defined again does not count.
bool Publisher::State::is_lost() const {
  if (Clock::now() - last_word_ > lease_) return true;
  const auto view = connection_->pulse().publisher(publisher_);
  return view && view->lost && view->applied_sequence >= defined_all_at_;
}

void Publisher::State::note_loss() {
  const std::chrono::nanoseconds silent = Clock::now() - last_word_;
  const std::string name = "publisher '" + std::string(definition_->publisher_name) + "' ";
  const std::string then = ": the server counted it as lost, and its objects were stale or had left the world; ";
  if (silent > lease_)
    lost_ = name + "was silent for " + client::words(silent) + ", longer than its lease of " + client::words(lease_) +
            then + "call keep_alive, or publish with a longer lease";
  else lost_ = name + "was not heard for its lease of " + client::words(lease_) + then + "publish with a longer lease";
}

bool Publisher::State::is_forgotten() const {
  if (is_lost() || connection_->pulse().server() != server_) return true;
  // Messages written during the outage may be lost, and so are those written before the readers are matched again.
  if (connection_->pulse().outages() != outages_ && pose_writer_.matched_readers() > 0 &&
      object_writer_.matched_readers() > 0)
    return true;
  return false;
}

// True if the server lacks a message: a batch may have been written before a new server's reader was matched, and its
// poses would be missing until the objects move again. A world that is busy with a step applies nothing, and afterwards
// has a backlog to apply.
bool Publisher::State::is_behind() const {
  const client::ServerPulse& pulse = connection_->pulse();
  const auto view = pulse.publisher(publisher_);
  return view && !view->lost && view->applied_sequence < sequence_ && !pulse.silent() &&
         Clock::now() - std::max(last_sample_, pulse.last_busy()) > kBehind;
}

// True if another batch may be written. The server's status is checked before DDS: acknowledgements come up to 20 ms
// late, and never from a dead server's reader, which DDS keeps for its participant's lease of ten seconds.
bool Publisher::State::has_room() {
  if (!unacknowledged_.is_full()) return true;
  const auto view = connection_->pulse().publisher(publisher_);
  if (view && !connection_->pulse().silent()) unacknowledged_.note_known(view->applied_sequence);
  if (!unacknowledged_.is_full()) return true;
  if (!pose_writer_.wait_for_acknowledgements(kAcknowledgementNs)) return false;
  unacknowledged_.note_all_known();
  return true;
}

std::optional<Error> Publisher::State::define_all() {
  // A new server has none of the earlier batches and does not need them.
  if (server_ != connection_->pulse().server()) unacknowledged_.note_all_known();
  server_ = connection_->pulse().server();
  outages_ = connection_->pulse().outages();
  defined_all_at_ = sequence_ + 1;
  if (auto error = write_gap()) { return error; }
  for (std::uint32_t number = 0; number < objects_.numbers_used(); ++number) {
    if (!objects_.at(number).used) { continue; }
    if (auto error = write_definition(number, objects_.at(number), false)) { return error; }
  }
  defined_all_ = Clock::now();
  if (auto error = write_batch({}, 0, 0)) { return error; }
  return assert_liveliness();
}

std::optional<Error> Publisher::State::write_definition(std::uint32_t number, const PublishedObject& object,
                                                        bool removed) {
  wire::Definition& definition = *definition_;
  definition.object_number = number;
  definition.sequence_number = sequence_ + 1;
  definition.removed = removed;
  definition.moving = object.options.moving;
  definition.lost_policy = static_cast<std::uint8_t>(object.options.lost_policy);
  if (object.enters && !removed) definition.lost_policy |= wire_contract::kPolicyEntersWithInstant;
  static_cast<void>(dds::set_text(definition.name, object.options.name));  // its length was checked
  definition.layers = object.options.layers;
  definition.mask = object.options.mask;
  definition.group = object.options.group;
  // Waiting poses are motions from this pose. A definition at the newest pose would place the object there, and a
  // server that has the object would take it for another one.
  double pose[kPoseNumbers];
  put_pose(object.sent, pose);
  std::copy_n(pose, 3, definition.position);
  std::copy_n(pose + 3, 4, definition.orientation);
  dds::borrow(definition.shape, removed ? std::span<const std::uint8_t>() : std::span(object.shape));
  return write_made_definition();
}

/// Written before all other messages of this publisher, since the server does not change the gap later.
std::optional<Error> Publisher::State::write_gap() {
  if (gap_.count() == wire_contract::kDefaultGapNs) return std::nullopt;
  wire::Definition& definition = *definition_;
  definition.object_number = wire_contract::kObjectPublisherItself;
  definition.sequence_number = sequence_ + 1;
  definition.removed = true;
  definition.position[0] = static_cast<double>(gap_.count()) * wire_contract::kNanosecond_s;
  definition.orientation[0] = 1;
  dds::borrow(definition.shape, std::span<const std::uint8_t>());
  return write_made_definition();
}

std::optional<Error> Publisher::State::write_made_definition() {
  return guarded([&]() -> std::optional<Error> {
    if (!object_writer_.write(*definition_)) { return not_taken(); }
    definitions_through_ = sequence_ + 1;
    note_written();
    return std::nullopt;
  });
}

void Publisher::State::fill_batch(std::uint8_t flags, std::int64_t time_ns) {
  batch_->definitions_through = definitions_through_;
  batch_->source_time_ns = time_ns;
  batch_->flags = flags;
  if (is_streamed_) batch_->flags |= wire_contract::kPosesStreamed;
  if (is_announced_) batch_->flags |= wire_contract::kPosesBringsObjects;
  if (time_ns != 0) last_instant_ = Clock::now();
  if (Clock::now() - defined_all_ < kSaysSo) batch_->flags |= wire_contract::kPosesAllSaid;
}

/// Sends that everything has been at rest up to then, or only that this publisher is alive. The message has no number:
/// a server that misses it lacks no pose, and a number would hide the loss of an earlier message.
std::optional<Error> Publisher::State::write_instant(std::int64_t time_ns, bool is_only_alive) {
  batch_->sequence_number = 0;
  fill_batch(is_only_alive ? wire_contract::kPosesStreamed : 0, time_ns);
  dds::borrow(batch_->object_numbers, std::span<const std::uint32_t>());
  wire::lend_columns<wire::PoseBatch>({}, wire::kPoseColumns, pose_columns_, *batch_);
  return guarded([&]() -> std::optional<Error> {
    if (!has_room() || !pose_writer_.write(*batch_)) return not_taken();
    // It occupies a place in the writer's history, where it could displace poses that the server has not received.
    unacknowledged_.note_written(sequence_, 0);
    return std::nullopt;
  });
}

std::optional<Error> Publisher::State::write_batch(std::span<const std::uint32_t> numbers, std::uint8_t flags,
                                                   std::int64_t time_ns) {
  poses_.resize(numbers.size() * kPoseNumbers);
  double* pose = poses_.data();
  for (const std::uint32_t number : numbers) { pose = put_pose(objects_.at(number).options.pose, pose); }
  batch_->sequence_number = sequence_ + 1;
  fill_batch(flags, time_ns);
  dds::borrow(batch_->object_numbers, numbers);
  wire::lend_columns<wire::PoseBatch>(poses_, wire::kPoseColumns, pose_columns_, *batch_);
  return guarded([&]() -> std::optional<Error> {
    if (!has_room() || !pose_writer_.write(*batch_)) { return not_taken(); }
    note_written();
    unacknowledged_.note_written(sequence_, numbers.size_bytes() + poses_.size() * sizeof(double));
    return std::nullopt;
  });
}

void Publisher::State::note_written() {
  ++sequence_;
  last_sample_ = Clock::now();
  connection_->note_write({publisher_, sequence_});
}

std::optional<Error> Publisher::State::send_waiting(std::int64_t time_ns) {
  std::size_t plain_left = objects_.sort_waiting();
  if (objects_.waiting().empty() && (objects_.size() > 0 || is_announced_)) return write_instant(time_ns, false);
  while (!objects_.waiting().empty()) {
    const bool teleported = plain_left == 0;
    const std::size_t of_a_kind = teleported ? objects_.waiting().size() : plain_left;
    const std::size_t count = std::min<std::size_t>(of_a_kind, kMaxPosesPerBatch);
    std::uint8_t flags = teleported ? wire_contract::kPosesTeleported : 0;
    if (count < objects_.waiting().size()) flags |= wire_contract::kPosesMoreFollows;
    if (auto error = write_batch(objects_.waiting().first(count), flags, time_ns)) { return error; }
    objects_.mark_sent(count);
    plain_left -= teleported ? 0 : count;
  }
  return std::nullopt;
}

}  // namespace collided
