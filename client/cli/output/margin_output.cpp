#include "client/cli/output/margin_output.hpp"

#include <cmath>

#include <fmt/format.h>

#include "client/cli/input/number.hpp"
#include "client/cli/output/clock_text.hpp"
#include "client/cli/output/event_output.hpp"
#include "client/cli/output/readable.hpp"

namespace collided::cli {
namespace {

bool comes_nearer(const MarginEvent& event) {
  return event.kind != MarginEventKind::within && event.kind != MarginEventKind::leave;
}

std::chrono::nanoseconds before(const MarginEvent& event, double seconds) {
  return event.world_time - std::chrono::nanoseconds(std::llround(seconds * 1e9));
}

/// World time by which the change had happened.
std::chrono::nanoseconds turned_by(const MarginEvent& event) {
  return event.kind == MarginEventKind::within ? event.entered : before(event, event.bracket_high_s);
}

std::string band_list(const Margin& margin) {
  std::string text;
  for (const double band_m : margin.bands_m) {
    if (band_m > 0) text += (text.empty() ? "" : ", ") + format_number(band_m) + " m";
  }
  return text.empty() ? "contact" : text;
}

/// Who is near: "drone_1 person_2 0.5 m"; the narrowest band of each pair.
std::string pair_list(const ListedMargin& listed) {
  std::string text;
  for (const MarginPair& pair : listed.pairs) {
    text += fmt::format("{}{} {} {}{}", text.empty() ? "" : "  ", printable(pair.object), printable(pair.around),
                        pair.within_m > 0 ? format_number(pair.within_m) + " m" : "contact",
                        pair.is_in_doubt ? " in doubt" : "");
  }
  return text;
}

std::string how_it_goes_on(const MarginEvent& event) {
  std::string text;
  if (event.closing_mps > event.closing_error_mps)
    text += fmt::format("  closing {} m/s", readable_number(event.closing_mps, event.closing_error_mps));
  if (event.contact_in && event.kind != MarginEventKind::contact)
    text += fmt::format("  contact in {}",
                        format_duration(std::chrono::nanoseconds(std::llround((event.contact_in->low_s) * 1e9))));
  return text;
}

}  // namespace

Record margin_record(const MarginEvent& event) {
  const Value none = std::monostate{};
  const bool is_nearer = comes_nearer(event) && event.doubt == Doubt::none;
  const auto number = [&](bool is_there, double value) { return is_there ? Value(value) : none; };
  const auto at = [&](double seconds) {
    return event.kind == MarginEventKind::within ? none : Value(std::int64_t{before(event, seconds).count()});
  };
  return {{"time", seconds_of(turned_by(event))},
          {"what", name_of(event.kind)},
          {"margin", std::string_view(event.margin)},
          {"object", std::string_view(event.object)},
          {"around", std::string_view(event.around)},
          {"band", event.band_m},
          {"distance", number(is_nearer, event.distance_m)},
          {"distance_error", number(is_nearer, event.distance_error_m)},
          {"closing", number(is_nearer, event.closing_mps)},
          {"closing_error", number(is_nearer, event.closing_error_mps)},
          {"contact_in_first", event.contact_in ? Value(event.contact_in->low_s) : none},
          {"contact_in_last", event.contact_in ? Value(event.contact_in->high_s) : none},
          {"after", event.kind == MarginEventKind::leave ? Value(seconds_of(turned_by(event) - event.entered)) : none},
          {"why", event.reason == EndReason::none ? none : Value(name_of(event.reason))},
          {"doubt", event.doubt == Doubt::none ? none : Value(name_of(event.doubt))},
          {"resync", event.resync ? Value(true) : none},
          {"poses_merged", event.poses_merged ? Value(true) : none},
          {"first_ns", at(event.bracket_low_s)},
          {"last_ns", at(event.bracket_high_s)},
          {"point", is_nearer ? MaybeVector(event.point) : MaybeVector()},
          {"normal", is_nearer && !event.normal.isZero(0) ? MaybeVector(event.normal) : MaybeVector()},
          {"sequence", event.sequence},
          {"episode", event.episode},
          {"epoch", event.epoch}};
}

std::vector<std::string> usual_margin_fields() {
  return {"time", "what", "margin", "object", "around", "band", "closing", "contact_in_first", "after", "why", "doubt"};
}

std::string margin_line(const Printer& printer, const MarginEvent& event) {
  const std::string doubt = event.doubt == Doubt::none ? "" : fmt::format("  in doubt ({})", name_of(event.doubt));
  const std::string band = event.band_m > 0 ? fmt::format("  {} m", format_number(event.band_m)) : "  contact";
  const std::string who =
      fmt::format("{}  {} x {}", printable(event.margin), printable(event.object), printable(event.around));
  if (event.kind == MarginEventKind::within)
    return fmt::format("within   {}{}  since {}{}", who, band, clock_text(event.entered), doubt);
  const Paint paint = event.kind == MarginEventKind::leave ? Paint::faint : Paint::bad;
  std::string line =
      fmt::format("{} {}  {}", clock_text(turned_by(event)), printer.paint(paint, name_of(event.kind)), who);
  if (event.kind != MarginEventKind::contact) line += band;
  if (event.kind == MarginEventKind::leave)
    line += fmt::format("  after {}  ({})", format_duration(turned_by(event) - event.entered),
                        event.reason == EndReason::fence_removed ? "margin_removed" : name_of(event.reason));
  else line += how_it_goes_on(event);
  line += doubt + fmt::format("  seq {}", event.sequence);
  if (event.resync) line += "  resync";
  if (event.poses_merged) line += "  (poses merged)";
  return line;
}

Record margin_record(const ListedMargin& listed) {
  const Margin& margin = listed.margin;
  return {{"margin", std::string_view(margin.name)},
          {"around", std::string_view(margin.around)},
          {"only", std::string_view(margin.only)},
          {"skip", margin.skip.empty() ? Value(std::monostate{}) : Value(std::string_view(margin.skip))},
          {"bands", band_list(margin)},
          {"hysteresis", margin.hysteresis_m},
          {"dwell", seconds_of(margin.dwell)},
          {"keep", margin.keep},
          {"pairs", pair_list(listed)}};
}

std::vector<std::string> margin_row(const ListedMargin& listed) {
  const Margin& margin = listed.margin;
  return {printable(margin.name),
          printable(margin.around),
          printable(margin.only) + (margin.skip.empty() ? "" : " but " + printable(margin.skip)),
          band_list(margin),
          format_number(margin.hysteresis_m) + " m",
          format_duration(margin.dwell),
          margin.keep ? "yes" : "no",
          pair_list(listed)};
}

}  // namespace collided::cli
