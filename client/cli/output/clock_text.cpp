#include "client/cli/output/clock_text.hpp"

#include <ctime>

#include <fmt/format.h>

namespace collided::cli {

std::string clock_text(std::chrono::nanoseconds world_time) {
  constexpr std::chrono::hours kTenYears{24 * 365 * 10};
  const auto milliseconds = std::chrono::floor<std::chrono::milliseconds>(world_time);
  if (world_time < kTenYears) return fmt::format("{:.3f}", static_cast<double>(milliseconds.count()) / 1000);
  const std::time_t seconds = milliseconds.count() / 1000;
  std::tm local{};
  ::localtime_r(&seconds, &local);
  return fmt::format("{:02}:{:02}:{:02}.{:03}", local.tm_hour, local.tm_min, local.tm_sec, milliseconds.count() % 1000);
}

}  // namespace collided::cli
