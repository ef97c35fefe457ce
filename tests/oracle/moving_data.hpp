#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "server/exact_phase/motion/moving_features.hpp"

namespace collided::oracle {
using namespace engine;

/// One published question about four moving points, with its exact answer.
struct MovingQuery {
  std::vector<MovingPoint> point;  // point and face, or two edges
  bool edge_edge = false;
  bool hit = false;
  /// Neighbouring doubles (or one) that hold the first time, where the source tells it.
  bool timed = false;
  TimeBracket truth;
  std::string name;
};

ExactResult ask(const MovingQuery& query, double width, TimeBracket& bracket);

/// $COLLIDED_DATA/ccd_queries: rationals, and how many of its queries are not exactly doubles (those are left out).
std::vector<MovingQuery> rational_queries(int& not_doubles);

/// $COLLIDED_DATA/exact/ccd: hexadecimal doubles with the first time.
std::vector<MovingQuery> timed_queries();

}  // namespace collided::oracle
