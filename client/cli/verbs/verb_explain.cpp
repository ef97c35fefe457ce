#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "client/cli/command.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/input/option.hpp"
#include "client/cli/input/question.hpp"
#include "client/cli/output/explanation_output.hpp"
#include "client/cli/server_command.hpp"
#include "client/cli/verbs/ask_options.hpp"
#include "client/cli/verbs/recorded_explanation.hpp"
#include "idl/answers/explanation.hpp"
#include "idl/answers/pair.hpp"
#include "idl/commands.hpp"
#include "idl/instant.hpp"

namespace collided::cli {
namespace {

ExplainedPair explained_pair(const nlohmann::json& answer) {
  auto explained = from_json<ExplainedPair>(answer);
  explained.answer = answer_in<PairAnswer>(answer);
  return explained;
}

Exit exit_by(Verdict verdict) {
  if (verdict == Verdict::undecided) return Exit::undecided;
  return verdict == Verdict::hit ? Exit::yes : Exit::no;
}

/// For a recording: how far back two paths are examined, and the interval before the instant of a ray.
constexpr std::chrono::seconds kLastOfRecording{5};
constexpr std::chrono::seconds kBeforeRay{2};

constexpr const char* kForms =
    "collide explain pair A B, ray X Y Z DX DY DZ, fence NAME, nearest NAME, or event SEQ (of contacts; --of standing)";

/// Explains a pair, a ray, a region, a question for the nearest or an event, selected by the first word.
class ExplainCommand : public Command {
 public:
  void declare(CLI::App& app) override {
    option(app, "words pair|ray|fence|nearest|event OBJECT", words_,
           "pair A B, ray and its 6 numbers, fence NAME, nearest NAME, or event SEQ");
    option(app, "--last TIME", last_,
           "pair: how far back their paths are looked at: 5s (as far as poses are remembered; of a recording 5s)");
    option(app, "--as-of TIME", world_.as_of,
           "pair, ray, of a recording also fence, nearest: all objects at one instant: settled, -2s (before now, "
           "or a recording's end), 2026-11-22T12:03:10.5Z; of a recording also +2s, after its begin");
    option(app, "--recording FILE", world_.path,
           "From this recording, by a server of its own instead of the one that runs; of events those of contacts");
    option(app, "--scene FILE", world_.scenes, "With --recording: a file that its server had loaded; may be repeated")
        ->allow_extra_args(false);
    option(app, "--to X Y Z", to_, "ray: aim at this point instead of giving a direction");
    option(app, "--length LENGTH", length_, "ray: nothing farther than this (inf)");
    option(app, "--only GLOB", only_, "ray: objects whose name matches this glob (* ? [..])");
    option(app, "--skip GLOB", skip_, "ray: not objects whose name matches this glob");
    option(app, "--mask BITS", mask_, "ray: layers that may answer: bits, 0x3 or 0b11");
    option(app, "--why-not OBJECT", why_not_, "ray, fence, nearest: an object that is reported in any case");
    option(app, "--most N", most_,
           "ray, fence, nearest: how many of those passed, outside, or farther away are reported (3)");
    option(app, "--of KIND", of_, "event: contacts or standing (contacts)")
        ->check(CLI::IsMember({"contacts", "standing"}));
    option(app, "--deadline", deadline_, "What takes longer ends with what was found by then: 100ms");
  }

  Exit run(Session& session, const Globals& globals) override {
    const std::string what = words_.empty() ? "" : words_.front();
    if (!world_.scenes.empty() && world_.path.empty()) throw bad_use("--scene belongs to --recording");
    if (what == "pair") return explain_pair(session, globals);
    if (what == "ray") return explain_ray(session, globals);
    if (what == "fence") return explain_standing(session, globals, "fence");
    if (what == "nearest") return explain_standing(session, globals, "question for the nearest");
    if (what == "event") return explain_event(session, globals);
    throw bad_use("what is to be explained?", kForms);
  }

 private:
  Exit explain_pair(Session& session, const Globals& globals) {
    refuse_others({&to_, &length_, &only_, &skip_, &mask_, &why_not_, &most_, &of_}, "pair");
    if (words_.size() != 3) throw bad_use("a pair has two names", kForms);
    nlohmann::json arguments{{"a", words_[1]}, {"b", words_[2]}};
    const auto lead = last_.empty() ? std::chrono::nanoseconds(kLastOfRecording) : parse_duration(last_);
    if (!last_.empty() || !world_.path.empty()) arguments["last_ns"] = lead.count();
    const nlohmann::json answer = ask(session, globals, std::move(arguments), {words_[1], words_[2]}, lead);
    const ExplainedPair told = explained_pair(answer);
    print(session, globals, words_[1], words_[2], told);
    return exit_by(told.answer.verdict);
  }

  Exit explain_ray(Session& session, const Globals& globals) {
    refuse_others({&last_, &of_}, "ray");
    const RayQuestion ray = asked_ray();
    nlohmann::json arguments{
        {"ray",
         {ray.origin.x(), ray.origin.y(), ray.origin.z(), ray.direction.x(), ray.direction.y(), ray.direction.z()}},
        {"only", only_},
        {"skip", skip_}};
    if (std::isfinite(ray.length_m)) arguments["length"] = ray.length_m;
    if (!mask_.empty()) arguments["mask"] = parse_bits(mask_);
    add_common(arguments);
    const auto told = from_json<ExplainedRay>(ask(session, globals, std::move(arguments), {why_not_}, kBeforeRay));
    print(session, globals, told);
    return exit_by(told.verdict);
  }

  /// what  its kind for people; the name alone decides which one is explained
  Exit explain_standing(Session& session, const Globals& globals, std::string_view what) {
    refuse_others({&last_, &to_, &length_, &only_, &skip_, &mask_, &of_}, what);
    if (words_.size() != 2) throw bad_use(fmt::format("which {}?", what == "fence" ? what : "question"), kForms);
    nlohmann::json arguments{{"standing", words_[1]}};
    add_common(arguments);
    print(session, globals,
          from_json<ExplainedStanding>(ask_of_standing(session, globals, std::move(arguments), what)));
    return Exit::yes;
  }

  Exit explain_event(Session& session, const Globals& globals) {
    refuse_others({&last_, &world_.as_of, &to_, &length_, &only_, &skip_, &mask_, &why_not_, &most_}, "event");
    if (words_.size() != 2) throw bad_use("which event? the number after 'seq'", kForms);
    const auto told = from_json<ExplainedEvent>(ask_of_event(session, globals, parse_count(words_[1], 1)));
    print(session, globals, told);
    return Exit::yes;
  }

  template <class... Explained>
  static void print(Session& session, const Globals& globals, const Explained&... told) {
    Printer printer = make_printer(session.io, globals);
    print_explained(printer, told...);
  }

  static void refuse_others(std::initializer_list<const std::string*> others, std::string_view what) {
    for (const std::string* other : others) {
      if (!other->empty())
        throw bad_use(fmt::format("an option does not belong to a {}", what), "collide help explain");
    }
  }

  RayQuestion asked_ray() const {
    const std::vector<double> values = parse_numbers({words_.begin() + 1, words_.end()}, Measure::length);
    if (values.size() != (to_.empty() ? 6u : 3u))
      throw bad_use(to_.empty() ? "a ray takes 6 numbers, start and direction, or 3 and --to X Y Z"
                                : "with --to a ray takes 3 numbers, its start",
                    kForms);
    Numbers numbers;
    for (std::size_t at = 0; at < values.size(); ++at) numbers.set(at, values[at]);
    if (!to_.empty()) {
      const Vec3 target = parse_vector(to_, Measure::length);
      for (std::size_t axis = 0; axis < 3; ++axis)
        numbers.set(column::kTo + axis, target[static_cast<Eigen::Index>(axis)]);
    }
    if (!length_.empty()) numbers.set(column::kLength, parse_number(length_, Measure::length));
    Questions questions = no_questions(QuestionKind::ray);
    add_question(questions, numbers);
    return std::get<std::vector<RayQuestion>>(questions).front();
  }

  void add_common(nlohmann::json& arguments) const {
    if (!why_not_.empty()) arguments["why_not"] = why_not_;
    if (!most_.empty()) arguments["most"] = parse_count(most_);
  }

  nlohmann::json ask_of_standing(Session& session, const Globals& globals, nlohmann::json arguments,
                                 std::string_view what) const {
    if (!world_.path.empty())
      return explain_recorded_standing(session, globals, world_, std::move(arguments), asking({why_not_}));
    refuse_others({&world_.as_of}, what);
    return ask_server(session, globals, std::move(arguments), {why_not_});
  }

  nlohmann::json ask_of_event(Session& session, const Globals& globals, std::uint64_t sequence) const {
    if (!world_.path.empty()) {
      if (of_ == "standing") throw bad_use("of a recording only events of contacts are explained", kForms);
      return explain_recorded_event(session, globals, world_, sequence, asking({}));
    }
    nlohmann::json arguments{{"event", sequence}};
    if (!of_.empty()) arguments["of"] = of_;
    return ask_server(session, globals, std::move(arguments), {});
  }

  void add_instant(nlohmann::json& arguments) const {
    const Instant instant = parse_instant(world_.as_of);
    const wire_contract::AskedInstant asked{.kind = static_cast<wire_contract::AskedInstant::Kind>(instant.kind),
                                            .ns = instant.time.count()};
    if (const std::string text = wire_contract::text_of(asked); !text.empty()) arguments["as_of"] = text;
  }

  /// Asks the running server, or the recording.
  ///
  /// names  of objects that must exist; empty ones are ignored
  /// lead   how much of a recording is replayed
  nlohmann::json ask(Session& session, const Globals& globals, nlohmann::json arguments,
                     const std::vector<std::string>& names, std::chrono::nanoseconds lead) const {
    if (!world_.path.empty())
      return explain_recorded(session, globals, world_, std::move(arguments), lead, asking(names));
    add_instant(arguments);
    return ask_server(session, globals, std::move(arguments), names);
  }

  AskExplanation asking(std::vector<std::string> names) const {
    return [this, names = std::move(names)](Session& session, const Globals& globals, nlohmann::json arguments) {
      return ask_server(session, globals, std::move(arguments), names);
    };
  }

  nlohmann::json ask_server(Session& session, const Globals& globals, nlohmann::json arguments,
                            const std::vector<std::string>& names) const {
    // The search ends before this side stops waiting.
    constexpr std::chrono::seconds kPatience{10};
    arguments["deadline_ns"] = deadline_.value_or(timeout_of(globals, kPatience) * 9 / 10).count();
    try {
      return server_command(session, globals, wire_contract::command::kExplain, arguments);
    } catch (const Failure&) {
      // An object that does not exist now may have existed at another instant.
      for (const std::string& name : world_.as_of.empty() ? names : std::vector<std::string>()) {
        if (name.empty()) continue;
        if (const auto unknown = unknown_object(session, globals, name)) throw Failure(*unknown);
      }
      throw;
    }
  }

  std::vector<std::string> words_;
  std::string last_;
  RecordedWorld world_;  // with no path: the running server's
  std::string to_;
  std::string length_;
  std::string only_;
  std::string skip_;
  std::string mask_;
  std::string why_not_;
  std::string most_;
  std::string of_;
  std::optional<std::chrono::nanoseconds> deadline_;
};

}  // namespace

std::unique_ptr<Command> make_explain() { return std::make_unique<ExplainCommand>(); }

}  // namespace collided::cli
