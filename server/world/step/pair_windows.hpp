#pragma once

#include <cstdint>
#include <vector>

#include "server/exact_phase/motion/body_motion.hpp"
#include "server/exact_phase/motion/time_of_contact.hpp"
#include "server/world/step/step_view.hpp"

namespace collided::engine {

/// The time in which a pair is decided: (from_ns, to_ns], including from_ns if is_closed. World time.
struct PairWindow {
  // end of the time decided in earlier steps; the time from there to from_ns stays undecided
  std::int64_t decided_ns = 0;
  std::int64_t from_ns = 0;
  std::int64_t to_ns = 0;
  bool is_closed = false;

  bool is_empty() const { return is_closed ? to_ns < from_ns : to_ns <= from_ns; }
};

/// True if the two are known up to different times, or moved at different times; else they are decided at the step's
/// end.
bool are_on_common_time(const StepView& step, std::uint32_t first, std::uint32_t second);
/// The newly known time of two objects on common time.
PairWindow window_of(const StepView& step, std::uint32_t first, std::uint32_t second);
/// Divides the window into pieces at the poses of both objects and at all instants of both publishers, whichever
/// objects moved then. So the pieces do not depend on when messages arrived.
///
/// cuts  becomes the ends of the pieces, ascending
void cut(const StepView& step, std::uint32_t first, std::uint32_t second, const PairWindow& window,
         std::vector<std::int64_t>& cuts);

/// The motions of two bodies in one piece of time.
struct MotionPair {
  const BodyMotion& a;
  const BodyMotion& b;
};
struct BracketNs {
  std::int64_t low_ns = 0;
  std::int64_t high_ns = 0;
};
/// A bracket within a piece of time in whole nanoseconds, rounded outward.
BracketNs rounded_outward(std::int64_t from_ns, std::int64_t to_ns, const TimeBracket& bracket);
/// The bracket widened by the time that the rounding of both positions takes at the point along the normal.
BracketNs in_nanoseconds(std::int64_t from_ns, std::int64_t to_ns, const MotionPair& motions,
                         const TimeBracket& bracket, const Vec3& point, const Vec3& normal);

}  // namespace collided::engine
