#include "client/cli/output/figure_text.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "client/cli/input/number.hpp"
#include "client/cli/output/clock_text.hpp"
#include "client/cli/output/output.hpp"

namespace collided::cli {

std::string state_text(const ServerStatus& status) {
  constexpr std::chrono::milliseconds kLong{500};
  std::string text = printable(status.state);
  if (status.step_lasting > kLong) text += ", step has lasted " + format_duration(status.step_lasting);
  return text;
}

double per_second(std::uint64_t count, const Figures& figures) {
  return static_cast<double>(count) / std::max(1e-9, seconds_of(std::chrono::nanoseconds(figures.up_ns)));
}

double per_step(std::uint64_t count, const Figures& figures) {
  return figures.steps == 0 ? 0 : static_cast<double>(count) / static_cast<double>(figures.steps);
}

std::string rate_text(double per_second) {
  // Above this, three digits would round up to "1e+03".
  if (per_second < 999.5) return fmt::format("{:.3g}/s", per_second);
  return per_second < 999'950 ? fmt::format("{:.1f} k/s", per_second / 1e3)
                              : fmt::format("{:.1f} M/s", per_second / 1e6);
}

std::string mean_text(double mean) {
  return mean < 999.5 ? fmt::format("{:.3g}", mean) : format_count(static_cast<std::uint64_t>(std::llround(mean)));
}

std::string percent_text(std::uint64_t of, std::uint64_t whole) {
  return fmt::format("{:.2g} %", whole == 0 ? 0 : 100 * static_cast<double>(of) / static_cast<double>(whole));
}

std::string quantile_text(const std::vector<DurationStep>& durations, double part) {
  const std::optional<std::int64_t> ns = view::quantile_ns(durations, part);
  return ns ? format_duration(std::chrono::nanoseconds(*ns)) : "-";
}

}  // namespace collided::cli
