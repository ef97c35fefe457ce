#pragma once

#include <string>

#include "collided/client.hpp"

namespace collided::client {

/// Whether either name matches `only` and neither `skip`; an empty glob asks for everything, skips nothing.
bool is_wanted(const Event& event, const std::string& only, const std::string& skip);

}  // namespace collided::client
