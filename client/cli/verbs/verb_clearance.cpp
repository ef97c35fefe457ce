#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>

#include "client/cli/command.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/input/option.hpp"
#include "client/cli/output/answer_output.hpp"
#include "client/cli/output/progress.hpp"
#include "client/cli/output/readable.hpp"
#include "client/cli/server_aside.hpp"
#include "client/cli/verbs/ask_options.hpp"
#include "client/cli/verbs/asked_world.hpp"
#include "client/cli/verbs/clearance_output.hpp"

namespace collided::cli {
namespace {

constexpr std::uint32_t kMostPairs = 10'000;
constexpr std::uint32_t kMostCertificates = 1'000;

/// The common part of clearance and clash: the options, and how pairs are printed.
class GroupCommand : public Command {
 public:
  void declare(CLI::App& app) override {
    declare_own(app);
    option(app, "--nearer,--within", Measure::length, nearer_m_, nearer_help());
    option(app, "--skip GLOB", options_.skip, "Not objects whose name matches this glob");
    app.add_flag("--with-filtered", options_.with_filtered,
                 "Also pairs that masks and groups let pass through each other");
    app.add_flag("--certificate", options_.certificate, "Ask for a proof of each pair and check it here");
    declare_instant(
        app, options_.as_of,
        "All objects at one instant: settled, -2s (before now), 2026-11-22T12:03:10.5Z (latest: each at its "
        "newest pose)");
    option(app, "--deadline", options_.deadline, "What takes longer ends undecided: 100ms");
  }

  bool takes_shards() const override { return true; }

  Exit run(Session& session, const Globals& globals) override {
    ClearanceOptions options = options_;
    options.nearer_m = nearer_m_.value_or(options.nearer_m);
    options.timeout = timeout_of(globals, std::chrono::seconds(60));
    const std::string from = adjust(options);
    if (options.to.empty() && !globals.shards.empty())
      throw bad_use("with --shards the other group must be named: what is beside a group, no shard knows alone",
                    "collide clearance 'robot/*' --to 'cell/*'");
    const std::string file = file_in(from);
    if (!file.empty() && !globals.shards.empty())
      throw bad_use("a server of its own reads the file, so --shards is not for it");
    if (!file.empty()) return ask_file(session, globals, file, options);
    return ask(session, globals, from, options);
  }

 protected:
  /// Asks and prints.
  Exit ask(Session& session, const Globals& globals, const std::string& from, ClearanceOptions& options) {
    Progress progress(session.io, globals);
    options.progress = [&](double fraction) {
      if (stop_requested) throw Failure(Exit::interrupted, "");
      progress.show(0, "looking at pairs", fraction);
    };
    const ShardedClearanceAnswer answer = take(AskedWorld(session, globals).clearance(from, options));
    progress.clear();
    check_certificates(answer.pairs);
    Printer printer = make_printer(session.io, globals);
    print_clearance(printer, answer, options.certificate);
    if (answer.pairs.empty() && printer.human()) printer.line(none_line(from, options));
    printer.finish();
    say_how_much(session.io, globals, answer);
    return exit_of(answer);
  }

  /// Asks a separate server, which reads the file and ends with the answer: the running server's world is unchanged.
  Exit ask_file(Session& session, const Globals& globals, const std::string& file, ClearanceOptions& options) {
    std::vector<std::string> words = reading_words();
    words.push_back(std::filesystem::absolute(file).string());
    ServerAside server(session, globals, "clash", words);
    options.to = "*";
    return ask(server.session(), server.globals(), "*", options);
  }

  virtual void declare_own(CLI::App& app) = 0;
  virtual std::string nearer_help() const = 0;
  /// Sets its own options; returns the first group.
  virtual std::string adjust(ClearanceOptions& options) = 0;
  /// The file that the group names; empty: it names objects.
  virtual std::string file_in(const std::string&) const { return {}; }
  virtual std::vector<std::string> reading_words() const { return {}; }
  bool has_nearer() const { return nearer_m_.has_value(); }
  std::uint32_t most_told(std::optional<std::uint64_t> asked) const {
    const std::uint64_t most = options_.certificate ? kMostCertificates : kMostPairs;
    const std::uint64_t count = asked.value_or(most);
    if (count > most)
      throw bad_use(
          fmt::format("{} pairs are above {}{}", count, most, options_.certificate ? ", with --certificate" : ""));
    return static_cast<std::uint32_t>(count);
  }

 private:
  static void check_certificates(const std::vector<ClearancePair>& pairs) {
    for (const ClearancePair& pair : pairs) {
      if (!pair.certificate) continue;
      if (pair.certificate->touches == (pair.verdict == Verdict::hit) && proves(*pair.certificate)) continue;
      throw Failure(Exit::undecided,
                    fmt::format("the server's certificate does not prove its answer to {} and {}", printable(pair.a),
                                printable(pair.b)),
                    "without --certificate the answers are shown");
    }
  }
  static std::string none_line(const std::string& from, const ClearanceOptions& options) {
    const std::string to = options.to.empty() ? "anything else" : printable(options.to);
    if (options.nearer_m > 0 && std::isfinite(options.nearer_m))
      return fmt::format("no pair of {} and {} is nearer than {}", printable(from), to,
                         readable_length(options.nearer_m, 0, Digits::rounded));
    return fmt::format("no pair of {} and {} touches", printable(from), to);
  }
  void say_how_much(Io& io, const Globals& globals, const ShardedClearanceAnswer& answer) const {
    if (answer.cut && has_nearer())
      print_hint(io, globals, "cut: more pairs are so near than are told here; -k tells more, up to 10000");
    if (std::isfinite(answer.complete_to_m))
      print_hint(io, globals,
                 fmt::format("pairs farther apart than {}, the margin of the shards, are not told",
                             readable_length(answer.complete_to_m, 0, Digits::rounded)));
    else if (answer.reason == UndecidedReason::not_covered && !answer.uncovered)
      print_hint(io, globals, "a shard that may hold a nearer pair does not answer");
    if (answer.late)
      print_hint(io, globals, "the deadline was over: some pairs were not looked at, and a nearer one may be missing");
    else if (answer.uncovered)
      print_hint(io, globals,
                 fmt::format("what is near {} is not covered: something that is not loaded may be nearer",
                             readable_point(*answer.uncovered, 0, Digits::rounded)));
    else if (answer.stale)
      print_hint(io, globals, "an object of a lost publisher may by now be nearer than is told here");
    if (answer.filtered > 0)
      print_hint(io, globals,
                 fmt::format("{} pair{} near enough may pass through each other and {} left out; --with-filtered tells "
                             "{}",
                             answer.filtered, answer.filtered == 1 ? "" : "s", answer.filtered == 1 ? "is" : "are",
                             answer.filtered == 1 ? "it" : "them"));
    if (!options_.certificate) return;
    const auto is_proved = [](const ClearancePair& pair) { return pair.certificate.has_value(); };
    print_hint(io, globals,
               fmt::format("proved here: {} of {} pairs",
                           std::count_if(answer.pairs.begin(), answer.pairs.end(), is_proved), answer.pairs.size()));
  }
  static Exit exit_of(const ClearanceAnswer& answer) {
    if (answer.verdict == Verdict::undecided || answer.late || answer.uncovered) return Exit::undecided;
    return answer.pairs.empty() ? Exit::no : Exit::yes;
  }

  ClearanceOptions options_;
  std::optional<double> nearer_m_;
};

class ClearanceCommand : public GroupCommand {
 private:
  void declare_own(CLI::App& app) override {
    option(app, "group GLOB", from_, "The first group: an object, a scene or a glob");
    option(app, "--to GLOB", to_, "The other group (everything else)");
    option(app, "-k", count_, "So many of the nearest pairs (1; with --nearer up to 10000)");
  }
  std::string nearer_help() const override { return "All pairs nearer than this, not only the nearest: 5mm"; }
  std::string adjust(ClearanceOptions& options) override {
    if (from_.size() != 1)
      throw bad_use(fmt::format("{} groups; one is needed, and --to for the other", from_.size()),
                    "collide clearance 'robot/*' --to 'cell/*'");
    options.to = to_;
    options.most = !count_ && !has_nearer() ? 1 : most_told(count_);
    return from_[0];
  }

  std::vector<std::string> from_;
  std::string to_;
  std::optional<std::uint64_t> count_;
};

class ClashCommand : public GroupCommand {
 public:
  Exit run(Session& session, const Globals& globals) override {
    try {
      return GroupCommand::run(session, globals);
    } catch (const Failure& failure) {
      // The library names its own call, and the group may have been meant as a file.
      std::string said = failure.what();
      constexpr std::string_view kCall = "clearance: ";
      if (const std::size_t at = said.find(kCall); at != std::string::npos) said.replace(at, kCall.size(), "clash: ");
      if (!std::filesystem::path(of_).has_extension() || said.find("is not in the world") == std::string::npos)
        throw Failure(failure.code, said, failure.hint);
      throw Failure(failure.code, said,
                    fmt::format("no file of this name in {} either", std::filesystem::current_path().string()));
    }
  }

 private:
  void declare_own(CLI::App& app) override {
    option(app, "group GLOB", of_,
           "A scene, a glob of objects (everything), or a file, which a server of its own reads");
    option(app, "--unit UNIT", unit_, "Of the file: m, mm, cm, km, um, in, ft, or metres a unit (m)");
    option(app, "--up AXIS", up_, "Axis of the file that points up: y or z (as the format says, else z)");
    option(app, "-k", count_, "At most so many pairs, the nearest (10000)");
  }
  std::string nearer_help() const override { return "Pairs nearer than this too: 5mm (0: only those that touch)"; }
  std::string adjust(ClearanceOptions& options) override {
    if (!has_nearer()) options.nearer_m = 0;
    options.to = of_;
    options.most = most_told(count_);
    return of_;
  }
  /// A file is named with its extension, unlike a scene.
  std::string file_in(const std::string& group) const override {
    std::error_code failed;
    const std::filesystem::path path(group);
    const bool is_file = path.has_extension() && std::filesystem::is_regular_file(path, failed);
    if (!is_file && (!unit_.empty() || !up_.empty()))
      throw bad_use(fmt::format("--unit and --up go with a file; {} is none", printable(group)));
    return is_file ? group : std::string();
  }
  std::vector<std::string> reading_words() const override {
    std::vector<std::string> words;
    if (!unit_.empty()) words.insert(words.end(), {"--unit", unit_});
    if (!up_.empty()) words.insert(words.end(), {"--up", up_});
    return words;
  }

  std::string of_ = "*";
  std::optional<std::uint64_t> count_;
  std::string unit_;
  std::string up_;
};

}  // namespace

std::unique_ptr<Command> make_clearance() { return std::make_unique<ClearanceCommand>(); }
std::unique_ptr<Command> make_clash() { return std::make_unique<ClashCommand>(); }

}  // namespace collided::cli
