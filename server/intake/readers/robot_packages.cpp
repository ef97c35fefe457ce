#include "server/intake/readers/robot_packages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "server/intake/scene.hpp"

namespace collided::engine {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPackage = "package://";
constexpr int kMostLevels = 4;

/// The components of "package://NAME/FILE" or "FILE"; an empty file if it cannot be in a package.
struct PackageName {
  std::string package;
  fs::path file;
};

PackageName taken_apart(const std::string& name) {
  PackageName parts;
  std::string rest = name;
  if (rest.starts_with(kPackage)) {
    const std::size_t slash = rest.find('/', kPackage.size());
    if (slash == std::string::npos) return parts;
    parts.package = rest.substr(kPackage.size(), slash - kPackage.size());
    rest = rest.substr(slash + 1);
  }
  const fs::path file = fs::path(rest).lexically_normal();
  const bool leads_out = parts.package == ".." || file.empty() || file.is_absolute() || *file.begin() == "..";
  if (!leads_out) parts.file = file;
  return parts;
}

/// The folders of a list with colons between them.
std::vector<fs::path> folders_in(const char* variable) {
  std::vector<fs::path> folders;
  const char* text = std::getenv(variable);
  std::string_view rest = text == nullptr ? "" : text;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(':'), rest.size());
    if (end > 0) folders.emplace_back(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return folders;
}

/// The possible places of the file, in search order.
std::vector<fs::path> candidates(const std::string& robot_folder, const PackageName& name) {
  std::vector<fs::path> paths;
  fs::path folder = fs::absolute(robot_folder);
  for (int level = 0; level < kMostLevels; ++level, folder = folder.parent_path())
    paths.insert(paths.end(), {folder / name.file, folder / name.package / name.file});
  if (name.package.empty()) return paths;
  for (const fs::path& root : folders_in("ROS_PACKAGE_PATH")) {
    paths.push_back(root / name.package / name.file);
    if (root.filename() == name.package) paths.push_back(root / name.file);
  }
  for (const fs::path& root : folders_in("AMENT_PREFIX_PATH"))
    paths.push_back(root / "share" / name.package / name.file);
  return paths;
}

}  // namespace

RobotPackages::RobotPackages(std::string folder, const std::vector<std::string>& packages)
    : folder_(std::move(folder)) {
  for (const std::string& package : packages) {
    const std::size_t sign = package.find('=');
    if (sign == 0 || sign == std::string::npos || sign + 1 == package.size())
      throw LoadError(fmt::format("package '{}': it is to be NAME=DIR. Nothing was loaded.", package));
    packages_.emplace_back(package.substr(0, sign), package.substr(sign + 1));
  }
}

fs::path RobotPackages::find(const std::string& name) const {
  const PackageName parts = taken_apart(name);
  if (folder_.empty() || parts.file.empty()) return {};
  for (const auto& [package, folder] : packages_) {
    std::error_code error;
    if (package == parts.package && fs::is_regular_file(folder / parts.file, error)) return folder / parts.file;
  }
  for (const fs::path& path : candidates(folder_, parts)) {
    std::error_code error;
    if (fs::is_regular_file(path, error)) return path;
  }
  return {};
}

std::string RobotPackages::advice(const std::string& name) const {
  const PackageName parts = taken_apart(name);
  if (parts.file.empty()) return "a mesh has a name like package://NAME/FILE or FILE, without leading out by '..'";
  if (folder_.empty()) return "what does not come from a folder has no other files";
  const std::string where = fmt::format("looked in the robot's folder and the {} above it", kMostLevels - 1);
  if (parts.package.empty()) return where;
  const bool is_set = !folders_in("ROS_PACKAGE_PATH").empty() || !folders_in("AMENT_PREFIX_PATH").empty();
  return fmt::format(
      "{}{}; say where it is, --package {}=DIR, or set ROS_PACKAGE_PATH, where the server starts, to the "
      "folder that holds it",
      where, is_set ? " and in ROS_PACKAGE_PATH and AMENT_PREFIX_PATH" : "", parts.package);
}

}  // namespace collided::engine
