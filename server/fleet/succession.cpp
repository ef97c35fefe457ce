#include "server/fleet/succession.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <future>
#include <memory>
#include <thread>

#include "server/service/runtime/clock.hpp"

namespace collided::engine::service {

using wire_contract::MemberRole;
using wire_contract::ServerState;

namespace {

constexpr std::chrono::milliseconds kLook{2};

}  // namespace

bool Succession::done_on_world_thread(std::function<void()> job) const {
  constexpr std::chrono::seconds kPatience{5};
  const auto done = std::make_shared<std::promise<void>>();
  with_.on_world_thread([job = std::move(job), done] {
    job();
    done->set_value();
  });
  return done->get_future().wait_for(kPatience) == std::future_status::ready;
}

// ---- of a standby

bool Succession::take_over(std::uint64_t primary, const SpokenBefore& before, const std::string& why) {
  // What the world's thread has yet to take in from publishers comes in the steps that follow, as ever.
  const bool is_done = done_on_world_thread([this, primary, before] {
    predecessor_.store(primary);
    role_.store(MemberRole::primary);
    with_.takes_questions.store(true);
    with_.speak(before);
  });
  if (!is_done) return false;
  with_.notice(fmt::format("{}: this server has taken its place, as epoch {}", why, with_.epoch()));
  with_.became_primary();
  return true;
}

void Succession::catch_up(const PublisherProgress& progress) {
  constexpr std::int64_t kMostNs = 500'000'000;
  const std::int64_t until_ns = steady_ns() + kMostNs;
  bool has_all = false;
  do {
    const auto found = std::make_shared<std::atomic<bool>>(false);
    const bool is_looked =
        done_on_world_thread([this, found, progress] { found->store(with_.has_come_as_far(progress)); });
    has_all = is_looked && found->load();
    if (!has_all) std::this_thread::sleep_for(kLook);
  } while (!has_all && steady_ns() < until_ns);
}

// ---- of a primary

void Succession::hear(const OtherMember& other) {
  if (other.role == MemberRole::standby && other.following.primary == with_.self) {
    const std::lock_guard lock(mutex_);
    const std::int64_t now_ns = steady_ns();
    std::erase_if(followers_, [&](const auto& entry) { return now_ns - entry.second.heard_ns > kMemberGoneNs; });
    followers_[other.server] = {.name = other.name, .is_ready = other.state == ServerState::ready, .heard_ns = now_ns};
    return;
  }
  if (other.role != MemberRole::primary || role() != MemberRole::primary) return;
  const bool is_heir = other.following.primary != 0 && other.epoch > with_.epoch();
  const bool is_earlier = std::pair(other.epoch, other.server) < std::pair(with_.epoch(), with_.self);
  if (is_heir) {
    if (has_heir_.exchange(true) || hands_over_.load()) return;
    give_way(fmt::format("'{}' (epoch {}) has taken this server's place, which was silent for too long; this one ends",
                         other.name, other.epoch));
  } else if (with_.joins && predecessor() == 0 && is_earlier) {
    give_way(fmt::format("'{}' (epoch {}) was the primary before this server, which ends to stand by", other.name,
                         other.epoch));
  }
}

void Succession::forget(std::uint64_t server) {
  const std::lock_guard lock(mutex_);
  followers_.erase(server);
}

bool Succession::stands_by(std::uint64_t server) const {
  const std::lock_guard lock(mutex_);
  return followers_.contains(server);
}

void Succession::lose_place(const std::string& why) {
  if (!has_heir_.exchange(true) && !hands_over_.load()) give_way(why);
}

void Succession::give_way(const std::string& why) {
  if (has_given_way_.exchange(true)) return;
  with_.takes_questions.store(false);
  with_.on_world_thread(with_.fall_silent);
  with_.notice(why);
  with_.end();
}

void Succession::cannot_follow() {
  if (!with_.joins || has_given_way_.exchange(true)) return;
  with_.notice("this server ends, to join again");
  with_.end();
}

std::optional<Succession::Heir> Succession::heir(const std::string& name) const {
  // Whoever has no place hands none over, and ends without waiting for one that takes it.
  if (role() != MemberRole::primary || has_heir_.load() || has_given_way_.load()) return std::nullopt;
  const std::lock_guard lock(mutex_);
  for (const auto& [server, follower] : followers_) {
    const bool is_there = follower.is_ready && steady_ns() - follower.heard_ns < kMemberGoneNs;
    if (is_there && (name.empty() || follower.name == name)) return Heir{.server = server, .name = follower.name};
  }
  return std::nullopt;
}

void Succession::choose(const std::string& name) {
  {
    const std::lock_guard lock(mutex_);
    chosen_ = name;
  }
  with_.end();
}

std::string Succession::take_choice() {
  const std::lock_guard lock(mutex_);
  return std::exchange(chosen_, {});
}

bool Succession::hand_over(ChangeFeed& feed, const Heir& to) {
  if (role() != MemberRole::primary || has_heir_.load()) return false;
  hands_over_.store(true);
  const auto words = std::make_shared<HandoverWords>(HandoverWords{.to = to.server, .progress = {}});
  const bool is_silent = done_on_world_thread([this, words] { words->progress = with_.say_last_words(); });
  // Before it is told to take the place, which it could not yet.
  with_.lend_place();
  if (is_silent) feed.tell({.text = handover_text(*words), .blob = {}});
  constexpr std::int64_t kPatienceNs = 3'000'000'000;
  const std::int64_t until_ns = steady_ns() + kPatienceNs;
  while (!has_heir_.load() && stands_by(to.server) && steady_ns() < until_ns) std::this_thread::sleep_for(kLook);
  if (has_heir_.load() || !with_.take_place_back()) {
    with_.notice(fmt::format("'{}' has this server's place", to.name));
    return true;
  }
  const char* const why = stands_by(to.server) ? "has not taken this server's place within 3 s"
                                               : "has left before it took this server's place";
  with_.notice(fmt::format("'{}' {}", to.name, why));
  hands_over_.store(false);
  static_cast<void>(done_on_world_thread([this] { with_.speak({}); }));
  with_.answer_held_questions();
  return false;
}

}  // namespace collided::engine::service
