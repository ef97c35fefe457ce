#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "client/cli/command.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/input/option.hpp"
#include "client/cli/input/question.hpp"
#include "client/cli/output/clock_text.hpp"
#include "client/cli/output/explanation_output.hpp"
#include "client/cli/output/readable.hpp"
#include "client/cli/server_command.hpp"
#include "client/cli/verbs/ask_options.hpp"
#include "client/cli/verbs/recorded_explanation.hpp"
#include "idl/commands.hpp"
#include "idl/instant.hpp"

namespace collided::cli {
namespace {

std::chrono::nanoseconds time_of(const nlohmann::json& answer, const char* key) {
  return std::chrono::nanoseconds(answer.at(key).get<std::int64_t>());
}

/// What the two are now, in a word.
std::string_view now_of(const nlohmann::json& answer) {
  const std::string said = text_of(answer, "answer");
  if (said == "hit") return "touching";
  return said == "miss" ? "apart" : "undecided";
}

/// Of a recording: how far back two paths are looked at, and what comes before the instant of a ray.
constexpr std::chrono::seconds kLastOfRecording{5};
constexpr std::chrono::seconds kBeforeRay{2};

constexpr const char* kForms =
    "collide explain pair A B, ray X Y Z DX DY DZ, fence NAME, nearest NAME, or event SEQ (of contacts; --of fences)";

/// What the first word says is explained: a pair, a ray, a fence, a question for the nearest or an event.
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
    option(app, "--why-not OBJECT", why_not_, "ray, fence, nearest: an object that is told of in any case");
    option(app, "--most N", most_,
           "ray, fence, nearest: so many of those passed, outside, or farther away are told (3)");
    option(app, "--of KIND", of_, "event: contacts or fences (contacts)")->check(CLI::IsMember({"contacts", "fences"}));
    option(app, "--deadline", deadline_, "What takes longer ends with what was found by then: 100ms");
  }

  Exit run(Session& session, const Globals& globals) override {
    const std::string what = words_.empty() ? "" : words_.front();
    if (!world_.scenes.empty() && world_.path.empty()) throw bad_use("--scene belongs to --recording");
    if (what == "pair") return explain_pair(session, globals);
    if (what == "ray") return explain_ray(session, globals);
    if (what == "fence") return explain_fence(session, globals);
    if (what == "nearest") return explain_nearest(session, globals);
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
    Printer printer = make_printer(session.io, globals);
    printer.set_usual_fields(
        {"a", "b", "answer", "distance", "depth", "error", "end", "nearest", "nearest_error", "at_least", "stale"});
    if (printer.human()) print_text(printer, answer);
    else printer.record(record_of(answer));
    const std::string_view now = now_of(answer);
    if (now == "undecided") return Exit::undecided;
    return now == "touching" ? Exit::yes : Exit::no;
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
    const nlohmann::json answer = ask(session, globals, std::move(arguments), {why_not_}, kBeforeRay);
    Printer printer = make_printer(session.io, globals);
    printer.set_usual_fields(usual_explained_ray_fields());
    if (printer.human()) print_explained_ray(printer, answer);
    else printer.record(explained_ray_record(answer));
    const std::string said = text_of(answer, "answer");
    if (said == "undecided") return Exit::undecided;
    return said == "hit" ? Exit::yes : Exit::no;
  }

  Exit explain_fence(Session& session, const Globals& globals) {
    refuse_others({&last_, &to_, &length_, &only_, &skip_, &mask_, &of_}, "fence");
    if (words_.size() != 2) throw bad_use("which fence?", kForms);
    nlohmann::json arguments{{"fence", words_[1]}};
    add_common(arguments);
    const nlohmann::json answer = ask_of_standing(session, globals, std::move(arguments), "fence");
    Printer printer = make_printer(session.io, globals);
    printer.set_usual_fields(usual_explained_fence_fields());
    if (printer.human()) print_explained_fence(printer, answer);
    else printer.record(explained_fence_record(answer));
    return Exit::yes;
  }

  Exit explain_nearest(Session& session, const Globals& globals) {
    refuse_others({&last_, &to_, &length_, &only_, &skip_, &mask_, &of_}, "question for the nearest");
    if (words_.size() != 2) throw bad_use("which question?", kForms);
    nlohmann::json arguments{{"nearest", words_[1]}};
    add_common(arguments);
    const nlohmann::json answer = ask_of_standing(session, globals, std::move(arguments), "question for the nearest");
    Printer printer = make_printer(session.io, globals);
    printer.set_usual_fields(usual_explained_nearest_fields());
    if (printer.human()) print_explained_nearest(printer, answer);
    else printer.record(explained_nearest_record(answer));
    return Exit::yes;
  }

  Exit explain_event(Session& session, const Globals& globals) {
    refuse_others({&last_, &world_.as_of, &to_, &length_, &only_, &skip_, &mask_, &why_not_, &most_}, "event");
    if (words_.size() != 2) throw bad_use("which event? the number after 'seq'", kForms);
    const nlohmann::json answer = ask_of_event(session, globals, parse_count(words_[1], 1));
    Printer printer = make_printer(session.io, globals);
    printer.set_usual_fields(usual_explained_event_fields());
    if (printer.human()) print_explained_event(printer, answer);
    else printer.record(explained_event_record(answer));
    return Exit::yes;
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
      if (of_ == "fences") throw bad_use("a recording holds no events of fences", kForms);
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

  /// Of the running server, or of the recording.
  ///
  /// names  of objects that must be there; empty ones are none
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
    // The search ends before this side stops waiting for it.
    constexpr std::chrono::seconds kPatience{10};
    arguments["deadline_ns"] = deadline_.value_or(timeout_of(globals, kPatience) * 9 / 10).count();
    try {
      return server_command(session, globals, wire_contract::command::kExplain, arguments);
    } catch (const Failure&) {
      // An object that is not there now may have been at another instant.
      for (const std::string& name : world_.as_of.empty() ? names : std::vector<std::string>()) {
        if (name.empty()) continue;
        if (const auto unknown = unknown_object(session, globals, name)) throw Failure(*unknown);
      }
      throw;
    }
  }

  Record record_of(const nlohmann::json& answer) const {
    const Value none = std::monostate{};
    const std::string_view now = now_of(answer);
    Record record{{"a", words_[1]},
                  {"b", words_[2]},
                  {"answer", now},
                  {"distance", now == "apart" ? Value(number_or_inf(answer, "distance")) : none},
                  {"depth", now == "touching" ? Value(number_or_inf(answer, "depth")) : none},
                  {"error", now == "undecided" ? none : Value(number_or_inf(answer, "error"))},
                  {"why_not", RawJson{answer.at("why_not").dump()}},
                  {"attached", text_of(answer, "attached")}};
    const auto nearest = answer.find("nearest");
    const bool is_known = nearest != answer.end();
    record.push_back({"end", is_known ? Value(text_of(*nearest, "end")) : none});
    for (const char* key : {"from_ns", "to_ns", "time_ns"})
      record.push_back({key, is_known ? Value(nearest->at(key).get<std::int64_t>()) : none});
    record.push_back({"nearest", is_known ? Value(number_or_inf(*nearest, "distance")) : none});
    record.push_back({"nearest_error", is_known ? Value(number_or_inf(*nearest, "error")) : none});
    record.push_back({"at_least", is_known ? Value(number_or_inf(*nearest, "at_least")) : none});
    record.push_back({"stale", answer.value("stale", false) ? Value(true) : none});
    record.push_back({"world", version_of(answer)});
    return record;
  }

  void print_text(Printer& printer, const nlohmann::json& answer) const {
    const std::string_view now = now_of(answer);
    const Digits digits = printer.digits();
    std::string line = fmt::format("{} and {}: {}", printable(words_[1]), printable(words_[2]), now);
    if (now == "apart")
      line += ", " + readable_length(number_or_inf(answer, "distance"), number_or_inf(answer, "error"), digits);
    if (now == "touching")
      line += fmt::format(", {} deep",
                          readable_length(number_or_inf(answer, "depth"), number_or_inf(answer, "error"), digits));
    printer.line(line);
    if (answer.value("stale", false))
      printer.line("  stale    one of them is where it was heard of last, and moved then");
    print_events(printer, answer);
    if (answer.contains("nearest")) print_nearest(printer, answer.at("nearest"));
    else printer.line("  nearest  " + printable(text_of(answer, "no_nearest")));
  }

  static void print_events(Printer& printer, const nlohmann::json& answer) {
    const std::vector<std::string> why = texts_of(answer, "why_not");
    if (why.empty()) printer.line("  events   each contact of the two is told");
    for (std::size_t i = 0; i < why.size(); ++i)
      printer.line((i == 0 ? "  events   none: " : "           and ") + printable(why[i]));
    if (const std::string child = text_of(answer, "attached"); !child.empty())
      printer.line(fmt::format("           {} moves along with the other", printable(child)));
  }

  static void print_nearest(Printer& printer, const nlohmann::json& nearest) {
    const std::string end = text_of(nearest, "end");
    const auto to = time_of(nearest, "to_ns");
    const std::chrono::duration<double> stretch = to - time_of(nearest, "from_ns");
    const std::chrono::nanoseconds ago = to - time_of(nearest, "time_ns");
    const std::string when = fmt::format("at {}, {} before the last that is known",
                                         clock_text(time_of(nearest, "time_ns")), format_duration(ago));
    const std::string within = format_duration(std::chrono::duration_cast<std::chrono::nanoseconds>(stretch));
    if (end == "touched") return printer.line(fmt::format("  nearest  they touched {}", when));
    if (end == "undecided") return printer.line(fmt::format("  nearest  undecided whether they touched {}", when));
    const Digits digits = printer.digits();
    if (std::isinf(number_or_inf(nearest, "distance")))
      return printer.line("  nearest  not looked at: the deadline was over");
    printer.line(fmt::format(
        "  nearest  {} {}",
        readable_length(number_or_inf(nearest, "distance"), number_or_inf(nearest, "error"), digits), when));
    printer.line(fmt::format("           at no time of the last {} nearer than {}{}", within,
                             readable_length(number_or_inf(nearest, "at_least"), 0, digits),
                             end == "cut_short" ? "; cut short, a longer --deadline says more" : ""));
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
