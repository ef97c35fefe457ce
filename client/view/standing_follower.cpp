#include "client/view/standing_follower.hpp"

#include <algorithm>
#include <utility>

namespace collided::view {
namespace {

bool hold_the_same(const draw::StandingOutline& a, const draw::StandingOutline& b) {
  return std::ranges::equal(a.holds, b.holds, [](const HeldObject& one, const HeldObject& other) {
    return one.object == other.object && one.in_doubt == other.in_doubt;
  });
}

}  // namespace

std::optional<std::vector<draw::StandingOutline>> StandingFollower::look() {
  const bool are_lines_elsewhere = look_at_nearest();
  Result<std::vector<draw::StandingOutline>> now = draw::standing_outlines(client_, false);
  if (!now) return std::nullopt;
  const bool stand_as_before = std::ranges::equal(
      *now, outlines_, [](const auto& a, const auto& b) { return a.id == b.id && a.carrier() == b.carrier(); });
  if (stand_as_before && std::ranges::equal(*now, outlines_, hold_the_same) && !are_lines_elsewhere)
    return std::nullopt;
  if (stand_as_before) {
    for (std::size_t i = 0; i < outlines_.size(); ++i) (*now)[i].lines = std::move(outlines_[i].lines);
  } else if (now = draw::standing_outlines(client_, true); !now) {
    return std::nullopt;
  }
  outlines_ = std::move(*now);
  std::vector<draw::StandingOutline> all = outlines_;
  all.insert(all.end(), nearest_.begin(), nearest_.end());
  return all;
}

/// Whether another object is nearest, or the line to it has changed.
bool StandingFollower::look_at_nearest() {
  Result<std::vector<draw::StandingOutline>> now = draw::nearest_outlines(client_);
  if (!now) return false;
  const auto are_same = [](const draw::StandingOutline& a, const draw::StandingOutline& b) {
    return a.name == b.name && hold_the_same(a, b) && a.distance_m == b.distance_m && a.lines == b.lines;
  };
  const bool is_elsewhere = !std::ranges::equal(*now, nearest_, are_same);
  nearest_ = std::move(*now);
  return is_elsewhere;
}

}  // namespace collided::view
