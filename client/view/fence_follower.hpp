#pragma once

#include <optional>
#include <vector>

#include "client/draw/drawing/fence_outlines.hpp"
#include "collided/client.hpp"

namespace collided::view {

/// Looks again and again at the fences and bands of a server, and at what is nearest by its questions.
///
/// threads  one
class FenceFollower {
 public:
  /// client  must outlive it
  explicit FenceFollower(Client& client) : client_(client) {}

  /// All of them, where some are others than at the last look, or others are in them, or a line to what is nearest is
  /// another one. Who is in which is asked each time, where they stand only when there are others.
  std::optional<std::vector<draw::FenceOutline>> look();
  /// Whether there were any at the last look.
  bool has_any() const { return !fences_.empty() || !nearest_.empty(); }

 private:
  bool look_at_nearest();

  Client& client_;
  std::vector<draw::FenceOutline> fences_;  // as they were returned
  std::vector<draw::FenceOutline> nearest_;
};

}  // namespace collided::view
