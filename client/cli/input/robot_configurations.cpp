#include "client/cli/input/robot_configurations.hpp"

#include <fmt/format.h>

namespace collided::cli {

std::optional<ConfigurationReader::Configuration> RobotConfigurations::next() {
  ConfigurationReader::Configuration made;
  JointRow row;
  warnings_.clear();
  const JointCsv::Found found = csv_.next(row, made.refusal);
  if (found == JointCsv::Found::end) return std::nullopt;
  ++row_count_;
  made.id = row.config.empty() ? std::to_string(row_count_) : row.config;
  if (found == JointCsv::Found::refused) return made;
  const std::string where = fmt::format("{} line {}: ", file_.name(), csv_.line_number());
  const Result<std::vector<std::string>> set = robot_.set(row.joints, positions_, place_.beyond_limits);
  if (!set) {
    const std::string& hint = set.error().hint;
    made.refusal = where + set.error().message + (hint.find("degrees") != std::string::npos ? " (" + hint + ")" : "");
    return made;
  }
  for (const std::string& warning : *set) warnings_.push_back(where + warning);
  const std::vector<Pose> poses = robot_.link_poses(positions_, place_.base);
  for (const std::size_t link : objects_.links) made.poses.push_back(poses[link]);
  return made;
}

}  // namespace collided::cli
