#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "collided/client.hpp"

namespace collided::client {

/// A shape as it is sent (table Shape of idl/scene.fbs). Error bad_input, with the part's number and value, where it is
/// not valid or takes more than a message. `where` begins the error.
///
/// solid       what its mesh is said to be
/// is_unknown  it is not known what is in it
enum class SaidSolid { surface, border, by_winding };
Result<std::vector<std::uint8_t>> encode_shape(const Shape& shape, const Vec3& scale, const std::string& where,
                                               SaidSolid solid = SaidSolid::surface, bool is_unknown = false);

}  // namespace collided::client
