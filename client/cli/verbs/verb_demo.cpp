#include <thread>

#include <fmt/format.h>

#include "client/cli/command.hpp"
#include "client/cli/input/option.hpp"
#include "client/cli/own_server.hpp"
#include "client/cli/verbs/undo.hpp"

namespace collided::cli {
namespace {

class DemoCommand : public Command {
 public:
  void declare(CLI::App& app) override { option(app, "--for", time_, "End after so long (at Ctrl-C)"); }

  Exit run(Session& session, const Globals& globals) override {
    const auto begun = std::chrono::steady_clock::now();
    const ConnectOptions where = connect_options(session.io, globals);
    OwnServer server(session.io, where, {});
    server.meet(session, globals);
    tell(session, where);
    while (!stop_requested && !server.ended() && std::chrono::steady_clock::now() - begun <= time_)
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    if (server.ended())
      throw Failure(Exit::refused, fmt::format("the server ended by itself ({})", server.exit_code()));
    return Exit::yes;
  }

 private:
  static void tell(Session& session, const ConnectOptions& where) {
    Client& client = session.client({});
    std::ostream& out = session.io.out;
    const RayQuestion ray{.origin = {0, 0, 5}, .direction = {0, 0, -1}};
    const Answer below = take(client.ask(ray));
    const Answer near = take(client.ask(NearQuestion{.point = {0, 0, 1}}));
    out << fmt::format("A small warehouse of {} objects is served until Ctrl-C.\n\n", take(client.list()).count)
        << "  $ collide ray 0 0 5  0 0 -1\n"
        << fmt::format("  5 m above its middle, a ray straight down {}\n\n", first_of(below, "meets"))
        << "  $ collide near 0 0 1\n"
        << fmt::format("  1 m above it, {}\n\n", first_of(near, "the nearest thing is"))
        << "Try in another terminal:\n\n"
        << environment_line(where) << "  collide ls\n"
        << "  collide add ball sphere 0.3 --at -5 0 0.5\n"
        << "  collide pair ball pallet_01\n"
        << "  collide watch          then, in a third one, collide move ball 5 0 0.5\n"
        << "  collide draw --term\n";
    out.flush();
  }
  static std::string first_of(const Answer& answer, std::string_view what) {
    if (answer.hits.empty()) return "meets nothing";
    const Hit& hit = answer.hits.front();
    return fmt::format("{} {} at {:.3g} m", what, printable(hit.object), hit.distance_m);
  }
  /// The variables that another terminal must set to reach this server; nothing for the default one.
  static std::string environment_line(const ConnectOptions& where) {
    std::string line;
    if (where.domain != 0) line += fmt::format(" COLLIDED_DOMAIN={}", where.domain);
    if (where.name_space != "collided") line += " COLLIDED_NAMESPACE=" + shell_word(where.name_space);
    return line.empty() ? line : "  export" + line + "\n";
  }

  std::chrono::nanoseconds time_ = std::chrono::nanoseconds::max();
};

}  // namespace

std::unique_ptr<Command> make_demo() { return std::make_unique<DemoCommand>(); }

}  // namespace collided::cli
