#include "client/cli/output/top_screen.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "client/cli/input/number.hpp"
#include "client/cli/output/figure_text.hpp"
#include "client/cli/output/wrapping.hpp"
#include "idl/glob.hpp"

namespace collided::cli {
namespace {

constexpr std::chrono::seconds kLongSilent{2};
constexpr std::size_t kNameColumns = 8;
constexpr std::size_t kFigureColumns = 11;

/// The text padded with blanks before or after; one that is too long loses its middle.
std::string padded_or_cut(std::string_view text, std::size_t columns, bool at_right) {
  std::string kept = cut_to(text, columns);
  const std::string blanks(columns - std::min(columns, columns_of(kept)), ' ');
  return at_right ? blanks + kept : kept + blanks;
}

std::string figure_cell(std::string_view text) { return padded_or_cut(text, kFigureColumns, true); }

/// A row of rates: name, rate, median, p99, and the rate's history in the remaining room.
std::string rate_row(const std::string& name, double rate, const std::vector<DurationStep>& durations,
                     const TopHistory& history, std::size_t columns) {
  std::string row = padded_or_cut(name, kNameColumns, false) + figure_cell(rate_text(rate));
  row += figure_cell(durations.empty() ? "-" : quantile_text(durations, 0.5));
  row += figure_cell(durations.empty() ? "-" : quantile_text(durations, 0.99));
  const std::size_t used = kNameColumns + 3 * kFigureColumns + 2;
  const auto past = history.rates().find(name);
  if (past == history.rates().end() || columns <= used) return row;
  return row + "  " + braille_curve(past->second, columns - used);
}

void add_rates(const Look& look, const TopHistory& history, std::size_t columns, std::vector<std::string>& lines) {
  const Figures& figures = look.figures;
  lines.push_back(padded_or_cut("", kNameColumns, false) + figure_cell("RATE") + figure_cell("P50") +
                  figure_cell("P99") + "  HISTORY");
  bool is_asked = false;
  for (const AskedKind& asked : figures.questions) {
    // A recently asked kind keeps its row, so that the screen does not jump.
    const auto past = history.rates().find(asked.kind);
    const bool was_asked = past != history.rates().end() &&
                           std::any_of(past->second.begin(), past->second.end(), [](double rate) { return rate > 0; });
    if (asked.answered == 0 && !was_asked) continue;
    is_asked = true;
    lines.push_back(rate_row(asked.kind, per_second(asked.answered, figures), asked.durations, history, columns));
  }
  if (!is_asked) lines.emplace_back("nobody asks");
  lines.push_back(rate_row("poses", per_second(figures.poses.applied, figures), {}, history, columns));
  lines.push_back(rate_row("steps", per_second(figures.steps, figures), figures.step_durations, history, columns));
}

/// Texts, three blanks between them, in as many lines as they need.
void add_wrapped(const std::vector<std::string>& texts, std::size_t columns, std::vector<std::string>& lines) {
  std::string line;
  for (const std::string& text : texts) {
    if (!line.empty() && columns_of(line) + 3 + columns_of(text) > columns) lines.push_back(std::exchange(line, {}));
    line += (line.empty() ? "" : "   ") + text;
  }
  if (!line.empty()) lines.push_back(line);
}

void add_counts(const Look& look, std::size_t columns, std::vector<std::string>& lines) {
  const Figures& figures = look.figures;
  std::uint64_t answered = 0;
  for (const AskedKind& asked : figures.questions) answered += asked.answered;
  std::vector<std::string> texts{
      fmt::format("{}, {} moving", counted(look.status.objects, "object"), format_count(look.status.moving)),
      fmt::format("{} hold", counted(look.status.contacts, "contact"))};
  if (look.status.contacts_truncated) texts.back() += ", more are missing (max_contacts)";
  texts.push_back(fmt::format("{} in doubt", format_count(figures.pairs.in_doubt)));
  texts.push_back(fmt::format("candidates {} a step", mean_text(per_step(figures.pairs.candidates, figures))));
  texts.push_back(fmt::format("undecided {}", percent_text(figures.undecided, answered)));
  const auto add_if_any = [&](const char* name, std::uint64_t count) {
    if (count > 0) texts.push_back(fmt::format("{} {}", name, format_count(count)));
  };
  add_if_any("refused", figures.refused);
  add_if_any("poses late", figures.poses.late);
  add_if_any("poses lost", figures.poses.lost());
  add_if_any("stamps late", figures.stamps.late);
  add_if_any("stamps jumped", figures.stamps.jumped);
  add_if_any("stamps missing", figures.stamps.missing);
  add_if_any("steps that waited for readers", figures.stalled_steps);
  add_wrapped(texts, columns, lines);
}

void add_stages(const Figures& figures, std::size_t columns, std::vector<std::string>& lines) {
  std::uint64_t busy_ns = 0;
  for (const StageTime& stage : figures.stages) busy_ns += stage.ns;
  const auto up_ns = static_cast<std::uint64_t>(std::max<std::int64_t>(1, figures.up_ns));
  std::vector<std::string> texts{"busy " + percent_text(std::min(busy_ns, up_ns), up_ns)};
  for (const StageTime& stage : figures.stages) {
    const double share = busy_ns == 0 ? 0 : 100 * static_cast<double>(stage.ns) / static_cast<double>(busy_ns);
    texts.push_back(fmt::format("{} {:.0f} %", printable(stage.stage), share));
  }
  add_wrapped(texts, columns, lines);
}

bool is_wanted_publisher(const std::string& name, const std::string& filter) {
  if (filter.empty()) return true;
  if (filter.find_first_of("*?[") != std::string::npos) return wire_contract::glob_matches(filter, name);
  return name.find(filter) != std::string::npos;
}

std::vector<const PublisherInfo*> publishers_listed(const Look& look, const TopHistory& history,
                                                    const TopChoice& choice) {
  std::vector<const PublisherInfo*> publishers;
  for (const PublisherInfo& one : look.status.publishers)
    if (is_wanted_publisher(one.name, choice.filter)) publishers.push_back(&one);
  const auto rate = [&](const PublisherInfo& one) { return history.messages_per_second(one.name).value_or(0); };
  std::stable_sort(publishers.begin(), publishers.end(), [&](const auto* a, const auto* b) {
    if (choice.is_reversed) std::swap(a, b);
    switch (choice.order) {
      case TopOrder::age: return a->silent > b->silent;
      case TopOrder::rate: return rate(*a) > rate(*b);
      case TopOrder::name: return a->name < b->name;
    }
    return false;
  });
  return publishers;
}

void add_publishers(const Look& look, const TopHistory& history, const TopChoice& choice, std::size_t columns,
                    std::size_t rows, std::vector<std::string>& lines) {
  constexpr std::size_t kState = 9;
  const std::size_t name_columns =
      columns > 2 * kFigureColumns + kState + kNameColumns ? columns - 2 * kFigureColumns - kState : kNameColumns;
  const auto title = [&](TopOrder order, const char* text) {
    return choice.order != order ? std::string(text) : std::string(choice.is_reversed ? "▴" : "▾") + text;
  };
  const std::vector<const PublisherInfo*> publishers = publishers_listed(look, history, choice);
  std::string name_title = title(TopOrder::name, "PUBLISHER");
  if (!choice.filter.empty())
    name_title +=
        fmt::format("  {} of {} by {}", publishers.size(), look.status.publishers.size(), printable(choice.filter));
  lines.push_back(padded_or_cut(name_title, name_columns, false) + figure_cell(title(TopOrder::rate, "MESSAGES")) +
                  figure_cell(title(TopOrder::age, "SILENT")) + "  STATE");
  // The last row says how many are left out.
  const std::size_t room = rows > lines.size() ? rows - lines.size() : 0;
  const std::size_t shown = publishers.size() <= room ? publishers.size() : (room > 0 ? room - 1 : 0);
  for (std::size_t i = 0; i < shown; ++i) {
    const PublisherInfo& one = *publishers[i];
    const std::optional<double> rate = history.messages_per_second(one.name);
    lines.push_back(padded_or_cut(printable(one.name), name_columns, false) +
                    figure_cell(rate ? rate_text(*rate) : "-") + figure_cell(format_duration(one.silent)) + "  " +
                    (one.lost                   ? "lost"
                     : one.silent > kLongSilent ? "silent"
                                                : ""));
  }
  if (shown < publishers.size() && room > 0) lines.push_back(fmt::format("and {} more", publishers.size() - shown));
  if (look.status.publishers.empty() && room > 0) lines.emplace_back("nobody publishes");
}

std::string keys_line(const TopChoice& choice) {
  if (choice.is_typing) return "filter: " + printable(choice.filter) + "_   Enter keeps it, Esc drops it";
  return fmt::format("q quit  s sort  r reverse  / filter  space {}", choice.is_paused ? "goes on (paused)" : "pause");
}

std::string joined_names(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + printable(name);
  return text;
}

}  // namespace

void TopHistory::append(const std::string& row, double rate) {
  std::deque<double>& rates = rates_[row];
  rates.push_back(rate);
  if (rates.size() > kMostKept) rates.pop_front();
}

void TopHistory::add(const Look& look) {
  for (const AskedKind& asked : look.figures.questions) append(asked.kind, per_second(asked.answered, look.figures));
  append("poses", per_second(look.figures.poses.applied, look.figures));
  append("steps", per_second(look.figures.steps, look.figures));
  std::map<std::string, std::uint64_t, std::less<>> now;
  messages_.clear();
  for (const PublisherInfo& one : look.status.publishers) {
    now[one.name] = one.applied_sequence;
    const auto before = sequences_.find(one.name);
    if (before == sequences_.end() || before->second > one.applied_sequence) continue;
    messages_[one.name] = per_second(one.applied_sequence - before->second, look.figures);
  }
  sequences_ = std::move(now);
}

void TopHistory::clear() { *this = {}; }

std::optional<double> TopHistory::messages_per_second(std::string_view publisher) const {
  const auto found = messages_.find(publisher);
  return found == messages_.end() ? std::nullopt : std::optional(found->second);
}

std::vector<std::string> top_screen(const Look& look, const TopHistory& history, const TopChoice& choice,
                                    std::string_view note, std::size_t columns, std::size_t rows) {
  const ServerStatus& status = look.status;
  std::vector<std::string> lines;
  lines.push_back(fmt::format("collided {} · {} · up {} · {} · world {}", printable(status.version_text),
                              state_text(status), format_duration(std::chrono::nanoseconds(look.up_ns)),
                              status.scenes.empty() ? "no scene" : joined_names(status.scenes),
                              format_count(status.version)));
  if (!note.empty()) lines.emplace_back(note);
  add_rates(look, history, columns, lines);
  add_counts(look, columns, lines);
  add_stages(look.figures, columns, lines);
  constexpr std::size_t kNoLimit = 1'000;
  const std::size_t body = rows == 0 ? kNoLimit : std::max<std::size_t>(2, rows) - 1;
  add_publishers(look, history, choice, columns, body, lines);
  if (rows > 0) {
    lines.resize(body);
    lines.push_back(keys_line(choice));
  }
  for (std::string& line : lines) {
    line = cut_between_words(line, columns);
    line.erase(line.find_last_not_of(' ') + 1);
  }
  return lines;
}

std::string braille_curve(const std::deque<double>& values, std::size_t columns) {
  // Dots of the left and the right column of a character, filled from below. Source: Unicode, "Braille Patterns",
  // U+2800.
  static constexpr unsigned kLeft[] = {0, 0x40, 0x44, 0x46, 0x47};
  static constexpr unsigned kRight[] = {0, 0x80, 0xa0, 0xb0, 0xb8};
  constexpr double kLevels = 4;
  const std::size_t room = 2 * columns;
  const std::size_t first = values.size() > room ? values.size() - room : 0;
  double largest = 0;
  for (std::size_t i = first; i < values.size(); ++i) largest = std::max(largest, values[i]);
  const auto level = [&](std::size_t i) -> std::size_t {
    if (i >= values.size() || values[i] <= 0 || largest <= 0) return 0;
    return std::clamp<std::size_t>(static_cast<std::size_t>(values[i] / largest * kLevels + 0.5), 1, 4);
  };
  // The newest value is at the right of its character.
  const std::size_t odd = (values.size() - first) % 2;
  std::string curve;
  for (std::size_t i = 0; i < values.size() - first + odd; i += 2) {
    const std::size_t at = first + i;
    const bool starts_with_blank = odd == 1 && i == 0;
    const unsigned left = starts_with_blank ? 0 : kLeft[level(at - odd)];
    const unsigned code = 0x2800U + left + kRight[level(at + 1 - odd)];
    for (const unsigned byte : {0xe0U | code >> 12, 0x80U | (code >> 6 & 0x3fU), 0x80U | (code & 0x3fU)})
      curve += static_cast<char>(byte);
  }
  return curve;
}

std::string cut_between_words(std::string_view line, std::size_t columns) {
  if (columns_of(line) <= columns) return std::string(line);
  std::size_t seen = 0;
  std::size_t end = 0;
  std::size_t blank = 0;  // the last one that leaves more than half of the line
  for (; end < line.size(); ++end) {
    const bool begins_character = (static_cast<unsigned char>(line[end]) & 0xc0) != 0x80;
    if (line[end] == ' ' && 2 * seen >= columns) blank = end;
    if (begins_character && seen++ == columns - 1) break;
  }
  std::string kept(line.substr(0, blank > 0 ? blank : end));
  kept.erase(kept.find_last_not_of(' ') + 1);
  return kept + "…";
}

}  // namespace collided::cli
