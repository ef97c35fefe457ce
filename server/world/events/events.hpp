#pragma once

#include <cstdint>
#include <vector>

#include "collided/codes.hpp"
#include "server/exact_phase/distance/contact.hpp"
#include "server/world/objects/contained.hpp"
#include "server/world/objects/object.hpp"

namespace collided::engine {

using codes::Doubt;
using codes::EndReason;
using codes::EventKind;

/// One open contact of objects a < b (by id), from its `began` to its `ended`.
struct OpenContact {
  ObjectId a = 0;
  ObjectId b = 0;
  std::uint32_t a_triangle = kNoTriangle;
  std::uint32_t b_triangle = kNoTriangle;
  std::uint64_t episode = 0;  // sequence of its `began`
  std::int64_t began_ns = 0;  // world time
  Contact contact;            // as last computed: the shortest way out of the two parts named; normal from a to b
  /// The contact when bodies that form one surface are taken as one: at an inner edge of a tiled floor it has the
  /// floor's normal, and the depth along it. Else equal to `contact`.
  Contact surface;
  // if set, it is unknown whether they touch, and `contact` is empty
  Doubt doubt = Doubt::none;
  // As last computed. In `began`: the state that the following `contained` event reports. In `emerged`: the state
  // before it.
  Contained contained = Contained::none;
};

/// A change of one contact, or its persistence, as subscribers receive it.
struct Event {
  EventKind kind = EventKind::began;
  EndReason reason = EndReason::none;
  std::uint64_t sequence = 0;  // without gaps within the epoch; 0 for persisted
  OpenContact of;              // in `ended`: its last state
  // the change happened between low and high seconds before the step's world time (low >= high; negative: after it)
  double bracket_low_s = 0;
  double bracket_high_s = 0;
  /// Velocity of b relative to a at the contact's point, m/s, from the last two accepted poses of each. An object
  /// counts as resting if it has no motion between them (new, teleported), or has been silent for longer than that
  /// motion took. Zero in `ended`.
  Vec3 relative_velocity = Vec3::Zero();
  double velocity_error = 0;  // |truth - relative_velocity| <= velocity_error, m/s
  /// The next event has the same number and is a part of this one: the end of a crossing, or the next nearest object.
  bool joins_next = false;
};

}  // namespace collided::engine
