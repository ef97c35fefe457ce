#pragma once

#include <tuple>

#include <collided/explanations.hpp>

#include "idl/answers/standing.hpp"
#include "idl/described.hpp"

/// Explanations as JSON, in the order of `collide explain --json`. Words are indexed by their codes.
namespace collided {

inline constexpr const char* kSideWords[] = {"outside", "inside", "undecided"};
inline constexpr const char* kTouchWords[] = {"apart", "touching", "undecided"};
inline constexpr const char* kRungWords[] = {"double", "expansion", "rational"};
inline constexpr const char* kWhereMissedWords[] = {"beside", "start", "end"};
inline constexpr const char* kEventsOfWords[] = {"contacts", "standing"};

// ---- a ray ---------------------------------------------------------------------------------------------------------

constexpr auto fields_of(const ExplainedMeeting*) {
  using T = ExplainedMeeting;
  return listed(
      fields<&T::object, &T::kind, &T::distance_m, &T::error_m, &T::point, &T::normal, &T::triangle, &T::part>(),
      field("level", &T::rung, kRungWords), fields<&T::inside>(), unless_default<&T::stale>(), fields<&T::age>(),
      field("why", &T::why_left_out, Written::unless_default));
}
constexpr auto fields_of(const ExplainedMiss*) {
  using T = ExplainedMiss;
  return listed(
      fields<&T::object>(), field("answer", &T::verdict),
      fields<&T::distance_m, &T::error_m, &T::along_m, &T::on_ray, &T::on_object, &T::point_error_m, &T::triangle>(),
      field("where", &T::where, kWhereMissedWords), fields<&T::box_met>(),
      field("why", &T::why_left_out, Written::unless_default));
}
constexpr auto fields_of(const ExplainedStale*) {
  using T = ExplainedStale;
  return fields<&T::object, &T::age, &T::from_m>();
}
constexpr auto fields_of(const Uncovered*) { return fields<&Uncovered::point, &Uncovered::covered_m>(); }
constexpr auto fields_of(const ExplainedRay*) {
  using T = ExplainedRay;
  return listed(field("answer", &T::verdict), fields<&T::reason>(), field("level", &T::rung, kRungWords),
                fields<&T::boxes_met, &T::objects, &T::nodes, &T::exact_tests, &T::left_out_count, &T::met,
                       &T::left_out, &T::misses, &T::stale, &T::unknown>(),
                field("not_covered", &T::uncovered), unless_default<&T::cut, &T::late>(),
                field("time_ns", &T::world_time), fields<&T::version>());
}

// ---- two objects: additions to the answer of `pair` ----------------------------------------------------------------

constexpr auto fields_of(const ExplainedApproach*) {
  using T = ExplainedApproach;
  return listed(fields<&T::end, &T::from, &T::to, &T::time, &T::distance_m, &T::error_m, &T::at_least_m, &T::looks>());
}
constexpr auto fields_of(const ExplainedPair*) {
  using T = ExplainedPair;
  return listed(fields<&T::why_not, &T::attached, &T::nearest>(), unless_default<&T::no_nearest>());
}

// ---- a standing question -------------------------------------------------------------------------------------------

constexpr auto fields_of(const ExplainedObject*) {
  using T = ExplainedObject;
  return listed(fields<&T::object>(), field("answer", &T::verdict, kSideWords),
                fields<&T::clearance_m, &T::error_m, &T::on_other, &T::on_object>(), unless_default<&T::stale>(),
                field("why", &T::why_left_out, Written::unless_default), unless_default<&T::reported>(),
                fields<&T::since>(), unless_default<&T::episode>(), fields_if<&T::reported, &T::doubt>());
}
constexpr auto fields_of(const ExplainedNews*) {
  using T = ExplainedNews;
  return fields<&T::sequence, &T::what, &T::object, &T::why, &T::doubt, &T::low, &T::high>();
}
constexpr auto fields_of(const ExplainedStanding*) {
  using T = ExplainedStanding;
  return listed(fields_of(static_cast<const DefinedStanding*>(nullptr)),
                fields<&T::placed, &T::looked_at, &T::holds, &T::others, &T::left_out, &T::asked_for, &T::events>(),
                unless_default<&T::cut_short, &T::late>(), field("time_ns", &T::world_time), fields<&T::version>());
}

// ---- an event ------------------------------------------------------------------------------------------------------

constexpr auto fields_of(const ExplainedBody*) {
  using T = ExplainedBody;
  return listed(fields<&T::object, &T::remembered>(), fields_if<&T::remembered, &T::moving, &T::publisher, &T::pose>(),
                fields<&T::motion_from, &T::motion_to>());
}
constexpr auto fields_of(const ExplainedGap*) {
  using T = ExplainedGap;
  return listed(fields<&T::time>(), field("answer", &T::verdict, kTouchWords), fields<&T::clearance_m, &T::error_m>());
}
constexpr auto fields_of(const ExplainedEvent*) {
  using T = ExplainedEvent;
  return listed(fields<&T::sequence>(), field("of", &T::of, kEventsOfWords), fields<&T::what, &T::a, &T::b>(),
                unless_default<&T::margin, &T::within>(),
                fields<&T::why, &T::doubt, &T::depth_m, &T::error_m, &T::low, &T::high, &T::world_time, &T::point,
                       &T::normal, &T::bodies, &T::before, &T::after, &T::why_wide, &T::episode, &T::a_triangle,
                       &T::b_triangle, &T::began, &T::version>());
}

}  // namespace collided
