#include <CLI/CLI.hpp>
#include <collided/diagnosis.hpp>
#include <fmt/format.h>

#include "client/cli/command.hpp"

namespace collided::cli {
namespace {

std::string_view name_of(Health health) {
  switch (health) {
    case Health::ok: return "ok";
    case Health::warn: return "warn";
    case Health::fail: break;
  }
  return "fail";
}

Paint paint_of(Health health) {
  return health == Health::ok ? Paint::good : health == Health::warn ? Paint::doubt : Paint::bad;
}

class DoctorCommand : public Command {
 public:
  void declare(CLI::App&) override {}

  Exit run(Session& session, const Globals& globals) override {
    Printer printer = make_printer(session.io, globals);
    Exit code = Exit::yes;
    for (const Finding& finding : diagnose(connect_options(session.io, globals))) {
      if (printer.human()) print_text(printer, finding);
      else
        printer.record({{"health", name_of(finding.health)},
                        {"about", finding.about},
                        {"text", finding.text},
                        {"remedy", finding.remedy}});
      if (finding.health != Health::fail) continue;
      const bool alone = finding.about == "server" && finding.text.starts_with("no ");
      code = alone ? Exit::no_server : code == Exit::no_server ? code : Exit::no;
    }
    printer.finish();
    return code;
  }

 private:
  static void print_text(Printer& printer, const Finding& finding) {
    const std::string word(name_of(finding.health));
    printer.line(printer.paint(paint_of(finding.health), word) + std::string(6 - word.size(), ' ') +
                 printable(finding.text));
    std::string_view left = finding.remedy;
    while (!left.empty()) {
      const std::size_t end = std::min(left.find('\n'), left.size());
      printer.line("        " + printable(left.substr(0, end)));
      left.remove_prefix(std::min(end + 1, left.size()));
    }
  }
};

}  // namespace

std::unique_ptr<Command> make_doctor() { return std::make_unique<DoctorCommand>(); }

}  // namespace collided::cli
