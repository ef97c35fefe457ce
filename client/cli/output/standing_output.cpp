#include "client/cli/output/standing_output.hpp"

#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "client/cli/input/number.hpp"
#include "client/cli/output/clock_text.hpp"
#include "client/cli/output/event_output.hpp"
#include "client/cli/output/readable.hpp"

namespace collided::cli {
namespace {

using Kind = StandingEventKind;
using std::chrono::nanoseconds;

Value text_or_none(std::string_view text) { return text.empty() ? Value() : Value(text); }

// ---- events --------------------------------------------------------------------------------------------------------

/// Whether it held before the watch began, so that the event is not a change.
bool held_before(const StandingEvent& event) {
  return event.kind == Kind::inside || event.kind == Kind::within || event.kind == Kind::is;
}
bool has_stay(const StandingEvent& event) {
  return event.kind == Kind::exit || event.kind == Kind::cross || event.kind == Kind::leave;
}
/// Whether the event is an approach of two, with their distance.
bool has_distance(const StandingEvent& event) {
  if (event.doubt != Doubt::none) return false;
  if (event.form == StandingForm::nearest) return !event.object.empty();
  return event.kind == Kind::approach || event.kind == Kind::near || event.kind == Kind::contact;
}

nanoseconds before(const StandingEvent& event, double seconds) {
  return event.world_time - nanoseconds(std::llround(seconds * 1e9));
}
/// World time by which the change had happened, or since when it has held.
nanoseconds happened_by(const StandingEvent& event) {
  if (held_before(event)) return event.entered;
  return before(event, event.kind == Kind::cross ? event.left_high_s : event.bracket_high_s);
}

/// The reason for people: the removed item has another name in each form.
std::string_view reason_text(const StandingEvent& event) {
  if (event.reason != EndReason::fence_removed || event.form == StandingForm::region) return name_of(event.reason);
  return event.form == StandingForm::bands ? "margin_removed" : "question_removed";
}

std::string object_or_nothing(const std::string& name) { return name.empty() ? "nothing" : printable(name); }

/// The objects of the event: "forklift_7", "worker x crane" or "door_1 -> door_2".
std::string objects_text(const StandingEvent& event) {
  if (event.form == StandingForm::bands) return fmt::format("{} x {}", printable(event.object), printable(event.other));
  if (event.kind == Kind::changed)
    return fmt::format("{} -> {}", object_or_nothing(event.other), object_or_nothing(event.object));
  return object_or_nothing(event.object);
}

/// The band, or the distance of the nearest.
std::string length_text(const StandingEvent& event) {
  if (event.form == StandingForm::bands && event.kind != Kind::contact)
    return event.band_m > 0 ? fmt::format("  {} m", format_number(event.band_m)) : "  contact";
  if (event.form == StandingForm::nearest && has_distance(event))
    return fmt::format("  {} m", readable_number(event.distance_m, event.distance_error_m));
  return {};
}

/// The closing speed of two in bands, and when they would touch.
std::string forecast_text(const StandingEvent& event) {
  std::string text;
  if (event.closing_mps > event.closing_error_mps)
    text += fmt::format("  closing {} m/s", readable_number(event.closing_mps, event.closing_error_mps));
  if (event.contact_in && event.kind != Kind::contact)
    text += fmt::format("  contact in {}", format_duration(nanoseconds(std::llround(event.contact_in->low_s * 1e9))));
  return text;
}

/// Since when it has held, how long it held and why it ended, or what follows.
std::string course_text(const StandingEvent& event) {
  const std::string stay = has_stay(event) ? format_duration(happened_by(event) - event.entered) : "";
  switch (event.kind) {
    case Kind::inside:
    case Kind::within: return "  since " + clock_text(event.entered);
    case Kind::exit:
    case Kind::leave: return fmt::format("  after {}  ({})", stay, reason_text(event));
    case Kind::cross: return "  in for " + stay;
    case Kind::approach:
    case Kind::near:
    case Kind::contact: return has_distance(event) ? forecast_text(event) : "";
    case Kind::changed: {
      // The line already shows that another one is nearer.
      const bool is_plain = event.reason == EndReason::none || event.reason == EndReason::separated;
      return is_plain ? "" : fmt::format("  ({})", reason_text(event));
    }
    default: return {};
  }
}

// ---- lists ---------------------------------------------------------------------------------------------------------

/// "5 m, 2 m"; contact, which is always a band, is named only if it is the only one.
std::string band_list(const DefinedStanding& standing) {
  std::string text;
  for (const double band_m : standing.bands_m) {
    if (band_m > 0) text += (text.empty() ? "" : ", ") + format_number(band_m) + " m";
  }
  return text.empty() ? "contact" : text;
}

/// "forklift_1 forklift_2", or for bands "worker crane 1 m  worker lift contact".
std::string held_text(const ListedStanding& standing, bool is_in_doubt) {
  std::string text;
  for (const HeldObject& held : standing.holds) {
    if (held.in_doubt != is_in_doubt) continue;
    if (standing.form != StandingForm::bands) {
      text += (text.empty() ? "" : " ") + printable(held.object);
      continue;
    }
    text += fmt::format("{}{} {} {}", text.empty() ? "" : "  ", printable(held.object), printable(held.other),
                        held.band_m > 0 ? format_number(held.band_m) + " m" : "contact");
  }
  return text;
}

/// The objects that it monitors, by its globs: "forklift* but forklift_9".
std::string seen_globs(const DefinedStanding& standing) {
  const std::string text = standing.only.empty() ? "all" : printable(standing.only);
  return standing.skip.empty() ? text : text + " but " + printable(standing.skip);
}

/// Its subject: a region and its carrier, the owners of the bands, or the origin of the distances.
std::string about_text(const DefinedStanding& standing) {
  if (standing.form == StandingForm::nearest) return target_text(standing);
  if (standing.form == StandingForm::bands) return printable(standing.around);
  return standing.kind + (standing.to.empty() ? "" : " on " + printable(standing.to));
}

std::string details_text(const ListedStanding& standing) {
  if (standing.form == StandingForm::region) return fmt::format("{}", fmt::join(standing.detect, ","));
  std::string text =
      standing.form == StandingForm::bands ? band_list(standing) : "within " + format_number(standing.within_m) + " m";
  if (standing.hysteresis_m > 0) text += fmt::format("; hysteresis {} m", format_number(standing.hysteresis_m));
  if (standing.dwell.count() > 0) text += "; dwell " + format_duration(standing.dwell);
  if (standing.cut_short > 0) text += fmt::format("; {} cut short", format_count(standing.cut_short));
  return text;
}

}  // namespace

Record standing_record(const StandingEvent& event) {
  const Value none;
  const bool is_of_bands = event.form == StandingForm::bands;
  const bool is_nearer = has_distance(event);
  const auto only_if = [&](bool is_there, Value value) { return is_there ? std::move(value) : none; };
  const auto at = [&](bool is_there, double seconds) {
    return only_if(is_there, std::int64_t{before(event, seconds).count()});
  };
  const auto vector = [](bool is_there, const Vec3& value) {
    return is_there && !value.isZero(0) ? MaybeVector(value) : MaybeVector();
  };
  return {{"time", seconds_of(happened_by(event))},
          {"what", name_of(event.kind)},
          {"form", name_of(event.form)},
          {"standing", std::string_view(event.standing)},
          {"object", text_or_none(event.object)},
          {"other", text_or_none(event.other)},
          {"band", only_if(is_of_bands, event.band_m)},
          {"distance", only_if(is_nearer, event.distance_m)},
          {"distance_error", only_if(is_nearer, event.distance_error_m)},
          {"closing", only_if(is_nearer && is_of_bands, event.closing_mps)},
          {"closing_error", only_if(is_nearer && is_of_bands, event.closing_error_mps)},
          {"contact_in_first", event.contact_in ? Value(event.contact_in->low_s) : none},
          {"contact_in_last", event.contact_in ? Value(event.contact_in->high_s) : none},
          {"after", only_if(has_stay(event), seconds_of(happened_by(event) - event.entered))},
          {"why", text_or_none(name_of(event.reason))},
          {"doubt", text_or_none(name_of(event.doubt))},
          {"resync", only_if(event.resync, true)},
          {"poses_merged", only_if(event.poses_merged, true)},
          {"first_ns", at(!held_before(event), event.bracket_low_s)},
          {"last_ns", at(!held_before(event), event.bracket_high_s)},
          {"left_first_ns", at(event.kind == Kind::cross, event.left_low_s)},
          {"left_last_ns", at(event.kind == Kind::cross, event.left_high_s)},
          {"point", vector(is_nearer || event.form == StandingForm::region, event.point)},
          {"normal", vector(is_nearer, event.normal)},
          {"sequence", event.sequence},
          {"episode", event.episode},
          {"epoch", event.epoch}};
}

std::vector<std::string> usual_standing_fields() {
  return {"time", "what", "standing", "object", "other", "band", "distance", "after", "why", "doubt"};
}

std::string standing_line(const Printer& printer, const StandingEvent& event) {
  std::string line;
  if (held_before(event)) {
    line = fmt::format("{:<8}", name_of(event.kind));
  } else {
    const bool is_end =
        event.kind == Kind::exit || event.kind == Kind::leave || (event.kind == Kind::changed && event.object.empty());
    line = fmt::format("{} {} ", clock_text(happened_by(event)),
                       printer.paint(is_end ? Paint::faint : Paint::bad,
                                     event.kind == Kind::changed ? "nearest" : name_of(event.kind)));
  }
  line += fmt::format(" {}  {}{}{}", printable(event.standing), objects_text(event), length_text(event),
                      course_text(event));
  if (event.doubt != Doubt::none) line += fmt::format("  in doubt ({})", name_of(event.doubt));
  if (event.kind == Kind::inside || event.kind == Kind::within) return line;
  line += fmt::format("  seq {}", event.sequence);
  if (event.resync) line += "  resync";
  if (event.poses_merged) line += "  (poses merged)";
  return line;
}

Record standing_record(const ListedStanding& standing) {
  const Value none;
  const bool is_of_region = standing.form == StandingForm::region;
  const bool is_of_bands = standing.form == StandingForm::bands;
  const bool is_of_nearest = standing.form == StandingForm::nearest;
  const bool is_held_alone = is_of_nearest && !standing.holds.empty();
  return {{"standing", std::string_view(standing.name)},
          {"form", name_of(standing.form)},
          {"region", text_or_none(standing.kind)},
          {"to", text_or_none(standing.to)},
          {"point", standing.point ? MaybeVector(*standing.point) : MaybeVector()},
          {"around", text_or_none(standing.around)},
          {"only", text_or_none(standing.only)},
          {"skip", text_or_none(standing.skip)},
          {"bands", is_of_bands ? Value(band_list(standing)) : none},
          {"within", is_of_nearest ? Value(standing.within_m) : none},
          {"hysteresis", is_of_region ? none : Value(standing.hysteresis_m)},
          {"dwell", is_of_bands ? Value(seconds_of(standing.dwell)) : none},
          {"detect", is_of_region ? Value(fmt::format("{}", fmt::join(standing.detect, ","))) : none},
          {"keep", standing.keep},
          {"holds", held_text(standing, false)},
          {"in_doubt", held_text(standing, true)},
          {"since", is_held_alone ? Value(seconds_of(standing.holds.front().since)) : none},
          {"cut_short", is_of_nearest ? Value(standing.cut_short) : none}};
}

std::vector<std::string> standing_columns() { return {"NAME", "FORM", "OF", "LOOKS AT", "DETAILS", "KEPT", "HOLDS"}; }

std::vector<std::string> standing_row(const ListedStanding& standing) {
  std::string holds = held_text(standing, false);
  if (const std::string doubtful = held_text(standing, true); !doubtful.empty())
    holds += (holds.empty() ? "in doubt: " : "  in doubt: ") + doubtful;
  return {printable(standing.name),
          std::string(name_of(standing.form)),
          about_text(standing),
          seen_globs(standing),
          details_text(standing),
          standing.keep ? "yes" : "no",
          holds};
}

std::string target_text(const DefinedStanding& standing) {
  return standing.point ? format_vector(*standing.point) : printable(standing.to);
}

}  // namespace collided::cli
