#include <fmt/format.h>

#include "client/cli/command.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/input/option.hpp"
#include "client/cli/pace.hpp"
#include "client/cli/verbs/ask_options.hpp"
#include "client/cli/verbs/asked_world.hpp"
#include "client/cli/verbs/batch.hpp"
#include "client/cli/verbs/repeated_question.hpp"
#include "client/cli/input/shape_text.hpp"
#include "client/cli/server_command.hpp"
#include "idl/commands.hpp"

namespace collided::cli {

namespace {

/// The common part of the verbs of the four questions: one question from the words, a batch from a file, or a question
/// asked repeatedly.
class AskCommand : public Command {
 public:
  explicit AskCommand(QuestionKind kind) { view_.kind = kind; }

  void declare(CLI::App& app) override {
    option(app, "numbers", words_, "Numbers, or a file of questions, or -");
    declare_own(app);
    declare_ask_options(app, options_);
    app.add_flag("--stop-on-error", stop_on_error_, "Files: stop at the first bad line");
    app.add_flag("--watch", watch_, "Ask again and again, print what changes");
    option(app, "-n", most_changes_, "With --watch: end after so many changes");
    option(app, "--for", most_time_, "With --watch: end after this time");
    option(app, "--repeat", repeat_, "Ask so many times");
    option(app, "--every", every_, "Time between two asks (--watch: 10ms)");
  }

  bool takes_shards() const override { return true; }

  Exit run(Session& session, const Globals& globals) override {
    AskOptions options = options_;
    options.timeout = timeout_of(globals);
    adjust(options);
    print_warning(session.io, warning());
    const bool from_file = words_.size() == 1 && !is_number_text(words_.front());
    if (from_file) {
      if (watch_ || repeat_) throw bad_use("--watch and --repeat take one question, not a file");
      view_.with_id = true;
      // A request of a batch waits for those before it.
      constexpr std::chrono::seconds kBatchTimeout{60};
      options.timeout = timeout_of(globals, kBatchTimeout);
      return run_batch(session, globals, {words_.front(), options, view_, stop_on_error_});
    }
    Questions question = no_questions(view_.kind);
    add_question(question, numbers());
    if (watch_) hint_at_unknown_names(session, globals, "--only ", options.only);
    if (watch_) return run_repeated(session, globals, question, repeated_options(options));
    return ask_once_or_more(session, globals, question, options);
  }

 protected:
  virtual void declare_own(CLI::App& app) = 0;
  virtual void adjust(AskOptions&) {}
  /// A warning if the input is probably a mistake; else empty.
  virtual std::string warning() const { return {}; }
  /// The numbers of the question from words_ and the verb's own options.
  virtual Numbers numbers() const = 0;

  /// The words as numbers in metres for columns 0, 1, ... Throws Failure unless their count is one of those allowed.
  Numbers from_words(std::initializer_list<std::size_t> allowed, std::string_view needed) const {
    const std::vector<double> values = parse_numbers(words_, Measure::length);
    if (std::find(allowed.begin(), allowed.end(), values.size()) == allowed.end()) {
      throw bad_use(fmt::format("{} numbers; {}", values.size(), needed), fmt::format("collide help {}", verb_name()));
    }
    Numbers numbers;
    for (std::size_t at = 0; at < values.size(); ++at) numbers.set(at, values[at]);
    return numbers;
  }

  static void set_vector(Numbers& numbers, std::size_t first, const Vec3& vector) {
    for (std::size_t axis = 0; axis < 3; ++axis) numbers.set(first + axis, vector[static_cast<Eigen::Index>(axis)]);
  }

  std::vector<std::string> words_;
  AnswerView view_;

 private:
  std::string_view verb_name() const { return name_of(view_.kind); }

  RepeatedQuestionOptions repeated_options(const AskOptions& options) const {
    RepeatedQuestionOptions repeated{.ask = options, .kind = view_.kind};
    repeated.most_changes = most_changes_;
    repeated.most_time = most_time_;
    repeated.every = every_.value_or(repeated.every);
    return repeated;
  }

  Exit ask_once_or_more(Session& session, const Globals& globals, const Questions& question,
                        const AskOptions& options) {
    const std::uint64_t count = repeat_.value_or(1);
    AskedWorld asked(session, globals);
    Printer printer = make_printer(session.io, globals);
    auto next = std::chrono::steady_clock::now();
    Exit code = Exit::no;
    for (std::uint64_t at = 0; at < count && session.io.out.good(); ++at) {
      if (at > 0 && !sleep_until(next += every_.value_or(std::chrono::nanoseconds(0)))) return Exit::interrupted;
      const Answers answers = take(asked.ask(question, options));
      if (answers.answers.size() != 1) throw Failure(Exit::refused, "the server's answer does not fit the question");
      const Answer& answer = answers.answers.front();
      print_answer(printer, view_, RawJson{}, answer);
      printer.finish();
      session.io.out.flush();
      if (globals.verbose || (printer.human() && count == 1))
        print_hint(session.io, globals, cost_line(answers, answer));
      code = exit_of(answer);
    }
    if (code == Exit::no) hint_at_unknown_names(session, globals, "--only ", options.only);
    return code;
  }

  AskOptions options_;
  bool stop_on_error_ = false;
  bool watch_ = false;
  std::uint64_t most_changes_ = 0;
  std::chrono::nanoseconds most_time_ = std::chrono::nanoseconds::max();
  std::optional<std::uint64_t> repeat_;
  std::optional<std::chrono::nanoseconds> every_;
};

class RayCommand : public AskCommand {
 public:
  RayCommand() : AskCommand(QuestionKind::ray) {}

 private:
  void declare_own(CLI::App& app) override {
    option(app, "--to X Y Z", to_, "Aim at this point instead of giving a direction");
    option(app, "--length", Measure::length, length_, "Nothing farther than this (inf)", Infinity::taken);
    app.add_flag("--all", all_, "Everything along the ray, in order");
    app.add_flag("--any", any_, "Whatever is found first");
    app.add_flag("--verdict", verdict_, "Only whether there is a hit, not where");
  }
  void adjust(AskOptions& options) override {
    if (int{all_} + int{any_} + int{verdict_} > 1) throw bad_use("--all, --any and --verdict exclude each other");
    if (all_) options.mode = HitMode::all;
    if (any_) options.mode = HitMode::any;
    if (verdict_) options.mode = HitMode::verdict;
    view_.several = all_;
  }
  Numbers numbers() const override {
    Numbers numbers = to_.empty() ? from_words({6}, "a ray takes 6, start and direction, or 3 and --to X Y Z")
                                  : from_words({3}, "with --to a ray takes 3, its start");
    if (!to_.empty()) set_vector(numbers, column::kTo, parse_vector(to_, Measure::length));
    if (length_) numbers.set(column::kLength, *length_);
    return numbers;
  }
  std::string to_;
  std::optional<double> length_;
  bool all_ = false;
  bool any_ = false;
  bool verdict_ = false;
};

class SphereCommand : public AskCommand {
 public:
  SphereCommand() : AskCommand(QuestionKind::sphere) {}

 private:
  void declare_own(CLI::App& app) override { app.add_flag("--count", view_.count_only, "Only how many"); }
  Numbers numbers() const override { return from_words({4}, "a sphere takes 4: centre and radius"); }
};

class BoxCommand : public AskCommand {
 public:
  BoxCommand() : AskCommand(QuestionKind::box) {}

 private:
  void declare_own(CLI::App& app) override {
    option(app, "--center X Y Z", center_, "Centre, instead of two corners");
    option(app, "--size SIZE", size_, "Full lengths along its axes");
    option(app, "--rpy R P Y", rpy_, "Roll, pitch, yaw: 0 0 45deg");
    option(app, "--quat W X Y Z", quat_, "Rotation w x y z");
    app.add_flag("--count", view_.count_only, "Only how many");
  }
  std::string warning() const override { return angle_warning("--rpy", rpy_); }
  Numbers numbers() const override {
    if (center_.empty() != size_.empty()) throw bad_use("--center and --size go together");
    if (!rpy_.empty() && !quat_.empty()) throw bad_use("--rpy and --quat exclude each other");
    Numbers numbers;
    if (center_.empty()) {
      numbers = from_words({6}, "a box takes 6, two corners, or --center X Y Z --size X Y Z");
    } else {
      numbers = from_words({0}, "--center and --size replace the corners");
      set_vector(numbers, column::kBoxCenter, parse_vector(center_, Measure::length));
      set_vector(numbers, column::kSize, parse_vector(size_, Measure::length));
    }
    if (!rpy_.empty()) set_rotation(numbers, from_roll_pitch_yaw(parse_vector(rpy_, Measure::angle)));
    if (!quat_.empty()) {
      const std::vector<double> q = parse_numbers({quat_});
      if (q.size() != 4) throw bad_use("--quat takes 4 numbers, w first");
      set_rotation(numbers, unit_quaternion(q[0], q[1], q[2], q[3]));
    }
    return numbers;
  }
  static void set_rotation(Numbers& numbers, const Quat& rotation) {
    numbers.set(column::kQuaternion, rotation.w());
    numbers.set(column::kQuaternion + 1, rotation.x());
    numbers.set(column::kQuaternion + 2, rotation.y());
    numbers.set(column::kQuaternion + 3, rotation.z());
  }
  std::string center_;
  std::string size_;
  std::string rpy_;
  std::string quat_;
};

class NearCommand : public AskCommand {
 public:
  NearCommand() : AskCommand(QuestionKind::near) {}

 private:
  void declare_own(CLI::App& app) override {
    option(app, "-k", count_, "So many of the nearest (1)");
    option(app, "--reach", Measure::length, reach_, "Nothing farther than this (inf)", Infinity::taken);
    app.add_flag("--signed", signed_, "In a solid: minus the depth, instead of 0");
  }
  void adjust(AskOptions& options) override {
    if (signed_) options.mode = HitMode::signed_near;
    options.max_hits = static_cast<std::uint32_t>(std::min<std::uint64_t>(count_, 0xffffffff));
  }
  Numbers numbers() const override {
    Numbers numbers = from_words({3}, "near takes 3: a point");
    if (reach_) numbers.set(column::kReach, *reach_);
    return numbers;
  }
  std::uint64_t count_ = 1;
  std::optional<double> reach_;
  bool signed_ = false;
};

class InsideCommand : public AskCommand {
 public:
  InsideCommand() : AskCommand(QuestionKind::inside) {}

 private:
  void declare_own(CLI::App& app) override {
    app.add_flag("--any", any_, "Only whether there is one, without depth");
    app.add_flag("--count", view_.count_only, "Only how many");
  }
  void adjust(AskOptions& options) override {
    if (any_) options.mode = HitMode::any;
  }
  Numbers numbers() const override { return from_words({3}, "inside takes 3: a point"); }

  bool any_ = false;
};

}  // namespace

std::unique_ptr<Command> make_ray() { return std::make_unique<RayCommand>(); }
std::unique_ptr<Command> make_sphere() { return std::make_unique<SphereCommand>(); }
std::unique_ptr<Command> make_box() { return std::make_unique<BoxCommand>(); }
std::unique_ptr<Command> make_near() { return std::make_unique<NearCommand>(); }
std::unique_ptr<Command> make_inside() { return std::make_unique<InsideCommand>(); }

}  // namespace collided::cli
