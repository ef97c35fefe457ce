#include <CLI/CLI.hpp>

#include "client/cli/command.hpp"
#include "client/view/metrics.hpp"
#include "idl/commands.hpp"

namespace collided::cli {
namespace {

class MetricsCommand : public Command {
 public:
  void declare(CLI::App&) override {}

  Exit run(Session& session, const Globals& globals) override {
    Client& client = session.client(globals);
    const ServerStatus status = take(client.status());
    const Result<std::string> figures = client.command(wire_contract::command::kFigures, "{}");
    session.io.out << view::metrics_text(status, figures ? view::parse_figures(*figures) : std::nullopt);
    session.io.out.flush();
    return Exit::yes;
  }
};

}  // namespace

std::unique_ptr<Command> make_metrics() { return std::make_unique<MetricsCommand>(); }

}  // namespace collided::cli
