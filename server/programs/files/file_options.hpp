#pragma once

#include <functional>
#include <optional>
#include <string>

#include "server/intake/scene.hpp"

namespace collided::engine::files {

/// How a file is to be read, as the user wrote it.
struct FileOptions {
  std::string path;
  std::string name;
  std::string unit = "m";
  std::string up{};  // empty: as the format says, else z
  bool strict = false;
  bool mend = false;
  std::string crack{};   // a length with a unit: the widest crack; empty: a share of the diagonal
  std::string radius{};  // the same, of a cloud's points
  std::string srdf{};
};

/// Metres a unit: "mm", "in", ..., or a number above 0. Nothing for any other text.
std::optional<double> unit_in_metres(const std::string& unit);

/// "0.1mm", "2e-4": metres. Throws LoadError naming the option for what is no length above 0.
double length_in_metres(const char* option, const std::string& text);

/// "1,-2,3e5": three finite numbers. Throws LoadError naming the option.
Vec3 parse_point(const char* option, const std::string& text);

/// 0 where none was given.
double crack_in_metres(const FileOptions& file);

/// Throws LoadError with the reason, or Interrupted.
/// progress  told the fraction done in [0, 1]
Scene load(const FileOptions& file, LoadReport& report, const std::function<void(double)>& progress);

/// "18 204": thousands apart.
std::string grouped(std::uint64_t value);

/// The shortest text that reads back to the same double.
std::string shortest(double value);

}  // namespace collided::engine::files
