#include "client/cli/output/answer_output.hpp"

#include <array>
#include <cmath>

#include <fmt/format.h>

#include "client/cli/input/number.hpp"
#include "client/cli/output/readable.hpp"

namespace collided::cli {
namespace {

std::string_view verdict_name(Verdict verdict) {
  switch (verdict) {
    case Verdict::miss: return "miss";
    case Verdict::hit: return "hit";
    case Verdict::undecided: return "undecided";
    case Verdict::invalid: break;
  }
  return "invalid";
}

bool measures_depth(QuestionKind kind) {
  return kind == QuestionKind::sphere || kind == QuestionKind::box || kind == QuestionKind::inside;
}

/// Whether the depth is 0 within its bound: the surfaces touch without overlap.
bool is_touching(const Hit& hit) { return hit.distance_m <= hit.error_m; }

Value reason_value(const Answer& answer) {
  if (answer.verdict != Verdict::undecided) return std::monostate{};
  return name_of(answer.reason);
}

/// Fills the record of one hit, or of an answer without hits (`hit` is null).
void fill_record(Record& record, const AnswerView& view, const RawJson& id, const Answer& answer, const Hit* hit,
                 std::size_t order) {
  record.clear();
  const Value none = std::monostate{};
  if (view.with_id) record.push_back({"id", id});
  record.push_back({"answer", verdict_name(answer.verdict)});
  record.push_back({"object", hit ? Value(std::string_view(hit->object)) : none});
  record.push_back({measures_depth(view.kind) ? "depth" : "distance", hit ? Value(hit->distance_m) : none});
  record.push_back({"error", hit ? Value(hit->error_m) : none});
  record.push_back({"point", hit ? MaybeVector(hit->point) : MaybeVector()});
  record.push_back({"normal", hit ? MaybeVector(hit->normal) : MaybeVector()});
  record.push_back({"triangle", hit && hit->triangle != kNoTriangle ? Value(std::uint64_t{hit->triangle}) : none});
  if (view.kind == QuestionKind::ray) {
    record.push_back({"order", hit && view.several ? Value(std::uint64_t{order}) : none});
    record.push_back({"exit", hit && hit->inside ? Value(hit->exit_m) : none});
  }
  const Value by = hit && hit->by_winding ? Value(std::string_view("winding")) : Value(true);
  record.push_back({"inside", hit && hit->inside ? by : none});
  record.push_back({"stale", hit && hit->stale ? Value(true) : none});
  record.push_back({"reason", reason_value(answer)});
  if (!measures_depth(view.kind)) record.push_back({"point_error", hit ? Value(hit->point_error_m) : none});
  const std::optional<Uncovered>& uncovered = answer.uncovered;
  if (view.kind == QuestionKind::ray) record.push_back({"covered", uncovered ? Value(uncovered->covered_m) : none});
  record.push_back({"covered_to", uncovered ? MaybeVector(uncovered->point) : MaybeVector()});
}

std::string hit_line(const Printer& printer, const AnswerView& view, const Hit& hit) {
  const bool ray = view.kind == QuestionKind::ray;
  std::string line = ray ? printer.paint(Paint::good, "hit") + "  " : std::string();
  const char* word = measures_depth(view.kind) ? "depth" : "distance";
  const Digits digits = printer.digits();
  line +=
      fmt::format("{}  {} {}  at {}", printable(hit.object), word, readable_length(hit.distance_m, hit.error_m, digits),
                  readable_point(hit.point, hit.point_error_m, digits));
  if (ray) line += "  normal " + readable_direction(hit.normal, digits);
  if (hit.triangle != kNoTriangle) line += fmt::format("  triangle {}", hit.triangle);
  if (hit.inside)
    line += ray ? "  inside, out at " + readable_length(hit.exit_m, hit.error_m, Digits::rounded) : "  inside";
  if (hit.by_winding) line += " by winding";
  if (hit.stale) line += "  stale";
  return line;
}

void contact_row(Printer& printer, const AnswerView& view, const Hit& hit) {
  std::string what = is_touching(hit) ? "touching" : "contact";
  if (view.kind == QuestionKind::inside)
    what = is_touching(hit) && std::isfinite(hit.error_m) ? "on the surface" : "inside";
  if (hit.by_winding) what = "inside by winding";
  if (hit.stale) what += " stale";
  printer.row({"OBJECT", "WHAT", "DEPTH", "CONTACT"},
              {printable(hit.object), what, readable_length(hit.distance_m, hit.error_m, printer.digits()),
               readable_point(hit.point, hit.point_error_m, printer.digits())});
}

std::string nothing_line(const Printer& printer, QuestionKind kind) {
  const std::string word = printer.paint(Paint::faint, "miss");
  switch (kind) {
    case QuestionKind::ray: return word + "  nothing along the ray";
    case QuestionKind::sphere: return word + "  nothing touches the sphere";
    case QuestionKind::box: return word + "  nothing touches the box";
    case QuestionKind::inside: return word + "  in no solid";
    case QuestionKind::near: break;
  }
  return word + "  nothing within reach";
}

std::string where_uncovered(const AnswerView& view, const Answer& answer) {
  if (!answer.uncovered) return {};
  const std::string place = ", at " + readable_point(answer.uncovered->point, 0, Digits::rounded);
  if (view.kind != QuestionKind::ray) return place;
  return place + fmt::format(" ({} on)", readable_length(answer.uncovered->covered_m, 0, Digits::rounded));
}

void print_for_people(Printer& printer, const AnswerView& view, const RawJson& id, const Answer& answer) {
  const std::string prefix = view.with_id ? id.text + "  " : std::string();
  if (answer.verdict == Verdict::undecided) {
    printer.line(fmt::format("{}{} {}{}", prefix, printer.paint(Paint::doubt, "undecided:"), explain(answer.reason),
                             where_uncovered(view, answer)));
  }
  if (answer.verdict == Verdict::invalid) printer.line(prefix + printer.paint(Paint::bad, "invalid"));
  if (answer.verdict == Verdict::miss) printer.line(prefix + nothing_line(printer, view.kind));
  if (answer.verdict == Verdict::hit && answer.hits.empty()) printer.line(prefix + printer.paint(Paint::good, "hit"));
  for (const Hit& hit : answer.hits) {
    const bool in_table = measures_depth(view.kind) && !view.with_id;
    if (in_table) contact_row(printer, view, hit);
    else printer.line(prefix + hit_line(printer, view, hit));
  }
}

void print_count(Printer& printer, const AnswerView& view, const RawJson& id, const Answer& answer) {
  Record record;
  if (view.with_id) record.push_back({"id", id});
  record.push_back({"count", std::uint64_t{answer.hits.size()}});
  // A single number, for $(collide box ... --count); an undecided answer needs its reason too.
  if (view.with_id || answer.verdict == Verdict::undecided) record.push_back({"reason", reason_value(answer)});
  if (!printer.human()) {
    printer.record(record);
    return;
  }
  std::string line = view.with_id ? id.text + "  " : std::string();
  line += std::to_string(answer.hits.size());
  if (answer.verdict == Verdict::undecided) line += fmt::format("  at least; {}", explain(answer.reason));
  printer.line(line);
}

}  // namespace

void print_answer(Printer& printer, const AnswerView& view, const RawJson& id, const Answer& answer) {
  if (view.count_only) {
    print_count(printer, view, id, answer);
    return;
  }
  if (printer.human()) {
    print_for_people(printer, view, id, answer);
    return;
  }
  static thread_local Record record;
  if (answer.hits.empty()) {
    fill_record(record, view, id, answer, nullptr, 0);
    printer.record(record);
  }
  for (std::size_t order = 0; order < answer.hits.size(); ++order) {
    fill_record(record, view, id, answer, &answer.hits[order], order);
    printer.record(record);
  }
}

void print_refused(Printer& printer, const AnswerView& view, const RawJson& id, std::size_t line) {
  Answer answer;
  answer.verdict = Verdict::invalid;
  if (printer.human()) {
    printer.line(fmt::format("{}  {} (line {})", id.text, printer.paint(Paint::bad, "invalid"), line));
    return;
  }
  print_answer(printer, view, id, answer);
}

Exit exit_of(const Answer& answer) {
  switch (answer.verdict) {
    case Verdict::hit: return Exit::yes;
    case Verdict::miss: return Exit::no;
    case Verdict::undecided: return Exit::undecided;
    case Verdict::invalid: break;
  }
  return Exit::refused;
}

std::string_view explain(UndecidedReason reason) {
  switch (reason) {
    case UndecidedReason::none: return "the server gave no reason";
    case UndecidedReason::numeric: return "numeric; both answers are consistent with the input";
    case UndecidedReason::stale_object: return "stale_object; an object that decides has not been heard of lately";
    case UndecidedReason::recovering: return "recovering; the server has not yet heard of every object";
    case UndecidedReason::truncated: return "truncated; there is more than the answer may hold (--max-hits)";
    case UndecidedReason::not_covered: return "not_covered; it reaches out of what the server's geometry covers";
    case UndecidedReason::deadline: break;
  }
  return "deadline; the server had no time left (--deadline)";
}

std::string cost_line(const Answers& answers, const Answer& answer) {
  std::string line = fmt::format("     {}: {} nodes, {} exact tests", format_duration(answers.compute),
                                 answer.cost.nodes, answer.cost.exact_tests);
  // Answers of several shards have no version.
  line += answers.epoch == 0 ? std::string("; all shards") : fmt::format("; world {}", answers.version);
  if (answers.oldest_pose_age) line += fmt::format(", poses {} old", format_duration(*answers.oldest_pose_age));
  return line;
}

}  // namespace collided::cli
