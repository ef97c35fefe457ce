#include "server/world/step/motion_history.hpp"

#include <algorithm>

namespace collided::engine {
namespace {

/// A pure function of segment and time, so that every caller gets the same frame to the bit.
Frame place_on(const MotionSegment& segment, std::int64_t time_ns) {
  if (time_ns >= segment.to_ns) return segment.to;
  if (time_ns <= segment.from_ns) return segment.from;
  const double share =
      static_cast<double>(time_ns - segment.from_ns) / static_cast<double>(segment.to_ns - segment.from_ns);
  return segment.path().at(share);
}

Vec3 center_on(const MotionSegment& segment, const Vec3& center, std::int64_t time_ns) {
  if (time_ns >= segment.to_ns) return place(segment.to, center);
  if (time_ns <= segment.from_ns) return place(segment.from, center);
  const double share =
      static_cast<double>(time_ns - segment.from_ns) / static_cast<double>(segment.to_ns - segment.from_ns);
  return segment.to.rotation * center + ((1 - share) * segment.from.position + share * segment.to.position);
}

}  // namespace

void MotionHistory::add(std::uint32_t slot, const MotionSegment& segment) {
  if (slot >= segments_.size()) segments_.resize(slot + 1);
  if (segments_[slot].empty()) travelling_.push_back(slot);
  segments_[slot].push_back(segment);
}

void MotionHistory::forget(std::uint32_t slot) {
  if (!is_travelling(slot)) return;
  segments_[slot].clear();
  std::erase(travelling_, slot);
}

void MotionHistory::forget_up_to(std::int64_t time_ns) {
  std::erase_if(travelling_, [&](std::uint32_t slot) {
    std::vector<MotionSegment>& own = segments_[slot];
    const auto is_past = [&](const MotionSegment& segment) { return segment.to_ns <= time_ns; };
    own.erase(own.begin(), std::find_if_not(own.begin(), own.end(), is_past));
    return own.empty();
  });
}

bool MotionHistory::moves(std::uint32_t slot, std::int64_t from_ns, std::int64_t to_ns) const {
  if (!is_travelling(slot)) return false;
  return std::any_of(segments_[slot].begin(), segments_[slot].end(), [&](const MotionSegment& segment) {
    return segment.to_ns > from_ns && (segment.from_ns < to_ns || segment.to_ns <= to_ns);
  });
}

bool MotionHistory::jumps(std::uint32_t slot, std::int64_t time_ns) const {
  if (!is_travelling(slot)) return false;
  return std::any_of(segments_[slot].begin(), segments_[slot].end(),
                     [&](const MotionSegment& segment) { return segment.is_jump() && segment.to_ns == time_ns; });
}

const MotionSegment* MotionHistory::under_way(std::uint32_t slot, std::int64_t time_ns) const {
  if (!is_travelling(slot)) return nullptr;
  for (const MotionSegment& segment : segments_[slot]) {
    if (segment.from_ns < time_ns && time_ns <= segment.to_ns) return &segment;
  }
  return nullptr;
}

Aabb MotionHistory::bounds(std::uint32_t slot) const {
  Aabb all;
  if (is_travelling(slot)) {
    for (const MotionSegment& segment : segments_[slot]) all.extend(segment.bounds);
  }
  return all;
}

void MotionHistory::add_times(std::uint32_t slot, std::int64_t from_ns, std::int64_t to_ns,
                              std::vector<std::int64_t>& times) const {
  if (!is_travelling(slot)) return;
  for (const MotionSegment& segment : segments_[slot]) {
    for (const std::int64_t time : {segment.from_ns, segment.to_ns}) {
      if (time > from_ns && time <= to_ns) times.push_back(time);
    }
  }
}

/// The first segment that ends after that time; null if there is none.
const MotionSegment* MotionHistory::ending_after(std::uint32_t slot, std::int64_t time_ns) const {
  for (const MotionSegment& segment : segments_[slot]) {
    if (segment.to_ns > time_ns) return &segment;
  }
  return nullptr;
}

BodyMotion MotionHistory::motion(std::uint32_t slot, std::int64_t from_ns, std::int64_t to_ns,
                                 const Pose& resting) const {
  if (!is_travelling(slot)) return BodyMotion::resting(frame_of(resting));
  const MotionSegment* found = ending_after(slot, from_ns);
  if (found == nullptr) return BodyMotion::resting(segments_[slot].back().to);
  const bool rests = found->is_jump() || found->from_ns >= to_ns;
  if (rests) return BodyMotion::resting(found->from);
  return {place_on(*found, from_ns), place_on(*found, to_ns), found->pivot};
}

MotionHistory::PointMotion MotionHistory::center_motion(std::uint32_t slot, const Vec3& center, std::int64_t from_ns,
                                                        std::int64_t to_ns, const Pose& resting) const {
  const auto at_rest = [&](const Frame& frame) {
    const Vec3 point = place(frame, center);
    return PointMotion{point, point};
  };
  if (!is_travelling(slot)) return at_rest(frame_of(resting));
  const MotionSegment* found = ending_after(slot, from_ns);
  if (found == nullptr) return at_rest(segments_[slot].back().to);
  if (found->is_jump() || found->from_ns >= to_ns) return at_rest(found->from);
  return {center_on(*found, center, from_ns), center_on(*found, center, to_ns)};
}

Frame MotionHistory::at(std::uint32_t slot, std::int64_t time_ns, const Pose& resting) const {
  if (!is_travelling(slot)) return frame_of(resting);
  const MotionSegment* later = ending_after(slot, time_ns);
  return later == nullptr ? segments_[slot].back().to : place_on(*later, time_ns);
}

}  // namespace collided::engine
