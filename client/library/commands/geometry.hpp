#pragma once

#include "client/library/connection/connection.hpp"

namespace collided::client {

/// Client::shapes, by the commands shapes, surface and more.
Result<ShownObjects> shapes(Connection& connection, const ShapesOptions& options, const ShownObjects* earlier);

/// Client::poses, by the command poses.
Result<Poses> poses(Connection& connection, std::chrono::nanoseconds timeout);

}  // namespace collided::client
