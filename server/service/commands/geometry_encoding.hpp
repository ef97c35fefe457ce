#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "server/service/commands/surface_numbers.hpp"
#include "server/world/objects/snapshot.hpp"

namespace collided::engine::service {

/// What viewers are told, as buffers of idl/geometry.fbs. Pure, but for the numbers that surfaces are given; any state
/// may be read by any thread. The work grows with what is told, so that the world's thread has no part in it.

inline constexpr std::uint64_t kMaxGeometryBytes = std::uint64_t{512} << 20;  // of one buffer
inline constexpr std::uint64_t kMaxPosesReported = 400'000;

/// What cannot be told says why: a BadCommand.
std::string encode_objects(const Snapshot& state, const std::function<bool(const ObjectInfo&)>& wanted,
                           SurfaceNumbers& numbers);

/// crease_cosine  tell the edges too, those beyond this angle as creases; none: triangles only
std::string encode_surface(const SurfaceNumbers::Found& surface, std::optional<double> crease_cosine);

/// Of every object that moves.
std::string encode_poses(const Snapshot& state);

/// The bytes from `first` on of a buffer of `total`.
std::string encode_page(std::uint64_t transfer, std::uint64_t total, std::uint64_t first, std::string_view bytes);

}  // namespace collided::engine::service
