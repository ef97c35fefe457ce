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
  /// Where it begins; nothing: the two touch from the begin of the motion on.
  std::optional<SweptContact> begin = {};
  /// Where it ends: contact at low, none from high on up to the next interval; nothing: they touch at the end of the
  /// motion.
  std::optional<TimeBracket> end = {};
  Contact last = {};  // about where it ends
};

/// All intervals of contact of two bodies within a motion, in order.
struct ContactTimes {
  std::vector<ContactInterval> intervals;
  bool are_too_many = false;  // the last interval holds what was not cut any more
  bool is_end_open = false;   // the search for the end of the last interval was cut short
  bool is_open = false;       // within an interval they may have parted and met again: the search was cut short

  /// Of the last interval it is known when it begins, and no more.
  bool is_last_in_doubt() const { return are_too_many || is_end_open; }
  void clear() { *this = {.intervals = std::move(intervals)}, intervals.clear(); }
};

/// Two bodies on their motions, seen from a common origin, and how their contacts are found.
struct BodiesInMotion {
  /// One of the two.
  struct Side {
    const SweptBody& body;
    double reach_m = 0;                // no point of it is farther from its frame's origin
    std::uint32_t first_triangle = 0;  // of a body that is a part of a scene: its triangles' numbers count from here
  };
  /// The first contact within the span, of the motion or (its times counted from the end) of the reversed one.
  using First = FunctionRef<SweptContact(const TimeSpan& span, bool is_reversed)>;
  /// The deepest pair of parts that touch at that time.
  using TouchAt = FunctionRef<ContactSearch(double t)>;

  /// find_first, find_touch  find contacts in world coordinates; must outlive this, as what the sides refer to
  BodiesInMotion(const Side& of_a, const Side& of_b, First find_first, TouchAt find_touch);

  Vec3 origin;
  SeenBody a;
  SeenBody b;
  std::uint32_t a_first_triangle;
  std::uint32_t b_first_triangle;
  First first;
  TouchAt touch_at;
  double off_m;  // how far the placed parts may be from their motions, in all
  double
      contact_off_m;  // KnownContacts::off_m of points that were moved back to the world and are seen from the origin
};

/// How far the search goes.
struct ContactTimesLimits {
  double width = 1e-9;            // gaps shorter than that are not looked for
  std::uint32_t most = 64;        // intervals
  std::uint32_t most_looks = 64;  // times within the motion at which the two may be tested
};

/// What is known of the two at an end of the motion: touching, and by which parts.
struct TouchAtEnd {
  bool yes = false;
  std::uint32_t a_triangle = kNoTriangle;
  std::uint32_t b_triangle = kNoTriangle;
  Contact contact = {};  // of these parts there; without a normal: it is not known
};

/// Finds all intervals of contact of their surfaces: the first contact, the last one by the reversed motion, and between
/// the two either a proof that they touch throughout (lasting_contact.hpp) or a time at which they are apart, from which
/// both searches go on.
///
/// begin, end  what is known of the ends of the motion
/// first       the first contact, where it is known that they do not touch at the begin
/// threads     any; allocates where a motion has more intervals than any before
void find_contact_times(const BodiesInMotion& bodies, const TouchAtEnd& begin, const TouchAtEnd& end,
                        const SweptContact* first, const ContactTimesLimits& limits, ContactTimes& times);

/// Two that touch at both ends of the motion surely do so throughout, by parts that touch at one of them. A filter.
bool surely_touch_throughout(const BodiesInMotion& bodies, const TouchAtEnd& begin, const TouchAtEnd& end);

/// The whole object is one convex primitive.
inline bool is_lone_convex(const ObjectInfo& info) { return !info.mesh && info.primitives.size() == 1; }
/// Two of them that go straight: they touch in one interval at most.
bool touch_at_most_once(const ObjectInfo& a, const BodyMotion& on_a, const ObjectInfo& b, const BodyMotion& on_b);

}  // namespace collided::engine
