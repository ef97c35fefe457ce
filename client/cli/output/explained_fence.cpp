#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "client/cli/output/clock_text.hpp"
#include "client/cli/output/explanation_output.hpp"
#include "client/cli/server_command.hpp"

namespace collided::cli {
namespace {

/// "0.2 m deep" or "1.2 m away", with its bound.
std::string standing_text(const Printer& printer, const nlohmann::json& row) {
  const double clearance_m = number_or_inf(row, "clearance");
  if (std::isinf(clearance_m)) return "how far was not looked at";
  const std::string far = readable_length(std::abs(clearance_m), number_or_inf(row, "error"), printer.digits());
  const std::string said = text_of(row, "answer");
  if (said == "undecided") return fmt::format("undecided, {} from its border", far);
  return said == "inside" ? far + " deep" : far + " away";
}

}  // namespace

std::string looked_at(const nlohmann::json& answer) {
  const std::string only = text_of(answer, "only");
  const std::string skip = text_of(answer, "skip");
  std::string text = only.empty() ? "all that moves" : fmt::format("'{}'", printable(only));
  if (!skip.empty()) text += fmt::format(" but '{}'", printable(skip));
  if (const std::uint64_t mask = count_of(answer, "mask"); mask != 0xffffffff)
    text += fmt::format(", of the layers {:#x}", mask);
  return text;
}

void print_standings(Printer& printer, std::string_view word, const nlohmann::json& rows) {
  for (const nlohmann::json& row : rows) {
    std::string line =
        fmt::format("  {:<8} {}  {}", word, printable(text_of(row, "object")), standing_text(printer, row));
    if (flag_of(row, "told")) line += "  since " + clock_text(time_at(row, "since_ns"));
    if (const std::string doubt = text_of(row, "doubt"); !doubt.empty()) line += fmt::format("  in doubt ({})", doubt);
    if (flag_of(row, "stale")) line += "  stale";
    if (const std::string why = text_of(row, "why"); !why.empty()) line += "; " + printable(why);
    // It may have moved on since the last step that was decided for both.
    if (word == "inside" && flag_of(row, "told") && text_of(row, "answer") == "outside")
      line += ", by poses that are not decided yet";
    printer.line(line);
  }
}

void print_last_events(Printer& printer, const nlohmann::json& events) {
  for (const nlohmann::json& event : events) {
    const std::string why = text_of(event, "why");
    printer.line(fmt::format("  event    {} {} {}{}  seq {}", clock_text(time_at(event, "high_ns")),
                             text_of(event, "what"), printable(text_of(event, "object")),
                             why.empty() ? "" : fmt::format("  ({})", why), count_of(event, "sequence")));
  }
}

std::vector<std::string> usual_explained_fence_fields() {
  return {"fence", "region", "to", "placed", "looked_at", "inside_count", "late"};
}

Record explained_fence_record(const nlohmann::json& answer) {
  const auto raw = [&](const char* key) { return RawJson{answer.contains(key) ? answer.at(key).dump() : "null"}; };
  return {{"fence", text_of(answer, "fence")},
          {"region", text_of(answer, "kind")},
          {"to", text_of(answer, "to")},
          {"placed", flag_of(answer, "placed")},
          {"only", text_of(answer, "only")},
          {"skip", text_of(answer, "skip")},
          {"mask", count_of(answer, "mask")},
          {"tells", raw("tells")},
          {"keep", flag_of(answer, "keep")},
          {"looked_at", count_of(answer, "looked_at")},
          {"inside_count", std::uint64_t{answer.at("inside").size()}},
          {"inside", raw("inside")},
          {"outside", raw("outside")},
          {"left_out", raw("left_out")},
          {"asked_for", raw("asked_for")},
          {"events", raw("events")},
          {"late", flag_of(answer, "late") ? Value(true) : Value(std::monostate{})},
          {"time_ns", answer.value("time_ns", std::int64_t{0})},
          {"world", count_of(answer, "version")}};
}

void print_explained_fence(Printer& printer, const nlohmann::json& answer) {
  const nlohmann::json& inside = answer.at("inside");
  printer.line(fmt::format("{}: a {}{}, {} in it", printable(text_of(answer, "fence")), text_of(answer, "kind"),
                           text_of(answer, "to").empty() ? "" : " on " + printable(text_of(answer, "to")),
                           inside.empty() ? "nothing" : std::to_string(inside.size())));
  if (!flag_of(answer, "placed"))
    printer.line(fmt::format("  nowhere  {} is not there, so it looks at nothing", printable(text_of(answer, "to"))));
  printer.line(fmt::format("  looks at {}: {} now; tells {}", looked_at(answer), count_of(answer, "looked_at"),
                           fmt::join(texts_of(answer, "tells"), ", ")));
  print_standings(printer, "inside", inside);
  print_standings(printer, "outside", answer.at("outside"));
  print_standings(printer, "left out", answer.at("left_out"));
  if (answer.contains("asked_for")) print_standings(printer, "asked", nlohmann::json::array({answer.at("asked_for")}));
  print_last_events(printer, answer.at("events"));
  if (flag_of(answer, "late"))
    printer.line("  late     the deadline was over: some were not looked at; a longer --deadline says more");
}

}  // namespace collided::cli
