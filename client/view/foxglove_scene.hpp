#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>

#include "collided/client.hpp"

namespace collided::view {

/// JSON text of Foxglove's types.
struct FoxgloveSchema {
  const char* name;
  const char* json_schema;
};
extern const FoxgloveSchema kSceneUpdateSchema;
extern const FoxgloveSchema kFrameTransformsSchema;
extern const FoxgloveSchema kEventSchema;

/// All objects as entities, after deleting those of before. An object with more triangles than most_triangles becomes the
/// box around it; half-spaces are left out, since they have no end.
std::string scene_update(const ShownObjects& shown, std::uint32_t most_triangles);

/// Frames of moving objects, by id, in the frame "world".
std::string frame_transforms(const Poses& poses, const std::map<std::uint64_t, std::string>& names);

/// A beginning as an arrow along its normal that lasts a second.
std::string contact_update(std::span<const Event> events);

std::string event_json(const Event& event);

}  // namespace collided::view
