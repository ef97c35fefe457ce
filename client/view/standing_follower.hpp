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

  /// All outlines if, since the last look, one was added or removed, holds other objects, or has another line to what is
  /// nearest. What they hold is asked each time, where regions and bands are only when there are others.
  std::optional<std::vector<draw::StandingOutline>> look();
  /// Whether there were any at the last look.
  bool has_any() const { return !outlines_.empty() || !nearest_.empty(); }

 private:
  bool look_at_nearest();

  Client& client_;
  std::vector<draw::StandingOutline> outlines_;  // of regions and bands, as they were returned
  std::vector<draw::StandingOutline> nearest_;
};

}  // namespace collided::view
