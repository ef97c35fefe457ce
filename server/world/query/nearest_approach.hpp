#pragma once

#include <cstdint>

#include "collided/codes.hpp"
#include "server/world/objects/deadline.hpp"
#include "server/world/objects/snapshot.hpp"
#include "server/world/query/pose_memory.hpp"

namespace collided::engine {

using codes::ApproachEnd;

/// How near two objects came to each other within an interval of time.
struct NearestApproach {
  ApproachEnd end = ApproachEnd::found;  // found: at_least_m is within a thousandth of distance_m, or a micrometre
  std::int64_t from_ns = 0;              // the interval, world time: both existed at known places
  std::int64_t to_ns = 0;
  std::int64_t time_ns = 0;  // time of the least distance found
  double distance_m = 0;     // distance at time_ns
  double error_m = 0;        // |truth - distance_m| <= error_m
  double at_least_m = 0;     // lower bound over the whole interval
  std::uint32_t looks = 0;   // evaluations of both at an instant
};

/// Searches the objects' paths, both of this snapshot, for the time at which they were nearest: branch and bound over
/// time, with the lengths of their paths as bounds on how fast their distance may change.
///
/// since_ns  earliest begin of the interval, which begins no earlier than the paths
/// cost      that of some tens to thousands of distances between the two
/// threads   any
NearestApproach nearest_approach(const Snapshot& snapshot, ObjectId a, const PoseMemory::RememberedPath& path_of_a,
                                 ObjectId b, const PoseMemory::RememberedPath& path_of_b, std::int64_t since_ns,
                                 Deadline& deadline);

}  // namespace collided::engine
