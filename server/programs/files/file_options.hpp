#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/intake/scene.hpp"

namespace collided::engine::files {

/// How to read a file, as the user wrote it; load() checks it.
struct FileOptions {
  std::string path;
  std::string name;                     // of the scene; empty: the file's stem
  std::string unit = "m";               // of the file's numbers, for unit_in_metres()
  std::string up{};                     // empty: as the format says, else z
  bool strict = false;                  // refuse faults instead of mending them
  bool mend = false;                    // cut edges at T-vertices and close cracks
  std::string crack{};                  // widest crack, a length with a unit; empty: a share of the diagonal
  std::string radius{};                 // of the balls about a cloud's points, a length with a unit; empty: 0
  std::string srdf{};                   // for a URDF robot: path of the file that says which links may touch
  std::vector<std::string> packages{};  // for a URDF robot: "NAME=DIR", the folder of a package that it names
};

/// Metres per unit of "mm", "in", ..., or of a number above 0. Nothing for any other text.
std::optional<double> unit_in_metres(const std::string& unit);

/// Metres of "0.1mm" or "2e-4". Throws LoadError that names the option if the text is not a length above 0.
double length_in_metres(const char* option, const std::string& text);

/// A point from "1,-2,3e5": three finite numbers. Throws LoadError that names the option.
Vec3 parse_point(const char* option, const std::string& text);

/// file.crack in metres; 0 if it is empty.
double crack_in_metres(const FileOptions& file);

/// The engine's options. Throws LoadError.
LoadOptions load_options(const FileOptions& file);

/// Reads the file. Throws LoadError with the reason, or Interrupted.
///
/// progress  called with the fraction done in [0, 1]
Scene load(const FileOptions& file, LoadReport& report, const std::function<void(double)>& progress);

/// The number with its thousands separated: "18 204".
std::string grouped(std::uint64_t value);

/// A count with its noun: "1 part", "18 204 parts".
std::string counted(std::uint64_t count, std::string_view what);

/// The first line of a report: "hall  3 parts, 1 204 triangles, 0 objects".
std::string scene_line(const Scene& scene);

/// The shortest text that reads back to the same double; without an exponent from 1e-4 to 1e15.
std::string shortest(double value);

}  // namespace collided::engine::files
