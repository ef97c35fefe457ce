#pragma once

#include "client/cli/output/top_screen.hpp"

namespace collided::cli {

/// Does what a key of `collide top` asks for. Returns false where it ends the page.
bool obey(char key, TopChoice& choice);

}  // namespace collided::cli
