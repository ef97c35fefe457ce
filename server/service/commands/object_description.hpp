#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "idl/answers/commands.hpp"
#include "server/world/objects/snapshot.hpp"

namespace collided::engine::service {

/// The tiles read of a file in tiles.
nlohmann::json tiles_json(const TilesRead& tiles);

std::vector<CoveredBox> covered_boxes(const std::vector<Aabb>& boxes);

/// The object of that name in the state; throws BadCommand with the nearest names.
ObjectId find_shown(const Snapshot& state, const std::string& name);

/// Throws BadCommand if this server holds only some of the object's triangles: the missing ones may be nearer.
void require_whole(const Snapshot& state, ObjectId id, const std::string& command);

/// publisher_name  empty for an object of the server's own
ListedObject listed_object(const Snapshot& snapshot, const ObjectInfo& info, const std::string& publisher_name);

/// [low, high] of an object's bounds, or null if it has no triangles; a side that is not finite becomes null in the
/// text.
nlohmann::json bounds_of(const Snapshot& snapshot, const ObjectInfo& info);

/// Its pose, filter, age and whether it is solid.
ObjectDetails object_details(const Snapshot& snapshot, const ObjectInfo& info, const std::string& publisher_name,
                             std::int64_t now_ns);
/// The parts of its shape: [{sphere|box|capsule|mesh ...}].
nlohmann::json shape_of(const ObjectInfo& info);

}  // namespace collided::engine::service
