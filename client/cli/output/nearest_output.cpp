#include "client/cli/output/nearest_output.hpp"

#include <cmath>

#include <fmt/format.h>

#include "client/cli/input/number.hpp"
#include "client/cli/output/clock_text.hpp"
#include "client/cli/output/event_output.hpp"
#include "client/cli/output/readable.hpp"

namespace collided::cli {
namespace {

std::chrono::nanoseconds seconds_before(const NearestEvent& event, double seconds) {
  return event.world_time - std::chrono::nanoseconds(std::llround(seconds * 1e9));
}

bool has_distance(const NearestEvent& event) { return !event.to.empty() && event.doubt == Doubt::none; }

Value text_or_none(const std::string& text) {
  return text.empty() ? Value(std::monostate{}) : Value(std::string_view(text));
}

std::string about_text(const NearestQuestion& nearest) {
  if (!nearest.point) return printable(nearest.to);
  return fmt::format("{} {} {}", format_number(nearest.point->x()), format_number(nearest.point->y()),
                     format_number(nearest.point->z()));
}

}  // namespace

Record nearest_record(const NearestEvent& event) {
  const Value none = std::monostate{};
  const bool is_change = event.kind == NearestEventKind::changed;
  const auto at = [&](double seconds) {
    return is_change ? Value(std::int64_t{seconds_before(event, seconds).count()}) : none;
  };
  return {{"time", seconds_of(is_change ? seconds_before(event, event.bracket_high_s) : event.world_time)},
          {"what", name_of(event.kind)},
          {"nearest", std::string_view(event.nearest)},
          {"from", text_or_none(event.from)},
          {"to", text_or_none(event.to)},
          {"distance", has_distance(event) ? Value(event.distance_m) : none},
          {"distance_error", has_distance(event) ? Value(event.distance_error_m) : none},
          {"why", event.reason == EndReason::none ? none : Value(name_of(event.reason))},
          {"doubt", event.doubt == Doubt::none ? none : Value(name_of(event.doubt))},
          {"resync", event.resync ? Value(true) : none},
          {"poses_merged", event.poses_merged ? Value(true) : none},
          {"first_ns", at(event.bracket_low_s)},
          {"last_ns", at(event.bracket_high_s)},
          {"point", has_distance(event) ? MaybeVector(event.point) : MaybeVector()},
          {"normal", has_distance(event) && !event.normal.isZero(0) ? MaybeVector(event.normal) : MaybeVector()},
          {"sequence", event.sequence},
          {"epoch", event.epoch}};
}

std::vector<std::string> usual_nearest_fields() {
  return {"time", "what", "nearest", "from", "to", "distance", "why", "doubt"};
}

std::string nearest_line(const Printer& printer, const NearestEvent& event) {
  const std::string to = event.to.empty() ? "nothing" : printable(event.to);
  std::string line;
  if (event.kind == NearestEventKind::is) {
    line = fmt::format("is       {}  {}", printable(event.nearest), to);
  } else {
    const std::string from = event.from.empty() ? "nothing" : printable(event.from);
    line = fmt::format("{} {}  {}  {} -> {}", clock_text(seconds_before(event, event.bracket_high_s)),
                       printer.paint(event.to.empty() ? Paint::faint : Paint::bad, "nearest"), printable(event.nearest),
                       from, to);
  }
  if (has_distance(event)) line += fmt::format("  {} m", readable_number(event.distance_m, event.distance_error_m));
  if (event.reason != EndReason::none && event.reason != EndReason::separated)
    line +=
        fmt::format("  ({})", event.reason == EndReason::fence_removed ? "question_removed" : name_of(event.reason));
  if (event.doubt != Doubt::none) line += fmt::format("  in doubt ({})", name_of(event.doubt));
  line += fmt::format("  seq {}", event.sequence);
  if (event.resync) line += "  resync";
  if (event.poses_merged) line += "  (poses merged)";
  return line;
}

Record nearest_record(const ListedNearest& listed) {
  const NearestQuestion& nearest = listed.question;
  return {{"nearest", std::string_view(nearest.name)},
          {"only", std::string_view(nearest.only)},
          {"skip", text_or_none(nearest.skip)},
          {"of", about_text(nearest)},
          {"within", nearest.within_m},
          {"hysteresis", nearest.hysteresis_m},
          {"keep", nearest.keep},
          {"object", text_or_none(listed.object)},
          {"since", listed.since ? Value(seconds_of(*listed.since)) : Value(std::monostate{})},
          {"in_doubt", listed.is_in_doubt},
          {"cut_short", listed.cut_short}};
}

std::vector<std::string> nearest_row(const ListedNearest& listed) {
  const NearestQuestion& nearest = listed.question;
  return {printable(nearest.name),
          printable(nearest.only) + (nearest.skip.empty() ? "" : " but " + printable(nearest.skip)),
          about_text(nearest),
          format_number(nearest.within_m) + " m",
          format_number(nearest.hysteresis_m) + " m",
          nearest.keep ? "yes" : "no",
          format_count(listed.cut_short),
          (listed.object.empty() ? "nothing" : printable(listed.object)) + (listed.is_in_doubt ? " in doubt" : "")};
}

}  // namespace collided::cli
