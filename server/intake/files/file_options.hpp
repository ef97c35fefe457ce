#pragma once

#include <optional>
#include <string>

#include "server/intake/scene.hpp"

namespace collided::files {

/// How a file is to be read, as the user wrote it.
struct FileOptions {
  std::string path;
  std::string name;
  std::string unit = "m";
  std::string up = "z";
  bool strict = false;
};

/// Metres a unit: "mm", "in", ..., or a number above 0. Nothing for any other text.
std::optional<double> unit_in_metres(const std::string& unit);

/// Throws LoadError with the reason.
Scene load(const FileOptions& file, LoadReport& report);

/// "18 204": thousands apart.
std::string grouped(std::uint64_t value);

/// The shortest text that reads back to the same double.
std::string shortest(double value);

}  // namespace collided::files
