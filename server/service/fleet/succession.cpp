#include "server/service/fleet/succession.hpp"

#include <fmt/format.h>

#include <chrono>
#include <future>
#include <memory>

namespace collided::engine::service {

using wire_contract::MemberRole;

MemberRole Succession::role() const { return with_.stands_by.load() ? MemberRole::standby : MemberRole::primary; }

bool Succession::take_over(std::uint64_t primary, const std::string& why) {
  constexpr std::chrono::seconds kPatience{5};
  const auto done = std::make_shared<std::promise<void>>();
  const bool is_taken = with_.inbox.push_job([this, primary, done] {
    // What the world's thread has yet to take in from publishers comes in the steps that follow, as ever.
    predecessor_.store(primary);
    with_.stands_by.store(false);
    with_.loop.speak();
    done->set_value();
  });
  if (!is_taken || done->get_future().wait_for(kPatience) != std::future_status::ready) return false;
  with_.notice(fmt::format("{}: this server has taken its place, as epoch {}", why, with_.epoch));
  with_.became_primary();
  return true;
}

void Succession::hear(const OtherMember& other) {
  const bool is_heir = other.role == MemberRole::primary && other.following.primary != 0 && other.epoch > with_.epoch;
  if (!is_heir || role() != MemberRole::primary || has_given_way_.exchange(true)) return;
  with_.stands_by.store(true);
  static_cast<void>(with_.inbox.push_job([this] { with_.loop.fall_silent(); }));
  with_.notice(fmt::format("'{}' (epoch {}) has taken this server's place, which was silent for too long; this one ends",
                           other.name, other.epoch));
  with_.end();
}

}  // namespace collided::engine::service
