#include <fmt/format.h>

#include "client/cli/command.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/input/option.hpp"
#include "client/cli/output/margin_output.hpp"
#include "client/cli/output/readable.hpp"
#include "client/cli/verbs/standing.hpp"

namespace collided::cli {
namespace {

/// The distances of "5m,2m,50cm", in metres.
std::vector<double> bands_of(const std::vector<std::string>& words) {
  std::vector<double> bands_m = parse_numbers(words, Measure::length);
  for (std::size_t i = 0; i < bands_m.size(); ++i) {
    if (!std::isfinite(bands_m[i]) || bands_m[i] < 0)
      throw bad_use(fmt::format("band {} is {} m; a finite distance, 0 or more, is needed", i + 1, bands_m[i]));
    if (i > 0 && !(bands_m[i] < bands_m[i - 1]))
      throw bad_use(
          fmt::format("band {}, {} m, is not less than the one before it, {} m", i + 1, bands_m[i], bands_m[i - 1]),
          "the widest comes first: 5m,2m,50cm");
  }
  if (bands_m.empty()) throw bad_use("a margin needs a distance", "collide margin add NAME GLOB GLOB 5m,2m,50cm");
  return bands_m;
}

class MarginCommand : public StandingCommand {
 public:
  MarginCommand() : StandingCommand({"margin", "margin", "margins"}) {}

  void declare(CLI::App& app) override {
    option(app, "words add|ls|rm|watch NAME", words_,
           "add NAME GLOB GLOB DISTANCE,..., ls [GLOB], rm GLOB, or watch [GLOB]");
    option(app, "--hysteresis", Measure::length, margin_.hysteresis_m,
           "add: who is within a band leaves it so much farther out (0)");
    option(app, "--dwell", margin_.dwell, "add: a change is told once it has lasted so long; contact at once (0)");
    option(app, "--only GLOB", only_, "watch: margins or objects (glob)");
    option(app, "--skip GLOB", skip_, "add: objects that have no part in it; watch: margins or objects (glob)");
    option(app, "--mask", mask_, "add: layers of the moving objects of the second group: bits (all)");
    declare_ends(app);
  }

 private:
  Exit add(Session& session, const Globals& globals) override {
    if (words_.size() < 5)
      throw bad_use("a name, two groups and distances are needed",
                    "collide margin add close 'drone*' 'person*' 5m,2m,50cm");
    margin_.name = words_[1];
    margin_.around = words_[2];
    margin_.only = words_[3];
    margin_.skip = skip_;
    margin_.mask = mask_;
    margin_.keep = is_kept_;
    margin_.bands_m = bands_of({words_.begin() + 4, words_.end()});
    const AddedMargin added = take(session.client(globals).add_margin(margin_));
    if (added.parts > 0) {
      print_warning(session.io,
                    fmt::format("{} of loaded scenes {} and {} no bands; give what stands still a shape of its own: "
                                "collide add",
                                counted(added.parts, "part"), added.parts == 1 ? "matches" : "match",
                                added.parts == 1 ? "has" : "have"));
    }
    return stands(session, globals, margin_.name);
  }

  Exit list(Session& session, const Globals& globals) override {
    return print_list(
        session, globals, take(session.client(globals).margins(word(1))),
        {"MARGIN", "AROUND", "FOR", "BANDS", "HYSTERESIS", "DWELL", "KEPT", "WITHIN"},
        [](const ListedMargin& listed) { return margin_record(listed); }, margin_row);
  }

  std::size_t remove(Session& session, const Globals& globals, const std::string& glob) override {
    return take(session.client(globals).remove_margins(glob));
  }

  Exit follow(Session& session, const Globals& globals, const std::string& glob) override {
    MarginWatch watch =
        take(session.client(globals).watch_margins({.only = glob.empty() ? only_ : glob, .skip = skip_}));
    return follow_events(session, globals, std::move(watch), until(), usual_margin_fields(), margin_line,
                         [](const MarginEvent& event) { return margin_record(event); });
  }

  Margin margin_;
};

}  // namespace

std::unique_ptr<Command> make_margin() { return std::make_unique<MarginCommand>(); }

}  // namespace collided::cli
