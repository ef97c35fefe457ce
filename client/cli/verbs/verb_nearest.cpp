#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "client/cli/command.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/output/nearest_output.hpp"
#include "client/cli/output/readable.hpp"
#include "client/cli/verbs/standing.hpp"

namespace collided::cli {
namespace {

constexpr const char* kNearestForms =
    "collide nearest add escape 'door_*' person_7 20m, or collide nearest add yard 'truck_*' 4 0 1 50m";

/// What the first word after the verb says is done: add, ls, rm or watch.
class NearestCommand : public Command {
 public:
  void declare(CLI::App& app) override {
    app.add_option("words", words_,
                   "add NAME GLOB OBJECT DISTANCE, add NAME GLOB X Y Z DISTANCE, ls [GLOB], rm GLOB, or "
                   "watch [GLOB]");
    app.add_option("--hysteresis", hysteresis_, "add: another one must be nearer by more than this (0)");
    app.add_option("--only", only_, "watch: questions or objects (glob)");
    app.add_option("--skip", skip_, "add: objects that do not count; watch: questions or objects (glob)");
    app.add_option("--mask", mask_, "add: layers of the objects that count: bits (all)");
    app.add_flag("--keep", nearest_.keep, "add: it stays, after a crash too, until it is removed");
    app.add_option("-n", most_events_, "End after so many events");
    app.add_option("--for", most_time_, "End after this time");
  }

  Exit run(Session& session, const Globals& globals) override {
    const std::string action = words_.empty() ? "ls" : words_.front();
    if (action == "add") return add(session, globals);
    if (action == "ls") return list(session, globals);
    if (action == "rm") return remove(session, globals);
    if (action == "watch") return follow(session, globals, word(1));
    throw bad_use(fmt::format("'{}' is nothing to do with the nearest", action), "add, ls, rm or watch");
  }

 private:
  std::string word(std::size_t index) const { return index < words_.size() ? words_[index] : std::string(); }

  /// A question that is not kept goes with the process, so the process stays and tells of it.
  Exit add(Session& session, const Globals& globals) {
    if (words_.size() != 5 && words_.size() != 7)
      throw bad_use("a name, a group, an object or point, and a distance are needed", kNearestForms);
    nearest_.name = words_[1];
    nearest_.only = words_[2];
    if (words_.size() == 5) {
      nearest_.to = words_[3];
    } else {
      nearest_.point = Vec3(parse_finite(words_[3], Measure::length), parse_finite(words_[4], Measure::length),
                            parse_finite(words_[5], Measure::length));
    }
    nearest_.within_m = parse_finite(words_.back(), Measure::length);
    if (!(nearest_.within_m > 0)) throw bad_use("distance " + words_.back() + ": more than 0 is needed", kNearestForms);
    nearest_.hysteresis_m = parse_finite(hysteresis_, Measure::length);
    if (nearest_.hysteresis_m < 0) throw bad_use("--hysteresis " + hysteresis_ + ": a distance of 0 or more is needed");
    nearest_.skip = skip_;
    nearest_.mask = parse_bits(mask_);
    take(session.client(globals).add_nearest(nearest_));
    if (!nearest_.keep && !session.has_many_verbs) {
      skip_ = {};
      print_hint(session.io, globals,
                 fmt::format("nearest {} stands until this ends; --keep lets it stand", printable(nearest_.name)));
      return follow(session, globals, nearest_.name);
    }
    print_standing(session, globals, "nearest", nearest_.name);
    return Exit::yes;
  }

  Exit list(Session& session, const Globals& globals) {
    const std::vector<ListedNearest> all = take(session.client(globals).nearest(word(1)));
    Printer printer = make_printer(session.io, globals);
    for (const ListedNearest& listed : all) {
      if (!printer.human()) {
        printer.record(nearest_record(listed));
        continue;
      }
      printer.row({"NEAREST", "LOOKS AT", "OF", "WITHIN", "HYSTERESIS", "KEPT", "IS"}, nearest_row(listed));
    }
    printer.finish();
    return all.empty() ? Exit::no : Exit::yes;
  }

  Exit remove(Session& session, const Globals& globals) {
    if (words_.size() < 2) throw bad_use("which question?", "collide nearest rm GLOB");
    return print_removed(session, globals, "question", take(session.client(globals).remove_nearest(words_[1])));
  }

  Exit follow(Session& session, const Globals& globals, const std::string& glob) {
    const Until until = follow_end(most_events_, most_time_);
    NearestWatch watch =
        take(session.client(globals).watch_nearest({.only = glob.empty() ? only_ : glob, .skip = skip_}));
    return follow_events(session, globals, std::move(watch), until, usual_nearest_fields(), nearest_line,
                         [](const NearestEvent& event) { return nearest_record(event); });
  }

  std::vector<std::string> words_;
  NearestQuestion nearest_;
  std::string hysteresis_ = "0";
  std::string only_;
  std::string skip_;
  std::string mask_ = "0xffffffff";
  std::string most_events_;
  std::string most_time_;
};

}  // namespace

std::unique_ptr<Command> make_nearest() { return std::make_unique<NearestCommand>(); }

}  // namespace collided::cli
