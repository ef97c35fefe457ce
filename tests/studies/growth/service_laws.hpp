#pragma once

#include <string>
#include <vector>

#include "tests/studies/growth/law.hpp"

namespace collided::growth {

/// Clients and subscribers over DDS, from the lines of growth_service. Throws where a line is none of its.
std::vector<Law> service_laws(const std::string& lines);

}  // namespace collided::growth
