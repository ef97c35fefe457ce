#pragma once

#include "client/library/connection/connection.hpp"

namespace collided::client {

/// The commands shapes, surface and more, until everything is here.
Result<ShownObjects> shapes(Connection& connection, const ShapesOptions& options, const ShownObjects* earlier);

/// The command poses.
Result<Poses> poses(Connection& connection, std::chrono::nanoseconds timeout);

}  // namespace collided::client
