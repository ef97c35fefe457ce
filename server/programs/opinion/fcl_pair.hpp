#pragma once

#include <string>

#include "server/world/audit/opinion_request.hpp"

namespace collided::engine {

/// FCL's answer about two objects: "touching"; "apart 0.25" (metres); "apart - WHY" if it has no distance for these
/// shapes; or "unsupported WHY". Each part of one object is tested against each part of the other; all triangles of an
/// object are one mesh.
std::string fcl_answer(const OpinionRequest& request);

}  // namespace collided::engine
