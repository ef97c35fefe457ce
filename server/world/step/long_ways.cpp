#include "server/world/step/long_ways.hpp"

#include <algorithm>
#include <cmath>

namespace collided::engine {
namespace {

constexpr std::uint32_t kMostParts = 64;
/// With fewer movers, comparing the whole boxes is cheap.
constexpr std::size_t kFewestMovers = 256;
/// Number of movers sampled to judge a step.
constexpr std::size_t kSample = 128;

// Measured in ns, of which only the ratios matter. A box: made, put into a grid and searched for. A pair: found, found
// within a part (where it is also sorted), decided for balls, and decided for anything else.
constexpr double kBoxCost = 300;
constexpr double kFoundCost = 25;
constexpr double kFoundInPartCost = 80;
constexpr double kBallsCost = 30;
constexpr double kOthersCost = 3'000;
/// The estimate takes positions for independent, and is up to twice the cost of long paths; only a clear gain counts.
constexpr double kClearGain = 0.45;

/// Averages over the movers.
struct Crowd {
  Vec3 size = Vec3::Zero();
  Vec3 travel = Vec3::Zero();
  Aabb at_begin, at_end;  // bounds of their positions
  double count = 0;       // number of all boxes
  double balls = 0;       // share of the movers

  /// Expected pairs of boxes of this size that overlap in the room.
  double pairs_in(const Aabb& room, const Vec3& box) const {
    double share = 0.5;
    for (int axis = 0; axis < 3; ++axis) share *= std::min(1.0, 2 * box[axis] / (room.high[axis] - room.low[axis]));
    return count * count * share;
  }
  double cost_of(std::uint32_t parts) const {
    const Vec3 box = size + travel / parts;
    const double pairs = (pairs_in(at_begin, box) + pairs_in(at_end, box)) / 2;
    const double decided = balls * kBallsCost + (1 - balls) * kOthersCost;
    return parts * (count * kBoxCost + pairs * (decided + (parts == 1 ? kFoundCost : kFoundInPartCost)));
  }
};

}  // namespace

std::optional<StraightWay> way_of(const StepView& step, std::uint32_t slot) {
  const ObjectRows& rows = step.rows;
  if (rows.motion(slot) != Motion::moved || rows.info(slot) == nullptr || step.motion.is_open(slot))
    return std::nullopt;
  const BallMotion& ball = step.motion.ball(slot);
  StraightWay way = ball.radius_m >= 0
                        ? StraightWay(MovingSphere{.start = ball.start, .end = ball.end, .radius_m = ball.radius_m})
                        : StraightWay(step.motion.body_motion(slot), rows.bounds(slot), rows[slot].reach_m);
  return way.is_finite() ? std::optional(way) : std::nullopt;
}

std::uint32_t parts_of(const StraightWay& way) {
  // A path along one axis fills its box, whatever its length.
  Vec3 travel = way.travel().cwiseAbs();
  std::sort(travel.begin(), travel.end());
  const double parts = travel[1] / (2 * way.size().maxCoeff());
  constexpr std::uint32_t kMostForOne = 16;
  return parts < 2 ? 1 : static_cast<std::uint32_t>(std::min<double>(kMostForOne, parts));
}

std::uint32_t LongWays::part_count(std::size_t boxes) const {
  const std::vector<std::uint32_t>& moved = step_.rows.moved();
  // Pairs of several sources are decided at other times than the step's.
  if (moved.size() < kFewestMovers || step_.sources.need_common_time()) return 1;
  Crowd crowd;
  crowd.count = static_cast<double>(boxes);
  std::size_t sampled = 0;
  for (std::size_t i = 0; i < moved.size(); i += moved.size() / kSample) {
    const std::optional<StraightWay> way = way_of(step_, moved[i]);
    if (!way) continue;
    crowd.size += way->size();
    crowd.travel += way->travel().cwiseAbs();
    crowd.balls += step_.motion.ball(moved[i]).radius_m >= 0 ? 1 : 0;
    crowd.at_begin.extend(way->between(0, 0));
    crowd.at_end.extend(way->between(1, 1));
    ++sampled;
  }
  if (sampled < kSample / 2) return 1;
  crowd.size /= static_cast<double>(sampled);
  crowd.travel /= static_cast<double>(sampled);
  crowd.balls /= static_cast<double>(sampled);
  std::uint32_t best = 1;
  double least = kClearGain * crowd.cost_of(1);
  for (std::uint32_t parts = 2; parts <= kMostParts; parts *= 2) {
    const double cost = crowd.cost_of(parts);
    if (cost < least) {
      best = parts;
      least = cost;
    }
  }
  return best;
}

void LongWays::pairs(std::uint32_t parts, Grid::PairFound found, WalkCost& cost) {
  constexpr std::size_t kFirstSort = std::size_t{1} << 20;
  most_unsorted_ = kFirstSort;
  boxes_.assign(step_.motion.bounds().begin(), step_.motion.bounds().end());
  for (const std::uint32_t slot : step_.rows.moved()) {
    if (const std::optional<StraightWay> way = way_of(step_, slot)) {
      slots_.push_back(slot);
      ways_.push_back(*way);
    }
  }
  for (std::uint32_t part = 0; part < parts; ++part)
    find_in_part(static_cast<double>(part) / parts, static_cast<double>(part + 1) / parts, cost);
  keep_each_once();
  for (const std::uint64_t pair : found_) {
    if (!found(static_cast<std::uint32_t>(pair >> 32), static_cast<std::uint32_t>(pair))) return;
  }
}

void LongWays::find_in_part(double begin, double end, WalkCost& cost) {
  for (std::size_t i = 0; i < slots_.size(); ++i) boxes_[slots_[i]] = ways_[i].between(begin, end);
  Grid grid(Grid::Use::pairs);
  grid.rebuild(boxes_);
  const auto keep = [&](std::uint32_t first, std::uint32_t second) {
    if (!step_.looks_at_all && !step_.rows.has_moved(first) && !step_.rows.has_moved(second)) return true;
    found_.push_back(std::uint64_t{first} << 32 | second);
    if (found_.size() >= most_unsorted_) {
      keep_each_once();
      most_unsorted_ = std::max(most_unsorted_, 2 * found_.size());
    }
    return true;
  };
  grid.pairs(keep, cost);
}

void LongWays::keep_each_once() {
  std::sort(found_.begin(), found_.end());
  found_.erase(std::unique(found_.begin(), found_.end()), found_.end());
}

}  // namespace collided::engine
