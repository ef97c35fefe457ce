#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <utility>

#include "server/fleet/membership.hpp"

namespace collided::engine::service {

/// What a primary does for the servers that follow it: each wish of theirs once.
///
/// threads  one
class ServedFollowers {
 public:
  struct Collaborators {
    std::function<void(std::uint64_t follower, std::uint64_t fetch)> send_all;  // all that is kept
    std::function<void()> ask_again;  // have publishers define everything again
  };
  ServedFollowers(std::uint64_t self, Collaborators with) : self_(self), with_(std::move(with)) {}

  void hear(const OtherMember& other) {
    if (other.following.primary != self_) return;
    Following& served = served_[other.server];
    if (other.following.fetch > served.fetch) with_.send_all(other.server, other.following.fetch);
    if (other.following.again > served.again) with_.ask_again();
    served = other.following;
  }

 private:
  const std::uint64_t self_;
  const Collaborators with_;
  std::map<std::uint64_t, Following> served_;  // by follower; one entry for each that ever followed
};

}  // namespace collided::engine::service
