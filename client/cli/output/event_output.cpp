#include "client/cli/output/event_output.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "client/cli/input/number.hpp"
#include "client/cli/output/clock_text.hpp"
#include "client/cli/output/readable.hpp"

namespace collided::cli {
namespace {

/// Which of the two, ordered by name, lies within the other; nothing: neither.
Value contained_value(const Event& event, bool swapped) {
  if (event.contained == Containment::none) return std::monostate{};
  return std::string_view((event.contained == Containment::a_in_b) != swapped ? "a" : "b");
}

Value triangle_value(std::uint32_t triangle) {
  if (triangle == kNoTriangle) return std::monostate{};
  return std::uint64_t{triangle};
}

}  // namespace

Record event_record(const Event& event) {
  // The server orders a pair by its numbers for the objects, which differ from run to run; here it is ordered by the
  // names.
  const bool swapped = event.b < event.a;
  const double sign = swapped ? -1 : 1;  // for directions from one to the other
  const std::string_view a = swapped ? event.b : event.a;
  const std::string_view b = swapped ? event.a : event.b;
  const bool is_doubt = event.doubt != Doubt::none;
  const bool touches = event.kind != EventKind::ended && event.kind != EventKind::emerged && !is_doubt;
  const bool at_inner_edge = touches && event.surface_normal != event.normal;
  const bool is_told = event.kind == EventKind::began || event.kind == EventKind::persisted;
  const Value none = std::monostate{};
  const auto at = [&](double seconds_before) { return event.world_time.count() - std::llround(seconds_before * 1e9); };
  const bool has_bracket = event.kind != EventKind::open && event.kind != EventKind::persisted;
  return {{"time", seconds_of(event.world_time)},
          {"time_ns", std::int64_t{event.world_time.count()}},
          {"first_ns", has_bracket ? Value(std::int64_t{at(event.bracket_low_s)}) : none},
          {"last_ns", has_bracket ? Value(std::int64_t{at(event.bracket_high_s)}) : none},
          {"what", name_of(event.kind)},
          {"a", a},
          {"b", b},
          {"depth", touches ? Value(event.depth_m) : none},
          {"error", touches ? Value(event.depth_error_m) : none},
          {"point", touches ? MaybeVector(event.point) : MaybeVector()},
          {"normal", touches ? MaybeVector(sign * event.normal) : MaybeVector()},
          {"surface_normal", at_inner_edge ? MaybeVector(sign * event.surface_normal) : MaybeVector()},
          {"surface_depth", at_inner_edge ? Value(event.surface_depth_m) : none},
          {"a_triangle", triangle_value(swapped ? event.b_triangle : event.a_triangle)},
          {"b_triangle", triangle_value(swapped ? event.a_triangle : event.b_triangle)},
          {"after", event.kind == EventKind::ended ? Value(seconds_of(lasted(event))) : none},
          {"why", event.reason == EndReason::none ? none : Value(name_of(event.reason))},
          {"doubt", is_doubt ? Value(name_of(event.doubt)) : none},
          {"contained", contained_value(event, swapped)},
          {"resync", event.resync ? Value(true) : none},
          {"poses_merged", event.poses_merged ? Value(true) : none},
          {"sequence", event.sequence},
          {"episode", event.episode},
          {"bracket_low", event.bracket_low_s},
          {"bracket_high", event.bracket_high_s},
          {"epoch", event.epoch},
          {"velocity", is_told && touches ? MaybeVector(sign * event.relative_velocity) : MaybeVector()},
          {"velocity_error", is_told && touches ? Value(event.velocity_error) : none}};
}

std::vector<std::string> usual_event_fields() { return {"time", "what", "a", "b", "depth", "after", "why", "doubt"}; }

std::string event_line(const Printer& printer, const Event& event) {
  const auto [first, second] = std::minmax(event.a, event.b);
  const std::string pair = fmt::format("{} x {}", printable(first), printable(second));
  const std::string doubt =
      fmt::format("{}{}", event.doubt == Doubt::none ? "" : fmt::format("  in doubt ({})", name_of(event.doubt)),
                  event.poses_merged ? "  (poses merged)" : "");
  const std::string inner =
      event.contained == Containment::none
          ? ""
          : fmt::format("  {} within", printable(event.contained == Containment::a_in_b ? event.a : event.b));
  if (event.kind == EventKind::open)
    return fmt::format("{:<8} {}  since {}{}{}", "open", pair, clock_text(event.began), inner, doubt);
  const Paint paint = event.kind == EventKind::began ? Paint::bad : Paint::faint;
  std::string line =
      fmt::format("{} {}  {}", clock_text(happened(event)), printer.paint(paint, name_of(event.kind)), pair);
  if (event.kind == EventKind::ended)
    line += fmt::format("  after {}  ({})", format_duration(lasted(event)), name_of(event.reason));
  else if (event.kind == EventKind::emerged)
    line += fmt::format("  {} no longer within", printable(event.contained == Containment::a_in_b ? event.a : event.b));
  else if (event.doubt == Doubt::none)
    line +=
        inner + fmt::format("  depth {} at {}", readable_length(event.depth_m, event.depth_error_m, printer.digits()),
                            readable_point(event.point, event.depth_error_m, printer.digits()));
  line += doubt + fmt::format("  seq {}", event.sequence);
  if (event.resync) line += "  resync";
  return line;
}

}  // namespace collided::cli
