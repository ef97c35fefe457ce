#pragma once

#include <map>
#include <utility>
#include <vector>

#include "server/world/objects/snapshot.hpp"

namespace collided::oracle {
using namespace engine;

/// The clearance of two objects from every pair of their parts, without an index: the distance, or less the greatest
/// depth where parts overlap. It lies between the two.
struct PlainClearance {
  ObjectId a = 0;
  ObjectId b = 0;
  bool touches = false;
  double low_m = 0;
  double high_m = 0;
};

/// Of all pairs of one object of each group, each pair once; least first.
std::vector<PlainClearance> plain_clearances(const Snapshot& snapshot, const std::vector<ObjectId>& from,
                                             const std::vector<ObjectId>& to, bool with_filtered);

}  // namespace collided::oracle
