#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>

#include "client/draw/drawing/standing_outlines.hpp"
#include "collided/client.hpp"

namespace collided::view {

/// A type of Foxglove: its name and its JSON schema.
struct FoxgloveSchema {
  const char* name;
  const char* json_schema;
};
extern const FoxgloveSchema kSceneUpdateSchema;
extern const FoxgloveSchema kFrameTransformsSchema;
extern const FoxgloveSchema kEventSchema;

/// Limits on triangles sent as text; beyond them the bounding box is shown.
struct TriangleLimits {
  std::uint32_t of_object = 50'000;
  std::uint32_t of_scene = 400'000;
};

/// A SceneUpdate that deletes all entities and then adds all objects. Half-spaces are left out, since they are
/// unbounded.
std::string scene_update(const ShownObjects& shown, const TriangleLimits& most = {});

/// The frames of moving objects within the frame "world".
/// names  of the frames, by id
std::string frame_transforms(const Poses& poses, const std::map<std::uint64_t, std::string>& names);

/// A SceneUpdate with an arrow along the normal of each contact that begins, shown for a second.
std::string contact_update(std::span<const Event> events);

/// A SceneUpdate that deletes all entities of its channel and then adds the lines of all outlines, in another colour if
/// one holds an object.
///
/// still  poses of the objects that are not frames, for the outlines that they carry
std::string standing_update(std::span<const draw::StandingOutline> outlines, const std::map<std::string, Pose>& still,
                            std::chrono::nanoseconds world_time);

/// An event as JSON.
std::string event_json(const Event& event);

}  // namespace collided::view
