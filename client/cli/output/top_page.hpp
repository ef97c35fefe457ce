#pragma once

#include <deque>
#include <string>
#include <vector>

#include "client/cli/output/output.hpp"
#include "client/view/figures.hpp"
#include "collided/client.hpp"

namespace collided::cli {

/// A server's status, and its activity between two looks at it.
struct Look {
  ServerStatus status;
  Figures figures;                // of the time between the two looks
  std::int64_t up_ns = 0;         // since the server's start
  std::deque<double> past_rates;  // questions a second at earlier looks, the newest last
};

/// The page as lines for a terminal, not yet cut to its width.
std::vector<std::string> top_lines(const Look& look);

/// The page as records {figure, value, unit}: first the figures that every server has, then each publisher, then the
/// structures not built.
std::vector<Record> top_records(const Look& look);

/// The rate of questions, per second.
double asked_rate(const Figures& figures);

}  // namespace collided::cli
