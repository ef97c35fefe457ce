#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <collided/robot.hpp>

#include "client/cli/input/configuration_reader.hpp"
#include "client/cli/publish/joint_csv.hpp"

namespace collided::cli {

/// Reads configurations of a robot from a file in the format of JointCsv: a row is a configuration, named by its column
/// config, if there is one, else by its number from 1. A joint whose cell is empty stays as in the row before. One
/// thread.
class RobotConfigurations {
 public:
  /// objects  those of the robot; all arguments by reference must outlive this
  RobotConfigurations(const InputFile& file, const Robot& robot, const RobotObjects& objects, const RobotPlace& place)
      : file_(file), robot_(robot), objects_(objects), place_(place), csv_(file, robot, true) {}

  /// The next one; nothing at the end. Throws Failure if the header is not understood.
  std::optional<ConfigurationReader::Configuration> next();
  const std::vector<std::string>& objects() const { return objects_.names; }
  /// Suspicious values of the last one: an angle that may be meant in degrees.
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  const InputFile& file_;
  const Robot& robot_;
  const RobotObjects& objects_;
  RobotPlace place_;
  JointCsv csv_;
  std::vector<double> positions_;
  std::vector<std::string> warnings_;
  std::size_t row_count_ = 0;
};

}  // namespace collided::cli
