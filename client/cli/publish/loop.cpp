#include "client/cli/publish/loop.hpp"

#include <fmt/format.h>

#include "client/cli/input/number.hpp"
#include "client/cli/output/progress.hpp"
#include "client/cli/pace.hpp"
#include "idl/clocks.hpp"

namespace collided::cli {
namespace {

using Clock = std::chrono::steady_clock;

// A server counts a publisher as lost after 500 ms of silence.
constexpr std::chrono::milliseconds kKeepAlive{100};
constexpr double kLongestWait_s = 1e9;

class Loop {
 public:
  Loop(Session& session, const Globals& globals, MotionSource& source, const PublishLoopOptions& options)
      : io_(session.io),
        globals_(globals),
        source_(source),
        options_(options),
        publisher_(session, globals, options.publisher_name),
        until_(options.most_frames, options.most_time) {
    source_.begin(session, globals, publisher_);
  }

  Exit run() {
    Progress progress(io_, globals_);
    start_ = round_start_ = last_due_ = Clock::now();
    begun_ = wire_contract::since_1970();
    while (!until_.reached(frames_) && io_.out.good()) {
      const std::optional<double> time_s = next_frame_time();
      if (!time_s) break;
      if (!wait_until_due(*time_s)) break;
      send();
      progress.show(frames_, "frames");
    }
    if (options_.stay && !stop_requested) stay();
    progress.clear();
    return report();
  }

 private:
  std::optional<double> next_frame_time() {
    std::optional<double> time_s = source_.next_time();
    const bool again = !time_s && options_.loop && frames_ > round_first_frame_;
    if (!again || !source_.restart()) return time_s;
    // The next round begins one frame after the last frame of this one.
    round_start_ = last_due_ + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(last_step_s_));
    round_first_frame_ = frames_;
    return source_.next_time();
  }

  bool wait_until_due(double time_s) {
    const double seconds = options_.rate_hz > 0 ? static_cast<double>(frames_ - round_first_frame_) / options_.rate_hz
                                                : time_s / options_.speed;
    const auto due = round_start_ + std::chrono::duration_cast<Clock::duration>(
                                        std::chrono::duration<double>(std::min(seconds, kLongestWait_s)));
    if (frames_ > round_first_frame_) last_step_s_ = std::chrono::duration<double>(due - last_due_).count();
    const bool first_of_all = frames_ == 0;
    if (!first_of_all && Clock::now() > due + std::chrono::duration_cast<Clock::duration>(
                                                  std::chrono::duration<double>(std::max(last_step_s_, 1e-3))))
      ++late_;
    last_due_ = due;
    while (Clock::now() + kKeepAlive < due) {
      if (!sleep_until(std::min(Clock::now() + kKeepAlive, until_.end())) || Clock::now() >= until_.end()) return false;
      keep_alive();
    }
    return sleep_until(std::min(due, until_.end())) && due <= until_.end();
  }

  void send() {
    poses_ += source_.move(publisher_);
    if (source_.has_own_instants()) publisher_.stream();
    const std::chrono::nanoseconds at = instant();
    const Result<void> sent = publisher_.flush(at);
    source_.sent(at);
    ++frames_;
    if (!sent) lose(sent.error());
  }

  /// The time of a frame: the one that the source gives, however late it is sent; without one, the time of sending.
  std::chrono::nanoseconds instant() {
    const auto now = since_1970(Clock::now());
    last_instant_ =
        last_due_ > last_instant_due_ || frames_ == 0 ? since_1970(last_due_) : std::max(now, last_instant_);
    last_instant_due_ = last_due_;
    return last_instant_;
  }

  std::chrono::nanoseconds since_1970(Clock::time_point time) const {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(begun_ + (time - start_));
  }

  void keep_alive() {
    if (const Result<void> said = publisher_.keep_alive(); !said) lose(said.error());
  }

  /// A frame could not be sent. The server may come back, so the run goes on and counts what is missing.
  void lose(const Error& error) {
    if (lost_++ == 0) print_hint(io_, globals_, "not sent: " + error.message + "; going on");
  }

  void stay() {
    print_hint(io_, globals_, "the last frame is out; its objects stay until Ctrl-C");
    while (!stop_requested && Clock::now() < until_.end()) {
      // Everything rests; this flush says so, so that contacts with other publishers' objects can be decided.
      if (const Result<void> sent = publisher_.flush(std::max(since_1970(Clock::now()), last_instant_)); !sent)
        lose(sent.error());
      sleep_until(std::min(Clock::now() + kKeepAlive, until_.end()));
    }
  }

  Exit report() {
    const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
    const double rate = seconds > 0 ? static_cast<double>(frames_) / seconds : 0;
    Record record{{"frames", frames_},
                  {"poses", poses_},
                  {"seconds", seconds},
                  {"rate", rate},
                  {"late", late_},
                  {"lost", lost_},
                  {"refused", source_.refused_count()}};
    std::vector<std::string> lines{fmt::format("published {}, {} in {:.3g} s: {:.4g} frames/s, {} late, {} lost",
                                               counted(frames_, "frame"), counted(poses_, "pose"), seconds, rate,
                                               format_count(late_), format_count(lost_))};
    source_.report(record, lines);
    Printer printer = make_printer(io_, globals_);
    printer.set_usual_fields({"frames", "poses", "seconds", "late", "lost"});
    if (printer.human()) {
      for (const std::string& line : lines) printer.line(line);
    } else {
      printer.record(record);
    }
    if (stop_requested) return Exit::interrupted;
    return source_.refused_count() > 0 ? Exit::partly_refused : Exit::yes;
  }

  Io& io_;
  const Globals& globals_;
  MotionSource& source_;
  const PublishLoopOptions& options_;
  WorldPublisher publisher_;
  Until until_;
  Clock::time_point start_;
  Clock::time_point round_start_;
  Clock::time_point last_due_;
  std::chrono::nanoseconds begun_{};         // start_, since 1970
  std::chrono::nanoseconds last_instant_{};  // since 1970
  Clock::time_point last_instant_due_;
  double last_step_s_ = 0;
  std::uint64_t round_first_frame_ = 0;
  std::uint64_t frames_ = 0;
  std::uint64_t poses_ = 0;
  std::uint64_t late_ = 0;
  std::uint64_t lost_ = 0;
};

}  // namespace

Exit publish(Session& session, const Globals& globals, MotionSource& source, const PublishLoopOptions& options) {
  return Loop(session, globals, source, options).run();
}

}  // namespace collided::cli
