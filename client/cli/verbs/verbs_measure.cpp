#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <limits>
#include <span>

#include "client/cli/command.hpp"
#include "client/cli/input/menu_questions.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/input/option.hpp"
#include "client/cli/server_command.hpp"
#include "idl/commands.hpp"

namespace collided::cli {
namespace {

namespace wire = wire_contract::command;

std::vector<nlohmann::json> rows_of(const nlohmann::json& answer, const char* key) {
  const nlohmann::json rows = answer.value(key, nlohmann::json::array());
  return {rows.begin(), rows.end()};
}

/// A member that is a number or, for infinity, a text.
double number_or_infinity(const nlohmann::json& row, const char* key) {
  return text_of(row, key) == "inf" ? std::numeric_limits<double>::infinity() : number_of(row, key);
}

/// The counts of FCL's opinions, such as "298 agree, 1 differ"; empty where FCL was not asked.
std::string opinion(const nlohmann::json& row) {
  std::string words;
  const nlohmann::json counts = row.value("opinion", nlohmann::json::object());
  for (const char* verdict : {"agree", "differ", "failed", "unsupported"}) {
    const std::uint64_t count = count_of(counts, verdict);
    if (count > 0) words += fmt::format("{}{} {}", words.empty() ? "" : ", ", format_count(count), verdict);
  }
  return words;
}

class MenuCommand : public Command {
 public:
  void declare(CLI::App& app) override {
    option(app, "--questions", questions_, "Of each kind (1000)");
    read_option(app, "--seed N", seed_, "Of the random questions (1)",
                [](const std::string& text) { return parse_count(text); });
    option(app, "--from FILE", from_,
           "Your own questions instead: a file, or - for stdin, in any form of a batch (collide help ray)");
    option(app, "--opinion WHOSE", opinion_,
           "Ask another library about the pairs too: fcl, run by the server in processes of its own");
    option(app, "--of KIND", of_, "What they are: ray, sphere, box, near");
    option(app, "--deadline", deadline_, "Ends with what there is by then: 2s");
  }

  Exit run(Session& session, const Globals& globals) override {
    const nlohmann::json answer =
        from_.empty() && of_.empty() ? ask_random(session, globals) : ask_own(session, globals);
    const std::vector<nlohmann::json> rows = rows_of(answer, "rows");
    Printer printer = make_printer(session.io, globals);
    for (const nlohmann::json& row : rows) print(printer, row, !opinion_.empty());
    printer.finish();
    const bool is_late = answer.value("late", false);
    if (is_late) print_hint(session.io, globals, "the deadline was over before all questions were asked");
    else if (rows.empty()) print_hint(session.io, globals, "the world is empty: nothing to price");
    if (std::any_of(rows.begin(), rows.end(),
                    [](const nlohmann::json& row) { return judged_of(row) < count_of(row, "asked"); })) {
      print_hint(
          session.io, globals,
          "'7 of 400' wrong: the exact comparison had time for 400 of the questions, the others were only timed");
    }
    return rows.empty() ? Exit::no : Exit::yes;
  }

 private:
  nlohmann::json ask_random(Session& session, const Globals& globals) const {
    nlohmann::json arguments{{"questions", questions_}, {"seed", seed_}};
    if (!opinion_.empty()) arguments["opinion"] = opinion_;
    limit(arguments);
    return server_command(session, globals, wire::kMenu, arguments);
  }
  void limit(nlohmann::json& arguments) const {
    if (deadline_) arguments["deadline_ns"] = deadline_->count();
  }
  nlohmann::json ask_own(Session& session, const Globals& globals) const {
    static constexpr std::array<std::string_view, 4> kKinds{"ray", "sphere", "box", "near"};
    const auto kind = std::find(kKinds.begin(), kKinds.end(), of_);
    if (from_.empty() || kind == kKinds.end()) {
      throw bad_use("your own questions take --from FILE and --of ray, sphere, box or near",
                    "collide menu --from rays.csv --of ray");
    }
    const auto number = static_cast<QuestionKind>(kind - kKinds.begin());
    const std::vector<double> numbers = read_menu_questions(from_, number, session.io.in);
    nlohmann::json arguments{{"of", of_}};
    limit(arguments);
    return server_command_with_bytes(session, globals, wire::kMenu, arguments, std::as_bytes(std::span(numbers)));
  }

  static std::string length(double metres) {
    return std::isfinite(metres) ? format_bound(metres) + (metres == 0 ? "" : " m") : "none";
  }
  static std::string duration(const nlohmann::json& row, const char* key) {
    return format_duration(std::chrono::nanoseconds(count_of(row, key)));
  }

  /// How many questions were compared with rationals; all of them, where the server does not say.
  static std::uint64_t judged_of(const nlohmann::json& row) {
    return row.contains("judged") ? count_of(row, "judged") : count_of(row, "asked");
  }
  static std::string wrong(const nlohmann::json& row) {
    const std::string count = format_count(count_of(row, "wrong"));
    return judged_of(row) < count_of(row, "asked") ? fmt::format("{} of {}", count, format_count(judged_of(row)))
                                                   : count;
  }

  static void print(Printer& printer, const nlohmann::json& row, bool with_opinion) {
    const double error = number_or_infinity(row, "worst_error");
    const double bound = number_or_infinity(row, "worst_bound");
    if (printer.human()) {
      std::vector<std::string> heads{"ASKED", "METHOD", "WORST ERROR", "BOUND", "P50", "P99", "UNDECIDED", "WRONG"};
      std::vector<std::string> cells{text_of(row, "kind"),
                                     text_of(row, "method"),
                                     length(error),
                                     length(bound),
                                     duration(row, "p50_ns"),
                                     duration(row, "p99_ns"),
                                     format_count(count_of(row, "undecided")),
                                     wrong(row)};
      if (with_opinion) heads.emplace_back("FCL");
      if (with_opinion) cells.push_back(opinion(row));
      printer.row(heads, cells);
      return;
    }
    Record record{{"kind", text_of(row, "kind")},
                  {"method", text_of(row, "method")},
                  {"worst_error", error},
                  {"worst_bound", bound},
                  {"p50_ns", count_of(row, "p50_ns")},
                  {"p99_ns", count_of(row, "p99_ns")},
                  {"asked", count_of(row, "asked")},
                  {"undecided", count_of(row, "undecided")},
                  {"wrong", count_of(row, "wrong")},
                  {"judged", judged_of(row)}};
    const nlohmann::json counts = row.value("opinion", nlohmann::json::object());
    if (with_opinion) {
      for (const char* verdict : {"agree", "differ", "failed", "unsupported"})
        record.push_back({verdict, count_of(counts, verdict)});
    }
    printer.record(record);
  }

  std::uint64_t questions_ = 1000;
  std::uint64_t seed_ = 1;
  std::string from_;
  std::string of_;
  std::string opinion_;
  std::optional<std::chrono::nanoseconds> deadline_;
};

class AuditCommand : public Command {
 public:
  void declare(CLI::App&) override {}

  Exit run(Session& session, const Globals& globals) override {
    const nlohmann::json answer = server_command(session, globals, wire::kAudit, nlohmann::json::object());
    Printer printer = make_printer(session.io, globals);
    if (printer.human()) print_text(printer, answer);
    else printer.record(record(answer));
    printer.finish();
    if (count_of(answer, "every") == 0) {
      print_hint(session.io, globals,
                 "this server audits nothing; 'collided --audit 1/1000' works one answer in 1 000 out again");
    }
    return count_of(answer, "differing") == 0 ? Exit::yes : Exit::no;
  }

 private:
  static void print_text(Printer& printer, const nlohmann::json& answer) {
    const std::uint64_t differing = count_of(answer, "differing");
    const std::string differ = fmt::format("{} differ", format_count(differing));
    printer.line(fmt::format("since start {} re-asked, {}", format_count(count_of(answer, "audited")),
                             printer.paint(differing == 0 ? Paint::good : Paint::bad, differ)));
    if (const std::uint64_t skipped = count_of(answer, "skipped"); skipped > 0) {
      printer.line(fmt::format("{} more were chosen while the auditor was behind", format_count(skipped)));
    }
    if (const std::string words = opinion(answer); !words.empty()) printer.line("FCL: " + words);
    if (const std::uint64_t repairs = count_of(answer, "float_repairs"); repairs > 0) {
      printer.line(fmt::format("{} threads had their floating-point settings set back", format_count(repairs)));
    }
    for (const std::string& difference : texts_of(answer, "differences")) printer.line("  " + printable(difference));
    for (const nlohmann::json& row : rows_of(answer, "questions")) {
      printer.row({"ASKED", "DOUBLE", "EXPANSION", "RATIONAL"},
                  {text_of(row, "kind"), format_count(count_of(row, "double")),
                   format_count(count_of(row, "expansion")), format_count(count_of(row, "rational"))});
    }
  }

  static Record record(const nlohmann::json& answer) {
    const auto text = [&](const char* key) {
      return RawJson{
          answer.value(key, nlohmann::json::array()).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)};
    };
    Record record{{"every", count_of(answer, "every")},     {"chosen", count_of(answer, "chosen")},
                  {"audited", count_of(answer, "audited")}, {"differing", count_of(answer, "differing")},
                  {"skipped", count_of(answer, "skipped")}, {"float_repairs", count_of(answer, "float_repairs")},
                  {"questions", text("questions")},         {"differences", text("differences")}};
    const nlohmann::json counts = answer.value("opinion", nlohmann::json::object());
    for (const char* verdict : {"agree", "differ", "failed", "unsupported"}) {
      if (!counts.empty()) record.push_back({verdict, count_of(counts, verdict)});
    }
    return record;
  }
};

}  // namespace

std::unique_ptr<Command> make_menu() { return std::make_unique<MenuCommand>(); }
std::unique_ptr<Command> make_audit() { return std::make_unique<AuditCommand>(); }

}  // namespace collided::cli
