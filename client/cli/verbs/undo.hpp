#pragma once

#include <string>
#include <vector>

#include "client/cli/session.hpp"

namespace collided::cli {

/// What would bring back the objects of a name or glob ("" is all): one `collide add ...` an object, taken before they go.
/// Objects of a scene or of a publisher are not among them, and of others at most `most`; `left_out` counts what no line
/// brings back.
struct Undo {
  std::vector<std::string> lines;
  std::uint64_t left_out = 0;
};
Undo undo_of(Session& session, const Globals& globals, const std::string& glob, bool moving_only,
             std::size_t most = 10);

/// The lines as a hint, once the objects are gone.
void print_undo(Session& session, const Globals& globals, const Undo& undo);

/// A word as a shell takes it whole.
std::string shell_word(const std::string& word);

}  // namespace collided::cli
