#include "client/view/figures.hpp"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

namespace collided::view {
namespace {

using nlohmann::json;

std::vector<DurationStep> durations_of(const json& steps) {
  std::vector<DurationStep> durations;
  for (const json& step : steps) durations.push_back({step.at(0).get<std::int64_t>(), step.at(1).get<std::uint64_t>()});
  return durations;
}

Figures figures_of(const json& answer) {
  Figures figures;
  answer.at("up_ns").get_to(figures.up_ns);
  answer.at("step_period_ns").get_to(figures.step_period_ns);
  answer.at("steps").get_to(figures.steps);
  answer.at("stalled_steps").get_to(figures.stalled_steps);
  figures.step_durations = durations_of(answer.at("step_durations"));
  for (const json& stage : answer.at("stages")) {
    figures.stages.push_back({stage.at("stage").get<std::string>(), stage.at("ns").get<std::uint64_t>()});
  }
  const json& pairs = answer.at("pairs");
  pairs.at("candidates").get_to(figures.candidates);
  figures.in_doubt = pairs.value("in_doubt", std::uint64_t{0});
  pairs.at("filtered").get_to(figures.filtered);
  pairs.at("exact_tests").get_to(figures.exact_tests);
  if (const auto fences = answer.find("fences"); fences != answer.end()) {
    fences->at("count").get_to(figures.fences);
    fences->at("entered").get_to(figures.fences_entered);
    fences->at("inside").get_to(figures.in_fences);
    fences->at("events").get_to(figures.fence_events);
    figures.fences_cut_short = fences->value("cut_short", std::uint64_t{0});
  }
  answer.at("refused").get_to(figures.refused_requests);
  answer.at("undecided").get_to(figures.undecided_answers);
  const json& poses = answer.at("poses");
  poses.at("applied").get_to(figures.poses_applied);
  poses.at("late").get_to(figures.poses_late);
  for (const char* fate : {"unknown", "refused", "superseded", "dropped"}) {
    figures.poses_lost += poses.at(fate).get<std::uint64_t>();
  }
  const json& stamps = answer.at("stamps");
  stamps.at("late").get_to(figures.stamps_late);
  stamps.at("jumped").get_to(figures.stamps_jumped);
  stamps.at("missing").get_to(figures.stamps_missing);
  for (const json& asked : answer.at("questions")) {
    figures.questions.push_back({.kind = asked.at("kind").get<std::string>(),
                                 .answered = asked.at("answered").get<std::uint64_t>(),
                                 .durations = durations_of(asked.at("durations"))});
  }
  answer.at("not_built").get_to(figures.not_built);
  return figures;
}

/// The growth of a count, never negative. The counts in one reading are not taken at the same instant.
std::uint64_t grown(std::uint64_t older, std::uint64_t newer) { return newer > older ? newer - older : 0; }

std::vector<DurationStep> grown(const std::vector<DurationStep>& older, const std::vector<DurationStep>& newer) {
  std::vector<DurationStep> more;
  auto before = older.begin();
  for (const DurationStep& step : newer) {
    while (before != older.end() && before->longest_ns < step.longest_ns) ++before;
    const bool known = before != older.end() && before->longest_ns == step.longest_ns;
    const std::uint64_t count = grown(known ? before->count : 0, step.count);
    if (count > 0) more.push_back({step.longest_ns, count});
  }
  return more;
}

}  // namespace

std::optional<Figures> parse_figures(std::string_view text) {
  try {
    return figures_of(json::parse(text));
  } catch (const json::exception&) { return std::nullopt; }
}

Figures between(const Figures& older, const Figures& newer) {
  Figures more = newer;
  if (newer.up_ns < older.up_ns) return more;
  more.up_ns = newer.up_ns - older.up_ns;
  const auto subtract = [&](std::uint64_t Figures::*sum) { more.*sum = grown(older.*sum, newer.*sum); };
  for (const auto sum :
       {&Figures::steps, &Figures::stalled_steps, &Figures::candidates, &Figures::filtered, &Figures::exact_tests,
        &Figures::fence_events, &Figures::refused_requests, &Figures::undecided_answers, &Figures::poses_applied,
        &Figures::poses_late, &Figures::poses_lost, &Figures::stamps_late, &Figures::stamps_jumped,
        &Figures::stamps_missing}) {
    subtract(sum);
  }
  more.step_durations = grown(older.step_durations, newer.step_durations);
  for (std::size_t i = 0; i < std::min(older.stages.size(), more.stages.size()); ++i) {
    more.stages[i].ns = grown(older.stages[i].ns, newer.stages[i].ns);
  }
  for (std::size_t i = 0; i < std::min(older.questions.size(), more.questions.size()); ++i) {
    more.questions[i].answered = grown(older.questions[i].answered, newer.questions[i].answered);
    more.questions[i].durations = grown(older.questions[i].durations, newer.questions[i].durations);
  }
  return more;
}

std::optional<std::int64_t> quantile_ns(std::span<const DurationStep> durations, double part) {
  std::uint64_t total = 0;
  for (const DurationStep& step : durations) total += step.count;
  if (total == 0) return std::nullopt;
  const auto wanted = static_cast<std::uint64_t>(std::ceil(part * static_cast<double>(total)));
  std::uint64_t seen = 0;
  for (const DurationStep& step : durations) {
    seen += step.count;
    if (seen >= wanted) return step.longest_ns;
  }
  return durations.back().longest_ns;
}

}  // namespace collided::view
