#include <algorithm>
#include <chrono>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <collided/fleet.hpp>
#include <fmt/format.h>

#include "client/cli/command.hpp"
#include "client/cli/failure.hpp"
#include "client/cli/server_command.hpp"
#include "idl/commands.hpp"

namespace collided::cli {
namespace {

class HandoverCommand : public Command {
 public:
  void declare(CLI::App& app) override {
    app.add_option("name", to_, "The server that takes the place, as fleet calls it; else any that is ready");
  }

  Exit run(Session& session, const Globals& globals) override {
    const std::optional<FleetMember> from = primary(session, globals);
    const nlohmann::json answer = server_command(session, globals, wire_contract::command::kHandOver, {{"to", to_}});
    const std::string to = answer.value("to", std::string());
    for (int looks = 0; looks < kMostLooks; ++looks) {
      const std::optional<FleetMember> now = primary(session, globals);
      if (!now || now->name != to) continue;
      const std::string whose = from ? printable(from->name) : std::string("the one before");
      Printer printer = make_printer(session.io, globals);
      if (!printer.human()) printer.record({{"to", to}, {"epoch", now->epoch}});
      else if (!globals.quiet) printer.line(fmt::format("{} has the place of {}", printable(to), whose));
      printer.finish();
      return Exit::yes;
    }
    throw Failure(Exit::no, fmt::format("'{}' has not taken the place", printable(to)),
                  "collide fleet shows who is there; the server's log says why");
  }

 private:
  static constexpr int kMostLooks = 6;  // each takes as long as listening does

  /// Nothing while there is none, or there are two.
  static std::optional<FleetMember> primary(Session& session, const Globals& globals) {
    const Result<Fleet> found = fleet(connect_options(session.io, globals));
    if (!found) return std::nullopt;
    const auto is_primary = [](const FleetMember& member) { return member.role == FleetRole::primary; };
    if (std::ranges::count_if(found->members, is_primary) != 1) return std::nullopt;
    return *std::ranges::find_if(found->members, is_primary);
  }

  std::string to_;
};

}  // namespace

std::unique_ptr<Command> make_handover() { return std::make_unique<HandoverCommand>(); }

}  // namespace collided::cli
