#pragma once

#include "client/cli/output/top_screen.hpp"

namespace collided::cli {

/// Carries out a key of `collide top`. Returns false if it ends the page.
bool obey(char key, TopChoice& choice);

}  // namespace collided::cli
