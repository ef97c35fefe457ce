#pragma once

#include <optional>
#include <string>
#include <vector>

#include <collided/robot.hpp>

#include "client/cli/input/line_reader.hpp"

namespace collided::cli {

/// A row of joint positions.
struct JointRow {
  std::optional<double> time_s;
  std::string config;  // its name; empty: none
  std::vector<JointValue> joints;
};

/// Reads rows of joint positions from a file with a header: t and the names of joints, in any order, separated by
/// commas or blanks; t may be missing. Radians and metres, or with a unit (30deg). A joint with an empty cell stays.
/// One thread.
class JointCsv {
 public:
  enum class Found { row, refused, end };

  /// robot        whose joints the header may name; must outlive this
  /// has_configs  a column config, if there is one, names the rows
  JointCsv(const InputFile& file, const Robot& robot, bool has_configs = false)
      : file_(file), robot_(robot), has_configs_(has_configs), lines_(file.descriptor()) {}

  /// Reads the next row. If it is refused, `refusal` gives the reason: "joints.csv line 7: 'nan' in column elbow".
  /// Throws Failure if the header names no joint of the robot, or one twice.
  Found next(JointRow& row, std::string& refusal);
  /// See LineReader::when_waiting.
  void when_waiting(std::function<void()> call) { lines_.when_waiting(std::move(call)); }
  /// Whether rows have times; known once a row was read.
  bool has_time() const { return has_time_; }
  std::size_t line_number() const { return lines_.line_number(); }

 private:
  void take_header();
  void read(JointRow& row);

  const InputFile& file_;
  const Robot& robot_;
  bool has_configs_;
  LineReader lines_;
  bool started_ = false;
  bool has_time_ = false;
  char separator_ = ',';
  std::vector<std::optional<std::size_t>> joint_of_cell_;  // none: the time, or the name
  std::optional<std::size_t> config_cell_;
  std::string text_;
  std::vector<std::string> cells_;
};

}  // namespace collided::cli
