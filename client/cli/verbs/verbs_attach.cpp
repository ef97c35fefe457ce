#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "client/cli/command.hpp"
#include "client/cli/input/option.hpp"
#include "client/cli/server_command.hpp"
#include "idl/commands.hpp"

namespace collided::cli {
namespace {

void tell_attached(Session& session, const Globals& globals, const nlohmann::json& answer, std::string_view did) {
  const std::string child = text_of(answer, "child");
  const std::string parent = text_of(answer, "parent");
  Printer printer = make_printer(session.io, globals);
  if (printer.human()) {
    printer.line(
        fmt::format("{} {} {}  (world {})", printable(child), did, printable(parent), count_of(answer, "version")));
  } else {
    printer.record({{"child", child}, {"parent", parent}, {"world", count_of(answer, "version")}});
  }
}

class AttachCommand : public Command {
 public:
  void declare(CLI::App& app) override {
    option(app, "names OBJECT", names_, "The object that is to move along, and the one that it moves with");
    app.add_flag("--durable", durable_, "Refused where it would not outlive the server");
  }
  Exit run(Session& session, const Globals& globals) override {
    if (names_.size() != 2)
      throw bad_use(fmt::format("{} name{}; two are needed", names_.size(), names_.size() == 1 ? "" : "s"),
                    "collide attach crate robot/hand");
    const nlohmann::json answer = server_command(session, globals, wire_contract::command::kAttach,
                                                 {{"child", names_[0]}, {"parent", names_[1]}, {"durable", durable_}});
    tell_attached(session, globals, answer, "moves along with");
    print_hint(session.io, globals, fmt::format("undo: collide detach '{}'", names_[0]));
    return Exit::yes;
  }

 private:
  std::vector<std::string> names_;
  bool durable_ = false;
};

class DetachCommand : public Command {
 public:
  void declare(CLI::App& app) override {
    option(app, "name OBJECT", name_, "The object that is attached; it stays where it is");
    app.add_flag("--durable", durable_, "Refused where it would not outlive the server");
  }
  Exit run(Session& session, const Globals& globals) override {
    if (name_.empty()) throw bad_use("which object?", "collide detach crate");
    const nlohmann::json answer =
        server_command(session, globals, wire_contract::command::kDetach, {{"child", name_}, {"durable", durable_}});
    tell_attached(session, globals, answer, "no longer moves along with");
    return Exit::yes;
  }

 private:
  std::string name_;
  bool durable_ = false;
};

}  // namespace

std::unique_ptr<Command> make_attach() { return std::make_unique<AttachCommand>(); }
std::unique_ptr<Command> make_detach() { return std::make_unique<DetachCommand>(); }

}  // namespace collided::cli
