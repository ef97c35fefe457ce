#include "client/cli/output/explanation_output.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "client/cli/input/number.hpp"
#include "client/cli/output/clock_text.hpp"
#include "client/cli/output/described_record.hpp"
#include "client/cli/output/standing_output.hpp"
#include "idl/answers/explanation.hpp"

namespace collided::cli {
namespace {

// ---- records -------------------------------------------------------------------------------------------------------

/// The record of an explanation; its version is called world.
template <Described T>
Record explanation_record(const T& answer) {
  Record record = record_of(answer, Vectors::json);
  Field& version = record.back();
  version = {"world", answer.version == 0 ? Value() : version.value};
  return record;
}

void drop_empty(Record& record, std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names) {
    Value& value = place_of(record, name)->value;
    if (value_text(value).empty()) value = std::monostate{};
  }
}

/// Fields for the object that answers, before the one of that name.
template <class Object>
void insert_object(Record& record, std::string_view before, const Object* object, double distance_m) {
  const Value none;
  record.insert(place_of(record, before), {{"object", object ? Value(object->object) : none},
                                           {"distance", object ? Value(distance_m) : none},
                                           {"error", object ? Value(object->error_m) : none}});
}

void put_null(Value& none) {
  if (std::holds_alternative<std::monostate>(none)) none = RawJson{"null"};
}

// ---- a ray ---------------------------------------------------------------------------------------------------------

/// ", triangle 7" or ", part 2": which part of the object it is; empty if it is all of it.
std::string piece_text(std::uint32_t triangle, std::optional<std::uint32_t> part = {}) {
  if (part) return fmt::format(", part {}", *part);
  return triangle < kNoTriangle - 1 ? fmt::format(", triangle {}", triangle) : std::string();
}

std::string_view arithmetic_text(Rung rung) {
  if (rung == Rung::filter) return "in double";
  return rung == Rung::expansion ? "by expansions, since double left it open"
                                 : "by rationals, since no less decided it";
}

/// The distance, or that of a miss, with its bound.
template <class Row>
std::string far_text(const Printer& printer, const Row& row) {
  return readable_length(row.distance_m, row.error_m, printer.digits());
}

void print_answer_line(Printer& printer, const ExplainedRay& ray) {
  if (ray.verdict == Verdict::undecided)
    printer.line(fmt::format("{}: {}", printer.paint(Paint::doubt, "undecided"), name_of(ray.reason)));
  if (ray.verdict == Verdict::miss) printer.line("miss  nothing that may answer is on the ray");
  if (ray.met.empty()) return;
  const ExplainedMeeting& first = ray.met.front();
  if (ray.verdict == Verdict::hit)
    printer.line(fmt::format("hit  {}  {}", printable(first.object), far_text(printer, first)));
  printer.line(fmt::format("  decided  {}{}, a {}, {}{}", printable(first.object),
                           piece_text(first.triangle, first.part), first.kind, arithmetic_text(first.rung),
                           first.inside ? "; the ray begins in it" : ""));
}

void print_search(Printer& printer, const ExplainedRay& ray) {
  printer.line(fmt::format("  looked   {} {} of {} on the way; {} and {} for it", format_count(ray.boxes_met),
                           ray.boxes_met == 1 ? "box" : "boxes", counted(ray.objects, "object"),
                           counted(ray.nodes, "node"), counted(ray.exact_tests, "exact test")));
  if (ray.left_out_count > 0)
    printer.line(fmt::format("  filter   leaves out {}", counted(ray.left_out_count, "object")));
  for (const ExplainedMeeting& met : ray.left_out)
    printer.line(fmt::format("  left out {} at {}: {}", printable(met.object), far_text(printer, met),
                             printable(met.why_left_out)));
}

void print_behind(Printer& printer, const std::vector<ExplainedMeeting>& met) {
  constexpr std::size_t kMostNamed = 3;
  for (std::size_t i = 1; i < met.size() && i <= kMostNamed; ++i)
    printer.line(fmt::format("  behind   {} at {}", printable(met[i].object), far_text(printer, met[i])));
  if (met.size() > kMostNamed + 1) printer.line(fmt::format("           and {} more", met.size() - kMostNamed - 1));
}

void print_misses(Printer& printer, const ExplainedRay& ray) {
  for (const ExplainedMiss& miss : ray.misses) {
    std::string line = fmt::format("  {}   {} {} {}{}", miss.verdict == Verdict::undecided ? "maybe " : "passed",
                                   printable(miss.object), miss.where == WhereMissed::end ? "beyond its end by" : "by",
                                   far_text(printer, miss), piece_text(miss.triangle));
    line += miss.where == WhereMissed::start
                ? ", where it begins"
                : fmt::format(", {} along", readable_length(miss.along_m, 0, printer.digits()));
    if (!miss.box_met) line += "; its box was not met";
    if (!miss.why_left_out.empty()) line += "; " + printable(miss.why_left_out);
    printer.line(line);
  }
}

void print_doubts(Printer& printer, const ExplainedRay& ray) {
  for (const ExplainedStale& stale : ray.stale)
    printer.line(fmt::format("  stale    {} was heard of last {} before; it may be in the way from {} on",
                             printable(stale.object), format_duration(stale.age),
                             readable_length(stale.from_m, 0, printer.digits())));
  for (const std::string& name : ray.unknown)
    printer.line(fmt::format("  unknown  what is in {} is not known, and the ray meets its box", printable(name)));
  if (ray.uncovered)
    printer.line(fmt::format("  covered  up to {}: beyond, the loaded geometry is not said to be complete",
                             readable_length(ray.uncovered->covered_m, 0, printer.digits())));
  if (ray.cut) printer.line("  cut      the ray meets more than is looked at; what is behind is not all");
  if (ray.late)
    printer.line("  late     the deadline was over: nearer misses may be missing; a longer --deadline says more");
}

// ---- a standing question -------------------------------------------------------------------------------------------

/// "0.2 m deep" or "1.2 m away", with its bound.
std::string clearance_text(const Printer& printer, const ExplainedObject& object) {
  if (std::isinf(object.clearance_m)) return "how far was not looked at";
  const std::string far = readable_length(std::abs(object.clearance_m), object.error_m, printer.digits());
  if (object.verdict == Verdict::undecided) return fmt::format("undecided, {} from its border", far);
  return object.verdict == Verdict::hit ? far + " deep" : far + " away";
}

/// "  WORD     NAME  0.2 m deep"
void print_object(Printer& printer, std::string_view word, const ExplainedObject& object) {
  std::string line = fmt::format("  {:<8} {}  {}", word, printable(object.object), clearance_text(printer, object));
  if (object.reported) line += "  since " + clock_text(object.since.value_or(std::chrono::nanoseconds(0)));
  if (!object.doubt.empty()) line += fmt::format("  in doubt ({})", object.doubt);
  if (object.stale) line += "  stale";
  if (!object.why_left_out.empty()) line += "; " + printable(object.why_left_out);
  // It may have moved since the last step decided for both.
  if (word == "inside" && object.reported && object.verdict == Verdict::miss)
    line += ", by poses that are not decided yet";
  printer.line(line);
}

/// The objects that it monitors, by its globs and mask.
std::string seen_text(const ExplainedStanding& standing) {
  std::string text = standing.only.empty() ? "all that moves" : fmt::format("'{}'", printable(standing.only));
  if (!standing.skip.empty()) text += fmt::format(" but '{}'", printable(standing.skip));
  if (standing.mask != 0xffffffff) text += fmt::format(", of the layers {:#x}", standing.mask);
  return text;
}

/// Its definition, its carrier or point, and the objects that it monitors.
void print_definition(Printer& printer, const ExplainedStanding& standing) {
  const std::string name = printable(standing.name);
  if (is_of_nearest(standing)) {
    printer.line(fmt::format("{}: {} is nearest", name,
                             standing.holds.empty() ? "nothing" : printable(standing.holds.front().object)));
  } else {
    printer.line(fmt::format("{}: a {}{}, {} in it", name, standing.kind,
                             standing.to.empty() ? "" : " on " + printable(standing.to),
                             standing.holds.empty() ? "nothing" : std::to_string(standing.holds.size())));
  }
  if (!standing.placed)
    printer.line(fmt::format("  nowhere  {} is not there, so it looks at nothing", printable(standing.to)));
  const std::string seen = fmt::format("  looks at {}: {} now", seen_text(standing), standing.looked_at);
  if (!is_of_nearest(standing))
    return printer.line(fmt::format("{}; reports {}", seen, fmt::join(standing.detect, ", ")));
  const auto length = [&](double metres) { return readable_length(metres, 0, printer.digits()); };
  printer.line(fmt::format("{}, within {} of {}", seen, length(standing.within_m), target_text(standing)));
  if (standing.hysteresis_m > 0)
    printer.line(fmt::format("           another one must be nearer by {}", length(standing.hysteresis_m)));
}

Record standing_record(const ExplainedStanding& standing) {
  Record record = explanation_record(standing);
  place_of(record, "name")->name = "standing";
  place_of(record, "kind")->name = "region";
  put_null(place_of(record, "asked_for")->value);
  const bool has_nearest = is_of_nearest(standing) && !standing.holds.empty();
  const ExplainedObject* const nearest = has_nearest ? &standing.holds.front() : nullptr;
  insert_object(record, "holds", nearest, nearest ? nearest->clearance_m : 0);
  record.insert(place_of(record, "holds"), {"holds_count", std::uint64_t{standing.holds.size()}});
  // In a recording these would be the searches of the replay.
  const bool is_counted = is_of_nearest(standing) && standing.version != 0;
  place_of(record, "cut_short")->value = is_counted ? Value(standing.cut_short) : Value();
  return record;
}

// ---- an event, and two objects -------------------------------------------------------------------------------------

void print_gap(Printer& printer, std::string_view word, const std::optional<ExplainedGap>& gap) {
  if (!gap) return;
  std::string line =
      fmt::format("  {:<8} {} at {}", word, kTouchWords[static_cast<std::size_t>(gap->verdict)], clock_text(gap->time));
  if (gap->verdict != Verdict::undecided)
    line += fmt::format(", {}{}", readable_length(std::abs(gap->clearance_m), gap->error_m, printer.digits()),
                        gap->verdict == Verdict::miss ? "" : " deep");
  printer.line(line);
}

void print_body(Printer& printer, const ExplainedBody& body) {
  const std::string name = printable(body.object);
  if (!body.remembered) return printer.line(fmt::format("  object   {}: where it was then is not remembered", name));
  std::string line = fmt::format("  object   {} at {}", name, readable_point(body.pose.position, 0, printer.digits()));
  if (!body.publisher.empty()) line += ", by publisher " + printable(body.publisher);
  if (!body.moving) line += ", which stands still";
  else if (body.motion_from && body.motion_to)
    line += fmt::format(", between poses of {} and {}", clock_text(*body.motion_from), clock_text(*body.motion_to));
  else line += ", at rest";
  printer.line(line);
}

Record pair_record(const std::string& a, const std::string& b, const ExplainedPair& pair) {
  const Value none;
  const PairAnswer& now = pair.answer;
  const auto& nearest = pair.nearest;
  const auto time = [&](std::chrono::nanoseconds ExplainedApproach::*when) {
    return nearest ? Value(std::int64_t{((*nearest).*when).count()}) : none;
  };
  const auto length = [&](double ExplainedApproach::*metres) { return nearest ? Value((*nearest).*metres) : none; };
  return {{"a", a},
          {"b", b},
          {"answer", std::string_view(kTouchWords[static_cast<std::size_t>(now.verdict)])},
          {"distance", now.verdict == Verdict::miss ? Value(now.distance_m) : none},
          {"depth", now.verdict == Verdict::hit ? Value(now.depth_m) : none},
          {"error", now.verdict == Verdict::undecided ? none : Value(now.error_m)},
          {"why_not", RawJson{json_of(pair.why_not).dump()}},
          {"attached", pair.attached},
          {"end", nearest ? Value(name_of(nearest->end)) : none},
          {"from_ns", time(&ExplainedApproach::from)},
          {"to_ns", time(&ExplainedApproach::to)},
          {"time_ns", time(&ExplainedApproach::time)},
          {"nearest", length(&ExplainedApproach::distance_m)},
          {"nearest_error", length(&ExplainedApproach::error_m)},
          {"at_least", length(&ExplainedApproach::at_least_m)},
          {"stale", now.stale ? Value(true) : none},
          {"world", now.version == 0 ? none : Value(now.version)}};
}

void print_why_no_events(Printer& printer, const ExplainedPair& pair) {
  if (pair.why_not.empty()) printer.line("  events   each contact of the two is told");
  for (std::size_t i = 0; i < pair.why_not.size(); ++i)
    printer.line((i == 0 ? "  events   none: " : "           and ") + printable(pair.why_not[i]));
  if (!pair.attached.empty())
    printer.line(fmt::format("           {} moves along with the other", printable(pair.attached)));
}

void print_approach(Printer& printer, const ExplainedApproach& nearest) {
  using End = ApproachEnd;
  const std::string when = fmt::format("at {}, {} before the last that is known", clock_text(nearest.time),
                                       format_duration(nearest.to - nearest.time));
  if (nearest.end == End::touched) return printer.line(fmt::format("  nearest  they touched {}", when));
  if (nearest.end == End::undecided)
    return printer.line(fmt::format("  nearest  undecided whether they touched {}", when));
  if (std::isinf(nearest.distance_m)) return printer.line("  nearest  not looked at: the deadline was over");
  printer.line(fmt::format("  nearest  {} {}", far_text(printer, nearest), when));
  printer.line(fmt::format("           at no time of the last {} nearer than {}{}",
                           format_duration(nearest.to - nearest.from),
                           readable_length(nearest.at_least_m, 0, printer.digits()),
                           nearest.end == End::cut_short ? "; cut short, a longer --deadline says more" : ""));
}

}  // namespace

void print_explained(Printer& printer, const ExplainedRay& ray) {
  printer.set_usual_fields({"answer", "reason", "object", "distance", "error", "level", "objects", "boxes_met",
                            "left_out_count", "cut", "late"});
  if (!printer.human()) {
    Record record = explanation_record(ray);
    drop_empty(record, {"reason"});
    const ExplainedMeeting* const first = ray.met.empty() ? nullptr : &ray.met.front();
    insert_object(record, "level", first, first ? first->distance_m : 0);
    return printer.record(record);
  }
  print_answer_line(printer, ray);
  print_search(printer, ray);
  print_behind(printer, ray.met);
  print_misses(printer, ray);
  print_doubts(printer, ray);
}

void print_explained(Printer& printer, const ExplainedStanding& standing) {
  printer.set_usual_fields({"standing", "form", "region", "to", "placed", "looked_at", "holds_count", "object",
                            "distance", "error", "cut_short", "late"});
  if (!printer.human()) return printer.record(standing_record(standing));
  print_definition(printer, standing);
  const bool is_nearest = is_of_nearest(standing);
  for (const ExplainedObject& held : standing.holds) print_object(printer, is_nearest ? "nearest" : "inside", held);
  for (const ExplainedObject& other : standing.others) {
    const char* const place = other.clearance_m <= standing.within_m ? "next" : "too far";
    print_object(printer, is_nearest ? place : "outside", other);
  }
  for (const ExplainedObject& left_out : standing.left_out) print_object(printer, "left out", left_out);
  if (standing.asked_for) print_object(printer, "asked", *standing.asked_for);
  for (const ExplainedNews& news : standing.events)
    printer.line(fmt::format("  event    {} {} {}{}  seq {}", clock_text(news.high), news.what, printable(news.object),
                             news.why.empty() ? "" : fmt::format("  ({})", news.why), news.sequence));
  if (standing.cut_short > 0) {
    printer.line(
        fmt::format("  cut      {} ended at their limit: an object that came and went then may not have been "
                    "reported",
                    standing.cut_short == 1 ? "1 search" : format_count(standing.cut_short) + " searches"));
  }
  if (standing.late)
    printer.line("  late     the deadline was over: some were not looked at; a longer --deadline says more");
}

void print_explained(Printer& printer, const ExplainedEvent& event) {
  printer.set_usual_fields(
      {"sequence", "of", "what", "a", "b", "margin", "within", "why", "doubt", "low_ns", "high_ns"});
  if (!printer.human()) {
    Record record = explanation_record(event);
    drop_empty(record, {"why", "doubt"});
    return printer.record(record);
  }
  std::string head =
      fmt::format("event {}: {} {} x {}", event.sequence, event.what, printable(event.a), printable(event.b));
  if (!event.margin.empty()) head += fmt::format(", within {} m by margin {}", event.within, printable(event.margin));
  if (!event.why.empty()) head += fmt::format("  ({})", event.why);
  if (!event.doubt.empty()) head += fmt::format("  in doubt ({})", event.doubt);
  printer.line(head);
  printer.line(
      fmt::format("  when     by {}, within {}", clock_text(event.high), format_duration(event.high - event.low)));
  for (const std::string& reason : event.why_wide) printer.line("  bracket  " + printable(reason));
  print_gap(printer, "before", event.before);
  print_gap(printer, "after", event.after);
  // The second body of a standing question's event is the question.
  const std::size_t count = event.of == EventsOf::standing ? 1 : event.bodies.size();
  for (std::size_t i = 0; i < std::min(count, event.bodies.size()); ++i) print_body(printer, event.bodies[i]);
}

void print_explained(Printer& printer, const std::string& a, const std::string& b, const ExplainedPair& pair) {
  printer.set_usual_fields(
      {"a", "b", "answer", "distance", "depth", "error", "end", "nearest", "nearest_error", "at_least", "stale"});
  if (!printer.human()) return printer.record(pair_record(a, b, pair));
  const PairAnswer& now = pair.answer;
  const Digits digits = printer.digits();
  std::string line =
      fmt::format("{} and {}: {}", printable(a), printable(b), kTouchWords[static_cast<std::size_t>(now.verdict)]);
  if (now.verdict == Verdict::miss) line += ", " + readable_length(now.distance_m, now.error_m, digits);
  if (now.verdict == Verdict::hit) line += fmt::format(", {} deep", readable_length(now.depth_m, now.error_m, digits));
  printer.line(line);
  if (now.stale) printer.line("  stale    one of them is where it was heard of last, and moved then");
  print_why_no_events(printer, pair);
  if (pair.nearest) print_approach(printer, *pair.nearest);
  else printer.line("  nearest  " + printable(pair.no_nearest));
}

}  // namespace collided::cli
