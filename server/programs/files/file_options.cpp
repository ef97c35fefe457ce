#include "server/programs/files/file_options.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "server/programs/files/interrupt.hpp"

namespace collided::engine::files {

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

double length_in_metres(const char* option, const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const std::string unit(end, text.data() + text.size());
  const std::optional<double> unit_m = unit.empty() ? 1.0 : unit_in_metres(unit);
  if (error != std::errc{} || !unit_m || !std::isfinite(value) || !(value > 0)) {
    throw LoadError(fmt::format("{} '{}'; a length above 0 is needed, as 0.1mm or 2e-4", option, text));
  }
  return value * *unit_m;
}

Vec3 parse_point(const char* option, const std::string& text) {
  Vec3 point = Vec3::Zero();
  const char* at = text.data();
  const char* const end = at + text.size();
  for (int axis = 0; axis < 3; ++axis) {
    const auto [stop, error] = std::from_chars(at, end, point[axis]);
    const bool separated = axis == 2 ? stop == end : stop != end && *stop == ',';
    if (error != std::errc{} || !separated || !std::isfinite(point[axis])) {
      throw LoadError(fmt::format("{} '{}'; three finite numbers are needed: X,Y,Z", option, text));
    }
    at = stop + 1;
  }
  return point;
}

double crack_in_metres(const FileOptions& file) {
  return file.crack.empty() ? 0 : length_in_metres("--crack", file.crack);
}

LoadOptions load_options(const FileOptions& file) {
  const std::optional<double> unit_m = unit_in_metres(file.unit);
  if (!unit_m)
    throw LoadError(fmt::format("--unit '{}'; allowed: m mm cm km um in ft, or metres a unit above 0", file.unit));
  LoadOptions options;
  options.name = file.name;
  options.unit_m = *unit_m;
  options.up = file.up.empty() ? '\0' : file.up[0];
  options.strict = file.strict;
  options.srdf = file.srdf;
  options.packages = file.packages;
  if (file.mend) options.mend_m = crack_in_metres(file);
  if (!file.radius.empty()) options.radius_m = length_in_metres("--radius", file.radius);
  options.cancelled = is_interrupted;
  return options;
}

Scene load(const FileOptions& file, LoadReport& report, const std::function<void(double)>& progress) {
  LoadOptions options = load_options(file);
  options.progress = progress;
  try {
    return load_scene(file.path, options, report);
  } catch (const LoadError&) {
    end_if_interrupted();
    throw;
  }
}

std::string grouped(std::uint64_t value) {
  if (value < 1000) return std::to_string(value);
  return fmt::format("{} {:03}", grouped(value / 1000), value % 1000);
}

std::string counted(std::uint64_t count, std::string_view what) {
  return fmt::format("{} {}{}", grouped(count), what, count == 1 ? "" : "s");
}

std::string scene_line(const Scene& scene) {
  return fmt::format("{}  {}, {}, {}", scene.name, counted(scene.parts.size(), "part"),
                     counted(scene.mesh.triangles.size(), "triangle"), counted(scene.objects.size(), "object"));
}

std::string shortest(double value) {
  constexpr double kLeastPlain = 1e-4;
  constexpr double kMostPlain = 1e15;  // above this, plain notation would show digits that no double holds
  std::array<char, 40> text{};
  const double size = std::abs(value);
  const bool is_plain = size == 0 || (size >= kLeastPlain && size < kMostPlain);
  char* const end = text.data() + text.size();
  const auto result = is_plain ? std::to_chars(text.data(), end, value, std::chars_format::fixed)
                               : std::to_chars(text.data(), end, value);
  return {text.data(), result.ptr};
}

}  // namespace collided::engine::files
