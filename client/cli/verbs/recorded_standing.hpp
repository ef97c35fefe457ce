#pragma once

#include <chrono>
#include <cstddef>
#include <string>

#include <collided/explanations.hpp>

namespace collided::cli {

/// Adds to a replay server's explanation the recorded server's reports up to an instant: the held objects and since
/// when, and the last events with their numbers. A replay reports its own interval only, and which object is nearest
/// depends, by hysteresis, on earlier states. Throws Failure.
///
/// path     of the recording
/// instant  since 1970
/// most     limit of the others that stay, of as many as there are
void put_recorded_news(ExplainedStanding& explained, const std::string& path, std::chrono::nanoseconds instant,
                       std::size_t most);

}  // namespace collided::cli
