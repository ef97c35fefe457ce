#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace collided::engine {

/// Finds the files that a robot's description names, as "FILE" or "package://NAME/FILE". Search order: the folders
/// given for packages, for FILE; the robot's folder and the three above it, for FILE and for NAME/FILE; the folders of
/// $ROS_PACKAGE_PATH, for NAME/FILE, and for FILE if the folder itself is called NAME; those of $AMENT_PREFIX_PATH, for
/// share/NAME/FILE.
///
/// source  ROS wiki, "Environment Variables"; REP 122 for share/
class RobotPackages {
 public:
  /// folder    of the robot; empty: nothing is found
  /// packages  "NAME=DIR" each; throws LoadError for any other form
  RobotPackages(std::string folder, const std::vector<std::string>& packages);
  /// The path of an existing file, or nothing. A name that leads out of the searched folder is not found.
  std::filesystem::path find(const std::string& name) const;
  /// For a message: where a file was searched for in vain, and what to set.
  std::string advice(const std::string& name) const;

 private:
  std::string folder_;
  std::vector<std::pair<std::string, std::filesystem::path>> packages_;
};

}  // namespace collided::engine
