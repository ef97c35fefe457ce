#pragma once

#include <random>

#include "tests/studies/bench/rows.hpp"

namespace collided::bench {

/// Whole steps with all events, as users get them, beside FCL's tree and Bullet's collision world on the same poses:
/// crowds that all move, 100 movers among 100,000 bodies at rest, and a world in which nothing moves.
void run_whole_steps(const Options& options, std::mt19937_64& random);

}  // namespace collided::bench
