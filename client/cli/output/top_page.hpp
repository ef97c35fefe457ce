#pragma once

#include <deque>
#include <string>
#include <vector>

#include "client/cli/output/output.hpp"
#include "client/view/figures.hpp"
#include "collided/client.hpp"

namespace collided::cli {

/// How a server does, over the time between two looks at it.
struct Look {
  ServerStatus status;
  view::Figures figures;          // between the looks
  std::int64_t up_ns = 0;         // of the server
  std::deque<double> past_rates;  // questions a second at earlier looks, the newest last
};

/// Lines for a terminal, none of them cut to its width.
std::vector<std::string> top_lines(const Look& look);

/// The same as records {figure, value, unit}: every figure that is there whoever asks, then each publisher, then what is
/// not built.
std::vector<Record> top_records(const Look& look);

/// Questions a second.
double asked_rate(const view::Figures& figures);

}  // namespace collided::cli
