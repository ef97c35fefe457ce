#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "client/cli/command.hpp"
#include "client/cli/input/number.hpp"
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
    app.add_option("words", words_, "NAME X Y Z DX DY DZ: origin and direction in the object's frame");
    app.add_option("--on", object_, "Object that carries it");
    app.add_option("--reach", reach_, "How far ahead it looks (10)");
    app.add_option("--back", back_, "How far behind the origin it begins (1)");
    app.add_option("--rm", removed_, "Remove probes by name or glob");
    app.add_flag("--watch", watch_, "Readings after every step");
    app.add_option("--only", options_.only, "Probes that match this glob");
    app.add_option("--skip", options_.skip, "No probes that match this glob");
    app.add_option("-n", most_readings_, "End after so many readings");
    app.add_option("--for", most_time_, "End after this time");
  }

  Exit run(Session& session, const Globals& globals) override {
    if (!removed_.empty()) return remove(session, globals);
    if (!words_.empty()) return set(session, globals);
    return watch_ ? follow(session, globals) : look(session, globals);
  }

 private:
  Exit set(Session& session, const Globals& globals) {
    if (object_.empty())
      throw bad_use("--on OBJECT says what carries it", "collide probe front_left --on car  1.2 0.7 0  0 0 -1");
    const std::vector<double> numbers = parse_numbers({words_.begin() + 1, words_.end()}, Measure::length);
    if (numbers.size() != 6)
      throw bad_use(fmt::format("{} numbers; an origin X Y Z and a direction DX DY DZ are needed", numbers.size()));
    const Probe probe{.name = words_[0],
                      .object = object_,
                      .origin = {numbers[0], numbers[1], numbers[2]},
                      .direction = {numbers[3], numbers[4], numbers[5]},
                      .reach_m = parse_number(reach_, Measure::length),
                      .back_m = parse_finite(back_, Measure::length)};
    if (probe.direction.isZero(0)) throw bad_use("direction 0 0 0 has no direction");
    take(session.client(globals).add_probe(probe));
    Printer printer = make_printer(session.io, globals);
    if (printer.human()) printer.line(fmt::format("probe {} on {}", printable(probe.name), printable(probe.object)));
    else printer.record({{"probe", std::string(probe.name)}, {"object", std::string(probe.object)}});
    printer.finish();
    hint_at_unknown_object(session, globals);
    return Exit::yes;
  }

  /// A probe may wait for its object, but a name that nothing has may be a mistake.
  void hint_at_unknown_object(Session& session, const Globals& globals) const {
    if (globals.quiet) return;
    try {
      if (const std::optional<Failure> unknown = unknown_object(session, globals, object_))
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
    const std::uint64_t most = most_readings_.empty() ? 0 : parse_count(most_readings_, 1);
    const auto most_time = most_time_.empty() ? std::chrono::nanoseconds::max() : parse_duration(most_time_);
    ProbeWatch watch = take(session.client(globals).watch_probes(options_));
    Printer printer = make_printer(session.io, globals);
    const Until until(most, most_time);
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
  std::string object_;
  std::string reach_ = "10";
  std::string back_ = "1";
  std::string removed_;
  bool watch_ = false;
  WatchOptions options_;
  std::string most_readings_;
  std::string most_time_;
};

}  // namespace

std::unique_ptr<Command> make_probe() { return std::make_unique<ProbeCommand>(); }

}  // namespace collided::cli
