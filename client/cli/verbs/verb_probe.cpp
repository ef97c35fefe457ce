#include <fmt/format.h>

#include "client/cli/command.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/input/option.hpp"
#include "client/cli/output/clock_text.hpp"
#include "client/cli/pace.hpp"
#include "client/cli/server_command.hpp"
#include "client/cli/output/readable.hpp"

namespace collided::cli {
namespace {

bool has_met(const ProbeReading& reading) { return !reading.met.empty(); }

Record probe_record(const ProbeReading& reading) {
  const Value none = std::monostate{};
  const bool met = has_met(reading);
  return {{"time", seconds_of(reading.world_time)},
          {"probe", std::string_view(reading.probe)},
          {"state", name_of(reading.state)},
          {"clearance", met ? Value(reading.clearance_m) : none},
          {"error", met ? Value(reading.error_m) : none},
          {"met", met ? Value(std::string_view(reading.met)) : none},
          {"point", met ? MaybeVector(reading.point) : MaybeVector()},
          {"normal", met ? MaybeVector(reading.normal) : MaybeVector()},
          {"triangle", reading.triangle == kNoTriangle ? none : Value(std::uint64_t{reading.triangle})},
          {"object", std::string_view(reading.object)},
          {"world", reading.version}};
}

/// A clearance as text, such as "-0.0031 m"; negative values are collisions.
std::string clearance_text(const ProbeReading& reading, Digits digits) {
  if (!has_met(reading)) return {};
  const std::string least = reading.state == Clearance::deeper ? "at most " : "";
  return fmt::format("{}{}{}", least, reading.clearance_m > 0 ? "+" : "",
                     readable_length(reading.clearance_m, reading.error_m, digits));
}

Paint paint_of(Clearance state) {
  if (state == Clearance::gap) return Paint::good;
  return state == Clearance::collision || state == Clearance::deeper ? Paint::bad : Paint::doubt;
}

class ProbeCommand : public Command {
 public:
  void declare(CLI::App& app) override {
    option(app, "words", words_, "NAME X Y Z DX DY DZ: origin and direction in the object's frame");
    option(app, "--on OBJECT", probe_.object, "Object that carries it");
    option(app, "--reach", Measure::length, probe_.reach_m, "How far ahead it looks (10)", Infinity::taken);
    option(app, "--back", Measure::length, probe_.back_m, "How far behind the origin it begins (1)");
    option(app, "--rm GLOB", removed_, "Remove probes by name or glob");
    app.add_flag("--watch", watch_, "Readings after every step");
    option(app, "--only GLOB", options_.only, "Probes that match this glob");
    option(app, "--skip GLOB", options_.skip, "No probes that match this glob");
    option(app, "-n", most_readings_, "End after so many readings");
    option(app, "--for", most_time_, "End after this time");
  }

  Exit run(Session& session, const Globals& globals) override {
    if (!removed_.empty()) return remove(session, globals);
    if (!words_.empty()) return set(session, globals);
    return watch_ ? follow(session, globals) : look(session, globals);
  }

 private:
  Exit set(Session& session, const Globals& globals) {
    if (probe_.object.empty())
      throw bad_use("--on OBJECT says what carries it", "collide probe front_left --on car  1.2 0.7 0  0 0 -1");
    const std::vector<double> numbers = parse_numbers({words_.begin() + 1, words_.end()}, Measure::length);
    if (numbers.size() != 6)
      throw bad_use(fmt::format("{} numbers; an origin X Y Z and a direction DX DY DZ are needed", numbers.size()));
    probe_.name = words_[0];
    probe_.origin = {numbers[0], numbers[1], numbers[2]};
    probe_.direction = {numbers[3], numbers[4], numbers[5]};
    if (probe_.direction.isZero(0)) throw bad_use("direction 0 0 0 has no direction");
    take(session.client(globals).add_probe(probe_));
    Printer printer = make_printer(session.io, globals);
    if (printer.human()) printer.line(fmt::format("probe {} on {}", printable(probe_.name), printable(probe_.object)));
    else printer.record({{"probe", probe_.name}, {"object", probe_.object}});
    printer.finish();
    hint_at_unknown_object(session, globals);
    return Exit::yes;
  }

  /// A probe may wait for its object, but an unknown name may be a mistake.
  void hint_at_unknown_object(Session& session, const Globals& globals) const {
    if (globals.quiet) return;
    try {
      if (const std::optional<Failure> unknown = unknown_object(session, globals, probe_.object))
        print_hint(session.io, globals, fmt::format("{}. The probe reads 'absent' until it is", unknown->what()));
    } catch (const Failure&) {
      return;  // the probe is set; only the hint is missing
    }
  }

  Exit remove(Session& session, const Globals& globals) {
    const std::size_t count = take(session.client(globals).remove_probes(removed_));
    Printer printer = make_printer(session.io, globals);
    if (printer.human()) printer.line(fmt::format("removed {} probe{}", count, count == 1 ? "" : "s"));
    else printer.record({{"removed", std::uint64_t{count}}});
    printer.finish();
    return count > 0 ? Exit::yes : Exit::no;
  }

  Exit look(Session& session, const Globals& globals) {
    const std::vector<ProbeReading> readings = take(session.client(globals).probes(options_.only));
    Printer printer = make_printer(session.io, globals);
    for (const ProbeReading& reading : readings) {
      if (!printer.human()) {
        printer.record(probe_record(reading));
        continue;
      }
      printer.row({"PROBE", "ON", "STATE", "CLEARANCE", "TO"},
                  {printable(reading.probe), printable(reading.object), std::string(name_of(reading.state)),
                   clearance_text(reading, printer.digits()), printable(reading.met)});
    }
    printer.finish();
    if (readings.empty())
      print_hint(session.io, globals,
                 options_.only.empty() ? "no probes; 'collide probe NAME --on OBJECT X Y Z DX DY DZ' makes one"
                                       : fmt::format("no probe's name matches '{}'", printable(options_.only)));
    return readings.empty() ? Exit::no : Exit::yes;
  }

  Exit follow(Session& session, const Globals& globals) {
    ProbeWatch watch = take(session.client(globals).watch_probes(options_));
    Printer printer = make_printer(session.io, globals);
    const Until until(most_readings_, most_time_);
    std::uint64_t count = 0;
    while (!until.reached(count) && session.io.out.good()) {
      const std::optional<ProbeReading> reading = next_of(watch, session.io, until);
      if (!reading) continue;
      if (printer.human()) printer.line(line_of(printer, *reading));
      else printer.record(probe_record(*reading));
      ++count;
    }
    session.io.out.flush();
    print_hint(
        session.io, globals,
        fmt::format("{} reading{}, {} lost", format_count(count), count == 1 ? "" : "s", format_count(watch.lost())));
    if (stop_requested) return Exit::interrupted;
    return count > 0 ? Exit::yes : Exit::no;
  }

  static std::string line_of(const Printer& printer, const ProbeReading& reading) {
    std::string line = fmt::format("{} {}  {}", clock_text(reading.world_time), printable(reading.probe),
                                   printer.paint(paint_of(reading.state), name_of(reading.state)));
    if (has_met(reading))
      line += fmt::format("  {}  {} {}", clearance_text(reading, printer.digits()),
                          reading.clearance_m > 0 ? "to" : "in", printable(reading.met));
    return line;
  }

  std::vector<std::string> words_;
  Probe probe_;
  std::string removed_;
  bool watch_ = false;
  WatchOptions options_;
  std::uint64_t most_readings_ = 0;  // 0: any number
  std::chrono::nanoseconds most_time_ = std::chrono::nanoseconds::max();
};

}  // namespace

std::unique_ptr<Command> make_probe() { return std::make_unique<ProbeCommand>(); }

}  // namespace collided::cli
