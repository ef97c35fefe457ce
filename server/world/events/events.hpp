#pragma once

#include <cstdint>
#include <vector>

#include "idl/topics.hpp"
#include "server/exact_phase/distance/contact.hpp"
#include "server/world/objects/object.hpp"

namespace collided::engine {

/// One contact that holds, of objects a < b (by id), from its `began` to its `ended`.
struct OpenContact {
  ObjectId a = 0;
  ObjectId b = 0;
  std::uint32_t a_triangle = wire_contract::kNoTriangle;
  std::uint32_t b_triangle = wire_contract::kNoTriangle;
  std::uint64_t episode = 0;  // sequence of its `began`
  std::int64_t began_ns = 0;  // world time
  Contact contact;            // as last computed; normal from a to b
  // else whether they touch is unknown, and `contact` is empty
  wire_contract::Doubt doubt = wire_contract::Doubt::none;
};

/// A change of one contact, or its persistence, as subscribers receive it.
struct Event {
  wire_contract::EventKind kind = wire_contract::EventKind::began;
  wire_contract::EndReason reason = wire_contract::EndReason::none;
  std::uint64_t sequence = 0;  // without gap within the epoch; 0 for persisted
  OpenContact of;              // for `ended`: the contact as it last was
  // the change happened between low and high seconds before the step's world time (low >= high; negative: after it)
  double bracket_low_s = 0;
  double bracket_high_s = 0;
  /// Of b relative to a at the contact's point, m/s, from the last two accepted poses of each. An object with no motion
  /// between them (new, teleported), or silent for longer than that motion took, counts as resting. Zero for `ended`.
  Vec3 relative_velocity = Vec3::Zero();
  double velocity_error = 0;  // |truth - relative_velocity| <= velocity_error, m/s
};

}  // namespace collided::engine
