#pragma once

#include <string>

#include "server/world/query/opinion_request.hpp"

namespace collided::engine {

/// What FCL says: "touching", "apart 0.25" (metres), "apart - WHY" where it has no distance for these shapes, or
/// "unsupported WHY". Every part of the one is asked against every part of the other; triangles make one mesh.
std::string fcl_answer(const OpinionRequest& request);

}  // namespace collided::engine
