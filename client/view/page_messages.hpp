#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "client/draw/drawing/standing_outlines.hpp"
#include "client/view/figures.hpp"
#include "collided/client.hpp"

/// The messages to the page. Texts are JSON with a "type"; bytes are little-endian, as read by page/source.js.
namespace collided::view {

/// An object's slot in the server's table, by which the page knows it while the table is unchanged.
inline std::uint32_t slot_of(std::uint64_t id) { return static_cast<std::uint32_t>(id); }

/// {epoch, version, table_version, objects [{slot, name, scene, moving, stale, layers, mask,
///  group, pose [7], parts [[kind, numbers ...]], runs [[surface, first triangle, triangles]]}]}.
/// Kinds and their numbers: sphere 0 (centre, radius), box 1 and ellipsoid 5 (centre, qw qx qy qz, half sizes),
/// capsule 2, cylinder 3, cone 4 (end, end, radius), half-space 6 (point, normal). A surface's number is a text, since
/// it has 64 bits.
std::string objects_text(const ShownObjects& shown);

/// u32 vertices, u32 triangles, f64 origin 3, f32 positions 3 each relative to the origin, u32 corners 3 each. The
/// origin is in the middle, so that coordinates far from 0 keep their digits.
std::string surface_bytes(const Surface& surface);

/// u32 1, u32 count, f64 world time (s), f64 table version, f64 version, f64 origin 3, then f32 7 an object (position
/// relative to the origin, qw qx qy qz), u32 slots, u8 stale.
std::string poses_bytes(const Poses& poses);

/// {type "events", events [...], left_out}: at most `most` of them, the newest; left_out counts the others.
std::string events_text(std::span<const Event> events, std::size_t most);

/// {type "contacts", contacts [...], left_out}: the open contacts, at most `most`.
std::string contacts_text(std::span<const Event> contacts, std::size_t most);

/// {type "status", ... as in `collide status --json`, publishers, and the rates and stages of the time since the last
/// one}.
std::string status_text(const ServerStatus& status, const std::optional<Figures>& recent);

/// {type "standing", standing [OutlinedStanding, and of the nearest its distance (m)]}: the lines in the frame of
/// `about` of a band or `to` of a region, otherwise in the world.
std::string standing_text(std::span<const draw::StandingOutline> outlines);

/// {type "silent", seconds}: the server does not answer.
std::string silent_text(double seconds);

/// {type "table", epoch, table_version}: objects or shapes have changed.
std::string table_text(const ShownObjects& shown);

/// {type "hello", version, up ("y" or "z"), connection (options of `collide` that connect to this server)}
std::string hello_text(bool y_is_up, std::string_view connection);

}  // namespace collided::view
