#include <algorithm>
#include <array>
#include <string_view>

#include <collided/recording.hpp>
#include <fmt/format.h>

#include "client/cli/command.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/input/option.hpp"
#include "client/cli/input/time_text.hpp"
#include "client/cli/output/clock_text.hpp"
#include "client/cli/output/event_output.hpp"
#include "client/cli/output/standing_output.hpp"

namespace collided::cli {
namespace {

constexpr const char* kRecordedTimes =
    "2026-11-22T12:03:10.5Z, seconds since 1970, +2s after the begin or -2s before the end";

class EventsCommand : public Command {
 public:
  void declare(CLI::App& app) override {
    option(app, "file FILE", path_, "A recording")->required();
    option(app, "--of KIND", of_, "contacts, standing (all of the next three), fences, margins or nearest (contacts)")
        ->check(CLI::IsMember({"contacts", "standing", "fences", "margins", "nearest"}));
    option(app, "--only GLOB", options_.only, "Events of which a name matches this glob");
    option(app, "--skip GLOB", options_.skip, "No event of which a name matches this glob");
    option(app, "--from TIME", from_,
           "What held then, and what happened from then on: 2026-11-22T12:03:10.5Z, seconds since "
           "1970, +2s after the begin, -2s before the end");
    option(app, "--to TIME", to_, "Up to then, in the same words");
  }

  Exit run(Session& session, const Globals& globals) override {
    if (!from_.empty()) options_.from = parse_time("--from", from_, kRecordedTimes);
    if (!to_.empty()) options_.to = parse_time("--to", to_, kRecordedTimes);
    if (of_ == "contacts") {
      const RecordedEvents recorded = take(recorded_events(path_, options_));
      return print(session, globals, recorded, recorded.events, usual_event_fields(), event_line, event_record);
    }
    RecordedStandingEvents recorded = take(recorded_standing_events(path_, options_));
    constexpr std::array<std::string_view, 3> kForms{"fences", "margins", "nearest"};  // in the order of their codes
    const auto form = std::find(kForms.begin(), kForms.end(), of_) - kForms.begin();
    if (of_ != "standing")
      std::erase_if(recorded.events, [&](const StandingEvent& event) { return static_cast<int>(event.form) != form; });
    return print(session, globals, recorded, recorded.events, usual_standing_fields(), standing_line,
                 [](const StandingEvent& event) { return standing_record(event); });
  }

 private:
  /// recorded  the summary of the whole recording
  template <class Recorded, class OneEvent, class Line, class ToRecord>
  Exit print(Session& session, const Globals& globals, const Recorded& recorded, const std::vector<OneEvent>& events,
             const std::vector<std::string>& usual_fields, const Line& line, const ToRecord& record) const {
    for (const std::string& warning : recorded.warnings)
      print_hint(session.io, globals, "warning: " + printable(warning));
    Printer printer = make_printer(session.io, globals);
    printer.set_usual_fields(usual_fields);
    for (const OneEvent& event : events) {
      if (!session.io.out.good()) break;
      if (printer.human()) printer.line(line(printer, event));
      else printer.record(record(event));
    }
    printer.finish();
    session.io.out.flush();
    print_hint(session.io, globals,
               fmt::format("{} event{} in {}, recorded from {} to {}; {} lost", format_count(events.size()),
                           events.size() == 1 ? "" : "s", printable(path_), clock_text(recorded.begin),
                           clock_text(recorded.end), format_count(recorded.lost)));
    return events.empty() ? Exit::no : Exit::yes;
  }

  std::string path_;
  std::string of_ = "contacts";
  RecordedEventsOptions options_;
  std::string from_;
  std::string to_;
};

}  // namespace

std::unique_ptr<Command> make_events() { return std::make_unique<EventsCommand>(); }

}  // namespace collided::cli
