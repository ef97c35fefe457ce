#include <unistd.h>

#include <fmt/format.h>

#include "client/cli/command.hpp"
#include "client/cli/input/keys.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/input/option.hpp"
#include "client/cli/output/clock_text.hpp"
#include "client/cli/output/described_record.hpp"
#include "client/cli/output/top_page.hpp"
#include "client/cli/output/top_keys.hpp"
#include "client/cli/output/top_screen.hpp"
#include "client/cli/server_command.hpp"
#include "client/cli/pace.hpp"
#include "idl/commands.hpp"
#include "client/cli/output/terminal_width.hpp"
#include "idl/terminal_text.hpp"

namespace collided::cli {
namespace {

using Clock = std::chrono::steady_clock;

/// A server without a status for this long counts as silent; it sends twenty a second.
constexpr std::chrono::milliseconds kSilent{500};
constexpr std::size_t kPastRates = 20;

/// Prints the server's newest steps, stage by stage, one a row.
Exit print_steps(Session& session, const Globals& globals, std::uint64_t last) {
  Printer printer = make_printer(session.io, globals);
  const auto steps =
      server_answer<NewestSteps>(session, globals, wire_contract::command::kSteps, {{"last", last}}).steps;
  const auto duration = [](std::int64_t ns) { return format_duration(std::chrono::nanoseconds(ns)); };
  for (const StepTrace& step : steps) {
    if (printer.human()) {
      printer.row({"WORLD", "TAKE", "UPDATE", "INDEX", "TEST", "EVENTS", "PUBLISH", "WHOLE", "MOVED", "EVENTS"},
                  {std::to_string(step.version), duration(step.take_ns), duration(step.update_ns),
                   duration(step.index_ns), duration(step.test_ns), duration(step.events_ns), duration(step.publish_ns),
                   duration(step.whole_ns), std::to_string(step.moved), std::to_string(step.events)});
      continue;
    }
    Record record = record_of(step);
    record[0].name = "world";
    record[1].name = "time_ns";
    printer.record(record);
  }
  printer.finish();
  return steps.empty() ? Exit::no : Exit::yes;
}

/// Switches the terminal to its alternate screen. The destructor restores the previous one.
class Screen {
 public:
  explicit Screen(const Io& io) : io_(io) { io_.out << "\x1b[?1049h\x1b[?25l"; }
  ~Screen() { (io_.out << "\x1b[?25h\x1b[?1049l").flush(); }
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  void show(const std::vector<std::string>& lines) {
    std::ostream& out = io_.out;
    out << "\x1b[H";
    // No line end after the last one: on a full screen it would scroll.
    for (std::size_t i = 0; i < lines.size(); ++i)
      out << (i == 0 ? "" : "\r\n") << wire_contract::terminal_text(lines[i], true) << "\x1b[K";
    (out << "\x1b[J").flush();
  }

 private:
  const Io& io_;
};

/// The content of the screen, and its history.
struct LiveTop {
  std::optional<Look> newest;
  TopHistory history;
  TopChoice choice;
  std::string note;
  Clock::time_point heard = Clock::now();
  bool is_silent = false;

  void hear(const Look& look, std::string restart) {
    if (!restart.empty()) {
      history.clear();
      note = std::move(restart);
    }
    newest = look;
    heard = Clock::now();
    is_silent = false;
    history.add(look);
  }
  void hear_nothing() { is_silent = true; }

  std::vector<std::string> lines(std::size_t columns, std::size_t rows) const {
    columns = std::max<std::size_t>(1, columns);
    if (newest && !is_silent) return top_screen(*newest, history, choice, note, columns, rows);
    if (!is_silent) return {};
    return {"collided", cut_between_words(fmt::format("no server answers, since {}; looking for it",
                                                      format_duration(Clock::now() - heard)),
                                          columns)};
  }
};

class TopCommand : public Command {
 public:
  void declare(CLI::App& app) override {
    app.add_flag("--once", once_, "One set of figures, over the time of --every");
    option(app, "--every", period_, "Between two looks (1s)");
    option(app, "-n", most_looks_, "End after so many");
    option(app, "--for", most_time_, "End after this time");
    option(app, "--steps", steps_, "Instead: the newest steps of the world by stage, at most 256");
  }

  Exit run(Session& session, const Globals& globals) override {
    constexpr std::chrono::milliseconds kShortest{10};
    if (period_ < kShortest) throw bad_use(fmt::format("--every {}; allowed: 10ms and more", format_duration(period_)));
    if (steps_) return print_steps(session, globals, *steps_);
    Printer printer = make_printer(session.io, globals);
    const bool is_live = printer.human() && session.io.out_is_terminal && !once_;
    const bool ends_by_itself = once_ || (!is_live && !most_looks_ && !most_time_);
    const Until until(ends_by_itself ? 1 : most_looks_.value_or(0),
                      most_time_.value_or(std::chrono::nanoseconds::max()));
    begin(session, globals);
    if (is_live) return live(session, globals, until, period_);
    return print(session, globals, printer, until, period_);
  }

 private:
  void begin(Session& session, const Globals& globals) {
    epoch_ = take(session.client(globals).status()).epoch;
    before_ = ask(session, globals);
    if (!before_) throw Failure(Exit::refused, "the server's answer to 'figures' is none that this collide knows");
  }

  /// The server's figures; nothing while no server answers.
  static std::optional<Figures> ask(Session& session, const Globals& globals) {
    const Result<std::string> text = session.client(globals).command(wire_contract::command::kFigures, "{}", {},
                                                                     timeout_of(globals, std::chrono::seconds(1)));
    if (!text && text.error().code == ErrorCode::refused) throw as_failure(text.error());
    return text ? view::parse_figures(*text) : std::nullopt;
  }

  /// The server's activity since the last look; nothing while it is silent.
  std::optional<Look> look(Session& session, const Globals& globals) {
    const std::optional<Figures> now = ask(session, globals);
    if (!now) return std::nullopt;
    Look look{.status = take(session.client(globals).status()),
              .figures = view::between(*before_, *now),
              .up_ns = now->up_ns,
              .past_rates = {}};
    if (look.status.age > kSilent) return std::nullopt;
    before_ = now;
    if (look.status.epoch != epoch_) {
      restart_ = fmt::format("the server was started anew: epoch {} after {}, pid {}", look.status.epoch, epoch_,
                             look.status.pid);
      past_rates_.clear();
    }
    epoch_ = look.status.epoch;
    past_rates_.push_back(asked_rate(look.figures));
    if (past_rates_.size() > kPastRates) past_rates_.pop_front();
    look.past_rates = past_rates_;
    return look;
  }

  Exit live(Session& session, const Globals& globals, const Until& until, std::chrono::nanoseconds period) {
    constexpr std::chrono::milliseconds kFirst{200};  // shorter than later ones, so that the first figures appear soon
    Keys keys(session.io.in);
    std::optional<Screen> screen(session.io);
    LiveTop top;
    std::uint64_t count = 0;
    for (std::chrono::nanoseconds wait = std::min<std::chrono::nanoseconds>(kFirst, period);
         wait_and_obey(session, keys, until, wait, top, *screen); wait = period) {
      if (!top.choice.is_paused) {
        if (const std::optional<Look> seen = look(session, globals)) top.hear(*seen, std::exchange(restart_, {}));
        else top.hear_nothing();
      }
      screen->show(top.lines(terminal_width(session.io), terminal_height(session.io)));
      if (until.reached(++count)) break;
    }
    screen.reset();
    // A page that ends by its count leaves its last figures; one that ends by a key was already read.
    if (until.reached(count) && !stop_requested) {
      for (const std::string& line : top.lines(terminal_width(session.io), 0))
        session.io.out << wire_contract::terminal_text(line, true) << '\n';
    }
    session.io.out.flush();
    return stop_requested ? Exit::interrupted : Exit::yes;
  }

  /// Waits, and carries out keys at once. False if the page should end: on a key, on Ctrl-C, or at its time.
  static bool wait_and_obey(Session& session, Keys& keys, const Until& until, std::chrono::nanoseconds wait,
                            LiveTop& top, Screen& screen) {
    constexpr std::chrono::milliseconds kCheck{50};
    const Clock::time_point due = std::min(Clock::now() + wait, until.end());
    std::size_t columns = terminal_width(session.io);
    std::size_t rows = terminal_height(session.io);
    while (Clock::now() < due) {
      if (!sleep_until(std::min(Clock::now() + kCheck, due))) return false;
      bool is_new = columns != terminal_width(session.io) || rows != terminal_height(session.io);
      for (std::optional<char> key = keys.next(); key; key = keys.next()) {
        if (!obey(*key, top.choice)) return false;
        is_new = true;
      }
      columns = terminal_width(session.io);
      rows = terminal_height(session.io);
      if (is_new) screen.show(top.lines(columns, rows));
    }
    return Clock::now() < until.end();
  }

  Exit print(Session& session, const Globals& globals, Printer& printer, const Until& until,
             std::chrono::nanoseconds period) {
    for (std::uint64_t count = 0; !until.reached(count) && session.io.out.good(); ++count) {
      if (!sleep_until(std::min(Clock::now() + period, until.end()))) return Exit::interrupted;
      const std::optional<Look> seen = look(session, globals);
      if (!seen) {
        if (until.reached(count + 1)) throw Failure(Exit::no_server, "the server fell silent");
        print_hint(session.io, globals, "no server answers");
        continue;
      }
      if (!restart_.empty()) print_hint(session.io, globals, std::exchange(restart_, {}));
      if (printer.human()) {
        for (const std::string& line : top_lines(*seen)) printer.line(line);
      } else {
        for (const Record& record : top_records(*seen)) printer.record(record);
      }
      session.io.out.flush();
    }
    return stop_requested ? Exit::interrupted : Exit::yes;
  }

  bool once_ = false;
  std::chrono::nanoseconds period_ = std::chrono::seconds(1);
  std::optional<std::uint64_t> most_looks_;
  std::optional<std::chrono::nanoseconds> most_time_;
  std::optional<std::uint64_t> steps_;
  std::optional<Figures> before_;
  std::uint64_t epoch_ = 0;
  std::string restart_;
  std::deque<double> past_rates_;
};

}  // namespace

std::unique_ptr<Command> make_top() { return std::make_unique<TopCommand>(); }

}  // namespace collided::cli
