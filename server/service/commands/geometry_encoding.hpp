#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "idl/commands.hpp"
#include "server/service/commands/surface_numbers.hpp"
#include "server/world/objects/snapshot.hpp"

namespace collided::engine::service {

/// What viewers receive, as buffers of idl/geometry.fbs. Pure except that surfaces are given numbers; any thread may
/// read any state. The work grows with the result, so it never runs on the world's thread.

using wire_contract::command::kMaxGeometryBytes;
inline constexpr std::uint64_t kMaxPosesReported = 400'000;

/// The objects of a state for which wanted() is true, as ShownObjects. Throws BadCommand beyond kMaxGeometryBytes.
std::string encode_objects(const Snapshot& state, const std::function<bool(const ObjectInfo&)>& wanted,
                           SurfaceNumbers& numbers);

/// A state as a scene file without indexes. Throws BadCommand beyond kMaxGeometryBytes, and where frozen_scene() refuses.
std::string encode_snapshot(const Snapshot& state);

/// A mesh, as Surface. Throws BadCommand beyond kMaxGeometryBytes.
///
/// crease_cosine  encode the edges too; those that bend by more than this angle are creases. None: triangles only
std::string encode_surface(const SurfaceNumbers::Found& surface, std::optional<double> crease_cosine);

/// The poses of all moving objects. Throws BadCommand beyond kMaxPosesReported.
std::string encode_poses(const Snapshot& state);

/// One page of a buffer of `total` bytes: `bytes`, which begin at byte `first` of it.
std::string encode_page(std::uint64_t transfer, std::uint64_t total, std::uint64_t first, std::string_view bytes);

}  // namespace collided::engine::service
