#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "client/cli/command.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/input/option.hpp"
#include "client/cli/pace.hpp"

/// What fences, margins and questions for the nearest have in common: questions that stay, whose events are followed.
namespace collided::cli {

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

/// What the verbs of such questions have in common: what the first word after the verb says is done, and how it is told.
class StandingCommand : public Command {
 public:
  Exit run(Session& session, const Globals& globals) override {
    const std::string action = words_.empty() ? "ls" : words_.front();
    if (action == "add") return add(session, globals);
    if (action == "ls") return list(session, globals);
    if (action == "watch") return follow(session, globals, word(1));
    if (action != "rm")
      throw bad_use(fmt::format("'{}' is nothing to do with {}", action, called_.many), "add, ls, rm or watch");
    if (words_.size() < 2)
      throw bad_use(fmt::format("which {}?", called_.one), fmt::format("collide {} rm GLOB", called_.verb));
    const std::size_t count = remove(session, globals, words_[1]);
    Printer printer = make_printer(session.io, globals);
    if (printer.human()) printer.line("removed " + counted(count, called_.one));
    else printer.record({{"removed", std::uint64_t{count}}});
    printer.finish();
    return count > 0 ? Exit::yes : Exit::no;
  }

 protected:
  /// "fence", "fence", "fences".
  struct Called {
    std::string verb;
    std::string one;
    std::string many;
  };
  explicit StandingCommand(Called called) : called_(std::move(called)) {}

  virtual Exit add(Session& session, const Globals& globals) = 0;
  virtual Exit list(Session& session, const Globals& globals) = 0;
  /// Returns how many there were.
  virtual std::size_t remove(Session& session, const Globals& globals, const std::string& glob) = 0;
  virtual Exit follow(Session& session, const Globals& globals, const std::string& glob) = 0;

  void declare_ends(CLI::App& app) {
    app.add_flag("--keep", is_kept_,
                 "add: it stays until it is removed or the server stops, and comes back after a crash");
    option(app, "-n", most_events_, "End after so many events");
    option(app, "--for", most_time_, "End after this time");
  }
  std::string word(std::size_t index) const { return index < words_.size() ? words_[index] : std::string(); }
  Until until() const { return {most_events_, most_time_}; }

  /// Says that it stands. One that is not kept goes with the process, so the process stays and tells of it.
  Exit stands(Session& session, const Globals& globals, const std::string& name) {
    if (!is_kept_ && !session.has_many_verbs) {
      only_ = skip_ = {};
      print_hint(session.io, globals,
                 fmt::format("{} {} stands until this ends; --keep lets it stand", called_.verb, printable(name)));
      return follow(session, globals, name);
    }
    Printer printer = make_printer(session.io, globals);
    if (printer.human()) printer.line(fmt::format("{} {}", called_.verb, printable(name)));
    else printer.record({{called_.verb, name}});
    printer.finish();
    return Exit::yes;
  }

  /// A table for people, a record each for programs. Exit::no: there is none.
  template <class Listed, class ToRecord, class ToRow>
  Exit print_list(Session& session, const Globals& globals, const std::vector<Listed>& all,
                  const std::vector<std::string>& head, const ToRecord& record, const ToRow& row) {
    Printer printer = make_printer(session.io, globals);
    for (const Listed& listed : all) {
      if (printer.human()) printer.row(head, row(listed));
      else printer.record(record(listed));
    }
    printer.finish();
    if (all.empty())
      print_hint(session.io, globals, fmt::format("no {}s; 'collide {} add' makes one", called_.one, called_.verb));
    return all.empty() ? Exit::no : Exit::yes;
  }

  std::vector<std::string> words_;
  bool is_kept_ = false;
  std::string only_;
  std::string skip_;
  std::uint32_t mask_ = 0xffffffff;

 private:
  Called called_;
  std::uint64_t most_events_ = 0;  // 0: any number
  std::chrono::nanoseconds most_time_ = std::chrono::nanoseconds::max();
};

}  // namespace collided::cli
