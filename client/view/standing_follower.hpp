#pragma once

#include <optional>
#include <vector>

#include "client/draw/drawing/standing_outlines.hpp"
#include "collided/client.hpp"

namespace collided::view {

/// Polls the outlines of a server's standing questions.
///
/// threads  one
class StandingFollower {
 public:
  /// client  must outlive it
  explicit StandingFollower(Client& client) : client_(client) {}

  /// All outlines if, since the last look, one was added or removed, holds other objects, or has another line to the
  /// nearest. The held objects are requested each time, the places of regions and bands only when they have changed.
  std::optional<std::vector<draw::StandingOutline>> look();
  /// Whether there were any at the last look.
  bool has_any() const { return !outlines_.empty() || !nearest_.empty(); }

 private:
  bool look_at_nearest();

  Client& client_;
  std::vector<draw::StandingOutline> outlines_;  // of regions and bands, as returned
  std::vector<draw::StandingOutline> nearest_;
};

}  // namespace collided::view
