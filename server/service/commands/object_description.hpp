#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "server/world/objects/snapshot.hpp"

namespace collided::engine::service {

/// The vector as it stands in answers: [x, y, z], without a minus before 0.
nlohmann::json numbers(const Vec3& vector);
/// [w, x, y, z], likewise.
nlohmann::json numbers(const Quat& rotation);

/// What is read of a file in tiles.
nlohmann::json tiles_json(const TilesRead& tiles);

/// Boxes as `load` takes them: [[low 3, high 3], ...], sides without end as "inf" and "-inf".
nlohmann::json covers_json(const std::vector<Aabb>& boxes);

/// The object of that name in the state; throws BadCommand with the nearest names.
ObjectId find_shown(const Snapshot& state, const std::string& name);

/// Throws BadCommand where this server holds some of the object's triangles only: those that it lacks may be nearer than what it
/// has.
void require_whole(const Snapshot& state, ObjectId id, const std::string& command);

/// What `list` says of an object (idl/commands.hpp). publisher_name: empty for an object of the server's own.
nlohmann::json describe_briefly(const Snapshot& snapshot, const ObjectInfo& info, const std::string& publisher_name);

/// [low, high] of an object's bounds, or null where it has no triangles; a side that is not finite becomes null in the text.
nlohmann::json bounds_of(const Snapshot& snapshot, const ObjectInfo& info);

/// What `get` adds to that: pose, bounds, shape, filter, age.
void describe_fully(const Snapshot& snapshot, const ObjectInfo& info, std::int64_t now_ns, nlohmann::json& object);

}  // namespace collided::engine::service
