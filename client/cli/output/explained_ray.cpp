#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "client/cli/input/number.hpp"
#include "client/cli/output/explanation_output.hpp"
#include "client/cli/server_command.hpp"

namespace collided::cli {
namespace {

constexpr std::uint64_t kNoPart = ~std::uint64_t{0};
constexpr std::uint64_t kOfNoTriangle = 0xffffffff;

std::string length(const Printer& printer, const nlohmann::json& row, const char* key) {
  return readable_length(number_or_inf(row, key), row.contains("error") ? number_or_inf(row, "error") : 0,
                         printer.digits());
}

/// ", triangle 7" or ", part 2": what of the object it is; empty where it is all of it.
std::string piece_of(const nlohmann::json& row) {
  if (const std::uint64_t part = row.value("part", kNoPart); part != kNoPart) return fmt::format(", part {}", part);
  const std::uint64_t triangle = row.value("triangle", kOfNoTriangle);
  return triangle < kOfNoTriangle - 1 ? fmt::format(", triangle {}", triangle) : std::string();
}

std::string_view arithmetic_of(const nlohmann::json& row) {
  const std::string level = text_of(row, "level");
  if (level == "double") return "in double";
  return level == "expansion" ? "by expansions, since double left it open" : "by rationals, since no less decided it";
}

void print_answer_line(Printer& printer, const nlohmann::json& answer) {
  const std::string said = text_of(answer, "answer");
  const nlohmann::json& met = answer.at("met");
  if (said == "undecided")
    printer.line(fmt::format("{}: {}", printer.paint(Paint::doubt, "undecided"), text_of(answer, "reason")));
  if (said == "miss") printer.line("miss  nothing that may answer is on the ray");
  if (met.empty()) return;
  const nlohmann::json& first = met.front();
  if (said == "hit")
    printer.line(fmt::format("hit  {}  {}", printable(text_of(first, "object")), length(printer, first, "distance")));
  printer.line(fmt::format("  decided  {}{}, a {}, {}{}", printable(text_of(first, "object")), piece_of(first),
                           text_of(first, "kind"), arithmetic_of(first),
                           flag_of(first, "inside") ? "; the ray begins in it" : ""));
}

void print_looked_at(Printer& printer, const nlohmann::json& answer) {
  const std::uint64_t boxes = count_of(answer, "boxes_met");
  printer.line(fmt::format("  looked   {} {} of {} on the way; {} and {} for it", format_count(boxes),
                           boxes == 1 ? "box" : "boxes", counted(count_of(answer, "objects"), "object"),
                           counted(count_of(answer, "nodes"), "node"),
                           counted(count_of(answer, "exact_tests"), "exact test")));
  const std::uint64_t left_out = count_of(answer, "left_out_count");
  if (left_out > 0) printer.line(fmt::format("  filter   leaves out {}", counted(left_out, "object")));
  for (const nlohmann::json& row : answer.at("left_out"))
    printer.line(fmt::format("  left out {} at {}: {}", printable(text_of(row, "object")),
                             length(printer, row, "distance"), printable(text_of(row, "why"))));
}

void print_behind(Printer& printer, const nlohmann::json& answer) {
  constexpr std::size_t kMostNamed = 3;
  const nlohmann::json& met = answer.at("met");
  for (std::size_t i = 1; i < met.size() && i <= kMostNamed; ++i)
    printer.line(
        fmt::format("  behind   {} at {}", printable(text_of(met[i], "object")), length(printer, met[i], "distance")));
  if (met.size() > kMostNamed + 1) printer.line(fmt::format("           and {} more", met.size() - kMostNamed - 1));
}

void print_misses(Printer& printer, const nlohmann::json& answer) {
  for (const nlohmann::json& row : answer.at("misses")) {
    const std::string where = text_of(row, "where");
    std::string line = fmt::format("  {}   {} {} {}{}", text_of(row, "answer") == "undecided" ? "maybe " : "passed",
                                   printable(text_of(row, "object")), where == "end" ? "beyond its end by" : "by",
                                   length(printer, row, "distance"), piece_of(row));
    line += where == "start" ? ", where it begins"
                             : fmt::format(", {} along", readable_length(number_of(row, "along"), 0, printer.digits()));
    if (!flag_of(row, "box_met")) line += "; its box was not met";
    if (const std::string why = text_of(row, "why"); !why.empty()) line += "; " + printable(why);
    printer.line(line);
  }
}

void print_doubts(Printer& printer, const nlohmann::json& answer) {
  for (const nlohmann::json& row : answer.at("stale"))
    printer.line(fmt::format("  stale    {} was heard of last {} before; it may be in the way from {} on",
                             printable(text_of(row, "object")),
                             format_duration(std::chrono::nanoseconds(row.at("age_ns").get<std::int64_t>())),
                             readable_length(number_of(row, "from"), 0, printer.digits())));
  for (const std::string& name : texts_of(answer, "unknown"))
    printer.line(fmt::format("  unknown  what is in {} is not known, and the ray meets its box", printable(name)));
  if (const auto leaving = answer.find("not_covered"); leaving != answer.end())
    printer.line(fmt::format("  covered  up to {}: beyond, the loaded geometry is not said to be complete",
                             readable_length(number_or_inf(*leaving, "covered"), 0, printer.digits())));
  if (flag_of(answer, "cut"))
    printer.line("  cut      the ray meets more than is looked at; what is behind is not all");
  if (flag_of(answer, "late"))
    printer.line("  late     the deadline was over: nearer misses may be missing; a longer --deadline says more");
}

}  // namespace

std::chrono::nanoseconds time_at(const nlohmann::json& row, const char* key) {
  return std::chrono::nanoseconds(row.value(key, std::int64_t{0}));
}

double number_or_inf(const nlohmann::json& answer, const char* key) {
  const nlohmann::json& value = answer.at(key);
  return value.is_number() ? value.get<double>() : std::numeric_limits<double>::infinity();
}

Value version_of(const nlohmann::json& answer) {
  return answer.contains("version") ? Value(count_of(answer, "version")) : Value(std::monostate{});
}

std::vector<std::string> usual_explained_ray_fields() {
  return {"answer",  "reason",    "object",         "distance", "error", "level",
          "objects", "boxes_met", "left_out_count", "cut",      "late"};
}

Record explained_ray_record(const nlohmann::json& answer) {
  const Value none = std::monostate{};
  const nlohmann::json& met = answer.at("met");
  const bool is_hit = !met.empty();
  const auto raw = [&](const char* key) { return RawJson{answer.contains(key) ? answer.at(key).dump() : "null"}; };
  return {{"answer", text_of(answer, "answer")},
          {"reason", text_of(answer, "reason").empty() ? none : Value(text_of(answer, "reason"))},
          {"object", is_hit ? Value(text_of(met.front(), "object")) : none},
          {"distance", is_hit ? Value(number_of(met.front(), "distance")) : none},
          {"error", is_hit ? Value(number_or_inf(met.front(), "error")) : none},
          {"level", text_of(answer, "level")},
          {"boxes_met", count_of(answer, "boxes_met")},
          {"objects", count_of(answer, "objects")},
          {"nodes", count_of(answer, "nodes")},
          {"exact_tests", count_of(answer, "exact_tests")},
          {"left_out_count", count_of(answer, "left_out_count")},
          {"met", raw("met")},
          {"left_out", raw("left_out")},
          {"misses", raw("misses")},
          {"stale", raw("stale")},
          {"unknown", raw("unknown")},
          {"not_covered", answer.contains("not_covered") ? Value(raw("not_covered")) : none},
          {"cut", flag_of(answer, "cut") ? Value(true) : none},
          {"late", flag_of(answer, "late") ? Value(true) : none},
          {"time_ns", answer.value("time_ns", std::int64_t{0})},
          {"world", version_of(answer)}};
}

void print_explained_ray(Printer& printer, const nlohmann::json& answer) {
  print_answer_line(printer, answer);
  print_looked_at(printer, answer);
  print_behind(printer, answer);
  print_misses(printer, answer);
  print_doubts(printer, answer);
}

}  // namespace collided::cli
