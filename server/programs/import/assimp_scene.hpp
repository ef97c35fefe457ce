#pragma once

#include <string>

#include "server/intake/scene.hpp"

namespace collided::engine {

/// The meshes of a file as Assimp reads it, each put in its place by the node that shows it, in double from there on.
///
/// A node that shows meshes is a part with the node's name, the parent's name in front where several have the same.
/// Axes stay as Assimp gives them; nothing is joined or dropped but what is no triangle, and the report says so.
/// throws    LoadError, without a consequence in its text: the caller knows it
Scene read_with_assimp(const std::string& path, const LoadOptions& options, LoadReport& report);

}  // namespace collided::engine
