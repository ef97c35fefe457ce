#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "collided/client.hpp"

namespace collided::client {

/// Encodes a shape for sending (table Shape of idl/scene.fbs). Error bad_input, with the part's number and value, if it
/// is invalid or exceeds a message. `where` begins the error.
///
/// solid       how its mesh is declared
/// is_unknown  its content is unknown
enum class SaidSolid { surface, border, by_winding };
Result<std::vector<std::uint8_t>> encode_shape(const Shape& shape, const Vec3& scale, const std::string& where,
                                               SaidSolid solid = SaidSolid::surface, bool is_unknown = false);

}  // namespace collided::client
