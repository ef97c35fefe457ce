#include <fmt/format.h>

#include "client/cli/command.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/input/option.hpp"
#include "client/cli/output/nearest_output.hpp"
#include "client/cli/output/readable.hpp"
#include "client/cli/verbs/standing.hpp"

namespace collided::cli {
namespace {

constexpr const char* kNearestForms =
    "collide nearest add escape 'door_*' person_7 20m, or collide nearest add yard 'truck_*' 4 0 1 50m";

class NearestCommand : public StandingCommand {
 public:
  NearestCommand() : StandingCommand({"nearest", "question", "the nearest"}) {}

  void declare(CLI::App& app) override {
    option(app, "words add|ls|rm|watch NAME", words_,
           "add NAME GLOB OBJECT DISTANCE, add NAME GLOB X Y Z DISTANCE, ls [GLOB], rm GLOB, or "
           "watch [GLOB]");
    option(app, "--hysteresis", Measure::length, nearest_.hysteresis_m,
           "add: another one must be nearer by more than this (0)");
    option(app, "--only GLOB", only_, "watch: questions or objects (glob)");
    option(app, "--skip GLOB", skip_, "add: objects that do not count; watch: questions or objects (glob)");
    option(app, "--mask", mask_, "add: layers of the objects that count: bits (all)");
    declare_ends(app);
  }

 private:
  Exit add(Session& session, const Globals& globals) override {
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
    nearest_.skip = skip_;
    nearest_.mask = mask_;
    nearest_.keep = is_kept_;
    take(session.client(globals).add_nearest(nearest_));
    return stands(session, globals, nearest_.name);
  }

  Exit list(Session& session, const Globals& globals) override {
    return print_list(
        session, globals, take(session.client(globals).nearest(word(1))),
        {"NEAREST", "LOOKS AT", "OF", "WITHIN", "HYSTERESIS", "KEPT", "CUT", "IS"},
        [](const ListedNearest& listed) { return nearest_record(listed); }, nearest_row);
  }

  std::size_t remove(Session& session, const Globals& globals, const std::string& glob) override {
    return take(session.client(globals).remove_nearest(glob));
  }

  Exit follow(Session& session, const Globals& globals, const std::string& glob) override {
    NearestWatch watch =
        take(session.client(globals).watch_nearest({.only = glob.empty() ? only_ : glob, .skip = skip_}));
    return follow_events(session, globals, std::move(watch), until(), usual_nearest_fields(), nearest_line,
                         [](const NearestEvent& event) { return nearest_record(event); });
  }

  NearestQuestion nearest_;
};

}  // namespace

std::unique_ptr<Command> make_nearest() { return std::make_unique<NearestCommand>(); }

}  // namespace collided::cli
