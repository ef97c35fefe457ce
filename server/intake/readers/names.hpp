#pragma once

#include <string>
#include <string_view>

#include "server/intake/readers/reading.hpp"

namespace collided::engine {

/// What is wrong with a name ("is empty"), or nothing: 1 to kMaxNameBytes bytes of UTF-8 without control characters.
std::string flaw_of_name(std::string_view name);

/// The name without what flaw_of_name objects to: bytes that are no UTF-8 and control characters become '?', what
/// is too long is cut at a character.
std::string mended_name(std::string_view name);

/// Gives parts and objects the names the scene knows them by: "scene/part", or "scene" for the only one without a name; makes each
/// one fit and unique ('#2', '#3', ...), says so in the report, and drops parts without triangles.
void name_parts(const Reading& reading, Scene& scene);

/// Moves names under the scene's old name to its new one ("old/shelf" to "new/shelf").
void rename_scene(const Reading& reading, Scene& scene, const std::string& new_name);

}  // namespace collided::engine
