#pragma once

#include <optional>
#include <set>

#include "server/world/query/query.hpp"

namespace collided::engine {

/// What the broad phase alone would say, for the price list: bounding boxes stand for what is in them. Never a miss
/// that is a hit; often the other way round.
struct BoxesAnswer {
  std::optional<double> distance_m;  // ray and near: to the nearest box
  std::set<ObjectId> objects;        // sphere and box: whose boxes overlap the asked shape's
};

/// question  one question, checked
BoxesAnswer answer_by_boxes(const Snapshot& snapshot, const Questions& question);

}  // namespace collided::engine
