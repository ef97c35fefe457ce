#include "idl/described_json.hpp"
#include "server/service/commands/command_family.hpp"
#include "server/service/commands/object_description.hpp"
#include "server/world/query/plan.hpp"

namespace collided::engine::service {

using nlohmann::json;
namespace names = wire_contract::command;

namespace {

std::vector<DurationStep> durations(const DurationCounts& counts) {
  std::vector<DurationStep> steps;
  counts.for_each([&](std::int64_t longest_ns, std::uint64_t count) { steps.push_back({longest_ns, count}); });
  return steps;
}

std::vector<StageTime> stages(const StepSums& sums) {
  return {{"take", sums.take_ns.get()}, {"update", sums.update_ns.get()}, {"index", sums.index_ns.get()},
          {"test", sums.test_ns.get()}, {"events", sums.events_ns.get()}, {"publish", sums.publish_ns.get()}};
}

/// The counts as they are now.
template <template <class> class Counts>
Counts<std::uint64_t> now(const Counts<Tally>& sums) {
  Counts<std::uint64_t> counts;
  const auto take = [&](const auto&... to) {
    const auto from = [&](const auto&... of) { ((counts.*to.member = of.of(sums).get()), ...); };
    std::apply(from, fields_of(&sums));
  };
  std::apply(take, fields_of(&counts));
  return counts;
}

/// The tiles held of scenes whose files are in tiles.
std::vector<HeldTiles> tiles_of(const Snapshot& state) {
  std::vector<HeldTiles> rows;
  for (const auto& scene : state.scenes) {
    if (!scene->tiles) continue;
    rows.push_back({.scene = scene->name,
                    .read = scene->tiles->tiles,
                    .of = scene->tiles->tiles_of_file,
                    .triangles = scene->mesh.triangles.size(),
                    .triangles_of_file = scene->tiles->triangles_of_file});
  }
  return rows;
}

std::vector<AskedKind> questions(const QuestionCounts& counts) {
  std::vector<AskedKind> rows;
  for (const QuestionKind kind : {QuestionKind::ray, QuestionKind::sphere, QuestionKind::box, QuestionKind::near,
                                  QuestionKind::sweep, QuestionKind::inside, QuestionKind::what_if}) {
    const auto number = static_cast<std::size_t>(kind);
    AskedKind& row = rows.emplace_back();
    row.kind = name_of(kind);
    for (const auto& level : counts.levels[number]) row.answered += level.load(std::memory_order_relaxed);
    row.durations = durations(counts.durations[number]);
  }
  return rows;
}

class ServerCommands : public CommandFamily {
 public:
  using CommandFamily::CommandFamily;
  std::vector<BoundCommand> commands() override;

 private:
  std::vector<Wing> wings() const;
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

/// The optional parts of this server.
std::vector<Wing> ServerCommands::wings() const {
  std::vector<Wing> wings;
  with_.place.list_wings(wings);
  wings.push_back({.name = "keys", .in_use = with_.uses_keys});
  wings.push_back({.name = "flight recorder", .in_use = with_.flight != nullptr});
  return wings;
}

/// The structures that the server builds for this world, and those that it leaves out, with reasons.
json ServerCommands::plan() const {
  const SnapshotRing::Lease state = with_.loop.world().newest();
  Plan plan;
  std::vector<PlanRow> rows = plan_of(*state, with_.loop.contacts_wanted());
  rows.push_back(plan_of_probes(with_.loop.probe_count(), with_.loop.probes_wanted()));
  if (const std::uint64_t cut_short = with_.loop.sums().fences.cut_short.get(); cut_short > 0)
    rows.push_back(plan_of_cut_searches(cut_short));
  if (with_.durable == nullptr) {
    rows.push_back({.structure = "journal",
                    .built = false,
                    .reason = "no folder to keep it in, so what commands do is lost when the server ends",
                    .saves = ""});
  }
  for (const PlanRow& row : rows)
    plan.structures.push_back(
        {.structure = row.structure, .built = row.built, .reason = row.reason, .saves = row.saves});
  for (const PairRow& row : pair_table()) plan.pairs.push_back({.a = row.a, .b = row.b, .how = row.how});
  json scenes = json::array();
  for (const auto& scene : state->scenes) {
    plan.bytes += scene->bytes();
    scenes.push_back({{"scene", scene->name}, {"load", json::parse(scene->source, nullptr, false)}});
    if (scene->tiles) scenes.back()["tiles"] = tiles_json(*scene->tiles);
    // An uploaded file is the server's own copy, which is removed with the scene.
    if (scenes.back()["load"].is_discarded() || scenes.back()["load"].contains("foreign"))
      scenes.back()["load"] = nullptr;
  }
  plan.wings = wings();
  json answer = json_of(plan);
  answer["scenes"] = scenes;
  return answer;
}

json ServerCommands::covers() const {
  const SnapshotRing::Lease state = with_.loop.world().newest();
  return {{"covers", state->covers ? json_of(covered_boxes(*state->covers)) : json(nullptr)},
          {"version", state->version}};
}

/// The counts since the start.
json ServerCommands::figures() const {
  const StepSums& sums = with_.loop.sums();
  const SnapshotRing::Lease state = with_.loop.world().newest();
  Figures figures{.up_ns = steady_ns() - started_ns_,
                  .keeps_nothing = with_.durable == nullptr,
                  .version = state->version,
                  .step_period_ns = with_.loop.step_period_ns(),
                  .steps = sums.steps.get(),
                  .stalled_steps = sums.stalled_steps.get(),
                  .step_durations = durations(sums.durations),
                  .stages = stages(sums),
                  .pairs = now(sums.pairs),
                  .fences = now(sums.fences),
                  .poses = now(sums.poses),
                  .stamps = now(sums.stamps),
                  .clocks = with_.loop.publisher_clocks(),
                  .questions = questions(with_.counts),
                  .refused = with_.counts.refused.load(),
                  .undecided = with_.counts.undecided.load(),
                  .filters_dropped = with_.counts.filters_dropped.load(),
                  .tiles = tiles_of(*state),
                  .wings = wings()};
  for (const PlanRow& row : plan_of(*state, with_.loop.contacts_wanted())) {
    if (!row.built) figures.not_built.push_back(row.structure);
  }
  return json_of(figures);
}

/// The newest steps, stage by stage.
json ServerCommands::steps(const Arguments& arguments) const {
  return json_of(NewestSteps{.steps = with_.loop.traces().newest(arguments.whole("last"))});
}

/// Lists what is missing since the crash and, unless only asked to show it, declares the world complete without it.
json ServerCommands::accept_loss(const Arguments& arguments) {
  const bool shows_only = arguments.truth("show");
  const std::vector<std::string> losses =
      with_.durable != nullptr ? with_.durable->losses() : std::vector<std::string>();
  if (!shows_only && with_.durable != nullptr) {
    for (const KeptKey& key : with_.durable->accept_losses()) with_.inventory.erase(key);
  }
  return {{"losses", losses}, {"accepted", !shows_only && !losses.empty()}};
}

}  // namespace collided::engine::service
