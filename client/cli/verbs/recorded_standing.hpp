#pragma once

#include <chrono>
#include <cstddef>
#include <string>

#include <collided/explanations.hpp>

namespace collided::cli {

/// Puts into a replay server's explanation what the recorded server had reported up to an instant: what held and since when,
/// and the last events with their numbers. A replay reports its own stretch of time only, and which object is nearest
/// depends, with a hysteresis, on what came before. Throws Failure.
///
/// path     of the recording
/// instant  since 1970
/// most     limit of the others that stay, of as many as there are
void put_recorded_news(ExplainedStanding& explained, const std::string& path, std::chrono::nanoseconds instant,
                       std::size_t most);

}  // namespace collided::cli
