#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "client/cli/command.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/input/option.hpp"
#include "client/cli/server_command.hpp"
#include "idl/answers/commands.hpp"
#include "idl/commands.hpp"

namespace collided::cli {
namespace {

std::string objects_of(std::uint64_t count) { return fmt::format("{} object{}", count, count == 1 ? "" : "s"); }

void warn_of_empty(Session& session, const Globals& globals, std::uint64_t count, const std::string& glob) {
  if (count == 0) print_hint(session.io, globals, fmt::format("no object's name matches '{}' now", printable(glob)));
}

/// Prints that pairs were `allowed` or `denied`, and how many contacts `ended` or `began` with it.
RuleChanged print_changed(Session& session, const Globals& globals, const std::vector<std::string>& names,
                          const nlohmann::json& answer, const char* did, const char* what) {
  auto changed = answer_in<RuleChanged>(answer);
  changed.contacts = count_of(answer, what);
  Printer printer = make_printer(session.io, globals);
  if (printer.human()) {
    printer.line(fmt::format("{}  {} with {}  {} {} (world {})", did, objects_of(changed.a_count),
                             objects_of(changed.b_count), what, counted(changed.contacts, "contact"), changed.version));
  } else {
    printer.record({{"a", std::string_view(names[0])},
                    {"b", std::string_view(names[1])},
                    {what, changed.contacts},
                    {"rules", changed.rules},
                    {"world", changed.version}});
  }
  return changed;
}

class AllowCommand : public Command {
 public:
  void declare(CLI::App& app) override {
    option(app, "names GLOB", names_, "Two globs: each object of the first with each of the second");
    option(app, "--because TEXT", because_, "Why they may touch, for whoever reads the list");
    app.add_flag("--durable", durable_, "Refused where it would not outlive the server");
  }
  Exit run(Session& session, const Globals& globals) override {
    if (names_.empty()) return list(session, globals);
    if (names_.size() != 2)
      throw bad_use(fmt::format("{} names; two are needed, or none to list the rules", names_.size()),
                    "collide allow arm/upper arm/fore --because 'they share a joint'");
    const nlohmann::json answer =
        server_command(session, globals, wire_contract::command::kAllow,
                       {{"a", names_[0]}, {"b", names_[1]}, {"because", because_}, {"durable", durable_}});
    const RuleChanged changed = print_changed(session, globals, names_, answer, "allowed", "ended");
    warn_of_empty(session, globals, changed.a_count, names_[0]);
    warn_of_empty(session, globals, changed.b_count, names_[1]);
    print_hint(session.io, globals, fmt::format("undo: collide deny '{}' '{}'", names_[0], names_[1]));
    return Exit::yes;
  }

 private:
  static Exit list(Session& session, const Globals& globals) {
    const nlohmann::json answer =
        server_command(session, globals, wire_contract::command::kAllowed, nlohmann::json::object());
    const auto rules = member_of<std::vector<ListedRule>>(answer, "rules");
    Printer printer = make_printer(session.io, globals);
    for (const ListedRule& rule : rules) {
      const std::string_view what = rule.allows ? "allowed" : "denied";
      if (printer.human())
        printer.row({"RULE", "A", "B", "BECAUSE"},
                    {std::string(what), printable(rule.a), printable(rule.b), printable(rule.because)});
      else printer.record({{"rule", what}, {"a", rule.a}, {"b", rule.b}, {"because", rule.because}});
    }
    printer.finish();
    if (rules.empty())
      print_hint(session.io, globals, "no pair is allowed to touch, but by masks, groups and SRDF files");
    return rules.empty() ? Exit::no : Exit::yes;
  }

  std::vector<std::string> names_;
  std::string because_;
  bool durable_ = false;
};

class DenyCommand : public Command {
 public:
  void declare(CLI::App& app) override {
    option(app, "names GLOB", names_, "The two globs");
    app.add_flag("--durable", durable_, "Refused where it would not outlive the server");
  }
  Exit run(Session& session, const Globals& globals) override {
    if (names_.size() != 2)
      throw bad_use(fmt::format("{} names; two are needed", names_.size()), "collide deny 'human_*' '*'");
    const nlohmann::json answer = server_command(session, globals, wire_contract::command::kDeny,
                                                 {{"a", names_[0]}, {"b", names_[1]}, {"durable", durable_}});
    print_changed(session, globals, names_, answer, "denied", "began");
    return Exit::yes;
  }

 private:
  std::vector<std::string> names_;
  bool durable_ = false;
};

}  // namespace

std::unique_ptr<Command> make_allow() { return std::make_unique<AllowCommand>(); }
std::unique_ptr<Command> make_deny() { return std::make_unique<DenyCommand>(); }

}  // namespace collided::cli
