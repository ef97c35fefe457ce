#pragma once

#include <tuple>

#include <collided/explanations.hpp>

#include "idl/described.hpp"

/// The names that explanations have as JSON, in the order of `collide explain --json`. Words are listed by their codes.
namespace collided {

inline constexpr const char* kSideWords[] = {"outside", "inside", "undecided"};
inline constexpr const char* kTouchWords[] = {"apart", "touching", "undecided"};
inline constexpr const char* kRungWords[] = {"double", "expansion", "rational"};
inline constexpr const char* kWhereMissedWords[] = {"beside", "start", "end"};
inline constexpr const char* kEventsOfWords[] = {"contacts", "fences"};

// ---- a ray ---------------------------------------------------------------------------------------------------------

constexpr auto fields_of(const ExplainedMeeting*) {
  using T = ExplainedMeeting;
  return std::tuple(field("object", &T::object), field("kind", &T::kind), field("distance", &T::distance_m),
                    field("error", &T::error_m), field("point", &T::point), field("normal", &T::normal),
                    field("triangle", &T::triangle), field("part", &T::part), field("level", &T::rung, kRungWords),
                    field("inside", &T::inside), field("stale", &T::stale, Written::unless_default),
                    field("age_ns", &T::age), field("why", &T::why_left_out, Written::unless_default));
}
constexpr auto fields_of(const ExplainedMiss*) {
  using T = ExplainedMiss;
  return std::tuple(field("object", &T::object), field("answer", &T::verdict), field("distance", &T::distance_m),
                    field("error", &T::error_m), field("along", &T::along_m), field("on_ray", &T::on_ray),
                    field("on_object", &T::on_object), field("point_error", &T::point_error_m),
                    field("triangle", &T::triangle), field("where", &T::where, kWhereMissedWords),
                    field("box_met", &T::box_met), field("why", &T::why_left_out, Written::unless_default));
}
constexpr auto fields_of(const ExplainedStale*) {
  using T = ExplainedStale;
  return std::tuple(field("object", &T::object), field("age_ns", &T::age), field("from", &T::from_m));
}
constexpr auto fields_of(const Uncovered*) {
  return std::tuple(field("point", &Uncovered::point), field("covered", &Uncovered::covered_m));
}
constexpr auto fields_of(const ExplainedRay*) {
  using T = ExplainedRay;
  return std::tuple(field("answer", &T::verdict), field("reason", &T::reason), field("level", &T::rung, kRungWords),
                    field("boxes_met", &T::boxes_met), field("objects", &T::objects), field("nodes", &T::nodes),
                    field("exact_tests", &T::exact_tests), field("left_out_count", &T::left_out_count),
                    field("met", &T::met), field("left_out", &T::left_out), field("misses", &T::misses),
                    field("stale", &T::stale), field("unknown", &T::unknown), field("not_covered", &T::uncovered),
                    field("cut", &T::cut, Written::unless_default), field("late", &T::late, Written::unless_default),
                    field("time_ns", &T::world_time), field("version", &T::version));
}

// ---- two objects: what is told beside the answer of `pair` ---------------------------------------------------------

constexpr auto fields_of(const ExplainedApproach*) {
  using T = ExplainedApproach;
  return std::tuple(field("end", &T::end), field("from_ns", &T::from), field("to_ns", &T::to),
                    field("time_ns", &T::time), field("distance", &T::distance_m), field("error", &T::error_m),
                    field("at_least", &T::at_least_m), field("looks", &T::looks));
}
constexpr auto fields_of(const ExplainedPair*) {
  using T = ExplainedPair;
  return std::tuple(field("why_not", &T::why_not), field("attached", &T::attached), field("nearest", &T::nearest),
                    field("no_nearest", &T::no_nearest, Written::unless_default));
}

// ---- a fence, and the nearest --------------------------------------------------------------------------------------

constexpr auto fields_of(const ExplainedStanding*) {
  using T = ExplainedStanding;
  return std::tuple(field("object", &T::object), field("answer", &T::verdict, kSideWords),
                    field("clearance", &T::clearance_m), field("error", &T::error_m), field("on_fence", &T::on_fence),
                    field("on_object", &T::on_object), field("stale", &T::stale, Written::unless_default),
                    field("why", &T::why_left_out, Written::unless_default),
                    field("told", &T::told, Written::unless_default), field("since_ns", &T::since),
                    field("episode", &T::episode, Written::unless_default), field_if<&T::told>("doubt", &T::doubt));
}
constexpr auto fields_of(const ExplainedNews*) {
  using T = ExplainedNews;
  return std::tuple(field("sequence", &T::sequence), field("what", &T::what), field("object", &T::object),
                    field("why", &T::why), field("doubt", &T::doubt), field("low_ns", &T::low),
                    field("high_ns", &T::high));
}
constexpr auto fields_of(const ExplainedFence*) {
  using T = ExplainedFence;
  return std::tuple(field("fence", &T::fence), field("kind", &T::kind), field("to", &T::to),
                    field("placed", &T::placed), field("only", &T::only), field("skip", &T::skip),
                    field("mask", &T::mask), field("tells", &T::tells), field("keep", &T::keep),
                    field("looked_at", &T::looked_at), field("inside", &T::inside), field("outside", &T::outside),
                    field("left_out", &T::left_out), field("asked_for", &T::asked_for), field("events", &T::events),
                    field("late", &T::late, Written::unless_default), field("time_ns", &T::world_time),
                    field("version", &T::version));
}
constexpr auto fields_of(const ExplainedNearest*) {
  using T = ExplainedNearest;
  return std::tuple(field("nearest", &T::nearest), field("to", &T::to), field("point", &T::point),
                    field("placed", &T::placed), field("only", &T::only), field("skip", &T::skip),
                    field("mask", &T::mask), field("within", &T::within_m), field("hysteresis", &T::hysteresis_m),
                    field("keep", &T::keep), field("looked_at", &T::looked_at), field("is", &T::is, Written::as_list),
                    field("others", &T::others), field("left_out", &T::left_out), field("asked_for", &T::asked_for),
                    field("events", &T::events), field("cut_short", &T::cut_short),
                    field("late", &T::late, Written::unless_default), field("time_ns", &T::world_time),
                    field("version", &T::version));
}

// ---- an event ------------------------------------------------------------------------------------------------------

constexpr auto fields_of(const ExplainedBody*) {
  using T = ExplainedBody;
  return std::tuple(field("object", &T::object), field("remembered", &T::remembered),
                    field_if<&T::remembered>("moving", &T::moving),
                    field_if<&T::remembered>("publisher", &T::publisher), field_if<&T::remembered>("pose", &T::pose),
                    field("motion_from_ns", &T::motion_from), field("motion_to_ns", &T::motion_to));
}
constexpr auto fields_of(const ExplainedGap*) {
  using T = ExplainedGap;
  return std::tuple(field("time_ns", &T::time), field("answer", &T::verdict, kTouchWords),
                    field("clearance", &T::clearance_m), field("error", &T::error_m));
}
constexpr auto fields_of(const ExplainedEvent*) {
  using T = ExplainedEvent;
  return std::tuple(field("sequence", &T::sequence), field("of", &T::of, kEventsOfWords), field("what", &T::what),
                    field("a", &T::a), field("b", &T::b), field("margin", &T::margin, Written::unless_default),
                    field("within", &T::within, Written::unless_default), field("why", &T::why),
                    field("doubt", &T::doubt), field("depth", &T::depth_m), field("error", &T::error_m),
                    field("low_ns", &T::low), field("high_ns", &T::high), field("world_time_ns", &T::world_time),
                    field("point", &T::point), field("normal", &T::normal), field("bodies", &T::bodies),
                    field("before", &T::before), field("after", &T::after), field("why_wide", &T::why_wide),
                    field("episode", &T::episode), field("a_triangle", &T::a_triangle),
                    field("b_triangle", &T::b_triangle), field("began_ns", &T::began), field("version", &T::version));
}

}  // namespace collided
