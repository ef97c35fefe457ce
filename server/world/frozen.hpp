#pragma once

#include <variant>

#include "server/intake/scene.hpp"
#include "server/world/objects/snapshot.hpp"
#include "server/world/world.hpp"

namespace collided::engine {

/// A state of the world as one scene, which answers every question as the state does, bit for bit, once it is loaded into an
/// empty world: geometry, names, filters, poses, solids, pairs that may touch, what it covers, and the order of ids.
///
/// returns   what it cannot hold stands in Scene::frozen->lacks; refused where only some triangles of a part are here
/// cost      copies the triangles of all scenes
/// threads   pure
std::variant<Scene, Refusal> frozen_scene(const Snapshot& state);

}  // namespace collided::engine
