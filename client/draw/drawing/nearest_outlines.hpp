#pragma once

#include <vector>

#include "client/draw/drawing/fence_outlines.hpp"
#include "collided/client.hpp"

namespace collided::draw {

/// The questions that stay for the nearest as outlines: a line in the world from what one is about to the object that is
/// nearest, as both stand now; none where nothing is near. At most 50. Asks the server once, and once for each line.
Result<std::vector<FenceOutline>> nearest_outlines(Client& client);

}  // namespace collided::draw
