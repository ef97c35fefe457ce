#include "client/cli/verbs/repeated_question.hpp"

#include <map>

#include <fmt/format.h>

#include "client/cli/input/number.hpp"
#include "client/cli/output/clock_text.hpp"
#include "client/cli/pace.hpp"
#include "client/cli/output/readable.hpp"
#include "client/cli/verbs/asked_world.hpp"

namespace collided::cli {
namespace {

using Clock = std::chrono::steady_clock;

struct Held {
  Hit hit;
  Clock::time_point since;
};

class RepeatedQuestion {
 public:
  RepeatedQuestion(Session& session, const Globals& globals, const RepeatedQuestionOptions& options)
      : io_(session.io), globals_(globals), options_(options), printer_(make_printer(session.io, globals)) {}

  Exit run(AskedWorld& asked, const Questions& question) {
    const Until until(options_.most_changes, options_.most_time);
    Clock::time_point next = Clock::now();
    while (!until.reached(change_count_) && io_.out.good()) {
      take_answers(take(asked.ask(question, options_.ask)), until);
      next = std::max(next + options_.every, Clock::now());
      if (!sleep_until(std::min(next, until.end()))) break;
    }
    print_hint(
        io_, globals_,
        fmt::format("{} change{} in {}, asked {} times", format_count(change_count_), change_count_ == 1 ? "" : "s",
                    format_duration(Clock::now() - start_), format_count(asked_count_)));
    return stop_requested ? Exit::interrupted : Exit::yes;
  }

 private:
  void take_answers(const Answers& answers, const Until& until) {
    // Answers of several shards have no version.
    const bool same_world =
        asked_count_++ > 0 && answers.epoch != 0 && answers.version == version_ && answers.epoch == epoch_;
    version_ = answers.version;
    epoch_ = answers.epoch;
    if (same_world || answers.answers.empty()) return;
    compare(answers.answers.front(), answers.world_time, until);
    io_.out.flush();
  }

  void compare(const Answer& answer, std::chrono::nanoseconds time, const Until& until) {
    const bool undecided = answer.verdict == Verdict::undecided;
    if (undecided != undecided_) print(time, undecided ? "undecided" : "decided", nullptr, std::nullopt, answer.reason);
    undecided_ = undecided;
    std::map<std::string, Held> now;
    for (const Hit& hit : answer.hits) {
      const auto before = held_.find(hit.object);
      const bool first_of_object =
          now.emplace(hit.object, Held{hit, before == held_.end() ? Clock::now() : before->second.since}).second;
      if (!first_of_object || until.reached(change_count_)) continue;
      if (before == held_.end()) print(time, "enter", &hit, std::nullopt, UndecidedReason::none);
      else if (follows_distance() && moved(before->second.hit, hit))
        print(time, "moved", &hit, std::nullopt, UndecidedReason::none);
    }
    // Objects missing from an undecided answer may still be there.
    if (undecided) {
      now.merge(held_);
      held_ = std::move(now);
      return;
    }
    for (const auto& [name, held] : held_) {
      if (now.contains(name) || until.reached(change_count_)) continue;
      print(time, "exit", &held.hit, Clock::now() - held.since, UndecidedReason::none);
    }
    held_ = std::move(now);
  }

  bool follows_distance() const { return options_.kind == QuestionKind::ray || options_.kind == QuestionKind::near; }

  static bool moved(const Hit& before, const Hit& now) {
    return std::abs(before.distance_m - now.distance_m) > before.error_m + now.error_m;
  }

  void print(std::chrono::nanoseconds time, std::string_view change, const Hit* hit,
             std::optional<std::chrono::nanoseconds> after, UndecidedReason reason) {
    ++change_count_;
    const bool shows_value = hit != nullptr && !after;
    const char* word = follows_distance() ? "distance" : "depth";
    if (printer_.human()) {
      std::string line = fmt::format("{} {:<5}", clock_text(time), change);
      if (hit != nullptr) line += " " + printable(hit->object);
      if (shows_value)
        line += fmt::format(" {} {}", word, readable_length(hit->distance_m, hit->error_m, printer_.digits()));
      if (after) line += " after " + format_duration(*after);
      if (reason != UndecidedReason::none) line += fmt::format(" {}", explain(reason));
      printer_.line(line);
      return;
    }
    const Value none = std::monostate{};
    printer_.record({{"time", seconds_of(time)},
                     {"change", change},
                     {"object", hit ? Value(std::string_view(hit->object)) : none},
                     {word, shows_value ? Value(hit->distance_m) : none},
                     {"error", shows_value ? Value(hit->error_m) : none},
                     {"point", shows_value ? MaybeVector(hit->point) : MaybeVector()},
                     {"after", after ? Value(seconds_of(*after)) : none},
                     {"reason", reason == UndecidedReason::none ? none : Value(name_of(reason))}});
  }

  Io& io_;
  const Globals& globals_;
  const RepeatedQuestionOptions& options_;
  Printer printer_;
  std::map<std::string, Held> held_;
  bool undecided_ = false;
  std::uint64_t version_ = 0;
  std::uint64_t epoch_ = 0;
  std::uint64_t change_count_ = 0;
  std::uint64_t asked_count_ = 0;
  Clock::time_point start_ = Clock::now();
};

}  // namespace

Exit run_repeated(Session& session, const Globals& globals, const Questions& question,
                  const RepeatedQuestionOptions& options) {
  AskedWorld asked(session, globals);
  return RepeatedQuestion(session, globals, options).run(asked, question);
}

}  // namespace collided::cli
