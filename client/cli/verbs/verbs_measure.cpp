#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <span>

#include "client/cli/command.hpp"
#include "client/cli/input/menu_questions.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/input/option.hpp"
#include "client/cli/output/described_record.hpp"
#include "client/cli/server_command.hpp"
#include "idl/answers/measured.hpp"
#include "idl/commands.hpp"

namespace collided::cli {
namespace {

namespace wire = wire_contract::command;

/// The counts of FCL's opinions, such as "298 agree, 1 differ"; empty if FCL was not asked.
std::string words_of(const OpinionCounts& counts) {
  std::string words;
  visit_fields<OpinionCounts>([&](const auto& verdict) {
    const std::uint64_t count = verdict.of(counts);
    if (count > 0) words += fmt::format("{}{} {}", words.empty() ? "" : ", ", format_count(count), verdict.name);
  });
  return words;
}

void append(const Record& more, Record& record) { record.insert(record.end(), more.begin(), more.end()); }

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
    const auto menu =
        answer_in<Menu>(from_.empty() && of_.empty() ? ask_random(session, globals) : ask_own(session, globals));
    Printer printer = make_printer(session.io, globals);
    for (const MenuRow& row : menu.rows) print(printer, row, !opinion_.empty());
    printer.finish();
    if (menu.late) print_hint(session.io, globals, "the deadline was over before all questions were asked");
    else if (menu.rows.empty()) print_hint(session.io, globals, "the world is empty: nothing to price");
    if (std::ranges::any_of(menu.rows, [](const MenuRow& row) { return row.judged < row.asked; })) {
      print_hint(
          session.io, globals,
          "'7 of 400' wrong: the exact comparison had time for 400 of the questions, the others were only timed");
    }
    return menu.rows.empty() ? Exit::no : Exit::yes;
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
  static std::string duration(std::int64_t ns) { return format_duration(std::chrono::nanoseconds(ns)); }
  static std::string wrong(const MenuRow& row) {
    const std::string count = format_count(row.wrong);
    return row.judged < row.asked ? fmt::format("{} of {}", count, format_count(row.judged)) : count;
  }

  static void print(Printer& printer, const MenuRow& row, bool with_opinion) {
    if (printer.human()) {
      std::vector<std::string> heads{"ASKED", "METHOD", "WORST ERROR", "BOUND", "P50", "P99", "UNDECIDED", "WRONG"};
      std::vector<std::string> cells{
          row.asked_of,         row.method,           length(row.worst_error_m),   length(row.worst_bound_m),
          duration(row.p50_ns), duration(row.p99_ns), format_count(row.undecided), wrong(row)};
      if (with_opinion) heads.emplace_back("FCL");
      if (with_opinion) cells.push_back(words_of(row.opinion));
      printer.row(heads, cells);
      return;
    }
    Record record = record_of(row);
    record.pop_back();
    if (with_opinion) append(record_of(row.opinion), record);
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
    const auto audit = server_answer<Audit>(session, globals, wire::kAudit, nlohmann::json::object());
    Printer printer = make_printer(session.io, globals);
    if (printer.human()) print_text(printer, audit);
    else printer.record(record(audit));
    printer.finish();
    if (audit.every == 0) {
      print_hint(session.io, globals,
                 "this server audits nothing; 'collided --audit 1/1000' works one answer in 1 000 out again");
    }
    return audit.differing == 0 ? Exit::yes : Exit::no;
  }

 private:
  static void print_text(Printer& printer, const Audit& audit) {
    const std::string differ = fmt::format("{} differ", format_count(audit.differing));
    printer.line(fmt::format("since start {} re-asked, {}", format_count(audit.audited),
                             printer.paint(audit.differing == 0 ? Paint::good : Paint::bad, differ)));
    if (audit.skipped > 0)
      printer.line(fmt::format("{} more were chosen while the auditor was behind", format_count(audit.skipped)));
    if (const std::string words = words_of(audit.opinion.value_or(OpinionCounts())); !words.empty())
      printer.line("FCL: " + words);
    if (audit.float_repairs > 0)
      printer.line(
          fmt::format("{} threads had their floating-point settings set back", format_count(audit.float_repairs)));
    for (const std::string& difference : audit.differences) printer.line("  " + printable(difference));
    for (const AuditedKind& row : audit.questions)
      printer.row({"ASKED", "DOUBLE", "EXPANSION", "RATIONAL"},
                  {row.kind, format_count(row.in_double), format_count(row.expansion), format_count(row.rational)});
  }

  static Record record(const Audit& audit) {
    Record record = record_of(audit);
    record.pop_back();
    if (audit.opinion) append(record_of(*audit.opinion), record);
    return record;
  }
};

}  // namespace

std::unique_ptr<Command> make_menu() { return std::make_unique<MenuCommand>(); }
std::unique_ptr<Command> make_audit() { return std::make_unique<AuditCommand>(); }

}  // namespace collided::cli
