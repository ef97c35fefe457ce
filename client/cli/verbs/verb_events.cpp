#include <CLI/CLI.hpp>
#include <collided/recording.hpp>
#include <fmt/format.h>

#include "client/cli/command.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/input/time_text.hpp"
#include "client/cli/output/clock_text.hpp"
#include "client/cli/output/event_output.hpp"

namespace collided::cli {
namespace {

constexpr const char* kTimes = "2026-11-22T12:03:10.5Z, seconds since 1970, +2s after the begin or -2s before the end";

class EventsCommand : public Command {
 public:
  void declare(CLI::App& app) override {
    app.add_option("file", path_, "A recording")->required();
    app.add_option("--only", options_.only, "Pairs of which either name matches this glob");
    app.add_option("--skip", options_.skip, "No pair of which a name matches this glob");
    app.add_option("--from", from_,
                   "Contacts that held then, and what happened from then on: 2026-11-22T12:03:10.5Z, seconds since "
                   "1970, +2s after the begin, -2s before the end");
    app.add_option("--to", to_, "Up to then, in the same words");
  }

  Exit run(Session& session, const Globals& globals) override {
    if (!from_.empty()) options_.from = parse_time("--from", from_, kTimes);
    if (!to_.empty()) options_.to = parse_time("--to", to_, kTimes);
    const RecordedEvents recorded = take(recorded_events(path_, options_));
    for (const std::string& warning : recorded.warnings)
      print_hint(session.io, globals, "warning: " + printable(warning));
    Printer printer = make_printer(session.io, globals);
    printer.set_usual_fields(usual_event_fields());
    for (const Event& event : recorded.events) {
      if (!session.io.out.good()) break;
      if (printer.human()) printer.line(event_line(printer, event));
      else printer.record(event_record(event));
    }
    printer.finish();
    session.io.out.flush();
    print_hint(session.io, globals,
               fmt::format("{} event{} in {}, recorded from {} to {}; {} lost", format_count(recorded.events.size()),
                           recorded.events.size() == 1 ? "" : "s", printable(path_), clock_text(recorded.begin),
                           clock_text(recorded.end), format_count(recorded.lost)));
    return recorded.events.empty() ? Exit::no : Exit::yes;
  }

 private:
  std::string path_;
  RecordedEventsOptions options_;
  std::string from_;
  std::string to_;
};

}  // namespace

std::unique_ptr<Command> make_events() { return std::make_unique<EventsCommand>(); }

}  // namespace collided::cli
