#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "collided/client.hpp"

namespace collided::client {

/// A shape as it is sent (table Shape of idl/scene.fbs). Error bad_input, with the part's number and value, where it is
/// not valid or takes more than a message. `where` begins the error.
///
/// is_solid  its mesh is said to be the border of a solid
Result<std::vector<std::uint8_t>> encode_shape(const Shape& shape, const Vec3& scale, const std::string& where,
                                               bool is_solid = false);

}  // namespace collided::client
