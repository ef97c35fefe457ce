#pragma once

#include <cstdint>
#include <vector>

#include "idl/topics.hpp"
#include "server/exact_phase/distance/contact.hpp"
#include "server/world/objects/object.hpp"

namespace collided::engine {

/// One contact that holds: of objects a < b (by id), from `began` to `ended`.
struct OpenContact {
  ObjectId a = 0;
  ObjectId b = 0;
  std::uint32_t a_triangle = wire_contract::kNoTriangle;
  std::uint32_t b_triangle = wire_contract::kNoTriangle;
  std::uint64_t episode = 0;  // sequence of its `began`
  std::int64_t began_ns = 0;  // world time
  Contact contact;            // as last computed; normal from a to b
  wire_contract::Doubt doubt = wire_contract::Doubt::none;  // else it is not known whether they touch, and no contact is
};

struct Event {
  wire_contract::EventKind kind = wire_contract::EventKind::began;
  wire_contract::EndReason reason = wire_contract::EndReason::none;
  std::uint64_t sequence = 0;  // without gap within the epoch; 0 for persisted
  OpenContact of;              // for `ended`: the contact as it last was
  double bracket_low_s = 0;    // the change happened at world_time - low .. - high (low >= high; below 0: after it)
  double bracket_high_s = 0;
  /// Of b relative to a at the contact's point, m/s, from the last two accepted poses of each; who has no way between
  /// them (new, teleported) or has been silent for longer than it took counts as resting. Zero for `ended`.
  Vec3 relative_velocity = Vec3::Zero();
  double velocity_error = 0;  // |truth - relative_velocity| <= velocity_error, m/s
};

}  // namespace collided::engine
