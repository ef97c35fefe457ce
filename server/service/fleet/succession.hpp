#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

#include "server/service/fleet/membership.hpp"
#include "server/service/ingest/inbox.hpp"
#include "server/service/world_loop.hpp"

namespace collided::engine::service {

/// Which part this server has in its namespace, and how that changes: a standby takes the place of a primary that has fallen
/// silent, and a primary gives way to a standby that has taken its place.
///
/// threads  take_over() and hear() for one each, the rest for any
class Succession {
 public:
  struct Collaborators {
    WorldLoop& loop;
    Inbox& inbox;
    std::atomic<bool>& stands_by;  // while it is set, questions are not taken
    std::uint64_t epoch = 0;       // of this server
    std::function<void(const std::string&)> notice;
    std::function<void()> became_primary;
    std::function<void()> end;  // has the process end; returns at once
  };
  explicit Succession(Collaborators with) : with_(std::move(with)) {}

  wire_contract::MemberRole role() const;
  /// The server whose place this one has taken; 0: none.
  std::uint64_t predecessor() const { return predecessor_.load(); }
  /// Makes this server the primary in the place of that one. Returns once its first words are written. False: the
  /// world's thread does not take it; try again.
  bool take_over(std::uint64_t primary, const std::string& why);
  /// Another server of the namespace has said what it is. Where it has taken this one's place, this one falls silent and
  /// has its process end.
  void hear(const OtherMember& other);
  /// Whether this server was the primary, and another one is now.
  bool has_given_way() const { return has_given_way_.load(); }

 private:
  const Collaborators with_;
  std::atomic<std::uint64_t> predecessor_{0};
  std::atomic<bool> has_given_way_{false};
};

}  // namespace collided::engine::service
