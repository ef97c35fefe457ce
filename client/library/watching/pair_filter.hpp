#pragma once

#include <string>

#include "collided/client.hpp"

namespace collided::client {

/// True if one of the two names matches `only` and none matches `skip`. An empty `only` matches everything, an empty
/// `skip` nothing.
bool is_wanted(const Event& event, const std::string& only, const std::string& skip);

}  // namespace collided::client
