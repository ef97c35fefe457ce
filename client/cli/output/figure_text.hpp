#pragma once

#include <string>
#include <vector>

#include "client/view/figures.hpp"
#include "collided/client.hpp"

// A server's figures as short texts, for `collide top`.
namespace collided::cli {

/// The state that a server is in; with it how long a step has lasted where that takes more than half a second.
std::string state_text(const ServerStatus& status);
/// How many a second: a count over the time of the figures.
double per_second(std::uint64_t count, const Figures& figures);
/// How many in each step of the world; 0 where there was none.
double per_step(std::uint64_t count, const Figures& figures);

/// "12.4 k/s"
std::string rate_text(double per_second);
/// "0.5", "312", "1 044"
std::string mean_text(double mean);
/// A part of a whole: "0.25 %"; of an empty whole "0 %".
std::string percent_text(std::uint64_t of, std::uint64_t whole);
/// The duration that such a part of them does not exceed; "-" where there are none.
std::string quantile_text(const std::vector<DurationStep>& durations, double part);

}  // namespace collided::cli
