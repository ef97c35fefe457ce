#pragma once

#include <cstdint>
#include <vector>

#include "server/exact_phase/motion/body_motion.hpp"
#include "server/geometry/aabb.hpp"

namespace collided::engine {

/// The motion of an object from one pose to the next; a jump if both have the same time. The centre of a lone sphere
/// moves straight, so its frames do not rotate.
struct MotionSegment {
  std::int64_t from_ns = 0;
  std::int64_t to_ns = 0;
  Frame from;
  Frame to;
  Vec3 pivot = Vec3::Zero();  // as in BodyMotion
  Aabb bounds;                // of the whole motion

  BodyMotion path() const { return {from, to, pivot}; }
  bool is_jump() const { return from_ns == to_ns; }
};

/// Where objects were recently, as far back as a source may still need it. Before the first segment, between segments
/// and after the last an object rests.
/// threads  the writer only
/// Always: an object's segments are ordered by time and do not overlap.
class MotionHistory {
 public:
  void add(std::uint32_t slot, const MotionSegment& segment);
  void forget(std::uint32_t slot);
  /// Forgets segments that end by then: no source needs that time any more.
  void forget_up_to(std::int64_t time_ns);

  /// Slots with a segment.
  const std::vector<std::uint32_t>& travelling() const { return travelling_; }
  bool is_travelling(std::uint32_t slot) const { return slot < segments_.size() && !segments_[slot].empty(); }
  /// True if the object has one segment that is not a jump, or none.
  bool is_on_one_way(std::uint32_t slot) const {
    if (!is_travelling(slot)) return true;
    return segments_[slot].size() == 1 && !segments_[slot].front().is_jump();
  }
  /// True if some of a segment lies in (from_ns, to_ns].
  bool moves(std::uint32_t slot, std::int64_t from_ns, std::int64_t to_ns) const;
  bool jumps(std::uint32_t slot, std::int64_t time_ns) const;
  /// The segment, not a jump, that the object is on at that time; null if it rests.
  const MotionSegment* under_way(std::uint32_t slot, std::int64_t time_ns) const;
  /// Calls visit(segment) for each segment, in order.
  template <class Visit>
  void for_each(std::uint32_t slot, Visit&& visit) const {
    if (!is_travelling(slot)) return;
    for (const MotionSegment& segment : segments_[slot]) visit(segment);
  }
  /// Bounds of all segments.
  Aabb bounds(std::uint32_t slot) const;
  /// Appends the times in (from_ns, to_ns] at which a segment begins or ends, in no order.
  void add_times(std::uint32_t slot, std::int64_t from_ns, std::int64_t to_ns, std::vector<std::int64_t>& times) const;

  /// The motion from just after from_ns up to to_ns, before a jump at to_ns; no time of add_times() may lie between the
  /// two. resting: where the object is if it has no segment.
  BodyMotion motion(std::uint32_t slot, std::int64_t from_ns, std::int64_t to_ns, const Pose& resting) const;
  /// For a point of a lone sphere, at less cost.
  struct PointMotion {
    Vec3 from;
    Vec3 to;
  };
  PointMotion center_motion(std::uint32_t slot, const Vec3& center, std::int64_t from_ns, std::int64_t to_ns,
                            const Pose& resting) const;
  /// The frame at that time, after a jump at it.
  Frame at(std::uint32_t slot, std::int64_t time_ns, const Pose& resting) const;

 private:
  const MotionSegment* ending_after(std::uint32_t slot, std::int64_t time_ns) const;

  std::vector<std::vector<MotionSegment>> segments_;
  std::vector<std::uint32_t> travelling_;
};

}  // namespace collided::engine
