#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "client/cli/command.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/output/clock_text.hpp"
#include "client/cli/output/readable.hpp"
#include "client/cli/server_command.hpp"
#include "idl/commands.hpp"

namespace collided::cli {
namespace {

/// Numbers that the server writes as "inf" where they are.
double number_or_inf(const nlohmann::json& answer, const char* key) {
  const nlohmann::json& value = answer.at(key);
  return value.is_string() ? std::numeric_limits<double>::infinity() : value.get<double>();
}

std::chrono::nanoseconds time_of(const nlohmann::json& answer, const char* key) {
  return std::chrono::nanoseconds(answer.at(key).get<std::int64_t>());
}

/// What the two are now, in a word.
std::string_view now_of(const nlohmann::json& answer) {
  const std::string said = text_of(answer, "answer");
  if (said == "hit") return "touching";
  return said == "miss" ? "apart" : "undecided";
}

class ExplainCommand : public Command {
 public:
  void declare(CLI::App& app) override {
    app.add_option("words", words_, "pair, and the two objects");
    app.add_option("--last", last_, "How far back their paths are looked at: 5s (as far as poses are remembered)");
    app.add_option("--deadline", deadline_, "What takes longer ends with what was found by then: 100ms");
  }

  Exit run(Session& session, const Globals& globals) override {
    if (words_.size() != 3 || words_[0] != "pair")
      throw bad_use("what is to be explained? a pair, and two names", "collide explain pair drone tower");
    nlohmann::json arguments{{"a", words_[1]}, {"b", words_[2]}};
    if (!last_.empty()) arguments["last_ns"] = parse_duration(last_).count();
    // The search ends before this side stops waiting for it.
    constexpr std::chrono::seconds kPatience{10};
    arguments["deadline_ns"] =
        (deadline_.empty() ? timeout_of(globals, kPatience) * 9 / 10 : parse_duration(deadline_)).count();
    const nlohmann::json answer = ask(session, globals, arguments);
    Printer printer = make_printer(session.io, globals);
    if (printer.human()) print_text(printer, answer);
    else printer.record(record_of(answer));
    const std::string_view now = now_of(answer);
    if (now == "undecided") return Exit::undecided;
    return now == "touching" ? Exit::yes : Exit::no;
  }

 private:
  nlohmann::json ask(Session& session, const Globals& globals, const nlohmann::json& arguments) const {
    try {
      return server_command(session, globals, wire_contract::command::kExplain, arguments);
    } catch (const Failure&) {
      for (const char* name : {"a", "b"}) {
        if (const auto unknown = unknown_object(session, globals, arguments.at(name))) throw Failure(*unknown);
      }
      throw;
    }
  }

  Record record_of(const nlohmann::json& answer) const {
    const Value none = std::monostate{};
    const std::string_view now = now_of(answer);
    Record record{{"a", words_[1]},
                  {"b", words_[2]},
                  {"answer", now},
                  {"distance", now == "apart" ? Value(number_or_inf(answer, "distance")) : none},
                  {"depth", now == "touching" ? Value(number_or_inf(answer, "depth")) : none},
                  {"error", now == "undecided" ? none : Value(number_or_inf(answer, "error"))},
                  {"why_not", RawJson{answer.at("why_not").dump()}},
                  {"attached", text_of(answer, "attached")}};
    const auto nearest = answer.find("nearest");
    const bool is_known = nearest != answer.end();
    record.push_back({"end", is_known ? Value(text_of(*nearest, "end")) : none});
    for (const char* key : {"from_ns", "to_ns", "time_ns"})
      record.push_back({key, is_known ? Value(nearest->at(key).get<std::int64_t>()) : none});
    record.push_back({"nearest", is_known ? Value(number_or_inf(*nearest, "distance")) : none});
    record.push_back({"nearest_error", is_known ? Value(number_or_inf(*nearest, "error")) : none});
    record.push_back({"at_least", is_known ? Value(number_or_inf(*nearest, "at_least")) : none});
    record.push_back({"stale", answer.value("stale", false) ? Value(true) : none});
    record.push_back({"world", count_of(answer, "version")});
    return record;
  }

  void print_text(Printer& printer, const nlohmann::json& answer) const {
    const std::string_view now = now_of(answer);
    const Digits digits = printer.digits();
    std::string line = fmt::format("{} and {}: {}", printable(words_[1]), printable(words_[2]), now);
    if (now == "apart")
      line += ", " + readable_length(number_or_inf(answer, "distance"), number_or_inf(answer, "error"), digits);
    if (now == "touching")
      line += fmt::format(", {} deep",
                          readable_length(number_or_inf(answer, "depth"), number_or_inf(answer, "error"), digits));
    printer.line(line);
    if (answer.value("stale", false))
      printer.line("  stale    one of them is where it was heard of last, and moved then");
    print_events(printer, answer);
    if (answer.contains("nearest")) print_nearest(printer, answer.at("nearest"));
    else printer.line("  nearest  " + printable(text_of(answer, "no_nearest")));
  }

  static void print_events(Printer& printer, const nlohmann::json& answer) {
    const std::vector<std::string> why = texts_of(answer, "why_not");
    if (why.empty()) printer.line("  events   each contact of the two is told");
    for (std::size_t i = 0; i < why.size(); ++i)
      printer.line((i == 0 ? "  events   none: " : "           and ") + printable(why[i]));
    if (const std::string child = text_of(answer, "attached"); !child.empty())
      printer.line(fmt::format("           {} moves along with the other", printable(child)));
  }

  static void print_nearest(Printer& printer, const nlohmann::json& nearest) {
    const std::string end = text_of(nearest, "end");
    const auto to = time_of(nearest, "to_ns");
    const std::chrono::duration<double> stretch = to - time_of(nearest, "from_ns");
    const std::chrono::nanoseconds ago = to - time_of(nearest, "time_ns");
    const std::string when = fmt::format("at {}, {} before the last that is known",
                                         clock_text(time_of(nearest, "time_ns")), format_duration(ago));
    const std::string within = format_duration(std::chrono::duration_cast<std::chrono::nanoseconds>(stretch));
    if (end == "touched") return printer.line(fmt::format("  nearest  they touched {}", when));
    if (end == "undecided") return printer.line(fmt::format("  nearest  undecided whether they touched {}", when));
    const Digits digits = printer.digits();
    if (std::isinf(number_or_inf(nearest, "distance")))
      return printer.line("  nearest  not looked at: the deadline was over");
    printer.line(fmt::format(
        "  nearest  {} {}",
        readable_length(number_or_inf(nearest, "distance"), number_or_inf(nearest, "error"), digits), when));
    printer.line(fmt::format("           at no time of the last {} nearer than {}{}", within,
                             readable_length(number_or_inf(nearest, "at_least"), 0, digits),
                             end == "cut_short" ? "; cut short, a longer --deadline says more" : ""));
  }

  std::vector<std::string> words_;
  std::string last_;
  std::string deadline_;
};

}  // namespace

std::unique_ptr<Command> make_explain() { return std::make_unique<ExplainCommand>(); }

}  // namespace collided::cli
