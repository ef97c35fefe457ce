#pragma once

#include <chrono>
#include <cstddef>
#include <vector>

#include "client/library/connection/connection.hpp"

namespace collided::client {

/// Fetches the server's flight recorder as the bytes of a recording, page by page. The server writes the file once and
/// sends requested pages, so this also works from another machine, with one page in flight at a time.
///
/// last  how far back; 0: only the current world of publishers' and commands' objects
Result<std::vector<std::byte>> fetch_recorded(Connection& connection, std::chrono::nanoseconds last);

}  // namespace collided::client
