#include "client/view/fence_follower.hpp"

#include <algorithm>
#include <utility>

#include "client/draw/drawing/nearest_outlines.hpp"

namespace collided::view {

std::optional<std::vector<draw::FenceOutline>> FenceFollower::look() {
  const bool are_lines_elsewhere = look_at_nearest();
  Result<std::vector<draw::FenceOutline>> now = draw::fence_outlines(client_, false);
  if (!now) return std::nullopt;
  const auto are_same = [&](auto&& same) {
    return std::equal(now->begin(), now->end(), fences_.begin(), fences_.end(), same);
  };
  const bool stand_as_before =
      are_same([](const auto& a, const auto& b) { return a.number == b.number && a.to == b.to; });
  const bool hold_the_same =
      are_same([](const auto& a, const auto& b) { return a.inside == b.inside && a.in_doubt == b.in_doubt; });
  if (stand_as_before && hold_the_same && !are_lines_elsewhere) return std::nullopt;
  if (stand_as_before) {
    for (std::size_t i = 0; i < fences_.size(); ++i) (*now)[i].lines = std::move(fences_[i].lines);
  } else if (now = draw::fence_outlines(client_, true); !now) {
    return std::nullopt;
  }
  fences_ = std::move(*now);
  std::vector<draw::FenceOutline> all = fences_;
  all.insert(all.end(), nearest_.begin(), nearest_.end());
  return all;
}

/// Whether what is nearest, or the line to it, is another one.
bool FenceFollower::look_at_nearest() {
  Result<std::vector<draw::FenceOutline>> now = draw::nearest_outlines(client_);
  if (!now) return false;
  const auto are_same = [](const draw::FenceOutline& a, const draw::FenceOutline& b) {
    return a.name == b.name && a.inside == b.inside && a.in_doubt == b.in_doubt && a.distance_m == b.distance_m &&
           a.lines == b.lines;
  };
  const bool is_elsewhere = !std::equal(now->begin(), now->end(), nearest_.begin(), nearest_.end(), are_same);
  nearest_ = std::move(*now);
  return is_elsewhere;
}

}  // namespace collided::view
