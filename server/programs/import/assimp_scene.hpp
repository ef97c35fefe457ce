#pragma once

#include <string>

#include "server/intake/scene.hpp"

namespace collided::engine {

/// The meshes of a file as Assimp reads it, each placed by the nodes that show it; from there on in double.
///
/// A node that shows meshes becomes a part with the node's name, after the parent's if several nodes have the same.
/// Axes stay as Assimp returns them. Nothing is joined, and only faces that are not triangles are dropped; the
/// report counts them.
///
/// throws  LoadError, without a consequence in its text: the caller knows it
Scene read_with_assimp(const std::string& path, const LoadOptions& options, LoadReport& report);

}  // namespace collided::engine
