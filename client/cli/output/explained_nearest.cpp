#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "client/cli/input/number.hpp"
#include "client/cli/output/explanation_output.hpp"
#include "client/cli/server_command.hpp"

namespace collided::cli {
namespace {

/// What the distances are to: an object, or a point.
std::string of_text(const nlohmann::json& answer) {
  const std::string to = text_of(answer, "to");
  if (!to.empty()) return printable(to);
  const std::vector<double> point = numbers_of(answer, "point");
  if (point.size() < 3) return "nothing";
  return fmt::format("{} {} {}", format_number(point[0]), format_number(point[1]), format_number(point[2]));
}

/// Others within the distance that was asked about, or beyond it.
nlohmann::json others(const nlohmann::json& answer, bool are_within) {
  nlohmann::json rows = nlohmann::json::array();
  for (const nlohmann::json& row : answer.at("others")) {
    if ((number_or_inf(row, "clearance") <= number_of(answer, "within")) == are_within) rows.push_back(row);
  }
  return rows;
}

}  // namespace

std::vector<std::string> usual_explained_nearest_fields() {
  return {"nearest", "of", "only", "within", "placed", "looked_at", "object", "distance", "error", "cut_short", "late"};
}

Record explained_nearest_record(const nlohmann::json& answer) {
  const Value none = std::monostate{};
  const nlohmann::json& is = answer.at("is");
  const auto raw = [&](const char* key) { return RawJson{answer.contains(key) ? answer.at(key).dump() : "null"}; };
  return {{"nearest", text_of(answer, "nearest")},
          {"of", of_text(answer)},
          {"placed", flag_of(answer, "placed")},
          {"only", text_of(answer, "only")},
          {"skip", text_of(answer, "skip")},
          {"mask", count_of(answer, "mask")},
          {"within", number_of(answer, "within")},
          {"hysteresis", number_of(answer, "hysteresis")},
          {"keep", flag_of(answer, "keep")},
          {"looked_at", count_of(answer, "looked_at")},
          {"object", is.empty() ? none : Value(text_of(is.front(), "object"))},
          {"distance", is.empty() ? none : Value(number_or_inf(is.front(), "clearance"))},
          {"error", is.empty() ? none : Value(number_or_inf(is.front(), "error"))},
          {"is", raw("is")},
          {"others", raw("others")},
          {"left_out", raw("left_out")},
          {"asked_for", raw("asked_for")},
          {"events", raw("events")},
          {"cut_short", answer.contains("cut_short") ? Value(count_of(answer, "cut_short")) : none},
          {"late", flag_of(answer, "late") ? Value(true) : none},
          {"time_ns", answer.value("time_ns", std::int64_t{0})},
          {"world", version_of(answer)}};
}

void print_explained_nearest(Printer& printer, const nlohmann::json& answer) {
  const nlohmann::json& is = answer.at("is");
  printer.line(fmt::format("{}: {} is nearest", printable(text_of(answer, "nearest")),
                           is.empty() ? "nothing" : printable(text_of(is.front(), "object"))));
  if (!flag_of(answer, "placed"))
    printer.line(fmt::format("  nowhere  {} is not there, so it looks at nothing", of_text(answer)));
  printer.line(fmt::format("  looks at {}: {} now, within {} of {}", looked_at(answer), count_of(answer, "looked_at"),
                           readable_length(number_of(answer, "within"), 0, printer.digits()), of_text(answer)));
  if (const double hysteresis_m = number_of(answer, "hysteresis"); hysteresis_m > 0)
    printer.line(
        fmt::format("           another one must be nearer by {}", readable_length(hysteresis_m, 0, printer.digits())));
  print_standings(printer, "nearest", is);
  print_standings(printer, "next", others(answer, true));
  print_standings(printer, "too far", others(answer, false));
  print_standings(printer, "left out", answer.at("left_out"));
  if (answer.contains("asked_for")) print_standings(printer, "asked", nlohmann::json::array({answer.at("asked_for")}));
  print_last_events(printer, answer.at("events"));
  if (const std::uint64_t count = count_of(answer, "cut_short"); count > 0) {
    printer.line(fmt::format("  cut      {} ended at their limit: who came and went then may not have been told",
                             count == 1 ? "1 search" : format_count(count) + " searches"));
  }
  if (flag_of(answer, "late"))
    printer.line("  late     the deadline was over: some were not looked at; a longer --deadline says more");
}

}  // namespace collided::cli
