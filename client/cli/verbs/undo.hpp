#pragma once

#include <string>
#include <vector>

#include "client/cli/session.hpp"

namespace collided::cli {

/// The commands that would add removed objects again: one `collide add ...` for each.
struct Undo {
  std::vector<std::string> lines;
  std::uint64_t left_out = 0;  // objects without such a command
};
/// The commands for the objects of a name or glob ("": all); call it before they are removed. Objects of a scene or a
/// publisher have none, and of the others at most `most` objects do.
Undo undo_of(Session& session, const Globals& globals, const std::string& glob, bool moving_only,
             std::size_t most = 10);

/// The commands that would load scenes again: that one, or all where it is empty. Scenes whose file a client sent are left
/// out and counted.
Undo undo_of_scenes(Session& session, const Globals& globals, const std::string& scene);

/// Prints the commands as a hint, after the objects were removed.
void print_undo(Session& session, const Globals& globals, const Undo& undo);

/// A word quoted for a shell where that is needed.
std::string shell_word(const std::string& word);

}  // namespace collided::cli
