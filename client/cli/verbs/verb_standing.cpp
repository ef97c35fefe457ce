#include <chrono>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "client/cli/command.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/input/option.hpp"
#include "client/cli/output/standing_output.hpp"
#include "client/cli/pace.hpp"
#include "client/cli/verbs/standing_words.hpp"

namespace collided::cli {
namespace {

/// The user's name for the standing questions of a form.
struct CalledForm {
  StandingForm form;
  std::string verb;
  std::string one;
  std::string many;
  std::string usage;  // of the words after "add"
  std::unique_ptr<StandingWords> (*words)();
};

/// The verbs fence, margin and nearest: one command, restricted to the standing questions of its form.
class StandingCommand : public Command {
 public:
  explicit StandingCommand(CalledForm called) : called_(std::move(called)), add_words_(called_.words()) {}

  void declare(CLI::App& app) override {
    const std::string watched = fmt::format("watch: {}s or objects (glob)", called_.one);
    option(app, "words add|ls|rm|watch NAME", words_, called_.usage + ", ls [GLOB], rm GLOB, or watch [GLOB]");
    add_words_->declare(app);
    const bool is_region = called_.form == StandingForm::region;
    option(app, "--only GLOB", only_, is_region ? "add: objects that it looks at; " + watched : watched);
    option(app, "--skip GLOB", skip_, "add: objects that it leaves out; " + watched);
    option(app, "--mask", mask_, "add: layers of the objects that it looks at: bits (all)");
    app.add_flag("--keep", is_kept_, "add: it stays until it is removed, and outlives the server");
    option(app, "-n", most_events_, "End after so many events");
    option(app, "--for", most_time_, "End after this time");
  }

  Exit run(Session& session, const Globals& globals) override {
    const std::string action = words_.empty() ? "ls" : words_.front();
    const std::string name = words_.size() > 1 ? words_[1] : std::string();
    if (action == "add") return add(session, globals, name);
    if (action == "ls") return list(session, globals, name);
    if (action == "watch") return follow(session, globals, name);
    if (action == "rm") return remove(session, globals, name);
    throw bad_use(fmt::format("'{}' is nothing to do with {}", action, called_.many), "add, ls, rm or watch");
  }

 private:
  Exit add(Session& session, const Globals& globals, const std::string& name) {
    Standing standing{.name = name, .only = only_, .skip = skip_, .mask = mask_, .keep = is_kept_};
    add_words_->read(words_, session.io, standing);
    const AddedStanding added = take(session.client(globals).add(standing));
    if (added.parts > 0) {
      print_warning(session.io,
                    fmt::format("{} of loaded scenes {} and {} no bands; give what stands still a shape of its own: "
                                "collide add",
                                counted(added.parts, "part"), added.parts == 1 ? "matches" : "match",
                                added.parts == 1 ? "has" : "have"));
    }
    // A question that is not kept is removed with the process, so the process stays and prints its events.
    if (!is_kept_ && !session.has_many_verbs) {
      only_ = skip_ = {};
      print_hint(session.io, globals,
                 fmt::format("{} {} stands until this ends; --keep lets it stand", called_.verb, printable(name)));
      return follow(session, globals, name);
    }
    Printer printer = make_printer(session.io, globals);
    if (printer.human()) printer.line(fmt::format("{} {}", called_.verb, printable(name)));
    else printer.record({{"standing", name}});
    printer.finish();
    return Exit::yes;
  }

  Exit list(Session& session, const Globals& globals, const std::string& glob) {
    const std::vector<ListedStanding> all = take(session.client(globals).standing(glob, called_.form));
    Printer printer = make_printer(session.io, globals);
    for (const ListedStanding& standing : all) {
      if (printer.human()) printer.row(standing_columns(), standing_row(standing));
      else printer.record(standing_record(standing));
    }
    printer.finish();
    if (!all.empty()) return Exit::yes;
    print_hint(session.io, globals, fmt::format("no {}s; 'collide {} add' makes one", called_.one, called_.verb));
    return Exit::no;
  }

  Exit remove(Session& session, const Globals& globals, const std::string& glob) {
    if (words_.size() < 2)
      throw bad_use(fmt::format("which {}?", called_.one), fmt::format("collide {} rm GLOB", called_.verb));
    const std::size_t count = take(session.client(globals).remove_standing(glob, called_.form));
    Printer printer = make_printer(session.io, globals);
    if (printer.human()) printer.line("removed " + counted(count, called_.one));
    else printer.record({{"removed", std::uint64_t{count}}});
    printer.finish();
    return count > 0 ? Exit::yes : Exit::no;
  }

  /// Prints events until the end, or Ctrl-C. Exit::no: none came.
  ///
  /// glob  of names of questions or objects; empty: as in --only
  Exit follow(Session& session, const Globals& globals, const std::string& glob) {
    StandingWatch watch = take(session.client(globals).watch_standing(
        {.only = glob.empty() ? only_ : glob, .skip = skip_, .form = called_.form}));
    Printer printer = make_printer(session.io, globals);
    printer.set_usual_fields(usual_standing_fields());
    const Until until(most_events_, most_time_);
    std::uint64_t count = 0;
    while (!until.reached(count) && session.io.out.good()) {
      const std::optional<StandingEvent> event = next_of(watch, session.io, until);
      if (!event) continue;
      if (printer.human()) printer.line(standing_line(printer, *event));
      else printer.record(standing_record(*event));
      ++count;
    }
    session.io.out.flush();
    print_hint(session.io, globals, fmt::format("{}, {} lost", counted(count, "event"), format_count(watch.lost())));
    if (stop_requested) return Exit::interrupted;
    return count > 0 ? Exit::yes : Exit::no;
  }

  CalledForm called_;
  std::unique_ptr<StandingWords> add_words_;
  std::vector<std::string> words_;
  std::string only_;
  std::string skip_;
  std::uint32_t mask_ = 0xffffffff;
  bool is_kept_ = false;
  std::uint64_t most_events_ = 0;  // 0: any number
  std::chrono::nanoseconds most_time_ = std::chrono::nanoseconds::max();
};

}  // namespace

std::unique_ptr<Command> make_fence() {
  return std::make_unique<StandingCommand>(CalledForm{.form = StandingForm::region,
                                                      .verb = "fence",
                                                      .one = "fence",
                                                      .many = "fences",
                                                      .usage = "add NAME REGION NUMBERS",
                                                      .words = region_words});
}

std::unique_ptr<Command> make_margin() {
  return std::make_unique<StandingCommand>(CalledForm{.form = StandingForm::bands,
                                                      .verb = "margin",
                                                      .one = "margin",
                                                      .many = "margins",
                                                      .usage = "add NAME GLOB GLOB DISTANCE,...",
                                                      .words = bands_words});
}

std::unique_ptr<Command> make_nearest() {
  return std::make_unique<StandingCommand>(
      CalledForm{.form = StandingForm::nearest,
                 .verb = "nearest",
                 .one = "question",
                 .many = "the nearest",
                 .usage = "add NAME GLOB OBJECT DISTANCE, add NAME GLOB X Y Z DISTANCE",
                 .words = nearest_words});
}

}  // namespace collided::cli
