#include "server/world/explain/event_explanation.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "server/world/query/pair_report.hpp"

namespace collided::engine {
namespace {

const ObjectInfo* find(const Snapshot& state, const std::string& name) {
  const auto found = std::find_if(state.objects.begin(), state.objects.end(),
                                  [&](const auto& info) { return info && info->name == name; });
  return found == state.objects.end() ? nullptr : found->get();
}

/// The stretch between two poses that holds the whole bracket; of the two stretches about a bracket that lies over a
/// pose, both together.
std::optional<PoseMemory::Reach> motion_about(const PoseMemory& memory, ObjectId id, const RecentEvent& recent) {
  const std::optional<PoseMemory::RememberedPath> path = memory.path_of(id);
  if (!path) return std::nullopt;
  std::optional<PoseMemory::Reach> about;
  for (const PoseMemory::RememberedPath::PathPiece& piece : path->pieces) {
    if (piece.to_ns < recent.low_ns() || piece.from_ns > recent.high_ns()) continue;
    about = PoseMemory::Reach{.from_ns = about ? about->from_ns : piece.from_ns, .to_ns = piece.to_ns};
  }
  return about;
}

EventBody body_of(const PoseMemory& memory, const Snapshot* then, const RecentEvent& recent, bool is_first) {
  EventBody body{.name = is_first ? recent.a : recent.b};
  const ObjectInfo* info = then == nullptr ? nullptr : find(*then, body.name);
  if (info == nullptr) return body;
  body.is_remembered = true;
  body.publisher = info->publisher;
  body.moves = info->moving;
  body.pose = then->poses[slot_of(info->id)];
  body.motion = motion_about(memory, is_first ? recent.event.of.a : recent.event.of.b, recent);
  return body;
}

std::optional<EventGap> gap_at(const PoseMemory& memory, std::int64_t time_ns, const RecentEvent& recent) {
  const std::shared_ptr<const Snapshot> state = memory.at(time_ns);
  if (!state) return std::nullopt;
  const ObjectInfo* a = find(*state, recent.a);
  const ObjectInfo* b = find(*state, recent.b);
  if (a == nullptr || b == nullptr) return std::nullopt;
  const PairReport report = report_pair(*state, a->id, b->id, {});
  EventGap gap{.time_ns = time_ns, .touches = report.touches};
  if (report.touches == Decision::no) {
    gap.distance_m = report.separation.distance_m;
    gap.error_m = report.separation.error_m;
  } else if (report.touches == Decision::yes) {
    gap.distance_m = -report.contact.depth_m;
    gap.error_m = report.contact.depth_error_m;
  }
  return gap;
}

std::string in_time(std::int64_t ns) {
  const double us = static_cast<double>(ns) * 1e-3;
  return us < 1e3 ? fmt::format("{:.4g} us", us) : fmt::format("{:.4g} ms", us * 1e-3);
}

void add_end_reason(const RecentEvent& recent, std::vector<std::string>& why) {
  switch (recent.event.reason) {
    case EndReason::teleported:
      why.emplace_back("an object was placed elsewhere, and touched nothing in between");
      break;
    case EndReason::removed: why.emplace_back("an object was removed; the step says when"); break;
    case EndReason::publisher_lost:
      why.emplace_back("a publisher was lost; the step says when that was noticed");
      break;
    case EndReason::geometry_changed: why.emplace_back("its geometry was replaced; the step says when"); break;
    case EndReason::allowed: why.emplace_back("a rule allows the two to touch since; the step says when"); break;
    case EndReason::fence_removed: why.emplace_back("the fence was removed; the step says when"); break;
    case EndReason::server_stopping: why.emplace_back("the server stopped; the step says when"); break;
    default: break;
  }
}

/// A search narrows the bracket within the motions; without one all of them counts.
void add_search(const EventExplanation& told, const RecentEvent& recent, std::int64_t clock_ns,
                std::vector<std::string>& why) {
  const std::int64_t width_ns = recent.high_ns() - recent.low_ns();
  std::optional<PoseMemory::Reach> shortest;
  std::string whose;
  for (const EventBody& body : told.bodies) {
    if (!body.motion) continue;
    if (shortest && shortest->to_ns - shortest->from_ns <= body.motion->to_ns - body.motion->from_ns) continue;
    shortest = body.motion;
    whose = body.name;
  }
  if (!shortest) return;
  const std::int64_t motion_ns = shortest->to_ns - shortest->from_ns;
  if (motion_ns == 0) {
    why.push_back(fmt::format("'{}' came to be there at one instant", whose));
  } else if (width_ns - 2 * clock_ns >= motion_ns) {
    why.push_back(
        fmt::format("two poses of '{}' are {} apart, and the way between them does not say when: all of it counts",
                    whose, in_time(motion_ns)));
  } else {
    why.push_back(fmt::format("found on the way between two poses of '{}', {} apart, by a search that stops at {}",
                              whose, in_time(motion_ns), in_time(width_ns - 2 * clock_ns)));
  }
}

void say_why_wide(const RecentEvent& recent, bool is_of_fence, std::int64_t clock_error_ns, EventExplanation& told) {
  const bool are_of_two = !is_of_fence && told.bodies[0].moves && told.bodies[1].moves &&
                          told.bodies[0].publisher != told.bodies[1].publisher;
  const std::int64_t clock_ns = are_of_two ? clock_error_ns : 0;
  add_end_reason(recent, told.why_wide);
  add_search(told, recent, clock_ns, told.why_wide);
  if (clock_ns > 0)
    told.why_wide.push_back(
        fmt::format("two publishers, whose clocks may differ by {}: so much more on either side", in_time(clock_ns)));
  if (recent.event.of.doubt == Doubt::cost_limit)
    told.why_wide.emplace_back("the motion took more looks than one pair is given, so that it is in doubt");
  if (recent.event.of.doubt == Doubt::numeric)
    told.why_wide.emplace_back("an exact test came out undecided, so that it is in doubt");
  if (recent.event.of.doubt == Doubt::publisher_lost)
    told.why_wide.emplace_back("a publisher is lost, and its object may have gone on");
  if (told.why_wide.empty()) told.why_wide.emplace_back("what led to it is not remembered any more");
}

}  // namespace

EventExplanation explain_event(const PoseMemory& memory, const RecentEvent& recent, bool is_of_fence,
                               std::int64_t clock_error_ns, Deadline& deadline) {
  EventExplanation told;
  const std::shared_ptr<const Snapshot> then = memory.at(recent.high_ns());
  told.bodies = {body_of(memory, then.get(), recent, true), body_of(memory, then.get(), recent, false)};
  const bool are_places_known =
      std::ranges::all_of(told.bodies, [](const EventBody& body) { return body.publisher != 0 || !body.motion; });
  if (!is_of_fence && are_places_known && !deadline.is_over()) {
    told.before = gap_at(memory, recent.low_ns(), recent);
    told.after = gap_at(memory, recent.high_ns(), recent);
  }
  say_why_wide(recent, is_of_fence, clock_error_ns, told);
  return told;
}

}  // namespace collided::engine
