#include "client/view/figures.hpp"

#include <algorithm>
#include <cmath>

#include "idl/described_json.hpp"

namespace collided::view {
namespace {

/// The growth of a count, never negative. The counts in one reading are not taken at the same instant.
std::uint64_t grown(std::uint64_t older, std::uint64_t newer) { return newer > older ? newer - older : 0; }

/// The growth of each of these counts.
template <Described Counts>
Counts grown(const Counts& older, const Counts& newer) {
  Counts more;
  visit_fields<Counts>([&](const auto& field) { more.*field.member = grown(field.of(older), field.of(newer)); });
  return more;
}

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
    return from_json<Figures>(nlohmann::json::parse(text));
  } catch (const nlohmann::json::exception&) { return std::nullopt; }
}

Figures between(const Figures& older, const Figures& newer) {
  Figures more = newer;
  if (newer.up_ns < older.up_ns) return more;
  more.up_ns = newer.up_ns - older.up_ns;
  for (std::uint64_t Figures::*sum :
       {&Figures::steps, &Figures::stalled_steps, &Figures::refused, &Figures::undecided, &Figures::filters_dropped})
    more.*sum = grown(older.*sum, newer.*sum);
  more.pairs = grown(older.pairs, newer.pairs);
  more.pairs.in_doubt = newer.pairs.in_doubt;
  more.fences.events = grown(older.fences.events, newer.fences.events);
  more.poses = grown(older.poses, newer.poses);
  more.stamps = grown(older.stamps, newer.stamps);
  more.step_durations = grown(older.step_durations, newer.step_durations);
  for (std::size_t i = 0; i < std::min(older.stages.size(), more.stages.size()); ++i)
    more.stages[i].ns = grown(older.stages[i].ns, newer.stages[i].ns);
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
