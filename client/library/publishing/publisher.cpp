#include "client/library/publishing/publisher.hpp"

#include <algorithm>
#include <thread>
#include <utility>

#include <nlohmann/json.hpp>

#include "client/library/asking/question_encoding.hpp"
#include "client/library/commands/command.hpp"
#include "client/library/connection/errors.hpp"
#include "client/library/connection/wait_until.hpp"
#include "client/library/publishing/shape_encoding.hpp"
#include "idl/clocks.hpp"
#include "idl/commands.hpp"

namespace collided {

using client::bad_input;
using client::Clock;
using client::PublishedObject;
using client::PublishedObjects;
using std::chrono::nanoseconds;

namespace {

constexpr nanoseconds kLeastLease = std::chrono::milliseconds(100);
constexpr nanoseconds kMostLease = std::chrono::hours(24);
// Assertions of liveliness per lease: one may be late or lost.
constexpr int kWordsInLease = 5;
constexpr nanoseconds kLongestWordPeriod = std::chrono::milliseconds(100);
// Without flushes, the time is sent at this period: pairs with other publishers' objects wait for it.
constexpr nanoseconds kSaidTimePeriod = std::chrono::milliseconds(250);
constexpr nanoseconds kLeastGap{wire_contract::kLeastGapNs};
constexpr nanoseconds kMostGap{wire_contract::kMostGapNs};
constexpr nanoseconds kLeastCommandTimeout = std::chrono::milliseconds(500);
// Several status periods: by then the server lists a publisher that it has accepted.
constexpr nanoseconds kListedSoon = std::chrono::milliseconds(300);
constexpr std::int64_t kGoodbyeSliceNs = 10'000'000;

std::optional<std::string> pose_fault(const Pose& pose) {
  auto found = client::finite_fault(pose.position, "position");
  return found ? found : client::rotation_fault(pose.rotation);
}

std::optional<std::string> name_fault(const std::string& name) {
  if (name.empty() || name.size() > wire_contract::kMaxNameBytes) {
    return "its name has " + std::to_string(name.size()) + " bytes; allowed 1 to " +
           std::to_string(wire_contract::kMaxNameBytes);
  }
  if (name.find('\0') != std::string::npos) { return "its name holds a zero byte"; }
  return std::nullopt;
}

}  // namespace

Publisher::Publisher(std::unique_ptr<State> state) : state_(std::move(state)) {}
Publisher::~Publisher() = default;
Publisher::Publisher(Publisher&&) noexcept = default;
Publisher& Publisher::operator=(Publisher&&) noexcept = default;

Result<Publisher::Object> Publisher::add(const ObjectOptions& options) { return state_->add(options); }
Result<Publisher::Object> Publisher::claim(const std::string& name, const Pose& pose, LostPolicy lost_policy) {
  return state_->claim({.name = name, .pose = pose, .lost_policy = lost_policy});
}
Result<void> Publisher::remove(Object object) { return state_->remove(object); }
Result<void> Publisher::reshape(Object object, const Shape& shape) { return state_->reshape(object, shape); }
Result<void> Publisher::move(Object object, const Pose& pose, bool teleport) {
  return state_->move(object, pose, teleport);
}
Result<FlushReport> Publisher::flush(std::chrono::nanoseconds source_time) { return state_->flush(source_time); }
void Publisher::stream() { state_->stream(); }
Result<void> Publisher::keep_alive(nanoseconds source_time) { return state_->keep_alive(source_time); }
Result<void> Publisher::wait_applied(std::chrono::nanoseconds timeout) { return state_->wait_applied(timeout); }
Result<PublisherReport> Publisher::report(std::chrono::nanoseconds timeout) { return state_->report(timeout); }

Publisher::State::State(std::shared_ptr<client::Connection> connection, const std::string& name,
                        const PublishOptions& options)
    : connection_(std::move(connection)),
      publisher_(client::random_number()),
      incarnation_(static_cast<std::uint64_t>(wire_contract::since_1970_ns())),
      lease_(options.lease),
      gap_(options.gap),
      word_period_(std::min(options.lease / kWordsInLease, kLongestWordPeriod)),
      server_(connection_->pulse().server()),
      outages_(connection_->pulse().outages()),
      last_word_(Clock::now()),
      object_topic_(connection_->participant(), connection_->options().name_space),
      pose_topic_(connection_->participant(), connection_->options().name_space),
      object_writer_(object_topic_, {.lease_ns = options.lease.count()}),
      pose_writer_(pose_topic_, {.lease_ns = options.lease.count()}) {
  definition_->publisher = batch_->publisher = publisher_;
  definition_->incarnation = batch_->incarnation = incarnation_;
  static_cast<void>(dds::set_text(definition_->publisher_name, name));  // its length was checked
}

Result<std::unique_ptr<Publisher::State>> Publisher::State::start(std::shared_ptr<client::Connection> connection,
                                                                  const std::string& name,
                                                                  const PublishOptions& options) {
  if (auto reason = name_fault(name)) { return bad_input("publisher: " + *reason); }
  if (options.lease < kLeastLease || options.lease > kMostLease) {
    return bad_input("publisher '" + name + "': its lease is " + client::words(options.lease) +
                     "; allowed 100 ms to a day");
  }
  if (options.gap < kLeastGap || options.gap > kMostGap) {
    return bad_input("publisher '" + name + "': its gap is " + client::words(options.gap) + "; allowed " +
                     client::words(kLeastGap) + " to " + client::words(kMostGap));
  }
  try {
    std::unique_ptr<State> state(new State(std::move(connection), name, options));
    // Batches are volatile: a batch written before the server's reader is matched would be lost.
    const Clock::time_point deadline = Clock::now() + state->connection_->options().wait;
    const auto is_read = [&] {
      return state->pose_writer_.matched_readers() > 0 && state->object_writer_.matched_readers() > 0;
    };
    if (!client::wait_until(deadline, is_read)) {
      return Error{ErrorCode::no_server, "publisher '" + name + "': the server does not read poses", ""};
    }
    if (auto error = state->write_gap()) { return *error; }
    return state;
  } catch (const dds::DdsError& failed) { return client::failure_of(failed); }
}

// A publisher that ends normally is not lost: its objects are removed at once, regardless of their LostPolicy.
Publisher::State::~State() {
  try {
    for (std::uint32_t number = 0; number < objects_.numbers_used(); ++number) {
      if (objects_.at(number).used && write_definition(number, objects_.at(number), true)) { break; }
    }
    // DDS may still wait for a dead server's reader, which acknowledges nothing; the live server's status suffices.
    const Clock::time_point until = Clock::now() + std::chrono::nanoseconds(wire_contract::kPublisherLeaseNs);
    while (!object_writer_.wait_for_acknowledgements(kGoodbyeSliceNs) && !is_applied() && Clock::now() < until) {}
  } catch (const dds::DdsError&) {
    // Then the lease runs out instead.
  }
}

bool Publisher::State::is_applied() const {
  const auto view = connection_->pulse().publisher(publisher_);
  return view && view->applied_sequence >= sequence_;
}

std::optional<Error> Publisher::State::object_fault(const ObjectOptions& options) const {
  const std::string where = "object '" + options.name + "': ";
  if (auto reason = name_fault(options.name)) { return bad_input(where + *reason); }
  if (objects_.has_name(options.name)) {
    return bad_input(where + "this publisher has an object of that name already");
  }
  if (auto reason = pose_fault(options.pose)) { return bad_input(where + *reason); }
  const bool is_endless = std::any_of(options.shape.begin(), options.shape.end(), [](const ShapePart& part) {
    return std::holds_alternative<HalfSpaceShape>(part);
  });
  if (is_endless && options.moving) {
    return bad_input(where + "a half-space has no end, so it cannot move", "set moving to false");
  }
  return std::nullopt;
}

Error Publisher::State::unknown(Object object) const {
  return bad_input("object " + std::to_string(object) + " was not added to this publisher, or is removed");
}

namespace {

client::SaidSolid said_solid(const ObjectOptions& options) {
  if (!options.solid) return client::SaidSolid::surface;
  return options.solid_by_winding ? client::SaidSolid::by_winding : client::SaidSolid::border;
}

Result<std::vector<std::uint8_t>> encoded(const Shape& shape, const ObjectOptions& options) {
  return client::encode_shape(shape, options.scale, "object '" + options.name + '\'', said_solid(options),
                              options.unknown);
}

}  // namespace

Result<Publisher::Object> Publisher::State::add(const ObjectOptions& options, bool enters) {
  Result<std::vector<std::uint8_t>> shape = encoded(options.shape, options);
  const std::lock_guard lock(mutex_);
  if (auto error = object_fault(options)) { return *error; }
  if (!shape) { return shape.error(); }
  return define(options, std::move(*shape), enters);
}

Result<Publisher::Object> Publisher::State::claim(const ObjectOptions& options) {
  const std::lock_guard lock(mutex_);
  if (auto error = object_fault(options)) { return *error; }
  return define(options, {}, false);  // no shape: keeps that of the object
}

Result<Publisher::Object> Publisher::State::define(const ObjectOptions& options, std::vector<std::uint8_t> shape,
                                                   bool enters) {
  if (auto error = say_alive()) { return *error; }
  const std::optional<Object> object = objects_.add(options, std::move(shape));
  if (!object) {
    return bad_input("object '" + options.name + "': a publisher holds at most " +
                     std::to_string(PublishedObjects::kMost) + " objects");
  }
  const std::uint32_t number = PublishedObjects::number(*object);
  objects_.find(*object)->enters = enters;
  if (enters) entering_.push_back(number);
  if (auto error = write_definition(number, objects_.at(number), false)) {
    objects_.remove(*object);
    return *error;
  }
  return *object;
}

Result<void> Publisher::State::remove(Object object) {
  const std::lock_guard lock(mutex_);
  if (objects_.find(object) == nullptr) { return unknown(object); }
  if (auto error = say_alive()) { return *error; }
  const std::uint32_t number = PublishedObjects::number(object);
  if (auto error = write_definition(number, objects_.at(number), true)) { return *error; }
  objects_.remove(object);
  return {};
}

Result<void> Publisher::State::reshape(Object object, const Shape& shape) {
  const std::lock_guard lock(mutex_);
  PublishedObject* const known = objects_.find(object);
  if (known == nullptr) { return unknown(object); }
  if (known->shape.empty()) {
    return bad_input("object '" + known->options.name + "' is claimed; its shape is not this publisher's");
  }
  Result<std::vector<std::uint8_t>> bytes = encoded(shape, known->options);
  if (!bytes) { return bytes.error(); }
  known->shape = std::move(*bytes);
  if (auto error = say_alive()) { return *error; }
  const std::uint32_t number = PublishedObjects::number(object);
  if (auto error = write_definition(number, objects_.at(number), false)) { return *error; }
  return {};
}

Result<void> Publisher::State::move(Object object, const Pose& pose, bool teleport) {
  const std::lock_guard lock(mutex_);
  const PublishedObject* const moved = objects_.find(object);
  if (moved == nullptr) { return unknown(object); }
  if (auto reason = pose_fault(pose)) {
    return bad_input("object '" + moved->options.name + "': " + *reason, "its pose is as before");
  }
  if (!moved->options.moving) {
    return bad_input("object '" + moved->options.name + "' was added as static", "its pose is as before");
  }
  objects_.set_pose(object, pose, teleport);
  if (Clock::now() - last_word_ > word_period_) {
    if (auto error = say_alive()) { return *error; }
  }
  return {};
}

Result<FlushReport> Publisher::State::flush(nanoseconds source_time) {
  const std::lock_guard lock(mutex_);
  if (auto error = say_alive()) { return *error; }
  has_own_clock_ = source_time.count() == 0;
  if (auto error = send_waiting(has_own_clock_ ? wire_contract::since_1970_ns() : source_time.count())) {
    return *error;
  }
  for (const std::uint32_t number : entering_) objects_.note_entered(number);
  entering_.clear();
  return FlushReport{.sequence = sequence_, .lost = std::exchange(lost_, {})};
}

void Publisher::State::stream() {
  const std::lock_guard lock(mutex_);
  is_streamed_ = true;
}

void Publisher::State::announce() {
  const std::lock_guard lock(mutex_);
  is_announced_ = true;
}

/// Sends the time, so that contacts with other publishers' objects need not wait for the next flush. The user's own
/// clock is unknown; it may be behind now.
std::optional<Error> Publisher::State::say_time(std::int64_t time_ns) {
  if (time_ns == 0 && has_own_clock_) time_ns = wire_contract::since_1970_ns();
  const bool is_due = time_ns != 0 && Clock::now() - last_instant_ > kSaidTimePeriod;
  return is_due ? write_instant(time_ns, true) : std::nullopt;
}

Result<void> Publisher::State::keep_alive(nanoseconds source_time) {
  const std::lock_guard lock(mutex_);
  if (auto error = say_alive()) { return *error; }
  if (auto error = say_time(source_time.count())) { return *error; }
  return {};
}

Result<PublisherReport> Publisher::State::report(nanoseconds timeout) {
  const Result<std::string> answer =
      client::command(*connection_, wire_contract::command::kLeftOut, {{"publisher", publisher_}}, timeout);
  if (!answer) { return answer.error(); }
  const nlohmann::json parsed = nlohmann::json::parse(*answer, nullptr, false);
  const auto objects = parsed.is_object() ? parsed.find("objects") : parsed.end();
  if (!parsed.is_object() || objects == parsed.end() || !objects->is_array()) {
    return Error{ErrorCode::internal, "publish: the server's answer about what it left out cannot be read", ""};
  }
  PublisherReport report;
  report.refused = parsed.value("refused", "");
  for (const nlohmann::json& object : *objects) {
    report.left_out.push_back({object.value("name", ""), object.value("why", "")});
  }
  report.left_out_count = parsed.value("count", std::uint64_t{report.left_out.size()});
  report.merged_poses = parsed.value("merged", std::uint64_t{0});
  return report;
}

std::string Publisher::State::busy_hint() const {
  const auto status = connection_->pulse().status();
  if (!status || status->step_lasting.count() == 0) { return {}; }
  return "it is busy: a step has lasted " + client::words(floor<std::chrono::milliseconds>(status->step_lasting));
}

/// How long a question may wait for the world's thread. A deadline that has just passed does not cut off the round
/// trip, and the publisher must renew its lease long before its end.
nanoseconds Publisher::State::patience(Clock::time_point deadline) const {
  return std::min(std::max<nanoseconds>(deadline - Clock::now(), kLeastCommandTimeout), lease_ / 2);
}

/// A definition that the server has refused or keeps waiting also counts as applied, so new ones are checked by a
/// question.
Result<void> Publisher::State::ask_for_left_out(Clock::time_point deadline) {
  std::uint64_t through = 0;
  {
    const std::lock_guard lock(mutex_);
    if (found_in_world_through_ == definitions_through_) { return {}; }
    through = definitions_through_;
  }
  const Result<PublisherReport> found = report(patience(deadline));
  if (!found) { return found.error(); }
  if (!found->left_out.empty()) {
    const std::uint64_t others = found->left_out_count - 1;
    return Error{ErrorCode::refused,
                 "object '" + found->left_out.front().name + "' is not in the world: " + found->left_out.front().why +
                     (others > 0 ? "; so are " + std::to_string(others) + " more" : std::string()),
                 "what waits for a name enters as soon as that is free"};
  }
  const std::lock_guard lock(mutex_);
  found_in_world_through_ = through;
  return {};
}

/// The server lists a publisher in the first status after its first sample. A publisher that is not listed may be
/// refused.
std::optional<Error> Publisher::State::why_not_known(Clock::time_point deadline) {
  const Result<PublisherReport> found = report(patience(deadline));
  if (!found || found->refused.empty()) { return std::nullopt; }
  return Error{ErrorCode::refused, "the server takes nothing of this publisher: " + found->refused,
               "none of its objects are in the world; they enter once there is room"};
}

Result<void> Publisher::State::wait_applied(nanoseconds timeout) {
  const Clock::time_point deadline = Clock::now() + timeout;
  const Clock::time_point asks_until = deadline + kLeastCommandTimeout;
  Clock::time_point next_question = Clock::now() + kListedSoon;
  while (true) {
    std::uint64_t wanted = 0;
    {
      const std::lock_guard lock(mutex_);
      // This call shows that the user's thread does not hang. A server that accepts nothing now may recover in time.
      const std::optional<Error> error = say_alive();
      if (error && (error->code != ErrorCode::timeout || Clock::now() >= deadline)) { return *error; }
      wanted = sequence_;
    }
    const auto view = connection_->pulse().publisher(publisher_);
    const std::uint64_t applied = view ? view->applied_sequence : 0;
    // Questions would only queue up behind the step.
    const bool may_ask = !connection_->pulse().is_busy() || Clock::now() >= deadline;
    if (applied >= wanted && may_ask) {
      Result<void> told = ask_for_left_out(deadline);
      if (told || told.error().code == ErrorCode::refused) { return told; }
      if (Clock::now() >= (told.error().code == ErrorCode::timeout ? asks_until : deadline)) { return told; }
      // The server was silent or busy for a moment, or was replaced: retry.
    } else if (Clock::now() >= deadline) {
      if (connection_->pulse().silent()) { return connection_->disconnected(); }
      return Error{ErrorCode::timeout,
                   "publish: the server has applied " + std::to_string(applied) + " of " + std::to_string(wanted) +
                       " messages in " + client::words(timeout),
                   busy_hint()};
    } else if (!view && may_ask && Clock::now() >= next_question) {
      if (auto error = why_not_known(deadline)) { return *error; }
      next_question = Clock::now() + kListedSoon;
    }
    connection_->pulse().wait_for_status(std::min(deadline, Clock::now() + word_period_));
  }
}

}  // namespace collided
