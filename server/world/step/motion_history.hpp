#pragma once

#include <cstdint>
#include <vector>

#include "server/exact_phase/motion/body_motion.hpp"
#include "server/geometry/aabb.hpp"

namespace collided::engine {

/// An object on its way from one pose to the next; a jump where both are at one time. A sphere alone goes straight with
/// its centre, so its frames do not turn.
struct MotionSegment {
  std::int64_t from_ns = 0;
  std::int64_t to_ns = 0;
  Frame from;
  Frame to;
  Aabb bounds;  // of the whole way

  bool is_jump() const { return from_ns == to_ns; }
};

/// Where objects were in the last moments, as far back as somebody may still ask. Between two segments an object rests, and
/// so it does before the first and after the last.
/// Writer's thread only. By slot. Always: an object's segments are in order of time and do not overlap.
class MotionHistory {
 public:
  void add(std::uint32_t slot, const MotionSegment& segment);
  void forget(std::uint32_t slot);
  /// Nobody asks for what was up to then.
  void forget_up_to(std::int64_t time_ns);

  /// Objects with a segment.
  const std::vector<std::uint32_t>& travelling() const { return travelling_; }
  bool is_travelling(std::uint32_t slot) const { return slot < segments_.size() && !segments_[slot].empty(); }
  /// Something of a segment lies in (from_ns, to_ns].
  bool moves(std::uint32_t slot, std::int64_t from_ns, std::int64_t to_ns) const;
  bool jumps(std::uint32_t slot, std::int64_t time_ns) const;
  /// The segment that the object is on then, jumps aside; null: it rests.
  const MotionSegment* under_way(std::uint32_t slot, std::int64_t time_ns) const;
  /// Of all segments.
  Aabb bounds(std::uint32_t slot) const;
  /// Times in (from_ns, to_ns] at which a segment begins or ends, in no order.
  void add_times(std::uint32_t slot, std::int64_t from_ns, std::int64_t to_ns, std::vector<std::int64_t>& times) const;

  /// From just after from_ns up to to_ns, before what jumps then; no time of add_times() lies between the two.
  /// resting: where the object is if it has no segment.
  BodyMotion motion(std::uint32_t slot, std::int64_t from_ns, std::int64_t to_ns, const Frame& resting) const;
  /// The same of a point of an object that is one sphere, which costs less.
  struct PointMotion {
    Vec3 from;
    Vec3 to;
  };
  PointMotion center_motion(std::uint32_t slot, const Vec3& center, std::int64_t from_ns, std::int64_t to_ns,
                      const Frame& resting) const;
  /// At that time, after what jumps then.
  Frame at(std::uint32_t slot, std::int64_t time_ns, const Frame& resting) const;

 private:
  const MotionSegment* ending_after(std::uint32_t slot, std::int64_t time_ns) const;

  std::vector<std::vector<MotionSegment>> segments_;
  std::vector<std::uint32_t> travelling_;
};

}  // namespace collided::engine
