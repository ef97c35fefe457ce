#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/exact_phase/arithmetic/decision.hpp"
#include "server/geometry/pose.hpp"
#include "server/world/events/recent_events.hpp"
#include "server/world/objects/deadline.hpp"
#include "server/world/query/pose_memory.hpp"

namespace collided::engine {

/// One of the two of an event, at the time by which the change had happened.
struct EventBody {
  std::string name;
  bool is_remembered = false;   // where it was is known
  std::uint64_t publisher = 0;  // 0: the server's own
  bool moves = false;
  Pose pose = {};
  // The stretch from one of its poses to the next in which the change lies; nothing: it rested then, or that is not
  // remembered.
  std::optional<PoseMemory::Reach> motion = {};
};

/// How the two stood to each other at an instant.
struct EventGap {
  std::int64_t time_ns = 0;
  Decision touches = Decision::no;
  double distance_m = 0;  // of two apart; else minus the depth
  double error_m = 0;
};

/// What is behind an event, by the memory of poses. That has a motion that no publisher said begin at another time than the
/// step had it, so that of such motions there are no gaps.
struct EventExplanation {
  std::array<EventBody, 2> bodies;
  std::optional<EventGap> before;     // at the bracket's beginning; of contacts whose places then are known
  std::optional<EventGap> after;      // at its end, likewise
  std::vector<std::string> why_wide;  // why the bracket is as wide as it is, a sentence each
};

/// Explains an event of contacts, or of fences.
///
/// is_of_fence     its b is a fence
/// clock_error_ns  by which publishers' clocks may differ, as WorldOptions has it
/// cost            two states of the past, and two reports on the pair
/// threads         any
EventExplanation explain_event(const PoseMemory& memory, const RecentEvent& recent, bool is_of_fence,
                               std::int64_t clock_error_ns, Deadline& deadline);

}  // namespace collided::engine
