#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "collided/client.hpp"

namespace collided::client {

/// A shape as it travels (table Shape of scene.fbs); bad_input with the part's number and value when it cannot.
/// `where` opens the error's message.
Result<std::vector<std::uint8_t>> encode_shape(const Shape& shape, const Vec3& scale, const std::string& where);

}  // namespace collided::client
