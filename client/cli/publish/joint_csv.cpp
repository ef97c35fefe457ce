#include "client/cli/publish/joint_csv.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "client/cli/failure.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/output/output.hpp"
#include "client/cli/output/suggest.hpp"
#include "client/cli/output/text_row.hpp"

namespace collided::cli {
namespace {

bool is_time_column(const std::string& name) { return name == "t" || name == "time" || name == "timestamp"; }

Measure measure_of(JointKind kind) { return kind == JointKind::prismatic ? Measure::length : Measure::angle; }

}  // namespace

void JointCsv::take_header() {
  separator_ = sniff_separator(text_);
  split_cells(text_, separator_, cells_);
  std::vector<std::string> names;
  for (const RobotJoint& joint : robot_.joints()) {
    if (joint.kind != JointKind::fixed && !joint.mimic) names.push_back(joint.name);
  }
  const std::string where = fmt::format("{} line {}: ", file_.name(), lines_.line_number());
  for (const std::string& cell : cells_) {
    if (std::count(cells_.begin(), cells_.end(), cell) > 1)
      throw bad_use(fmt::format("{}column '{}' stands twice", where, printable(cell)));
    if (has_configs_ && cell == "config" && !robot_.find_joint(cell)) {
      config_cell_ = joint_of_cell_.size();
      joint_of_cell_.push_back(std::nullopt);
      continue;
    }
    const bool is_time = is_time_column(cell);
    const std::optional<std::size_t> joint = robot_.find_joint(cell);
    if (!is_time && !joint) {
      throw bad_use(fmt::format("{}robot '{}' has no joint '{}'{}", where, printable(robot_.name()), printable(cell),
                                did_you_mean(cell, names)),
                    "the first line names the columns: t and joints");
    }
    if (!is_time && std::find(names.begin(), names.end(), cell) == names.end()) {
      throw bad_use(
          fmt::format("{}joint '{}' is fixed or follows another one; leave its column out", where, printable(cell)));
    }
    joint_of_cell_.push_back(is_time ? std::nullopt : joint);
    has_time_ = has_time_ || is_time;
  }
}

void JointCsv::read(JointRow& row) {
  split_cells(text_, separator_, cells_);
  if (cells_.size() != joint_of_cell_.size())
    throw bad_use(fmt::format("{} cells, {} are needed", cells_.size(), joint_of_cell_.size()));
  row = {};
  for (std::size_t at = 0; at < cells_.size(); ++at) {
    if (at == config_cell_) {
      row.config = cells_[at];
      continue;
    }
    const RobotJoint* const joint = joint_of_cell_[at] ? &robot_.joints()[*joint_of_cell_[at]] : nullptr;
    if (joint != nullptr && cells_[at].empty()) continue;
    double value = 0;
    try {
      value = parse_finite(cells_[at], joint != nullptr ? measure_of(joint->kind) : Measure::none);
    } catch (const Failure&) {
      throw bad_use(fmt::format("'{}' in column {}", printable(cells_[at]), joint != nullptr ? joint->name : "t"));
    }
    if (joint != nullptr) row.joints.push_back({joint->name, value});
    else row.time_s = value;
  }
}

JointCsv::Found JointCsv::next(JointRow& row, std::string& refusal) {
  while (lines_.next(text_)) {
    if (is_blank_line(text_)) continue;
    if (!started_) {
      started_ = true;
      if (text_.starts_with("\xef\xbb\xbf")) text_.erase(0, 3);  // byte order mark
      take_header();
      continue;
    }
    try {
      if (lines_.line_was_cut()) throw bad_use(fmt::format("longer than {} bytes", LineReader::kLongestLine));
      read(row);
      return Found::row;
    } catch (const Failure& failure) {
      refusal = fmt::format("{} line {}: {}", file_.name(), lines_.line_number(), failure.what());
      return Found::refused;
    }
  }
  return Found::end;
}

}  // namespace collided::cli
