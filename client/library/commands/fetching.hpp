#pragma once

#include <chrono>
#include <cstddef>
#include <vector>

#include "client/library/connection/connection.hpp"

namespace collided::client {

/// Fetches the server's flight recorder as the bytes of a recording, page by page. The server writes the file once and
/// sends the pages requested, so this works from another machine too, and only one page is under way at a time.
///
/// last  how far back; 0: only what publishers and commands have brought into the world
Result<std::vector<std::byte>> fetch_recorded(Connection& connection, std::chrono::nanoseconds last);

}  // namespace collided::client
