#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "client/cli/clock_text.hpp"
#include "client/cli/command.hpp"
#include "client/cli/number.hpp"
#include "client/cli/pace.hpp"
#include "client/cli/suggest.hpp"

namespace collided::cli {
namespace {

using Clock = std::chrono::steady_clock;

std::string_view name_of(What what) {
  switch (what) {
    case What::open: return "open";
    case What::began: return "began";
    case What::persisted: return "persisted";
    case What::ended: break;
  }
  return "ended";
}

std::string_view name_of(Why why) {
  switch (why) {
    case Why::none: return "";
    case Why::separated: return "separated";
    case Why::removed: return "removed";
    case Why::publisher_lost: return "publisher_lost";
    case Why::teleported: return "teleported";
    case Why::geometry_changed: return "geometry_changed";
    case Why::server_stopping: return "server_stopping";
    case Why::decided: return "decided";
    case Why::server_restarted: break;
  }
  return "server_restarted";
}

std::string_view name_of(Doubt doubt) {
  switch (doubt) {
    case Doubt::none: return "";
    case Doubt::numeric: return "numeric";
    case Doubt::cost_limit: break;
  }
  return "cost_limit";
}

Value triangle_value(std::uint32_t triangle) {
  if (triangle == kNoTriangle) return std::monostate{};
  return std::uint64_t{triangle};
}

Record event_record(const Event& event) {
  const bool is_doubt = event.doubt != Doubt::none;
  const bool touches = event.what != What::ended && !is_doubt;
  const bool is_told = event.what == What::began || event.what == What::persisted;
  const Value none = std::monostate{};
  const auto at = [&](double seconds_before) { return event.world_time.count() - std::llround(seconds_before * 1e9); };
  const bool has_bracket = event.what == What::began || event.what == What::ended;
  return {{"time", seconds_of(event.world_time)},
          {"time_ns", std::int64_t{event.world_time.count()}},
          {"first_ns", has_bracket ? Value(std::int64_t{at(event.bracket_low_s)}) : none},
          {"last_ns", has_bracket ? Value(std::int64_t{at(event.bracket_high_s)}) : none},
          {"what", name_of(event.what)},
          {"a", std::string_view(event.a)},
          {"b", std::string_view(event.b)},
          {"depth", touches ? Value(event.depth_m) : none},
          {"error", touches ? Value(event.depth_error_m) : none},
          {"point", touches ? MaybeVector(event.point) : MaybeVector()},
          {"normal", touches ? MaybeVector(event.normal) : MaybeVector()},
          {"a_triangle", triangle_value(event.a_triangle)},
          {"b_triangle", triangle_value(event.b_triangle)},
          {"after", event.what == What::ended ? Value(seconds_of(event.world_time - event.began)) : none},
          {"why", event.why == Why::none ? none : Value(name_of(event.why))},
          {"doubt", is_doubt ? Value(name_of(event.doubt)) : none},
          {"resync", event.resync ? Value(true) : none},
          {"sequence", event.sequence},
          {"episode", event.episode},
          {"bracket_low", event.bracket_low_s},
          {"bracket_high", event.bracket_high_s},
          {"epoch", event.epoch},
          {"velocity", is_told && touches ? MaybeVector(event.relative_velocity) : MaybeVector()}};
}

std::string event_line(const Printer& printer, const Event& event) {
  const std::string pair = fmt::format("{} x {}", printable(event.a), printable(event.b));
  const std::string doubt = event.doubt == Doubt::none ? "" : fmt::format("  in doubt ({})", name_of(event.doubt));
  if (event.what == What::open) return fmt::format("{:<8} {}  since {}{}", "open", pair, clock_text(event.began), doubt);
  const Paint paint = event.what == What::began ? Paint::bad : Paint::faint;
  std::string line = fmt::format("{} {}  {}", clock_text(event.world_time), printer.paint(paint, name_of(event.what)), pair);
  if (event.what == What::ended) line += fmt::format("  after {}  ({})", format_duration(event.world_time - event.began), name_of(event.why));
  else if (event.doubt == Doubt::none) line += fmt::format("  depth {} at {}", format_length(event.depth_m), format_vector(event.point));
  line += doubt + fmt::format("  seq {}", event.sequence);
  if (event.resync) line += "  resync";
  const auto age = std::chrono::system_clock::now().time_since_epoch() - event.world_time;
  const bool one_clock = age >= std::chrono::seconds(0) && age < std::chrono::hours(1);
  if (one_clock && event.what == What::began) line += "  age " + format_duration(age);
  return line;
}

/// A text with {names} of fields in it; {t} is the clock's time.
class Template {
 public:
  explicit Template(std::string text) : text_(std::move(text)) { fill(Event{}, [](std::string_view, const Value&) { return std::string(); }); }

  /// Every {name} replaced by what `show` makes of its value; throws Failure for unknown names.
  template <class Show>
  std::string fill(const Event& event, const Show& show) const {
    const Record record = event_record(event);
    std::string filled;
    std::size_t at = 0;
    while (at < text_.size()) {
      const std::size_t open = text_.find('{', at);
      const std::size_t close = open == std::string::npos ? open : text_.find('}', open);
      filled.append(text_, at, std::min(open, text_.size()) - at);
      if (open == std::string::npos) break;
      if (close == std::string::npos) throw bad_use(fmt::format("a {{ is never closed: {}", text_));
      filled += value(record, event, text_.substr(open + 1, close - open - 1), show);
      at = close + 1;
    }
    return filled;
  }

 private:
  template <class Show>
  static std::string value(const Record& record, const Event& event, const std::string& name, const Show& show) {
    if (name == "t") return show("t", Value(clock_text(event.world_time)));
    std::vector<std::string> names{"t"};
    for (const Field& field : record) {
      if (field.name == name) return show(field.name, field.value);
      names.emplace_back(field.name);
    }
    std::string listed;
    for (const std::string& known : names) listed += (listed.empty() ? "" : " ") + known;
    throw bad_use(fmt::format("no field '{{{}}}'{}", name, did_you_mean(name, names)), "fields: " + listed);
  }

  std::string text_;
};

/// Runs a shell command with the event's fields in its environment: a name can hold what it likes, the shell never reads it
/// as a command.
void run_shell(const Template& command, const Event& event) {
  std::vector<std::string> environment;
  const std::string line = command.fill(event, [&](std::string_view name, const Value& value) {
    environment.push_back(fmt::format("COLLIDE_{}={}", name, value_text(value)));
    return fmt::format("${{COLLIDE_{}}}", name);
  });
  for (char** inherited = ::environ; *inherited != nullptr; ++inherited) environment.emplace_back(*inherited);
  std::vector<char*> pointers;
  for (std::string& entry : environment) pointers.push_back(entry.data());
  pointers.push_back(nullptr);
  const char* words[] = {"sh", "-c", line.c_str(), nullptr};
  const pid_t child = ::fork();
  if (child == 0) {
    ::execve("/bin/sh", const_cast<char* const*>(words), pointers.data());
    ::_exit(127);
  }
  int status = 0;
  while (child > 0 && ::waitpid(child, &status, 0) < 0 && errno == EINTR && !stop_requested) {
  }
}

class WatchCommand : public Command {
 public:
  void declare(CLI::App& app) override {
    app.add_option("--only", options_.only, "Pairs of which either name matches this glob");
    app.add_option("--skip", options_.skip, "No pair of which a name matches this glob");
    app.add_flag("--persisted", options_.persisted, "Contacts that go on, too");
    app.add_flag("--manifold", manifold_, "Where the two bear on each other, asked for as each contact begins");
    app.add_option("-n", most_events_, "End after so many events");
    app.add_option("--for", most_time_, "End after this time");
    app.add_option("--format", format_, "One line an event: '{t} {what} {a} {b} {depth}'");
    app.add_option("--exec", command_, "Run this in a shell for every event; {a}, {b} ... stand for its fields");
  }

  Exit run(Session& session, const Globals& globals) override {
    const std::uint64_t most = most_events_.empty() ? 0 : parse_count(most_events_, 1);
    const auto most_time = most_time_.empty() ? std::chrono::nanoseconds::max() : parse_duration(most_time_);
    if (!format_.empty()) line_.emplace(format_);
    if (!command_.empty()) shell_.emplace(command_);
    Watch watch = take(session.client(globals).watch(options_));
    Printer printer = make_printer(session.io, globals);
    const Until until(most, most_time);
    const Clock::time_point start = Clock::now();
    std::uint64_t count = 0;
    while (!until.reached(count) && session.io.out.good()) {
      const std::optional<Event> event = next_of(watch, session.io, until);
      tell_of_silence(session, globals, watch);
      if (!event) continue;
      print(printer, *event, session.io);
      if (manifold_ && event->what == What::began) print_manifold(session, globals, printer, *event);
      if (shell_) run_shell(*shell_, *event);
      ++count;
    }
    session.io.out.flush();
    print_hint(session.io, globals, fmt::format("{} event{} in {}, {} lost", format_count(count), count == 1 ? "" : "s", format_duration(Clock::now() - start), format_count(watch.lost())));
    if (stop_requested) return Exit::interrupted;
    return count > 0 ? Exit::yes : Exit::no;
  }

 private:
  void print(Printer& printer, const Event& event, Io& io) const {
    if (line_) printer.line(line_->fill(event, [&](std::string_view, const Value& value) { return io.out_is_terminal ? printable(value_text(value)) : value_text(value); }));
    else if (printer.human()) printer.line(event_line(printer, event));
    else printer.record(event_record(event));
  }

  /// As the two stand when they are asked about: they may have gone on, or parted.
  static void print_manifold(Session& session, const Globals& globals, Printer& printer, const Event& event) {
    const Result<PairAnswer> pair = session.client(globals).pair(event.a, event.b);
    if (!pair) return;
    for (const ManifoldPoint& p : pair->manifold) {
      if (printer.human()) {
        printer.line(fmt::format("  bears at {}  {} deep ±{}", format_vector(p.point), format_length(p.depth_m), format_bound(p.error_m)));
        continue;
      }
      Event point = event;
      point.what = What::persisted;
      point.point = p.point;
      point.normal = pair->normal;
      point.depth_m = p.depth_m;
      point.depth_error_m = p.error_m;
      printer.record(event_record(point));
    }
  }

  void tell_of_silence(Session& session, const Globals& globals, const Watch& watch) {
    const bool connected = watch.connected();
    if (connected == was_connected_) return;
    was_connected_ = connected;
    print_hint(session.io, globals, connected ? "the server is back" : "the server is silent; events that it missed come marked resync");
  }

  WatchOptions options_;
  std::string most_events_;
  std::string most_time_;
  std::string format_;
  std::string command_;
  std::optional<Template> line_;
  std::optional<Template> shell_;
  bool manifold_ = false;
  bool was_connected_ = true;
};

}  // namespace

std::unique_ptr<Command> make_watch() {
  return std::make_unique<WatchCommand>();
}

}  // namespace collided::cli
