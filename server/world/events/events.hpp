#pragma once

#include <cstdint>
#include <vector>

#include "server/exact_phase/distance/contact.hpp"
#include "server/world/objects/contained.hpp"
#include "server/world/objects/object.hpp"

namespace collided::engine {

/// contained: one of two objects that touch has come to lie wholly within the other, a declared solid; emerged: no longer.
/// Both stand between the contact's `began` and its `ended`, alternate, and begin with `contained`; a contact that ends
/// while one holds the other emerges first.
enum class EventKind : std::uint8_t { began, persisted, ended, contained, emerged };

/// Why a contact ended. decided: it was a doubt that is settled; if no contact begins with it, the two are apart.
/// crossed, of fences: an object was in one and out again between two poses; its `began` has this reason too. allowed: the
/// two are allowed to touch since. removed: also told by a shard of two that have parted in what it holds of a large part,
/// where the other object reaches beyond that.
enum class EndReason : std::uint8_t {
  none,
  separated,
  removed,
  publisher_lost,
  teleported,
  geometry_changed,
  server_stopping,
  server_restarted,
  decided,
  crossed,
  fence_removed,
  allowed,
};

/// Why it is not known whether two objects touch. Such a pair is reported as one that touches, by `began` and `ended`,
/// until it is decided, so that a subscriber that takes it for a contact errs on the safe side. Its depth is 0 and the
/// bound of the depth infinite.
enum class Doubt : std::uint8_t {
  none,
  numeric,         // the exact test came out undecided
  cost_limit,      // the motion from pose to pose took more looks than one pair is given
  publisher_lost,  // one object is where its publisher last had it, and may have gone on
};

/// In b_triangle of the end of who was nearest: another one is at once, which the next event says.
inline constexpr std::uint32_t kNearestGoesOn = 1;

/// One contact that holds, of objects a < b (by id), from its `began` to its `ended`.
struct OpenContact {
  ObjectId a = 0;
  ObjectId b = 0;
  std::uint32_t a_triangle = kNoTriangle;
  std::uint32_t b_triangle = kNoTriangle;
  std::uint64_t episode = 0;  // sequence of its `began`
  std::int64_t began_ns = 0;  // world time
  Contact contact;            // as last computed: the shortest way out of the two parts named; normal from a to b
  /// The same with what several bodies form taken for one surface: at an inner edge of a tiled floor the normal is the
  /// floor's, and the depth that along it. Else the same as `contact`.
  Contact surface;
  // else whether they touch is unknown, and `contact` is empty
  Doubt doubt = Doubt::none;
  // As last computed. Of `began`: as `contained` says next; of `emerged`: as it was before.
  Contained contained = Contained::none;
};

/// A change of one contact, or its persistence, as subscribers receive it.
struct Event {
  EventKind kind = EventKind::began;
  EndReason reason = EndReason::none;
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
