#pragma once

#include <chrono>
#include <cstddef>
#include <vector>

#include "client/library/connection/connection.hpp"

namespace collided::client {

/// The server's flight recorder as a file's bytes, page by page: the server writes it once and sends what it is asked for,
/// so that it comes whole from another machine too and no more than a page is under way.
Result<std::vector<std::byte>> fetch_recorded(Connection& connection, std::chrono::nanoseconds last);

}  // namespace collided::client
