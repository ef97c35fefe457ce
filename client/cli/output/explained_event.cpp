#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "client/cli/input/number.hpp"
#include "client/cli/output/clock_text.hpp"
#include "client/cli/output/explanation_output.hpp"
#include "client/cli/server_command.hpp"

namespace collided::cli {
namespace {

void print_gap(Printer& printer, std::string_view word, const nlohmann::json& answer, const char* key) {
  const auto gap = answer.find(key);
  if (gap == answer.end()) return;
  const std::string said = text_of(*gap, "answer");
  const double clearance_m = number_or_inf(*gap, "clearance");
  std::string line = fmt::format("  {:<8} {} at {}", word, said, clock_text(time_at(*gap, "time_ns")));
  if (said != "undecided")
    line +=
        fmt::format(", {}{}", readable_length(std::abs(clearance_m), number_or_inf(*gap, "error"), printer.digits()),
                    said == "apart" ? "" : " deep");
  printer.line(line);
}

void print_body(Printer& printer, const nlohmann::json& body) {
  const std::string name = printable(text_of(body, "object"));
  if (!flag_of(body, "remembered"))
    return printer.line(fmt::format("  object   {}: where it was then is not remembered", name));
  const std::vector<double> pose = numbers_of(body, "pose");
  const std::string publisher = text_of(body, "publisher");
  std::string line = fmt::format("  object   {} at {}", name,
                                 readable_point({pose.at(0), pose.at(1), pose.at(2)}, 0, printer.digits()));
  if (!publisher.empty()) line += ", by publisher " + printable(publisher);
  if (!flag_of(body, "moving")) line += ", which stands still";
  else if (body.contains("motion_to_ns"))
    line += fmt::format(", between poses of {} and {}", clock_text(time_at(body, "motion_from_ns")),
                        clock_text(time_at(body, "motion_to_ns")));
  else line += ", at rest";
  printer.line(line);
}

}  // namespace

std::vector<std::string> usual_explained_event_fields() {
  return {"sequence", "of", "what", "a", "b", "margin", "within", "why", "doubt", "low_ns", "high_ns"};
}

Record explained_event_record(const nlohmann::json& answer) {
  const Value none = std::monostate{};
  const auto text_or_none = [&](const char* key) {
    return text_of(answer, key).empty() ? none : Value(text_of(answer, key));
  };
  const auto raw = [&](const char* key) { return answer.contains(key) ? Value(RawJson{answer.at(key).dump()}) : none; };
  Record record{{"sequence", count_of(answer, "sequence")},
                {"of", text_of(answer, "of")},
                {"what", text_of(answer, "what")},
                {"a", text_of(answer, "a")},
                {"b", text_of(answer, "b")},
                {"margin", text_or_none("margin")},
                {"within", text_or_none("within")},
                {"why", text_or_none("why")},
                {"doubt", text_or_none("doubt")},
                {"depth", number_of(answer, "depth")},
                {"error", number_or_inf(answer, "error")}};
  for (const char* key : {"low_ns", "high_ns", "world_time_ns"})
    record.push_back({key, answer.value(key, std::int64_t{0})});
  for (const char* key : {"point", "normal", "bodies", "before", "after", "why_wide"})
    record.push_back({key, raw(key)});
  record.push_back({"episode", count_of(answer, "episode")});
  record.push_back({"world", version_of(answer)});
  return record;
}

void print_explained_event(Printer& printer, const nlohmann::json& answer) {
  const std::string why = text_of(answer, "why");
  std::string head = fmt::format("event {}: {} {} x {}", count_of(answer, "sequence"), text_of(answer, "what"),
                                 printable(text_of(answer, "a")), printable(text_of(answer, "b")));
  if (const std::string margin = text_of(answer, "margin"); !margin.empty())
    head += fmt::format(", within {} m by margin {}", text_of(answer, "within"), printable(margin));
  if (!why.empty()) head += fmt::format("  ({})", why);
  if (const std::string doubt = text_of(answer, "doubt"); !doubt.empty()) head += fmt::format("  in doubt ({})", doubt);
  printer.line(head);
  printer.line(fmt::format("  when     by {}, within {}", clock_text(time_at(answer, "high_ns")),
                           format_duration(time_at(answer, "high_ns") - time_at(answer, "low_ns"))));
  for (const std::string& reason : texts_of(answer, "why_wide")) printer.line("  bracket  " + printable(reason));
  print_gap(printer, "before", answer, "before");
  print_gap(printer, "after", answer, "after");
  const nlohmann::json& bodies = answer.at("bodies");
  // The second of a fence's event is the fence.
  const std::size_t count = text_of(answer, "of") == "fences" ? 1 : bodies.size();
  for (std::size_t i = 0; i < std::min(count, bodies.size()); ++i) print_body(printer, bodies[i]);
}

}  // namespace collided::cli
