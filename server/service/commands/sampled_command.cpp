#include <cmath>

#include "idl/described_json.hpp"
#include "server/service/commands/command_family.hpp"
#include "server/service/commands/object_description.hpp"
#include "server/service/questions/question_samples.hpp"

namespace collided::engine::service {
namespace {

using nlohmann::json;

/// The numbers of a question, by the names in its verb of `collide`. A ray without an end has no length, a search
/// without one no reach.
void add_question(json& row, const SampledQuestion& sample) {
  const auto vector = [&](std::size_t first) {
    return json_of(Vec3(Eigen::Map<const Vec3>(sample.numbers.data() + first)));
  };
  const auto add_finite = [&row](const char* name, double value) {
    if (std::isfinite(value)) row[name] = value;
  };
  switch (sample.kind) {
    case QuestionKind::ray:
      row["origin"] = vector(0);
      row["direction"] = vector(3);
      return add_finite("length", sample.numbers[6]);
    case QuestionKind::sphere:
      row["center"] = vector(0);
      row["radius"] = sample.numbers[3];
      return;
    case QuestionKind::box:
      row["center"] = vector(0);
      row["half"] = vector(3);
      row["orientation"] = {sample.numbers[6], sample.numbers[7], sample.numbers[8], sample.numbers[9]};
      return;
    case QuestionKind::near: row["point"] = vector(0); return add_finite("reach", sample.numbers[3]);
    default: row["point"] = vector(0); return;
  }
}

class SampledCommands : public CommandFamily {
 public:
  using CommandFamily::CommandFamily;
  std::vector<BoundCommand> commands() override;

 private:
  json sampled(const CommandAsk& ask, const Arguments& arguments);
};

}  // namespace

std::unique_ptr<CommandFamily> sampled_commands(CommandContext& context) {
  return std::make_unique<SampledCommands>(context);
}

std::vector<BoundCommand> SampledCommands::commands() {
  return {on_asking_thread(wire_contract::command::kSampled, this, &SampledCommands::sampled)};
}

/// Some questions of other clients, as idl/commands.hpp lists them under `sampled`.
json SampledCommands::sampled(const CommandAsk& ask, const Arguments& arguments) {
  std::uint64_t since = arguments.whole("since");
  const std::int64_t now_ns = steady_ns();
  json rows = json::array();
  for (const SampledQuestion& sample : with_.samples.read(since, ask.client, now_ns)) {
    json& row = rows.emplace_back(json{{"sequence", sample.sequence},
                                       {"kind", name_of(sample.kind)},
                                       {"ago_ns", now_ns - sample.taken_ns},
                                       {"answer", name_of(sample.verdict)}});
    add_question(row, sample);
    since = sample.sequence;
    if (!sample.has_hit) continue;
    row["object"] = sample.object.data();
    row["distance"] = sample.hit.distance_m;
    row["error"] = json_of(sample.hit.error_m);
    row["at"] = json_of(sample.hit.point);
    row["normal"] = json_of(sample.hit.normal);
  }
  return {{"questions", rows}, {"since", since}};
}

}  // namespace collided::engine::service
