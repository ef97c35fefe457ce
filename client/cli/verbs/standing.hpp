#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "client/cli/command.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/pace.hpp"

/// What fences, margins and questions for the nearest have in common: questions that stay, whose events are followed.
namespace collided::cli {

/// Says that a fence, a margin or a question stands. kind: which of them.
inline void print_standing(Session& session, const Globals& globals, const std::string& kind, const std::string& name) {
  Printer printer = make_printer(session.io, globals);
  if (printer.human()) printer.line(fmt::format("{} {}", kind, printable(name)));
  else printer.record({{kind, name}});
  printer.finish();
}

/// Says how many were removed. Exit::no: none.
inline Exit print_removed(Session& session, const Globals& globals, const std::string& kind, std::size_t count) {
  Printer printer = make_printer(session.io, globals);
  if (printer.human()) printer.line("removed " + counted(count, kind));
  else printer.record({{"removed", std::uint64_t{count}}});
  printer.finish();
  return count > 0 ? Exit::yes : Exit::no;
}

/// When following ends, by the options -n and --for as they were given; empty: no end.
inline Until follow_end(const std::string& most, const std::string& most_time) {
  return {most.empty() ? 0 : parse_count(most, 1),
          most_time.empty() ? std::chrono::nanoseconds::max() : parse_duration(most_time)};
}

/// Prints the events of a watch until the end, or Ctrl-C. Exit::no: none came.
///
/// line, record  of an event, for people and for programs
template <class EventWatch, class Line, class ToRecord>
Exit follow_events(Session& session, const Globals& globals, EventWatch watch, const Until& until,
                   const std::vector<std::string>& usual_fields, const Line& line, const ToRecord& record) {
  Printer printer = make_printer(session.io, globals);
  printer.set_usual_fields(usual_fields);
  std::uint64_t count = 0;
  while (!until.reached(count) && session.io.out.good()) {
    const auto event = next_of(watch, session.io, until);
    if (!event) continue;
    if (printer.human()) printer.line(line(printer, *event));
    else printer.record(record(*event));
    ++count;
  }
  session.io.out.flush();
  print_hint(session.io, globals, fmt::format("{}, {} lost", counted(count, "event"), format_count(watch.lost())));
  if (stop_requested) return Exit::interrupted;
  return count > 0 ? Exit::yes : Exit::no;
}

}  // namespace collided::cli
