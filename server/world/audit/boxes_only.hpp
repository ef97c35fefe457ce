#pragma once

#include <optional>
#include <set>

#include "server/world/query/query.hpp"

namespace collided::engine {

/// The answer of the broad phase alone, to show the cost of exactness: bounding boxes stand for their contents. Never
/// misses an object that is hit; often hits one that is missed.
struct BoxesAnswer {
  std::optional<double> distance_m;  // ray and near: to the nearest box, metres; empty: none in reach
  std::set<ObjectId> objects;        // sphere and box: those whose boxes overlap the queried shape's
};

/// question  one question, already validated
BoxesAnswer answer_by_boxes(const Snapshot& snapshot, const Questions& question);

}  // namespace collided::engine
