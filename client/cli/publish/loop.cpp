#include "client/cli/publish/loop.hpp"

#include <utility>

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
        publisher_(session, globals, options.publisher_name, {.gap = options.gap}),
        until_(options.most_frames, options.most_time) {
    source_.when_waiting([this] { keep_alive(); });
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
    if (!stop_requested) look_at_end();
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
    if (frames_ == 0) enter();
    const std::chrono::nanoseconds at = instant();
    flush(at);
    source_.sent(at);
    note_period(at);
    ++frames_;
  }

  void flush(std::chrono::nanoseconds at) {
    const Result<FlushReport> sent = publisher_.flush(at);
    if (!sent) return lose(sent.error());
    if (!sent->lost.empty() && !std::exchange(was_warned_of_loss_, true)) print_warning(io_, sent->lost);
  }

  /// Waits until the server has the first objects, and reports those that it refuses. The clock of the run begins only
  /// then: frames due in the meantime would be late.
  void enter() {
    const Clock::time_point asked = Clock::now();
    const Result<void> entered = publisher_.wait_entered(kPatience);
    // A silent server may be back; look_at_end() reports it if it is not.
    if (!entered && entered.error().code == ErrorCode::refused) note_refused(entered.error());
    const Clock::duration waited = Clock::now() - asked;
    for (Clock::time_point* time : {&start_, &round_start_, &last_due_}) *time += waited;
    begun_ += waited;
    until_ = Until(options_.most_frames, options_.most_time);
  }

  /// Without this a run whose objects never were in the world would end normally.
  void look_at_end() {
    if (const Result<void> applied = publisher_.wait_applied(kPatience); !applied) {
      if (applied.error().code == ErrorCode::refused) note_refused(applied.error());
      else fail(applied.error());
    }
    if (const Result<PublisherReport> found = publisher_.report(kPatience)) merged_ = found->merged_poses;
    if (merged_ > 0)
      print_warning(io_, fmt::format("the server had more than it could apply: {} gave way to newer ones, and contacts "
                                     "on the way between may be missing",
                                     counted(merged_, "pose")));
  }

  /// The run continues: other objects may be in the world, and one whose name is taken enters once it is free.
  void note_refused(const Error& error) {
    std::uint64_t count = 1;
    if (const Result<PublisherReport> found = publisher_.report(kPatience))
      count = std::max(count, found->left_out_count);
    objects_refused_ = std::max(objects_refused_, count);
    fail(error);
  }

  void fail(const Error& error) {
    const Failure failure = as_failure(error);
    if (failure.what() == failed_) return;
    failed_ = failure.what();
    failed_as_ = failure.code;
    print_failure(io_, globals_, failure);
  }

  /// The time of a frame: the source's, even if it is sent late; without one, the time of sending.
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

  /// Reports how far time has advanced, but nothing about the objects: the next frame may have moved them all the
  /// while.
  void keep_alive() {
    if (const Result<void> said = publisher_.keep_alive(since_1970(Clock::now())); !said) lose(said.error());
  }

  /// One long pause means that something rested; several in a row mean that the source is slower than the gap.
  void note_period(std::chrono::nanoseconds at) {
    constexpr int kSeveral = 3;
    const std::chrono::nanoseconds period = at - std::exchange(noted_, at);
    const bool is_long = frames_ > 0 && period > options_.gap;
    long_periods_ = is_long ? long_periods_ + 1 : 0;
    if (long_periods_ < kSeveral || std::exchange(was_warned_of_gap_, true)) return;
    const auto seconds = [](std::chrono::nanoseconds time) { return std::chrono::duration<double>(time).count(); };
    print_warning(
        io_, fmt::format("frames are {0:.3g} s apart, longer than the gap of {1:.3g} s: after each one the objects "
                         "rest, and move only in the last {1:.3g} s before the next; --gap {2:.2g}s",
                         seconds(period), seconds(options_.gap), 1.5 * seconds(period)));
  }

  /// A frame could not be sent. The server may come back, so the run continues and counts missing ones.
  void lose(const Error& error) {
    if (lost_++ == 0) print_hint(io_, globals_, "not sent: " + error.message + "; going on");
  }

  void stay() {
    print_hint(io_, globals_, "the last frame is out; its objects stay until Ctrl-C");
    while (!stop_requested && Clock::now() < until_.end()) {
      // Everything rests; this flush reports that, so that contacts with other publishers' objects can be decided.
      flush(std::max(since_1970(Clock::now()), last_instant_));
      sleep_until(std::min(Clock::now() + kKeepAlive, until_.end()));
    }
  }

  Exit report() {
    const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
    const double rate = seconds > 0 ? static_cast<double>(frames_) / seconds : 0;
    Record record{{"frames", frames_},  {"poses", poses_},
                  {"seconds", seconds}, {"rate", rate},
                  {"late", late_},      {"lost", lost_},
                  {"merged", merged_},  {"refused", source_.refused_count() + objects_refused_}};
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
    if (failed_as_ != Exit::yes) return failed_as_;
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
  std::chrono::nanoseconds noted_{};  // the time of the frame before
  int long_periods_ = 0;              // from frame to frame, longer than the gap, in a row
  bool was_warned_of_gap_ = false;
  bool was_warned_of_loss_ = false;
  double last_step_s_ = 0;
  std::uint64_t round_first_frame_ = 0;
  std::uint64_t frames_ = 0;
  std::uint64_t poses_ = 0;
  std::uint64_t late_ = 0;
  std::uint64_t lost_ = 0;
  std::uint64_t merged_ = 0;           // poses, as the server counts them
  std::uint64_t objects_refused_ = 0;  // not in the world when the server was asked
  std::string failed_;                 // printed last
  Exit failed_as_ = Exit::yes;
};

}  // namespace

Exit publish(Session& session, const Globals& globals, MotionSource& source, const PublishLoopOptions& options) {
  return Loop(session, globals, source, options).run();
}

}  // namespace collided::cli
