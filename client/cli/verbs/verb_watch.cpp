#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>

#include "client/cli/command.hpp"
#include "client/cli/event_watch.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/input/option.hpp"
#include "client/cli/input/time_text.hpp"
#include "client/cli/output/clock_text.hpp"
#include "client/cli/output/event_output.hpp"
#include "client/cli/output/event_poster.hpp"
#include "client/cli/output/suggest.hpp"
#include "client/cli/pace.hpp"
#include "client/cli/verbs/ask_options.hpp"
#include "client/cli/output/readable.hpp"
#include "idl/clocks.hpp"

namespace collided::cli {
namespace {

using Clock = std::chrono::steady_clock;

/// A text with {names} of fields in it; {t} is the clock's time.
class Template {
 public:
  explicit Template(std::string text) : text_(std::move(text)) {
    fill(Event{}, [](std::string_view, const Value&) { return std::string(); });
  }

  /// The text with every {name} replaced by the result of `show` for its value; throws Failure for unknown names.
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
    if (name == "t") return show("t", Value(clock_text(happened(event))));
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

/// Runs a shell command with the event's fields in its environment, so that the shell never reads a name as part of the
/// command, whatever it contains.
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
  while (child > 0 && ::waitpid(child, &status, 0) < 0 && errno == EINTR && !stop_requested) {}
}

/// How long the end of a watch waits for a slow receiver.
constexpr std::chrono::seconds kPostsEnd{5};
constexpr const char* kTimes = "-10s, 2026-11-22T12:03:10.5Z or seconds since 1970";

class WatchCommand : public Command {
 public:
  void declare(CLI::App& app) override {
    const auto as_template = [](const std::string& text) { return Template(text); };
    option(app, "--only GLOB", options_.only, "Pairs of which either name matches this glob");
    option(app, "--skip GLOB", options_.skip, "No pair of which a name matches this glob");
    app.add_flag("--persisted", options_.persisted, "Contacts that go on, too");
    app.add_flag("--manifold", manifold_, "Where the two bear on each other, asked for as each contact begins");
    read_option(app, "--since TIME", options_.since,
                "First what the server remembers since 2026-11-22T12:03:10Z, seconds since 1970, or -10s",
                [](const std::string& text) { return since_1970(parse_time("--since", text, kTimes)); });
    option(app, "-n", most_events_, "End after so many events");
    option(app, "--for", most_time_, "End after this time");
    read_option(app, "--format TEXT", line_, "One line an event: '{t} {what} {a} {b} {depth}'", as_template);
    option(app, "--post URL", post_url_,
           "POST the events to this web address: a JSON array of the objects that --json prints");
    read_option(app, "--exec COMMAND", shell_, "Run this in a shell for every event; {a}, {b} ... stand for its fields",
                as_template);
  }

  Exit run(Session& session, const Globals& globals) override {
    if (post_url_) poster_.emplace(*post_url_);
    if (manifold_ && !globals.shards.empty())
      throw bad_use("--manifold asks one server about the two, so --shards is not for it");
    EventWatch watch(session, globals, options_);
    if (options_.since && watch.tells_since() > *options_.since)
      print_hint(session.io, globals,
                 fmt::format("the server remembers what happened from {} on", clock_text(watch.tells_since())));
    hint_at_unknown_names(session, globals, "--only ", options_.only);
    Printer printer = make_printer(session.io, globals);
    printer.set_usual_fields(usual_event_fields());
    const Until until(most_events_, most_time_);
    const Clock::time_point start = Clock::now();
    std::uint64_t count = 0;
    while (!until.reached(count) && session.io.out.good()) {
      const std::optional<Event> event = next_of(watch, session.io, until);
      if (const std::string_view news = watch.news(); !news.empty()) print_hint(session.io, globals, news);
      if (!event) continue;
      print(printer, *event, session.io);
      if (manifold_ && event->kind == EventKind::began) print_manifold(session, globals, printer, *event);
      if (shell_) run_shell(*shell_, *event);
      if (poster_) poster_->post(record_json(event_record(*event)));
      ++count;
    }
    session.io.out.flush();
    print_hint(session.io, globals,
               fmt::format("{} event{} in {}, {} lost", format_count(count), count == 1 ? "" : "s",
                           format_duration(Clock::now() - start), format_count(watch.lost())));
    const Exit posted = report_posts(session, globals);
    if (stop_requested) return Exit::interrupted;
    if (posted != Exit::yes) return posted;
    return count > 0 ? Exit::yes : Exit::no;
  }

  bool takes_shards() const override { return true; }

 private:
  void print(Printer& printer, const Event& event, Io& io) const {
    if (line_)
      printer.line(line_->fill(event, [&](std::string_view, const Value& value) {
        return io.out_is_terminal ? printable(value_text(value)) : value_text(value);
      }));
    else if (printer.human()) printer.line(event_line(printer, event) + age_of(event));
    else printer.record(event_record(event));
  }

  /// How long ago an event's contact began, if the world's clock is this machine's.
  static std::string age_of(const Event& event) {
    const auto age = wire_contract::since_1970() - happened(event);
    const bool one_clock = age >= std::chrono::seconds(0) && age < std::chrono::hours(1);
    return one_clock && event.kind == EventKind::began ? "  age " + format_duration(age) : std::string();
  }

  /// Prints the contact points of the two objects now; they may have moved or separated.
  static void print_manifold(Session& session, const Globals& globals, Printer& printer, const Event& event) {
    const Result<PairAnswer> pair = session.client(globals).pair(event.a, event.b);
    if (!pair) return;
    for (const ManifoldPoint& p : pair->manifold) {
      if (printer.human()) {
        printer.line(fmt::format("  bears at {}  {} deep", readable_point(p.point, p.error_m, printer.digits()),
                                 readable_length(p.depth_m, p.error_m, printer.digits())));
        continue;
      }
      Event point = event;
      point.kind = EventKind::persisted;
      point.point = p.point;
      point.normal = pair->normal;
      point.depth_m = p.depth_m;
      point.depth_error_m = p.error_m;
      printer.record(event_record(point));
    }
  }

  static std::chrono::nanoseconds since_1970(const RunTime& time) {
    if (time.since == RunTime::Since::begin) throw bad_use("--since: a time after the begin is for recordings", kTimes);
    if (time.since == RunTime::Since::year_1970) return time.offset;
    return wire_contract::since_1970() + time.offset;
  }

  /// Reports the outcome of posting the events, and whether all succeeded.
  Exit report_posts(Session& session, const Globals& globals) {
    if (!poster_) return Exit::yes;
    const EventPoster::PostCounts counts = poster_->finish(kPostsEnd);
    const std::string why = counts.last_failure.empty() ? "" : fmt::format("; last failure: {}", counts.last_failure);
    const std::string report = fmt::format("{} posted, {} dropped, {} refused{}", format_count(counts.posted),
                                           format_count(counts.dropped), format_count(counts.refused), why);
    if (counts.dropped == 0 && counts.refused == 0) {
      print_hint(session.io, globals, report);
      return Exit::yes;
    }
    const Exit outcome = counts.posted == 0 ? Exit::refused : Exit::partly_refused;
    print_failure(session.io, globals, Failure(outcome, fmt::format("--post {}: {}", *post_url_, report)));
    return outcome;
  }

  WatchOptions options_;
  std::uint64_t most_events_ = 0;  // 0: any number
  std::chrono::nanoseconds most_time_ = std::chrono::nanoseconds::max();
  std::optional<Template> line_;
  std::optional<Template> shell_;
  std::optional<std::string> post_url_;
  std::optional<EventPoster> poster_;
  bool manifold_ = false;
};

}  // namespace

std::unique_ptr<Command> make_watch() { return std::make_unique<WatchCommand>(); }

}  // namespace collided::cli
