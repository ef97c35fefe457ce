#pragma once

#include <cstdint>

#include "collided/codes.hpp"

namespace collided::wire_contract {

/// True if the id is that of a standing question, not of an object.
inline bool is_standing_id(std::uint64_t id) { return (id & codes::kStandingBit) != 0; }

}  // namespace collided::wire_contract
