#include "server/intake/files/file_options.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <utility>

namespace collided::files {

std::optional<double> unit_in_metres(const std::string& unit) {
  constexpr std::array<std::pair<const char*, double>, 7> kUnits{
      {{"m", 1}, {"mm", 1e-3}, {"cm", 1e-2}, {"km", 1e3}, {"um", 1e-6}, {"in", 0.0254}, {"ft", 0.3048}}};
  for (const auto& [name, metres] : kUnits) {
    if (unit == name) return metres;
  }
  double metres = 0;
  const auto [end, error] = std::from_chars(unit.data(), unit.data() + unit.size(), metres);
  const bool whole = error == std::errc{} && end == unit.data() + unit.size();
  if (!whole || !std::isfinite(metres) || !(metres > 0)) return std::nullopt;
  return metres;
}

Scene load(const FileOptions& file, LoadReport& report) {
  const std::optional<double> unit_m = unit_in_metres(file.unit);
  if (!unit_m) throw LoadError(fmt::format("--unit '{}'; allowed: m mm cm km um in ft, or metres a unit above 0", file.unit));
  LoadOptions options;
  options.name = file.name;
  options.unit_m = *unit_m;
  options.up = file.up == "y" ? 'y' : 'z';
  options.strict = file.strict;
  return load_scene(file.path, options, report);
}

std::string grouped(std::uint64_t value) {
  if (value < 1000) return std::to_string(value);
  return fmt::format("{} {:03}", grouped(value / 1000), value % 1000);
}

std::string shortest(double value) {
  std::array<char, 32> text{};
  const auto result = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), result.ptr};
}

}  // namespace collided::files
