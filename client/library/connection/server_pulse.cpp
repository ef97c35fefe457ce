#include "client/library/connection/server_pulse.hpp"

#include <algorithm>
#include <sstream>

#include "idl/columns.hpp"

namespace collided::client {
namespace {

using std::chrono::nanoseconds;

std::vector<std::string> lines(const char* text) {
  std::vector<std::string> found;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) { found.push_back(line); }
  return found;
}

std::vector<PublisherInfo> decode_publishers(const wire::Status& status) {
  const auto names = wire_contract::unpack_names(dds::view(status.publisher_names));
  const auto applied = dds::view(status.applied_sequences);
  const auto silent = dds::view(status.silent_ns);
  const auto states = dds::view(status.publisher_states);
  std::size_t count = std::min({names.size(), applied.size(), silent.size(), states.size()});
  // The last entry is that of the world.
  if (wire::busy_ns(status) > 0) count = std::min(count, silent.size() - 1);
  std::vector<PublisherInfo> publishers;
  for (std::size_t i = 0; i < count; ++i) {
    publishers.push_back({.name = std::string(names[i]),
                          .applied_sequence = applied[i],
                          .silent = nanoseconds(silent[i]),
                          .lost = states[i] == static_cast<std::uint8_t>(wire_contract::PublisherState::lost)});
  }
  return publishers;
}

}  // namespace

ServerStatus decode_status(const wire::Status& status) {
  ServerStatus decoded;
  decoded.name_space = status.namespace_name;
  decoded.version_text = status.server_version;
  decoded.pid = status.pid;
  decoded.state = state_name(status.state);
  decoded.epoch = status.epoch;
  decoded.version = status.version;
  decoded.world_time = nanoseconds(status.world_time_ns);
  decoded.last_event_sequence = status.last_event_sequence;
  decoded.contacts = status.contact_count;
  decoded.contacts_truncated = status.contacts_truncated != 0;
  decoded.scenes = lines(status.scenes);
  decoded.static_triangles = status.static_triangles;
  decoded.objects = status.object_count;
  decoded.moving = status.moving_count;
  decoded.poses_applied = status.poses_applied;
  decoded.poses_dropped = status.poses_dropped;
  decoded.questions_answered = status.questions_answered;
  decoded.questions_refused = status.questions_refused;
  decoded.undecided_answers = status.undecided_answers;
  decoded.publishers = decode_publishers(status);
  decoded.step_lasting = nanoseconds(wire::busy_ns(status));
  return decoded;
}

std::string state_name(std::uint8_t state) {
  const std::string_view name = name_of(static_cast<codes::ServerState>(state));
  return name.empty() ? "unknown (" + std::to_string(state) + ')' : std::string(name);
}

void ServerPulse::hear(dds::Sample<wire::Status>& status) {
  if (server() != status->server && server() != 0 && !is_heir(*status)) { return; }
  epoch_.store(status->epoch, std::memory_order_relaxed);
  is_stopping_.store(status->state == static_cast<std::uint8_t>(wire_contract::ServerState::stopping),
                     std::memory_order_relaxed);
  is_ready_.store(status->state == static_cast<std::uint8_t>(wire_contract::ServerState::ready),
                  std::memory_order_relaxed);
  server_.store(status->server, std::memory_order_release);
  pid_.store(status->pid, std::memory_order_relaxed);
  last_heard_ns_.store(now_ns(), std::memory_order_relaxed);
  // After a status that is merely late, on a crowded machine, the next one follows soon.
  is_busy_.store(wire::busy_ns(*status) > wire_contract::kStatusLostNs, std::memory_order_relaxed);
  if (is_busy()) last_busy_ns_.store(now_ns(), std::memory_order_relaxed);
  {
    const std::lock_guard lock(observers_mutex_);
    for (const auto& [number, observer] : observers_) { observer(*status); }
  }
  const std::lock_guard lock(mutex_);
  if (count_ > 0 && Clock::now() - newest_came_ > nanoseconds(wire_contract::kForgottenNs)) ++outages_;
  std::swap(newest_, status);
  ++count_;
  newest_came_ = Clock::now();
  came_.notify_all();
}

bool ServerPulse::is_heir(const wire::Status& status) const {
  if (status.server == server()) return false;
  const nanoseconds silence = Clock::now() - last_heard();
  if (status.epoch > epoch()) return may_have_heir();
  const bool is_earlier = status.epoch < epoch();
  return silence > nanoseconds(is_earlier ? wire_contract::kForgottenNs : wire_contract::kStatusLostNs);
}

void ServerPulse::greeted(std::uint64_t server, std::uint64_t epoch) {
  epoch_.store(epoch, std::memory_order_relaxed);
  is_stopping_.store(false, std::memory_order_relaxed);  // a server that stops does not answer: another one did
  server_.store(server, std::memory_order_release);
  hear_message();
}

Clock::time_point ServerPulse::last_heard() const {
  return Clock::time_point(nanoseconds(last_heard_ns_.load(std::memory_order_relaxed)));
}

Clock::time_point ServerPulse::last_busy() const {
  return Clock::time_point(nanoseconds(last_busy_ns_.load(std::memory_order_relaxed)));
}

bool ServerPulse::may_have_heir() const {
  return is_stopping_.load(std::memory_order_relaxed) ||
         Clock::now() - last_heard() > nanoseconds(wire_contract::kMayHaveHeirNs);
}

bool ServerPulse::silent() const { return Clock::now() - last_heard() > nanoseconds(wire_contract::kStatusLostNs); }

nanoseconds ServerPulse::settled() const {
  const std::lock_guard lock(mutex_);
  return nanoseconds(newest_->settled_ns);
}

std::optional<ServerStatus> ServerPulse::status() const {
  const std::lock_guard lock(mutex_);
  if (count_ == 0) { return std::nullopt; }
  ServerStatus status = decode_status(*newest_);
  status.age = Clock::now() - newest_came_;
  return status;
}

std::optional<ServerPulse::PublisherView> ServerPulse::publisher(std::uint64_t publisher) const {
  const std::lock_guard lock(mutex_);
  const auto publishers = dds::view(newest_->publishers);
  const auto applied = dds::view(newest_->applied_sequences);
  const auto states = dds::view(newest_->publisher_states);
  for (std::size_t i = 0; i < std::min({publishers.size(), applied.size(), states.size()}); ++i) {
    if (publishers[i] == publisher) {
      const auto is = [&](wire_contract::PublisherState state) {
        return states[i] == static_cast<std::uint8_t>(state);
      };
      return PublisherView{.applied_sequence = applied[i],
                           .lost = is(wire_contract::PublisherState::lost),
                           .asked = is(wire_contract::PublisherState::asked)};
    }
  }
  return std::nullopt;
}

bool ServerPulse::wait_for_status(Clock::time_point deadline) const {
  std::unique_lock lock(mutex_);
  return came_.wait_until(lock, deadline, [this, before = count_] { return count_ != before; });
}

int ServerPulse::observe(Observer observer) {
  const std::lock_guard lock(observers_mutex_);
  observers_.emplace(next_observer_, std::move(observer));
  return next_observer_++;
}

void ServerPulse::stop_observing(int observer) {
  const std::lock_guard lock(observers_mutex_);
  observers_.erase(observer);
}

}  // namespace collided::client
