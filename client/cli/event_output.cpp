#include "client/cli/event_output.hpp"

#include <fmt/format.h>

#include "client/cli/clock_text.hpp"
#include "client/cli/number.hpp"

namespace collided::cli {
namespace {

std::string_view name_of(What what) {
  switch (what) {
    case What::open: return "open";
    case What::began: return "began";
    case What::persisted: return "persisted";
    case What::ended: break;
  }
  return "ended";
}

std::string_view name_of(Why why) {
  switch (why) {
    case Why::none: return "";
    case Why::separated: return "separated";
    case Why::removed: return "removed";
    case Why::publisher_lost: return "publisher_lost";
    case Why::teleported: return "teleported";
    case Why::geometry_changed: return "geometry_changed";
    case Why::server_stopping: return "server_stopping";
    case Why::decided: return "decided";
    case Why::server_restarted: break;
  }
  return "server_restarted";
}

std::string_view name_of(Doubt doubt) {
  switch (doubt) {
    case Doubt::none: return "";
    case Doubt::numeric: return "numeric";
    case Doubt::cost_limit: return "cost_limit";
    case Doubt::publisher_lost: break;
  }
  return "publisher_lost";
}

Value triangle_value(std::uint32_t triangle) {
  if (triangle == kNoTriangle) return std::monostate{};
  return std::uint64_t{triangle};
}

}  // namespace

Record event_record(const Event& event) {
  const bool is_doubt = event.doubt != Doubt::none;
  const bool touches = event.what != What::ended && !is_doubt;
  const bool is_told = event.what == What::began || event.what == What::persisted;
  const Value none = std::monostate{};
  const auto at = [&](double seconds_before) { return event.world_time.count() - std::llround(seconds_before * 1e9); };
  const bool has_bracket = event.what == What::began || event.what == What::ended;
  return {{"time", seconds_of(event.world_time)},
          {"time_ns", std::int64_t{event.world_time.count()}},
          {"first_ns", has_bracket ? Value(std::int64_t{at(event.bracket_low_s)}) : none},
          {"last_ns", has_bracket ? Value(std::int64_t{at(event.bracket_high_s)}) : none},
          {"what", name_of(event.what)},
          {"a", std::string_view(event.a)},
          {"b", std::string_view(event.b)},
          {"depth", touches ? Value(event.depth_m) : none},
          {"error", touches ? Value(event.depth_error_m) : none},
          {"point", touches ? MaybeVector(event.point) : MaybeVector()},
          {"normal", touches ? MaybeVector(event.normal) : MaybeVector()},
          {"a_triangle", triangle_value(event.a_triangle)},
          {"b_triangle", triangle_value(event.b_triangle)},
          {"after", event.what == What::ended ? Value(seconds_of(lasted(event))) : none},
          {"why", event.why == Why::none ? none : Value(name_of(event.why))},
          {"doubt", is_doubt ? Value(name_of(event.doubt)) : none},
          {"resync", event.resync ? Value(true) : none},
          {"sequence", event.sequence},
          {"episode", event.episode},
          {"bracket_low", event.bracket_low_s},
          {"bracket_high", event.bracket_high_s},
          {"epoch", event.epoch},
          {"velocity", is_told && touches ? MaybeVector(event.relative_velocity) : MaybeVector()},
          {"velocity_error", is_told && touches ? Value(event.velocity_error) : none}};
}

std::string event_line(const Printer& printer, const Event& event) {
  const std::string pair = fmt::format("{} x {}", printable(event.a), printable(event.b));
  const std::string doubt = event.doubt == Doubt::none ? "" : fmt::format("  in doubt ({})", name_of(event.doubt));
  if (event.what == What::open) return fmt::format("{:<8} {}  since {}{}", "open", pair, clock_text(event.began), doubt);
  const Paint paint = event.what == What::began ? Paint::bad : Paint::faint;
  std::string line = fmt::format("{} {}  {}", clock_text(happened(event)), printer.paint(paint, name_of(event.what)), pair);
  if (event.what == What::ended) line += fmt::format("  after {}  ({})", format_duration(lasted(event)), name_of(event.why));
  else if (event.doubt == Doubt::none) line += fmt::format("  depth {} at {}", format_length(event.depth_m), format_vector(event.point));
  line += doubt + fmt::format("  seq {}", event.sequence);
  if (event.resync) line += "  resync";
  return line;
}

}  // namespace collided::cli
