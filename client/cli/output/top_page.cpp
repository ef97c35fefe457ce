#include "client/cli/output/top_page.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "client/cli/input/number.hpp"
#include "client/cli/output/clock_text.hpp"
#include "client/cli/output/figure_text.hpp"

namespace collided::cli {
namespace {

using view::quantile_ns;

double seconds(const Figures& figures) { return std::max(1e-9, seconds_of(std::chrono::nanoseconds(figures.up_ns))); }

double part(std::uint64_t of, std::uint64_t whole) {
  return whole == 0 ? 0 : static_cast<double>(of) / static_cast<double>(whole);
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + printable(name);
  return text;
}

/// A bar chart with a character for each value, in eighths of the largest.
std::string sparkline(const std::deque<double>& values) {
  static constexpr std::array<const char*, 8> kBars{"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
  double largest = 0;
  for (const double value : values) largest = std::max(largest, value);
  std::string line;
  for (const double value : values) {
    const double share = largest > 0 ? value / largest : 0;
    line += kBars[std::min<std::size_t>(7, static_cast<std::size_t>(share * 8))];
  }
  return line;
}

std::uint64_t answered(const Figures& figures) {
  std::uint64_t all = 0;
  for (const AskedKind& asked : figures.questions) all += asked.answered;
  return all;
}

void add_questions(const Look& look, std::vector<std::string>& lines) {
  const Figures& figures = look.figures;
  std::string label = "ASK";
  for (const AskedKind& asked : figures.questions) {
    if (asked.answered == 0) continue;
    lines.push_back(fmt::format("{:<7}{:<7}{:>10}  p50 {:<8} p99 {:<8}", label, asked.kind,
                                rate_text(per_second(asked.answered, figures)), quantile_text(asked.durations, 0.5),
                                quantile_text(asked.durations, 0.99)));
    if (label.empty()) continue;
    lines.back() += fmt::format(" |{}|", sparkline(look.past_rates));
    label.clear();
  }
  const std::string undecided = percent_text(figures.undecided, answered(figures));
  const std::string refused = format_count(figures.refused);
  if (!label.empty()) lines.push_back(fmt::format("{:<7}nobody asks   refused {}", label, refused));
  else lines.push_back(fmt::format("       undecided {}   refused {}", undecided, refused));
}

std::string publishers_text(const ServerStatus& status) {
  constexpr std::chrono::seconds kSilent{2};
  constexpr std::size_t kMostNamed = 4;
  std::vector<const PublisherInfo*> oldest;
  for (const PublisherInfo& publisher : status.publishers) oldest.push_back(&publisher);
  std::stable_sort(oldest.begin(), oldest.end(), [](const auto* a, const auto* b) { return a->silent > b->silent; });
  std::string text;
  for (std::size_t i = 0; i < std::min(oldest.size(), kMostNamed); ++i) {
    const PublisherInfo& publisher = *oldest[i];
    const char* state = publisher.lost ? "lost, " : publisher.silent > kSilent ? "silent, " : "";
    text += fmt::format("{}{} {}{}", i == 0 ? "" : "   ", printable(publisher.name), state,
                        format_duration(publisher.silent));
  }
  if (oldest.size() > kMostNamed) text += fmt::format("   and {} more", oldest.size() - kMostNamed);
  return text.empty() ? "nobody publishes" : text;
}

/// Adds the structures that are not built, in as many lines as needed.
void add_not_built(const Figures& figures, std::vector<std::string>& lines) {
  constexpr std::size_t kColumns = 80;
  std::string line = "NOT BUILT  ";
  const std::size_t indent = line.size();
  for (const std::string& structure : figures.not_built) {
    const bool is_first = line.size() == indent;
    if (!is_first && line.size() + structure.size() + 3 > kColumns) {
      lines.push_back(line + ",");
      line.assign(indent, ' ');
    } else if (!is_first) {
      line += ", ";
    }
    line += printable(structure);
  }
  lines.push_back(line);
}

/// Adds a line if there are fences or margins.
void add_fences(const Figures& figures, std::vector<std::string>& lines) {
  if (figures.fences.count == 0) return;
  lines.push_back(fmt::format("FENCES {} with bands   entered {}   in them {}   events {}",
                              format_count(figures.fences.count), format_count(figures.fences.entered),
                              format_count(figures.fences.inside),
                              rate_text(per_second(figures.fences.events, figures))));
  if (figures.fences.cut_short > 0) lines.back() += "   cut short " + format_count(figures.fences.cut_short);
}

/// Adds a line if publishers' stamps are late, jump or are missing.
void add_odd_stamps(const Figures& figures, std::vector<std::string>& lines) {
  if (figures.stamps.late + figures.stamps.jumped + figures.stamps.missing == 0) return;
  lines.push_back(fmt::format("STAMPS late {}   jumped {}   missing {}", format_count(figures.stamps.late),
                              format_count(figures.stamps.jumped), format_count(figures.stamps.missing)));
}

std::string stages_text(const Figures& figures) {
  std::uint64_t busy_ns = 0;
  for (const StageTime& stage : figures.stages) busy_ns += stage.ns;
  std::string text;
  for (const StageTime& stage : figures.stages) {
    text += fmt::format("{} {:.0f} %  ", printable(stage.stage), 100 * part(stage.ns, busy_ns));
  }
  const double share = static_cast<double>(busy_ns) * 1e-9 / seconds(figures);
  return text + fmt::format(" busy {:.0f} %", 100 * std::min(share, 1.0));
}

}  // namespace

double asked_rate(const Figures& figures) { return per_second(answered(figures), figures); }

std::vector<std::string> top_lines(const Look& look) {
  const ServerStatus& status = look.status;
  const Figures& figures = look.figures;
  std::vector<std::string> lines;
  lines.push_back(fmt::format("collided {} · {} · up {} · world {} · {}", printable(status.version_text),
                              status.scenes.empty() ? "no scene" : "scene " + joined(status.scenes),
                              format_duration(std::chrono::nanoseconds(look.up_ns)), format_count(status.version),
                              state_text(status)));
  add_questions(look, lines);
  lines.push_back(fmt::format("POSES  {}, {} moving   {}   late {}   lost {}", counted(status.objects, "object"),
                              format_count(status.moving), rate_text(per_second(figures.poses.applied, figures)),
                              format_count(figures.poses.late), format_count(figures.poses.lost())));
  add_odd_stamps(figures, lines);
  lines.push_back("FROM   " + publishers_text(status));
  lines.push_back("STAGE  " + stages_text(figures));
  const std::string period =
      figures.step_period_ns > 0 ? " of " + format_duration(std::chrono::nanoseconds(figures.step_period_ns)) : "";
  lines.push_back(fmt::format("STEP   {}   p50 {}{}   p99 {}", rate_text(per_second(figures.steps, figures)),
                              quantile_text(figures.step_durations, 0.5), period,
                              quantile_text(figures.step_durations, 0.99)));
  if (figures.stalled_steps > 0)
    lines.back() += fmt::format("   waited for readers {} times", format_count(figures.stalled_steps));
  lines.push_back(fmt::format("PAIRS  candidates {} a step   contacts {}   saved by filters {}",
                              mean_text(per_step(figures.pairs.candidates, figures)), format_count(status.contacts),
                              mean_text(per_step(figures.pairs.filtered, figures))));
  if (figures.pairs.in_doubt > 0)
    lines.back() += fmt::format("   {} of them in doubt", format_count(figures.pairs.in_doubt));
  if (status.contacts_truncated) lines.back() += "   contacts are missing (max_contacts)";
  add_fences(figures, lines);
  add_not_built(figures, lines);
  return lines;
}

std::vector<Record> top_records(const Look& look) {
  const ServerStatus& status = look.status;
  const Figures& figures = look.figures;
  std::vector<Record> records;
  const auto add = [&](std::string name, Value value, std::string_view unit) {
    records.push_back({{"figure", std::move(name)}, {"value", std::move(value)}, {"unit", unit}});
  };
  const auto quantiles = [&](const std::string& name, const std::vector<DurationStep>& durations) {
    for (const auto& [label, which] : {std::pair(".p50", 0.5), std::pair(".p99", 0.99)}) {
      const std::optional<std::int64_t> ns = quantile_ns(durations, which);
      add(name + label, ns ? Value(static_cast<double>(*ns) * 1e-9) : Value(std::monostate{}), "s");
    }
  };
  add("state", std::string(status.state), "");
  add("epoch", status.epoch, "");
  add("world", status.version, "");
  add("up", static_cast<double>(look.up_ns) * 1e-9, "s");
  add("over", seconds(figures), "s");
  for (const AskedKind& asked : figures.questions) {
    add("ask." + asked.kind + ".rate", per_second(asked.answered, figures), "1/s");
    quantiles("ask." + asked.kind, asked.durations);
  }
  add("ask.undecided", part(figures.undecided, answered(figures)), "");
  add("ask.refused", per_second(figures.refused, figures), "1/s");
  add("objects", std::uint64_t{status.objects}, "");
  add("moving", std::uint64_t{status.moving}, "");
  add("poses.rate", per_second(figures.poses.applied, figures), "1/s");
  add("poses.late", per_second(figures.poses.late, figures), "1/s");
  add("poses.lost", per_second(figures.poses.lost(), figures), "1/s");
  add("stamps.late", per_second(figures.stamps.late, figures), "1/s");
  add("stamps.jumped", per_second(figures.stamps.jumped, figures), "1/s");
  add("stamps.missing", per_second(figures.stamps.missing, figures), "1/s");
  add("step.lasting", seconds_of(status.step_lasting), "s");
  add("step.rate", per_second(figures.steps, figures), "1/s");
  quantiles("step", figures.step_durations);
  for (const StageTime& stage : figures.stages)
    add("stage." + stage.stage, static_cast<double>(stage.ns) * 1e-9 / seconds(figures), "of the time");
  add("pairs.candidates", per_step(figures.pairs.candidates, figures), "a step");
  add("pairs.filtered", per_step(figures.pairs.filtered, figures), "a step");
  add("contacts", std::uint64_t{status.contacts}, "");
  add("in_doubt", figures.pairs.in_doubt, "");
  add("fences", figures.fences.count, "");
  add("fences.entered", figures.fences.entered, "");
  add("fences.inside", figures.fences.inside, "");
  add("fences.events", per_second(figures.fences.events, figures), "1/s");
  add("fences.cut_short", figures.fences.cut_short, "");
  for (const PublisherInfo& publisher : status.publishers)
    add("silent." + publisher.name, seconds_of(publisher.silent), "s");
  for (const std::string& structure : figures.not_built) add("not_built", structure, "");
  return records;
}

}  // namespace collided::cli
