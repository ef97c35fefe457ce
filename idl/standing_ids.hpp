#pragma once

#include <cstdint>

#include "collided/codes.hpp"

namespace collided::wire_contract {

/// Whether an id is that of a standing question, and not of an object.
inline bool is_standing_id(std::uint64_t id) { return (id & codes::kStandingBit) != 0; }

}  // namespace collided::wire_contract
