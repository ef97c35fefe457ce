#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "client/cli/command.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/input/option.hpp"
#include "client/cli/server_command.hpp"
#include "idl/commands.hpp"

namespace collided::cli {
namespace {

std::string objects_of(std::uint64_t count) { return fmt::format("{} object{}", count, count == 1 ? "" : "s"); }

void warn_of_empty(Session& session, const Globals& globals, const nlohmann::json& answer, const char* count,
                   const std::string& glob) {
  if (count_of(answer, count) == 0)
    print_hint(session.io, globals, fmt::format("no object's name matches '{}' now", printable(glob)));
}

class AllowCommand : public Command {
 public:
  void declare(CLI::App& app) override {
    option(app, "names GLOB", names_, "Two globs: each object of the first with each of the second");
    option(app, "--because TEXT", because_, "Why they may touch, for whoever reads the list");
    app.add_flag("--durable", durable_, "Refused where it would not outlive a crash of the server");
  }
  Exit run(Session& session, const Globals& globals) override {
    if (names_.empty()) return list(session, globals);
    if (names_.size() != 2)
      throw bad_use(fmt::format("{} names; two are needed, or none to list the rules", names_.size()),
                    "collide allow arm/upper arm/fore --because 'they share a joint'");
    const nlohmann::json answer =
        server_command(session, globals, wire_contract::command::kAllow,
                       {{"a", names_[0]}, {"b", names_[1]}, {"because", because_}, {"durable", durable_}});
    Printer printer = make_printer(session.io, globals);
    if (printer.human()) {
      printer.line(fmt::format("allowed  {} with {}  ended {} (world {})", objects_of(count_of(answer, "a_count")),
                               objects_of(count_of(answer, "b_count")), counted(count_of(answer, "ended"), "contact"),
                               count_of(answer, "version")));
    } else {
      printer.record({{"a", std::string_view(names_[0])},
                      {"b", std::string_view(names_[1])},
                      {"ended", count_of(answer, "ended")},
                      {"rules", count_of(answer, "rules")},
                      {"world", count_of(answer, "version")}});
    }
    warn_of_empty(session, globals, answer, "a_count", names_[0]);
    warn_of_empty(session, globals, answer, "b_count", names_[1]);
    print_hint(session.io, globals, fmt::format("undo: collide deny '{}' '{}'", names_[0], names_[1]));
    return Exit::yes;
  }

 private:
  static Exit list(Session& session, const Globals& globals) {
    const nlohmann::json answer =
        server_command(session, globals, wire_contract::command::kAllowed, nlohmann::json::object());
    Printer printer = make_printer(session.io, globals);
    bool has_any = false;
    for (const nlohmann::json& rule : answer.value("rules", nlohmann::json::array())) {
      has_any = true;
      const std::string a = text_of(rule, "a");
      const std::string b = text_of(rule, "b");
      const std::string because = text_of(rule, "because");
      const std::string_view what = flag_of(rule, "allows") ? "allowed" : "denied";
      if (printer.human())
        printer.row({"RULE", "A", "B", "BECAUSE"}, {std::string(what), printable(a), printable(b), printable(because)});
      else printer.record({{"rule", what}, {"a", a}, {"b", b}, {"because", because}});
    }
    printer.finish();
    if (!has_any) print_hint(session.io, globals, "no pair is allowed to touch, but by masks, groups and SRDF files");
    return has_any ? Exit::yes : Exit::no;
  }

  std::vector<std::string> names_;
  std::string because_;
  bool durable_ = false;
};

class DenyCommand : public Command {
 public:
  void declare(CLI::App& app) override {
    option(app, "names GLOB", names_, "The two globs");
    app.add_flag("--durable", durable_, "Refused where it would not outlive a crash of the server");
  }
  Exit run(Session& session, const Globals& globals) override {
    if (names_.size() != 2)
      throw bad_use(fmt::format("{} names; two are needed", names_.size()), "collide deny 'human_*' '*'");
    const nlohmann::json answer = server_command(session, globals, wire_contract::command::kDeny,
                                                 {{"a", names_[0]}, {"b", names_[1]}, {"durable", durable_}});
    Printer printer = make_printer(session.io, globals);
    if (printer.human()) {
      printer.line(fmt::format("denied  {} with {}  began {} (world {})", objects_of(count_of(answer, "a_count")),
                               objects_of(count_of(answer, "b_count")), counted(count_of(answer, "began"), "contact"),
                               count_of(answer, "version")));
    } else {
      printer.record({{"a", std::string_view(names_[0])},
                      {"b", std::string_view(names_[1])},
                      {"began", count_of(answer, "began")},
                      {"rules", count_of(answer, "rules")},
                      {"world", count_of(answer, "version")}});
    }
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
