#pragma once

#include <chrono>
#include <cstddef>
#include <string>

#include <collided/explanations.hpp>

namespace collided::cli {

/// Puts into what a replay's server says of a fence what the recorded one had told up to an instant: who was in and since
/// when, and the last events with their numbers. A replay tells of its own stretch of time only. Throws Failure.
///
/// path     of the recording
/// instant  since 1970
void put_recorded_news(ExplainedFence& told, const std::string& path, std::chrono::nanoseconds instant);

/// The same of a question for the nearest: which object was nearest depends, with a hysteresis, on what came before.
///
/// most  so many of the others stay, of as many as there are
void put_recorded_news(ExplainedNearest& told, const std::string& path, std::chrono::nanoseconds instant,
                       std::size_t most);

}  // namespace collided::cli
