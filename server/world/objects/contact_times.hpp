#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "server/geometry/function_ref.hpp"
#include "server/world/objects/contact_search.hpp"
#include "server/world/objects/swept_object.hpp"

namespace collided::engine {

/// One closed interval of contact within a motion; times are fractions of it.
struct ContactInterval {
  /// Where it begins; nothing: the two touch from the start of the motion.
  std::optional<SweptContact> begin = {};
  /// Where it ends: contact at low, none from high until the next interval. Nothing: they touch at the end of the
  /// motion.
  std::optional<TimeBracket> end = {};
  Contact last = {};  // near its end
};

/// All intervals of contact of two bodies within a motion, in order.
struct ContactTimes {
  std::vector<ContactInterval> intervals;
  bool are_too_many = false;  // the last interval holds the rest, not split further
  bool is_end_open = false;   // the search for the end of the last interval was cut short
  bool is_open = false;       // the search was cut short: within an interval they may have separated and met again

  /// True if only the begin of the last interval is known.
  bool is_last_in_doubt() const { return are_too_many || is_end_open; }
  void clear() { *this = {.intervals = std::move(intervals)}, intervals.clear(); }
};

/// Two bodies on their motions, seen from a common origin, and how their contacts are found.
struct BodiesInMotion {
  /// One of the two.
  struct Side {
    const SweptBody& body;
    double reach_m = 0;                // largest distance of a point from its frame's origin
    std::uint32_t first_triangle = 0;  // number of the first triangle, if the body is a part of a scene
  };
  /// Finds the first contact within the span, of the motion or of the reversed one (times counted from the end).
  using First = FunctionRef<SweptContact(const TimeSpan& span, bool is_reversed)>;
  /// Finds the deepest pair of parts that touch at that time.
  using TouchAt = FunctionRef<ContactSearch(double t)>;

  /// find_first, find_touch  find contacts in world coordinates; must outlive this, as must what the sides refer to
  BodiesInMotion(const Side& of_a, const Side& of_b, First find_first, TouchAt find_touch);

  Vec3 origin;
  SeenBody a;
  SeenBody b;
  std::uint32_t a_first_triangle;
  std::uint32_t b_first_triangle;
  First first;
  TouchAt touch_at;
  double off_m;          // bound on how far the placed parts together are from their motions
  double contact_off_m;  // KnownContacts::off_m of points moved back to the world and seen from the origin
};

/// Limits of the search.
struct ContactTimesLimits {
  double width = 1e-9;            // shorter gaps may be missed
  std::uint32_t most = 64;        // most intervals
  std::uint32_t most_looks = 64;  // most times within the motion at which the two may be tested
};

/// What is known about the two at an end of the motion: whether they touch, and by which parts.
struct TouchAtEnd {
  bool yes = false;
  std::uint32_t a_triangle = kNoTriangle;
  std::uint32_t b_triangle = kNoTriangle;
  Contact contact = {};  // of these parts; no normal: unknown
};

/// Finds all intervals of contact of their surfaces: the first contact, the last one by the reversed motion, and
/// between the two either a proof that they touch throughout (lasting_contact.hpp) or a time at which they are apart,
/// from which both searches continue.
///
/// begin, end  what is known about the ends of the motion
/// first       the first contact, if they are known not to touch at the start
/// threads     any; allocates if a motion has more intervals than any before
void find_contact_times(const BodiesInMotion& bodies, const TouchAtEnd& begin, const TouchAtEnd& end,
                        const SweptContact* first, const ContactTimesLimits& limits, ContactTimes& times);

/// True if two bodies that touch at both ends of the motion certainly do so throughout, by parts that touch at one of
/// the ends. A filter.
bool surely_touch_throughout(const BodiesInMotion& bodies, const TouchAtEnd& begin, const TouchAtEnd& end);

/// True if the whole object is one convex primitive.
inline bool is_lone_convex(const ObjectInfo& info) { return !info.mesh && info.primitives.size() == 1; }
/// True if both move straight and touch in at most one interval.
bool touch_at_most_once(const ObjectInfo& a, const BodyMotion& on_a, const ObjectInfo& b, const BodyMotion& on_b);

}  // namespace collided::engine
