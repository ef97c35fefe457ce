#include <algorithm>
#include <string>
#include <utility>

#include <collided/fleet.hpp>
#include <fmt/format.h>

#include "client/cli/command.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/input/option.hpp"
#include "client/cli/output/clock_text.hpp"
#include "client/cli/programs/fleet/fleet_of_shards.hpp"
#include "client/cli/programs/fleet/fleet_plan.hpp"
#include "client/cli/programs/fleet/fleet_publish.hpp"
#include "client/cli/programs/fleet/fleet_split.hpp"

namespace collided::cli {
namespace {

bool is_wrong(const Finding& finding) { return finding.health == Health::fail; }

class FleetCommand : public Command {
 public:
  void declare(CLI::App& app) override {
    option(app, "action plan|publish|split", action_,
           "plan: propose a shard map; publish: write one to etcd; split: split a shard; without: list who is "
           "there")
        ->check(CLI::IsMember({"plan", "publish", "split"}));
    option(app, "--into N", plan_.into, "plan: so many shards (2)");
    option(app, "--by WHAT", plan_.by, "plan: what counts as load: moving, objects or triangles (moving)");
    option(app, "--margin LENGTH", plan_.margin, "plan: how far outside its box a shard holds everything (1)");
    option(app, "--split NAME", plan_.split, "plan: the shard of --shards that is split (the one with most load)");
    option(app, "-o FILE", plan_.out, "plan: file for the map, or its address in etcd (standard output)");
    option(app, "--to MAP", to_,
           "split: the map that comes after that of --shards (in etcd: KEY/next); publish: its address in etcd");
    option(app, "--revision", publish_.revision, "publish: in the place of the map there that has this revision");
    option(app, "--for", split_.patience, "split: take it back after so long (60s)");
    app.add_flag("--undo", split_.undo, "split: take back what was begun");
  }

  bool takes_shards() const override { return true; }

  Exit run(Session& session, const Globals& globals) override {
    if (action_ != "plan") refuse_options_of_plan();
    if (action_ != "split") refuse_options_of_split();
    if (action_ != "publish" && publish_.revision) throw bad_use("--revision is for 'collide fleet publish'");
    if (action_ != "publish" && action_ != "split" && !to_.empty())
      throw bad_use("--to is for 'collide fleet split' and 'collide fleet publish'");
    publish_.to = split_.to = to_;
    if (action_ == "plan") return plan_shards(session, globals, plan_);
    if (action_ == "split") return split_shards(session, globals, split_);
    if (action_ == "publish") return publish_map(session, globals, publish_);
    if (!globals.shards.empty()) return print_shards(session, globals);
    const Fleet found = take(fleet(connect_options(session.io, globals)));
    Printer printer = make_printer(session.io, globals);
    printer.set_usual_fields({"name", "role", "state", "epoch", "version_text"});
    if (printer.human()) print_table(printer, found.members);
    else
      for (const FleetMember& member : found.members) printer.record(record(member));
    printer.finish();
    for (const Finding& finding : found.findings) {
      if (printer.human()) print_text(printer, finding);
      else print_warning(session.io, finding.text);
    }
    printer.finish();
    return std::ranges::any_of(found.findings, is_wrong) ? Exit::no : Exit::yes;
  }

 private:
  void refuse_options_of_plan() const {
    for (const auto& [name, value] :
         {std::pair("--into", &plan_.into), std::pair("--by", &plan_.by), std::pair("--margin", &plan_.margin),
          std::pair("--split", &plan_.split), std::pair("-o", &plan_.out)}) {
      if (!value->empty()) throw bad_use(fmt::format("{} is for 'collide fleet plan'", name));
    }
  }

  void refuse_options_of_split() const {
    if (split_.patience || split_.undo) throw bad_use("--for and --undo are for 'collide fleet split'");
  }

  static void print_table(Printer& printer, const std::vector<FleetMember>& members) {
    static const std::vector<std::string> kHeader{"NAME", "ROLE",    "STATE", "EPOCH", "WORLD",
                                                  "LAG",  "VERSION", "HOST",  "PID",   "UP"};
    for (const FleetMember& member : members) {
      printer.row(kHeader, {printable(member.name), std::string(name_of(member.role)), member.state,
                            std::to_string(member.epoch), format_count(member.version), format_duration(member.lag),
                            printable(member.version_text), printable(member.host), std::to_string(member.pid),
                            format_duration(member.up)});
    }
  }

  static void print_text(Printer& printer, const Finding& finding) {
    const bool wrong = is_wrong(finding);
    const std::string word = wrong ? "fail" : "warn";
    printer.line(printer.paint(wrong ? Paint::bad : Paint::doubt, word) + "  " + printable(finding.text));
    if (!finding.remedy.empty()) printer.line("        " + finding.remedy);
  }

  static Record record(const FleetMember& member) {
    return {{"name", member.name},
            {"role", name_of(member.role)},
            {"state", member.state},
            {"epoch", member.epoch},
            {"version_text", member.version_text},
            {"host", member.host},
            {"pid", std::uint64_t{member.pid}},
            {"up", seconds_of(member.up)},
            {"world", member.version},
            {"lag", seconds_of(member.lag)},
            {"scene_fingerprint", fmt::format("{:016x}", member.scene_fingerprint)},
            {"world_hash", member.hash_time.count() == 0 ? Value() : Value(fmt::format("{:016x}", member.world_hash))},
            {"hash_time", member.hash_time.count() == 0 ? Value() : Value(seconds_of(member.hash_time))},
            {"clock_ahead", seconds_of(member.clock_ahead)},
            {"alarm", member.alarm}};
  }

  std::string action_;
  FleetPlanOptions plan_;
  FleetSplitOptions split_;
  FleetPublishOptions publish_;
  std::string to_;  // of split and publish
};

}  // namespace

std::unique_ptr<Command> make_fleet() { return std::make_unique<FleetCommand>(); }

}  // namespace collided::cli
