#include <cmath>

#include "server/service/commands/command_family.hpp"
#include "server/service/commands/object_description.hpp"
#include "server/world/query/plan.hpp"

namespace collided::engine::service {

using nlohmann::json;
namespace names = wire_contract::command;

namespace {

json durations(const DurationCounts& counts) {
  json steps = json::array();
  counts.for_each([&](std::int64_t longest_ns, std::uint64_t count) { steps.push_back({longest_ns, count}); });
  return steps;
}

json stages(const StepSums& sums) {
  json rows = json::array();
  const auto row = [&](const char* stage, const Tally& ns) { rows.push_back({{"stage", stage}, {"ns", ns.get()}}); };
  row("take", sums.take_ns);
  row("update", sums.update_ns);
  row("index", sums.index_ns);
  row("test", sums.test_ns);
  row("events", sums.events_ns);
  row("publish", sums.publish_ns);
  return rows;
}

/// What is held of the scenes whose files are in tiles.
json tiles_of(const Snapshot& state) {
  json rows = json::array();
  for (const auto& scene : state.scenes) {
    if (!scene->tiles) continue;
    rows.push_back(tiles_json(*scene->tiles));
    rows.back()["scene"] = scene->name;
    rows.back()["triangles"] = scene->mesh.triangles.size();
  }
  return rows;
}

json questions(const QuestionCounts& counts) {
  json rows = json::array();
  for (const QuestionKind kind : {QuestionKind::ray, QuestionKind::sphere, QuestionKind::box, QuestionKind::near,
                                  QuestionKind::sweep, QuestionKind::inside, QuestionKind::what_if}) {
    const auto number = static_cast<std::size_t>(kind);
    std::uint64_t answered = 0;
    for (const auto& level : counts.levels[number]) answered += level.load(std::memory_order_relaxed);
    rows.push_back(
        {{"kind", name_of(kind)}, {"answered", answered}, {"durations", durations(counts.durations[number])}});
  }
  return rows;
}

class ServerCommands : public CommandFamily {
 public:
  using CommandFamily::CommandFamily;
  std::vector<BoundCommand> commands() override;

 private:
  json plan() const;
  json covers() const;
  json figures() const;
  json steps(const Arguments& arguments) const;
  json accept_loss(const Arguments& arguments);  // on the world's thread

  const std::int64_t started_ns_ = steady_ns();
};

}  // namespace

std::unique_ptr<CommandFamily> server_commands(CommandContext& context) {
  return std::make_unique<ServerCommands>(context);
}

std::vector<BoundCommand> ServerCommands::commands() {
  return {on_asking_thread(names::kPlan, this, &ServerCommands::plan),
          on_asking_thread(names::kCovers, this, &ServerCommands::covers),
          on_asking_thread(names::kFigures, this, &ServerCommands::figures),
          on_asking_thread(names::kSteps, this, &ServerCommands::steps),
          on_world_thread(names::kAcceptLoss, this, &ServerCommands::accept_loss)};
}

/// Which structures the server builds for this world, and which it leaves out and why.
json ServerCommands::plan() const {
  const SnapshotRing::Lease state = with_.loop.world().newest();
  json structures = json::array();
  std::vector<PlanRow> rows = plan_of(*state, with_.loop.contacts_wanted());
  rows.push_back(plan_of_probes(with_.loop.probe_count(), with_.loop.probes_wanted()));
  if (const std::uint64_t cut_short = with_.loop.sums().fences_cut_short.get(); cut_short > 0)
    rows.push_back(plan_of_cut_searches(cut_short));
  if (with_.durable == nullptr) {
    rows.push_back({.structure = "journal",
                    .built = false,
                    .reason = "no folder to keep it in, so what commands do is lost with a crash",
                    .saves = ""});
  }
  for (const PlanRow& row : rows) {
    structures.push_back(
        {{"structure", row.structure}, {"built", row.built}, {"why", row.reason}, {"saves", row.saves}});
  }
  json pairs = json::array();
  for (const PairRow& row : pair_table()) pairs.push_back({{"a", row.a}, {"b", row.b}, {"how", row.how}});
  std::uint64_t bytes = 0;
  json scenes = json::array();
  for (const auto& scene : state->scenes) {
    bytes += scene->bytes();
    scenes.push_back({{"scene", scene->name}, {"load", json::parse(scene->source, nullptr, false)}});
    if (scene->tiles) scenes.back()["tiles"] = tiles_json(*scene->tiles);
    // An uploaded file is the server's own copy, which goes with the scene.
    if (scenes.back()["load"].is_discarded() || scenes.back()["load"].contains("foreign"))
      scenes.back()["load"] = nullptr;
  }
  return {{"structures", structures}, {"pairs", pairs}, {"scenes", scenes}, {"bytes", bytes}};
}

json ServerCommands::covers() const {
  const SnapshotRing::Lease state = with_.loop.world().newest();
  return {{"covers", state->covers ? covers_json(*state->covers) : json(nullptr)}, {"version", state->version}};
}

/// The counts since the start, as idl/commands.hpp lists them under `figures`.
json ServerCommands::figures() const {
  const StepSums& sums = with_.loop.sums();
  const SnapshotRing::Lease state = with_.loop.world().newest();
  json clocks = json::array();
  for (const WorldLoop::PublisherClock& clock : with_.loop.publisher_clocks())
    clocks.push_back({{"publisher", clock.name}, {"behind_ns", clock.behind_ns}});
  json not_built = json::array();
  for (const PlanRow& row : plan_of(*state, with_.loop.contacts_wanted())) {
    if (!row.built) not_built.push_back(row.structure);
  }
  return {{"up_ns", steady_ns() - started_ns_},
          {"keeps_nothing", with_.durable == nullptr},
          {"version", state->version},
          {"step_period_ns", with_.loop.step_period_ns()},
          {"steps", sums.steps.get()},
          {"stalled_steps", sums.stalled_steps.get()},
          {"step_durations", durations(sums.durations)},
          {"stages", stages(sums)},
          {"pairs",
           {{"moved", sums.moved.get()},
            {"candidates", sums.candidates.get()},
            {"filtered", sums.filtered.get()},
            {"exact_tests", sums.exact_tests.get()},
            {"undecided", sums.undecided.get()},
            {"in_doubt", sums.in_doubt.get()},
            {"swept", sums.swept.get()},
            {"kept_apart", sums.kept_apart.get()}}},
          {"fences",
           {{"count", sums.fences.get()},
            {"entered", sums.fences_entered.get()},
            {"inside", sums.in_fences.get()},
            {"events", sums.fence_events.get()},
            {"cut_short", sums.fences_cut_short.get()}}},
          {"poses",
           {{"applied", sums.poses_applied.get()},
            {"late", sums.poses_late.get()},
            {"unknown", sums.poses_unknown.get()},
            {"refused", sums.poses_refused.get()},
            {"superseded", sums.poses_superseded.get()},
            {"dropped", sums.poses_dropped.get()}}},
          {"stamps",
           {{"late", sums.stamps_late.get()},
            {"jumped", sums.stamps_jumped.get()},
            {"missing", sums.stamps_missing.get()}}},
          {"clocks", clocks},
          {"questions", questions(with_.counts)},
          {"refused", with_.counts.refused.load()},
          {"undecided", with_.counts.undecided.load()},
          {"filters_dropped", with_.counts.filters_dropped.load()},
          {"not_built", not_built},
          {"tiles", tiles_of(*state)}};
}

/// The newest steps, stage by stage, as idl/commands.hpp lists them under `steps`.
json ServerCommands::steps(const Arguments& arguments) const {
  const std::uint64_t last = arguments.whole("last");
  json rows = json::array();
  for (const StepTrace& trace : with_.loop.traces().newest(last)) {
    rows.push_back({{"version", trace.version},
                    {"world_time_ns", trace.world_time_ns},
                    {"whole_ns", trace.whole_ns},
                    {"take_ns", trace.take_ns},
                    {"update_ns", trace.update_ns},
                    {"index_ns", trace.index_ns},
                    {"test_ns", trace.test_ns},
                    {"events_ns", trace.events_ns},
                    {"publish_ns", trace.publish_ns},
                    {"moved", trace.moved},
                    {"candidates", trace.candidates},
                    {"exact_tests", trace.exact_tests},
                    {"contacts", trace.contacts},
                    {"events", trace.events}});
  }
  return {{"steps", rows}};
}

/// What of the time before the crash is missing, and, unless that is only to be shown, that the world counts as whole
/// without it.
json ServerCommands::accept_loss(const Arguments& arguments) {
  const bool shows_only = arguments.truth("show");
  const std::vector<std::string> losses =
      with_.durable != nullptr ? with_.durable->losses() : std::vector<std::string>();
  if (!shows_only && with_.durable != nullptr) with_.durable->accept_losses();
  return {{"losses", losses}, {"accepted", !shows_only && !losses.empty()}};
}

}  // namespace collided::engine::service
