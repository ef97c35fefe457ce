#include <algorithm>
#include <chrono>
#include <optional>
#include <string>

#include <collided/fleet.hpp>
#include <fmt/format.h>

#include "client/cli/command.hpp"
#include "client/cli/input/option.hpp"
#include "client/cli/failure.hpp"
#include "client/cli/server_command.hpp"
#include "idl/commands.hpp"

namespace collided::cli {
namespace {

class HandoverCommand : public Command {
 public:
  void declare(CLI::App& app) override {
    option(app, "name", to_, "The server that takes the place, as fleet calls it; else any that is ready");
  }

  Exit run(Session& session, const Globals& globals) override {
    const std::optional<FleetMember> from = primary(session, globals);
    const std::string to = asked(session, globals, from.has_value());
    for (int looks = 0; looks < kMostLooks; ++looks) {
      const std::optional<FleetMember> now = primary(session, globals);
      const bool is_done = now && (to.empty() ? !from || now->server != from->server : now->name == to);
      if (!is_done) continue;
      const std::string whose = from ? printable(from->name) : std::string("the one before");
      Printer printer = make_printer(session.io, globals);
      if (!printer.human()) printer.record({{"to", now->name}, {"epoch", now->epoch}});
      else if (!globals.quiet) printer.line(fmt::format("{} has the place of {}", printable(now->name), whose));
      printer.finish();
      return Exit::yes;
    }
    throw Failure(Exit::no,
                  to.empty() ? std::string("nobody has taken the place")
                             : fmt::format("'{}' has not taken the place", printable(to)),
                  "collide fleet shows who is there; the server's log says why");
  }

 private:
  static constexpr int kMostLooks = 6;  // each takes as long as listening does

  /// The server that will take over. If it was quicker than the answer, the state is as requested.
  std::string asked(Session& session, const Globals& globals, bool was_there) const {
    try {
      return text_of(server_command(session, globals, wire_contract::command::kHandOver, {{"to", to_}}), "to");
    } catch (const Failure& failed) {
      if (failed.code != Exit::no_server || !was_there) throw;
      return to_;
    }
  }
  /// Nothing while there is no primary, or two.
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
