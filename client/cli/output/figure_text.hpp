#pragma once

#include <string>
#include <vector>

#include "client/view/figures.hpp"
#include "collided/client.hpp"

// A server's figures as short texts, for `collide top`.
namespace collided::cli {

/// The state of a server, with the duration of the current step if that is more than half a second.
std::string state_text(const ServerStatus& status);
/// A rate: a count over the time of the figures.
double per_second(std::uint64_t count, const Figures& figures);
/// The mean per step of the world; 0 if there was none.
double per_step(std::uint64_t count, const Figures& figures);

/// "12.4 k/s"
std::string rate_text(double per_second);
/// "0.5", "312", "1 044"
std::string mean_text(double mean);
/// A part of a whole: "0.25 %"; "0 %" for an empty whole.
std::string percent_text(std::uint64_t of, std::uint64_t whole);
/// The quantile of the durations for this part; "-" if there are none.
std::string quantile_text(const std::vector<DurationStep>& durations, double part);

}  // namespace collided::cli
