#include "client/cli/output/fence_output.hpp"

#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "client/cli/input/number.hpp"
#include "client/cli/output/clock_text.hpp"
#include "client/cli/output/event_output.hpp"
#include "client/cli/output/readable.hpp"

namespace collided::cli {
namespace {

std::chrono::nanoseconds before(const FenceEvent& event, double seconds) {
  return event.world_time - std::chrono::nanoseconds(std::llround(seconds * 1e9));
}

/// World time by which the change had happened.
std::chrono::nanoseconds happened_by(const FenceEvent& event) {
  if (event.kind == FenceEventKind::inside) return event.entered;
  return before(event, event.kind == FenceEventKind::cross ? event.left_high_s : event.bracket_high_s);
}

std::string told_by(const ListedFence& fence) {
  std::vector<std::string_view> words;
  if (fence.enter) words.emplace_back("enter");
  if (fence.exit) words.emplace_back("exit");
  if (fence.cross) words.emplace_back("cross");
  return fmt::format("{}", fmt::join(words, ","));
}

/// What a fence looks at, as its globs say it.
std::string looked_at(const ListedFence& fence) {
  std::string text = fence.only.empty() ? "all" : printable(fence.only);
  if (!fence.skip.empty()) text += " but " + printable(fence.skip);
  return text;
}

std::string list_text(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : " ") + printable(name);
  return text;
}

}  // namespace

Record fence_record(const FenceEvent& event) {
  const Value none = std::monostate{};
  const bool is_cross = event.kind == FenceEventKind::cross;
  const bool has_bracket = event.kind != FenceEventKind::inside;
  const bool has_stay = is_cross || event.kind == FenceEventKind::exit;
  const auto at = [&](bool is_there, double seconds) {
    return is_there ? Value(std::int64_t{before(event, seconds).count()}) : none;
  };
  return {{"time", seconds_of(happened_by(event))},
          {"what", name_of(event.kind)},
          {"object", std::string_view(event.object)},
          {"fence", std::string_view(event.fence)},
          {"after", has_stay ? Value(seconds_of(happened_by(event) - event.entered)) : none},
          {"why", event.reason == EndReason::none ? none : Value(name_of(event.reason))},
          {"doubt", event.doubt == Doubt::none ? none : Value(name_of(event.doubt))},
          {"resync", event.resync ? Value(true) : none},
          {"poses_merged", event.poses_merged ? Value(true) : none},
          {"first_ns", at(has_bracket, event.bracket_low_s)},
          {"last_ns", at(has_bracket, event.bracket_high_s)},
          {"left_first_ns", at(is_cross, event.left_low_s)},
          {"left_last_ns", at(is_cross, event.left_high_s)},
          {"point", event.point.isZero(0) ? MaybeVector() : MaybeVector(event.point)},
          {"sequence", event.sequence},
          {"episode", event.episode},
          {"epoch", event.epoch}};
}

std::vector<std::string> usual_fence_fields() { return {"time", "what", "object", "fence", "after", "why", "doubt"}; }

std::string fence_line(const Printer& printer, const FenceEvent& event) {
  const std::string doubt = event.doubt == Doubt::none ? "" : fmt::format("  in doubt ({})", name_of(event.doubt));
  if (event.kind == FenceEventKind::inside)
    return fmt::format("inside   {}  {}  since {}{}", printable(event.fence), printable(event.object),
                       clock_text(event.entered), doubt);
  const Paint paint = event.kind == FenceEventKind::exit ? Paint::faint : Paint::bad;
  std::string line =
      fmt::format("{} {}  {}  {}", clock_text(happened_by(event)), printer.paint(paint, name_of(event.kind)),
                  printable(event.fence), printable(event.object));
  if (event.kind == FenceEventKind::exit)
    line += fmt::format("  after {}  ({})", format_duration(happened_by(event) - event.entered), name_of(event.reason));
  if (event.kind == FenceEventKind::cross)
    line += fmt::format("  in for {}", format_duration(happened_by(event) - event.entered));
  line += doubt + fmt::format("  seq {}", event.sequence);
  if (event.resync) line += "  resync";
  if (event.poses_merged) line += "  (poses merged)";
  return line;
}

Record fence_record(const ListedFence& fence) {
  return {{"fence", std::string_view(fence.name)},
          {"region", std::string_view(fence.kind)},
          {"to", fence.to.empty() ? Value(std::monostate{}) : Value(std::string_view(fence.to))},
          {"only", fence.only.empty() ? Value(std::monostate{}) : Value(std::string_view(fence.only))},
          {"skip", fence.skip.empty() ? Value(std::monostate{}) : Value(std::string_view(fence.skip))},
          {"tells", told_by(fence)},
          {"keep", fence.keep},
          {"inside", list_text(fence.inside)},
          {"in_doubt", list_text(fence.in_doubt)}};
}

std::vector<std::string> fence_row(const ListedFence& fence) {
  std::string inside = list_text(fence.inside);
  if (!fence.in_doubt.empty()) inside += (inside.empty() ? "in doubt: " : "  in doubt: ") + list_text(fence.in_doubt);
  return {printable(fence.name),     fence.kind, printable(fence.to), looked_at(fence), told_by(fence),
          fence.keep ? "yes" : "no", inside};
}

}  // namespace collided::cli
