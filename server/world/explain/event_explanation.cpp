#include "server/world/explain/event_explanation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <span>
#include <utility>

#include <collided/explanations.hpp>

#include "server/world/query/pair_report.hpp"

namespace collided::engine {
namespace {

using std::chrono::nanoseconds;

const ObjectInfo* find(const Snapshot& state, const std::string& name) {
  const auto found = std::find_if(state.objects.begin(), state.objects.end(),
                                  [&](const auto& info) { return info && info->name == name; });
  return found == state.objects.end() ? nullptr : found->get();
}

/// The motion between two poses that holds the whole bracket; if the bracket contains a pose, the motions before and
/// after it together.
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

/// One of the two objects, at the time by which the change had happened.
struct EventBody {
  ExplainedBody told;
  std::uint64_t publisher = 0;  // 0: the server itself
  std::optional<PoseMemory::Reach> motion = {};
};

EventBody body_of(const PoseMemory& memory, const Snapshot* then, const RecentEvent& recent, bool is_first) {
  EventBody body{.told = {.object = is_first ? recent.a : recent.b}};
  const ObjectInfo* info = then == nullptr ? nullptr : find(*then, body.told.object);
  if (info == nullptr) return body;
  const Pose& pose = then->poses[slot_of(info->id)];
  body.publisher = info->publisher;
  body.motion = motion_about(memory, is_first ? recent.event.of.a : recent.event.of.b, recent);
  body.told.remembered = true;
  body.told.moving = info->moving;
  body.told.pose = {.position = pose.position, .rotation = collided::Quat(pose.rotation)};
  if (body.motion) {
    body.told.motion_from = nanoseconds(body.motion->from_ns);
    body.told.motion_to = nanoseconds(body.motion->to_ns);
  }
  return body;
}

std::optional<ExplainedGap> gap_at(const PoseMemory& memory, std::int64_t time_ns, const RecentEvent& recent) {
  const std::shared_ptr<const Snapshot> state = memory.at(time_ns);
  if (!state) return std::nullopt;
  const ObjectInfo* a = find(*state, recent.a);
  const ObjectInfo* b = find(*state, recent.b);
  if (a == nullptr || b == nullptr) return std::nullopt;
  const PairReport report = report_pair(*state, a->id, b->id, {});
  ExplainedGap gap{.time = nanoseconds(time_ns), .verdict = static_cast<collided::Verdict>(report.touches)};
  if (report.touches == Decision::no) {
    gap.clearance_m = report.separation.distance_m;
    gap.error_m = report.separation.error_m;
  } else if (report.touches == Decision::yes) {
    gap.clearance_m = -report.contact.depth_m;
    gap.error_m = report.contact.depth_error_m;
  }
  return gap;
}

std::string_view word_of_kind(EventKind kind, bool is_of_fence, ObjectId fence) {
  if (is_nearest_question(fence)) return kind == EventKind::began ? "nearest" : "no longer nearest";
  if (is_of_fence) return kind == EventKind::began ? "enter" : "exit";
  return name_of(kind);
}

/// The content of the event itself. The name of a band's fence consists of margin, object and distance, a line each.
ExplainedEvent told_event(const RecentEvent& recent, bool is_of_fence) {
  const Event& event = recent.event;
  ExplainedEvent told{.sequence = event.sequence,
                      .of = is_of_fence ? EventsOf::standing : EventsOf::contacts,
                      .what = std::string(word_of_kind(event.kind, is_of_fence, event.of.b)),
                      .why = std::string(name_of(event.reason)),
                      .doubt = std::string(name_of(event.of.doubt)),
                      .a = recent.a,
                      .b = recent.b,
                      .a_triangle = event.of.a_triangle,
                      .b_triangle = event.of.b_triangle,
                      .depth_m = event.of.contact.depth_m,
                      .error_m = event.of.contact.depth_error_m,
                      .point = event.of.contact.point,
                      .normal = event.of.contact.normal,
                      .episode = event.of.episode,
                      .began = nanoseconds(event.of.began_ns),
                      .low = nanoseconds(recent.low_ns()),
                      .high = nanoseconds(recent.high_ns()),
                      .world_time = nanoseconds(recent.world_time_ns)};
  if (const std::size_t line = recent.b.find('\n'); line != std::string::npos) {
    const std::size_t next = recent.b.find('\n', line + 1);
    told.margin = recent.b.substr(0, line);
    told.b = recent.b.substr(line + 1, next - line - 1);
    told.within = recent.b.substr(recent.b.rfind('\n') + 1);
  }
  return told;
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

/// The search that narrowed the bracket within the motions; without motion, all of them count.
void add_search(std::span<const EventBody> bodies, const RecentEvent& recent, std::int64_t clock_ns,
                std::vector<std::string>& why) {
  const std::int64_t width_ns = recent.high_ns() - recent.low_ns();
  std::optional<PoseMemory::Reach> shortest;
  std::string whose;
  for (const EventBody& body : bodies) {
    if (!body.motion) continue;
    if (shortest && shortest->to_ns - shortest->from_ns <= body.motion->to_ns - body.motion->from_ns) continue;
    shortest = body.motion;
    whose = body.told.object;
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

std::vector<std::string> why_wide(const RecentEvent& recent, bool is_of_fence, std::int64_t clock_error_ns,
                                  std::span<const EventBody> bodies) {
  const bool are_of_two =
      !is_of_fence && bodies[0].told.moving && bodies[1].told.moving && bodies[0].publisher != bodies[1].publisher;
  const std::int64_t clock_ns = are_of_two ? clock_error_ns : 0;
  std::vector<std::string> why;
  add_end_reason(recent, why);
  add_search(bodies, recent, clock_ns, why);
  if (clock_ns > 0)
    why.push_back(
        fmt::format("two publishers, whose clocks may differ by {}: so much more on either side", in_time(clock_ns)));
  if (recent.event.of.doubt == Doubt::cost_limit)
    why.emplace_back("the motion took more looks than one pair is given, so that it is in doubt");
  if (recent.event.of.doubt == Doubt::numeric)
    why.emplace_back("an exact test came out undecided, so that it is in doubt");
  if (recent.event.of.doubt == Doubt::publisher_lost)
    why.emplace_back("a publisher is lost, and its object may have gone on");
  if (why.empty()) why.emplace_back("what led to it is not remembered any more");
  return why;
}

}  // namespace

ExplainedEvent explain_event(const PoseMemory& memory, const RecentEvent& recent, bool is_of_fence,
                             std::int64_t clock_error_ns, FunctionRef<std::string(std::uint64_t)> name_of,
                             Deadline& deadline) {
  ExplainedEvent told = told_event(recent, is_of_fence);
  const std::shared_ptr<const Snapshot> then = memory.at(recent.high_ns());
  std::array bodies{body_of(memory, then.get(), recent, true), body_of(memory, then.get(), recent, false)};
  const bool are_places_known =
      std::ranges::all_of(bodies, [](const EventBody& body) { return body.publisher != 0 || !body.motion; });
  if (!is_of_fence && are_places_known && !deadline.is_over()) {
    told.before = gap_at(memory, recent.low_ns(), recent);
    told.after = gap_at(memory, recent.high_ns(), recent);
  }
  told.why_wide = why_wide(recent, is_of_fence, clock_error_ns, bodies);
  for (EventBody& body : bodies) {
    body.told.publisher = name_of(body.publisher);
    told.bodies.push_back(std::move(body.told));
  }
  return told;
}

}  // namespace collided::engine
