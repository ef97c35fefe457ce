#pragma once

#include <string>
#include <string_view>

#include "server/intake/readers/reading.hpp"

namespace collided::engine {

/// The flaw of a name, such as "is empty"; nothing if it is valid. A name has 1 to kMaxNameBytes bytes of UTF-8 without
/// control characters.
std::string flaw_of_name(std::string_view name);

/// The nearest valid name: bytes that are not UTF-8 and control characters become '?', and a name that is too long is
/// cut between two characters.
std::string mended_name(std::string_view name);

/// Gives parts and objects their full names: "scene/part", or "scene" if there is only one and it has no name. Makes
/// names valid and unique ('#2', '#3', ...) and reports that. Drops parts without triangles.
void name_parts(const Reading& reading, Scene& scene);

/// Renames the scene, and with it its parts and objects ("old/shelf" to "new/shelf").
void rename_scene(const Reading& reading, Scene& scene, const std::string& new_name);

}  // namespace collided::engine
