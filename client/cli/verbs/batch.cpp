#include "client/cli/verbs/batch.hpp"

#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <future>

#include <fmt/format.h>

#include "client/cli/input/number.hpp"
#include "client/cli/input/question_reader.hpp"
#include "client/cli/output/progress.hpp"
#include "client/cli/verbs/ask_options.hpp"
#include "client/cli/verbs/asked_world.hpp"

namespace collided::cli {
namespace {

using Clock = std::chrono::steady_clock;

// The first request is small, so that answers come soon; the next ones grow. The limit keeps a server's processors
// busy: a larger request costs the program more in memory touched for the first time than the server in answering.
constexpr std::size_t kFirstRequest = 1'000;
constexpr std::size_t kLargestRequest = 8'000;
constexpr std::size_t kMostInFlight = 2;

/// Reuses the memory of answered questions for the next ones, instead of returning it to the system and allocating it
/// again page by page, which was a quarter of a batch's processor time.
void keep_freed_memory() {
#ifdef __GLIBC__
  constexpr int kMiB = 1 << 20;
  mallopt(M_MMAP_THRESHOLD, 32 * kMiB);
  mallopt(M_TRIM_THRESHOLD, 256 * kMiB);
  mallopt(M_ARENA_MAX, 1);  // questions are made on one thread and freed on another
#endif
}

struct BatchRequest {
  Questions questions;
  std::vector<QuestionReader::Line> lines;  // questions and refusals in the order of the file
  std::future<Result<Answers>> answers;
};

struct Counts {
  std::uint64_t answered = 0;
  std::uint64_t hit = 0;
  std::uint64_t miss = 0;
  std::uint64_t undecided = 0;
  std::uint64_t invalid = 0;
  std::uint64_t refused = 0;
};

class Batch {
 public:
  Batch(Session& session, const Globals& globals, const BatchOptions& options)
      : session_(session),
        globals_(globals),
        asked_(session, globals),
        options_(options),
        file_(options.path, session.io.in),
        reader_(file_, options.view.kind),
        printer_(make_printer(session.io, globals)),
        progress_(session.io, globals),
        pending_{no_questions(options.view.kind), {}, {}} {}

  Exit run() {
    while (!ended_ && !stop_requested && session_.io.out.good()) {
      read_some();
      if (!pending_.lines.empty()) send();
      while (!in_flight_.empty() && front_is_ready()) print_front();
      // Nothing can be read at the moment: prints answers before waiting for the pipe.
      while (!in_flight_.empty() && !ended_ && !reader_.ready()) print_front();
    }
    while (!in_flight_.empty() && !stop_requested) print_front();
    progress_.clear();
    printer_.finish();
    session_.io.out.flush();
    print_summary();
    if (counts_.hit == 0) hint_at_unknown_names(session_, globals_, "--only ", options_.ask.only);
    if (stop_requested) return Exit::interrupted;
    return counts_.refused + counts_.invalid > 0 ? Exit::partly_refused : Exit::yes;
  }

 private:
  /// Reads lines until the request is full, the pipe pauses or the input ends. Waits for the first line.
  void read_some() {
    QuestionReader::Line line;
    while (question_count(pending_.questions) < request_size_ && pending_.lines.size() < kLargestRequest) {
      if (!pending_.lines.empty() && !reader_.ready()) return;
      const QuestionReader::Found found = reader_.next(pending_.questions, line);
      if (found == QuestionReader::Found::end) {
        ended_ = true;
        return;
      }
      pending_.lines.push_back(line);
      if (found == QuestionReader::Found::refused && options_.stop_on_error) {
        ended_ = true;
        return;
      }
    }
  }

  void send() {
    while (in_flight_.size() >= kMostInFlight) print_front();
    BatchRequest request = std::move(pending_);
    pending_ = {no_questions(options_.view.kind), {}, {}};
    if (question_count(request.questions) > 0) {
      request.answers = asked_.ask_async(std::move(request.questions), options_.ask);
    }
    in_flight_.push_back(std::move(request));
    request_size_ = std::min(request_size_ * 2, kLargestRequest);
  }

  bool front_is_ready() {
    const auto& answers = in_flight_.front().answers;
    return !answers.valid() || answers.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
  }

  void print_front() {
    BatchRequest request = std::move(in_flight_.front());
    in_flight_.pop_front();
    Answers answers;
    if (request.answers.valid()) answers = take(request.answers.get());
    std::size_t at = 0;
    for (const QuestionReader::Line& line : request.lines) {
      if (!line.refusal.empty()) {
        refuse(line);
        continue;
      }
      if (at >= answers.answers.size()) throw Failure(Exit::refused, "the server's answer is shorter than the request");
      const Answer& answer = answers.answers[at++];
      count(answer);
      print_answer(printer_, options_.view, line.id, answer);
    }
    progress_.show(counts_.answered, form_of(options_.view.kind).plural);
    if (in_flight_.empty()) session_.io.out.flush();
  }

  void refuse(const QuestionReader::Line& line) {
    progress_.clear();
    print_error(session_.io, fmt::format("{} {}; {} {} answered, this one refused{}", file_.name(), line.refusal,
                                         format_count(counts_.answered), form_of(options_.view.kind).plural,
                                         options_.stop_on_error ? "; stopped" : " (--stop-on-error to stop)"));
    ++counts_.refused;
    print_refused(printer_, options_.view, line.id, line.number);
  }

  void count(const Answer& answer) {
    ++counts_.answered;
    if (answer.verdict == Verdict::hit) ++counts_.hit;
    if (answer.verdict == Verdict::miss) ++counts_.miss;
    if (answer.verdict == Verdict::undecided) ++counts_.undecided;
    if (answer.verdict == Verdict::invalid) ++counts_.invalid;
  }

  void print_summary() {
    const bool worth_it =
        session_.io.err_is_terminal || counts_.refused + counts_.invalid > 0 || globals_.verbose || stop_requested;
    if (globals_.quiet || !worth_it) return;
    const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
    std::string line =
        fmt::format(" {} {}  {:.3g} k/s  hit {}  miss {}  undecided {}", format_count(counts_.answered),
                    form_of(options_.view.kind).plural, static_cast<double>(counts_.answered) / seconds / 1000,
                    format_count(counts_.hit), format_count(counts_.miss), format_count(counts_.undecided));
    if (counts_.refused + counts_.invalid > 0)
      line += fmt::format("  refused {}", format_count(counts_.refused + counts_.invalid));
    session_.io.err << line << '\n';
  }

  Session& session_;
  const Globals& globals_;
  AskedWorld asked_;
  const BatchOptions& options_;
  InputFile file_;
  QuestionReader reader_;
  Printer printer_;
  Progress progress_;
  BatchRequest pending_;
  std::deque<BatchRequest> in_flight_;
  std::size_t request_size_ = kFirstRequest;
  bool ended_ = false;
  Counts counts_;
  Clock::time_point start_ = Clock::now();
};

}  // namespace

Exit run_batch(Session& session, const Globals& globals, const BatchOptions& options) {
  keep_freed_memory();
  return Batch(session, globals, options).run();
}

}  // namespace collided::cli
