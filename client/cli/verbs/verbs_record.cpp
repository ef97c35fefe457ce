#include <collided/recording.hpp>
#include <fmt/format.h>

#include "client/cli/command.hpp"
#include "client/cli/input/line_reader.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/input/option.hpp"
#include "client/cli/output/progress.hpp"
#include "client/cli/pace.hpp"
#include "client/view/standing_recorder.hpp"

namespace collided::cli {
namespace {

using Clock = std::chrono::steady_clock;

class RecordCommand : public Command {
 public:
  void declare(CLI::App& app) override {
    option(app, "file FILE", path_, "To write, an MCAP file")->required();
    option(app, "--for", most_time_, "End after this time; without it Ctrl-C ends");
    option(app, "--last", last_, "What the server took and wrote in its last 30s or less, from its flight recorder");
  }

  Exit run(Session& session, const Globals& globals) override {
    if (last_ && most_time_) throw bad_use("--for goes forward and --last back: one of them");
    return last_ ? fetch(session, globals, *last_) : follow(session, globals);
  }

 private:
  Exit fetch(Session& session, const Globals& globals, std::chrono::nanoseconds last) {
    const std::uint64_t bytes = take(fetch_recording(connect_options(session.io, globals), last, path_));
    Printer printer = make_printer(session.io, globals);
    if (printer.human())
      printer.line(fmt::format("{}: the last {}, {}", path_, format_duration(last), size_text(bytes)));
    else printer.record({{"file", path_}, {"seconds", std::chrono::duration<double>(last).count()}, {"bytes", bytes}});
    return Exit::yes;
  }

  Exit follow(Session& session, const Globals& globals) {
    const ConnectOptions options = connect_options(session.io, globals);
    Recording recording = take(record(options, path_));
    view::StandingRecorder standing(recording, options.name_space);
    const Clock::time_point start = Clock::now();
    const Until until(0, most_time_.value_or(std::chrono::nanoseconds::max()));
    {
      Progress progress(session.io, globals);
      while (!until.reached(0) && recording.counts().problem.empty()) {
        sleep_until(std::min(until.end(), Clock::now() + std::chrono::milliseconds(100)));
        standing.look();
        progress.show(recording.counts().samples, "samples");
      }
    }
    const auto took = Clock::now() - start;
    print(session, globals, take(recording.finish()), took);
    return Exit::yes;
  }

  void print(Session& session, const Globals& globals, const RecordingCounts& counts, Clock::duration took) const {
    Printer printer = make_printer(session.io, globals);
    for (const RecordedChannel& channel : counts.channels) {
      if (printer.human()) {
        if (channel.samples + channel.lost > 0) {
          printer.row({"TOPIC", "SAMPLES", "LOST"},
                      {channel.topic, format_count(channel.samples), format_count(channel.lost)});
        }
        continue;
      }
      printer.record({{"file", path_}, {"topic", channel.topic}, {"samples", channel.samples}, {"lost", channel.lost}});
    }
    printer.finish();
    print_hint(session.io, globals,
               fmt::format("{}: {} samples in {}, {}, {} lost", path_, format_count(counts.samples),
                           format_duration(took), size_text(counts.bytes), format_count(counts.lost)));
    if (counts.unanswered > 0)
      print_hint(session.io, globals, fmt::format("{} questions without an answer", format_count(counts.unanswered)));
    if (!counts.no_opening.empty())
      print_hint(session.io, globals, "what was in the world before is not in it: " + counts.no_opening);
  }

  static std::string size_text(std::uint64_t bytes) {
    return bytes < 1'000'000 ? fmt::format("{:.0f} kB", static_cast<double>(bytes) * 1e-3)
                             : fmt::format("{:.1f} MB", static_cast<double>(bytes) * 1e-6);
  }

  std::string path_;
  std::optional<std::chrono::nanoseconds> most_time_;
  std::optional<std::chrono::nanoseconds> last_;
};

class ReplayCommand : public Command {
 public:
  void declare(CLI::App& app) override {
    option(app, "file FILE", options_.path, "A recording")->required();
    option(app, "--rate FACTOR", rate_, "Of the recorded time (1)");
    app.add_flag("--loop", loop_, "Over and over");
    app.add_flag("--start-paused", start_paused_, "Begin when a line comes on standard input");
    app.add_flag("--ask", options_.ask,
                 "Ask every recorded question again, state by state, and compare the answers' bits");
  }

  Exit run(Session& session, const Globals& globals) override {
    options_.rate = rate_.empty() ? 1 : parse_finite(rate_);
    if (options_.ask && !rate_.empty())
      throw bad_use("--ask goes from state to state, whatever their times: no --rate");
    options_.go_on = [] { return !stop_requested.load(); };
    if (start_paused_ && !wait_for_line(session, globals)) return Exit::interrupted;
    Exit code = Exit::yes;
    do {
      const ReplayReport report = take(replay(connect_options(session.io, globals), options_));
      code = print(session, globals, report);
      session.io.out.flush();
      if (report.stopped) return Exit::interrupted;
    } while (loop_ && code == Exit::yes && session.io.out.good());
    return code;
  }

 private:
  static bool wait_for_line(Session& session, const Globals& globals) {
    print_hint(session.io, globals, "paused; Enter begins");
    LineReader lines(session.io.in);
    std::string line;
    lines.next(line);  // the end of input counts as a line
    return !stop_requested;
  }

  Exit print(Session& session, const Globals& globals, const ReplayReport& report) const {
    for (const std::string& warning : report.warnings)
      print_hint(session.io, globals, "warning: " + printable(warning));
    Printer printer = make_printer(session.io, globals);
    printer.set_usual_fields({"samples", "commands", "questions", "equal", "not_compared"});
    if (printer.human()) print_text(printer, report);
    else print_record(printer, report);
    if (!options_.ask || report.stopped) return Exit::yes;
    if (report.equal < report.questions) return Exit::no;
    return report.questions == 0 && report.not_compared > 0 ? Exit::undecided : Exit::yes;
  }

  void print_text(Printer& printer, const ReplayReport& report) const {
    std::string line = fmt::format("replayed {} samples", format_count(report.samples));
    if (report.commands > 0) line += fmt::format(" and {} commands", format_count(report.commands));
    if (report.standing > 0) line += fmt::format(", {} made again", counted(report.standing, "standing question"));
    if (options_.ask) {
      const bool all = report.equal == report.questions;
      line += fmt::format(", {} questions: {}", format_count(report.questions),
                          printer.paint(all ? Paint::good : Paint::bad, format_count(report.equal) + " equal"));
    }
    printer.line(line);
    for (const std::string& why : report.why_not_compared) printer.line("  not compared: " + why);
    for (const std::string& difference : report.differences) printer.line("  " + printable(difference));
  }

  static void print_record(Printer& printer, const ReplayReport& report) {
    const auto list = [](const std::vector<std::string>& texts) {
      std::string json = "[";
      for (const std::string& text : texts) {
        if (json.size() > 1) json += ',';
        append_json_string(json, text);
      }
      return RawJson{json + ']'};
    };
    printer.record({{"samples", report.samples},
                    {"commands", report.commands},
                    {"standing", report.standing},
                    {"questions", report.questions},
                    {"equal", report.equal},
                    {"not_compared", report.not_compared},
                    {"differences", list(report.differences)},
                    {"why_not_compared", list(report.why_not_compared)},
                    {"warnings", list(report.warnings)}});
  }

  ReplayOptions options_;
  std::string rate_;
  bool loop_ = false;
  bool start_paused_ = false;
};

}  // namespace

std::unique_ptr<Command> make_record() { return std::make_unique<RecordCommand>(); }
std::unique_ptr<Command> make_replay() { return std::make_unique<ReplayCommand>(); }

}  // namespace collided::cli
