#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "client/cli/session.hpp"

namespace collided::cli {

/// The commands that would restore what a verb is about to remove.
struct Undo {
  std::vector<std::string> lines;
  std::uint64_t left_out = 0;  // objects without such a command
};

/// The objects that a verb is about to remove.
struct Removal {
  std::string names = {};  // name or glob; empty: all
  bool moving_only = false;
  bool scenes_too = false;  // their scenes go as well; undo_of_scenes restores those
  std::string scene = {};   // with scenes_too: only this one (empty: all)
};
/// The commands for the objects that are about to be removed: one `add` for each, and one `load --replace` for each
/// scene that stays and has objects among them, since its file would be refused as loaded already. Objects of a
/// publisher return with it and have none.
Undo undo_of(Session& session, const Globals& globals, const Removal& removal);

/// The commands that would load scenes again: that one, or all if it is empty. Scenes whose file a client sent are left
/// out and counted.
Undo undo_of_scenes(Session& session, const Globals& globals, const std::string& scene);

/// Prints the commands as a hint, after the objects were removed.
void print_undo(Session& session, const Globals& globals, const Undo& undo);

/// A word, quoted for a shell if necessary.
std::string shell_word(const std::string& word);

}  // namespace collided::cli
