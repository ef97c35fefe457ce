#include "client/cli/publish/pose_csv.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "client/cli/failure.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/output/output.hpp"
#include "client/cli/output/suggest.hpp"
#include "client/cli/output/text_row.hpp"

namespace collided::cli {
namespace {

enum PoseColumn : int { kTime, kName, kX, kY, kZ, kQw, kQx, kQy, kQz, kColumnCount };
constexpr std::array<std::string_view, kColumnCount> kNames{"t", "name", "x", "y", "z", "qw", "qx", "qy", "qz"};
constexpr std::array<std::string_view, kColumnCount> kOtherNames{"timestamp", "object", "tx", "ty", "tz",
                                                                 "",          "",       "",   ""};
constexpr std::size_t kLongestName = 255;

int find_column(std::string_view name, bool has_configs) {
  if (has_configs && name == "config") return kTime;
  for (int column = 0; column < kColumnCount; ++column) {
    const auto index = static_cast<std::size_t>(column);
    if (kNames[index] == name || (!kOtherNames[index].empty() && kOtherNames[index] == name)) return column;
  }
  return kColumnCount;
}

Quat rotation_of(const std::array<double, kColumnCount>& value) {
  const Quat rotation(value[kQw], value[kQx], value[kQy], value[kQz]);
  const double norm = rotation.norm();
  constexpr double kMostOff = 1e-3;  // three digits, the coarsest recordings
  if (!(std::abs(norm - 1) <= kMostOff))
    throw bad_use(fmt::format("quaternion norm {}, allowed 1 +- 1e-3", format_number(norm)));
  return rotation.normalized();
}

}  // namespace

bool PoseCsv::take_header() {
  separator_ = sniff_separator(text_);
  split_cells(text_, separator_, cells_);
  if (is_number_text(cells_.front())) {
    // Without a header: t,name,x,y,z and perhaps the rotation.
    for (int column = 0; column < kColumnCount; ++column) column_of_cell_.push_back(column);
    return false;
  }
  std::vector<int> columns;
  for (const std::string& cell : cells_) {
    const int column = find_column(cell, has_configs_);
    if (column == kColumnCount) {
      const std::vector<std::string> names(kNames.begin(), kNames.end());
      throw bad_use(fmt::format("{} line {}: no column '{}'{}", file_.name(), lines_.line_number(), printable(cell),
                                did_you_mean(cell, names)),
                    has_configs_ ? "columns: config,name,x,y,z,qw,qx,qy,qz" : "columns: t,name,x,y,z,qw,qx,qy,qz");
    }
    columns.push_back(column);
  }
  const auto given = [&](int column) { return std::count(columns.begin(), columns.end(), column); };
  for (const int column : {kX, kY, kZ}) {
    if (given(column) != 1)
      throw bad_use(fmt::format("{} line {}: column '{}' must stand once", file_.name(), lines_.line_number(),
                                kNames[static_cast<std::size_t>(column)]));
  }
  const auto rotation_count = given(kQw) + given(kQx) + given(kQy) + given(kQz);
  if (rotation_count != 0 && rotation_count != 4)
    throw bad_use(fmt::format("{} line {}: a rotation takes qw, qx, qy and qz", file_.name(), lines_.line_number()));
  has_time_ = given(kTime) > 0;
  column_of_cell_ = std::move(columns);
  return true;
}

void PoseCsv::read(PoseRow& row) {
  row.config.clear();
  split_cells(text_, separator_, cells_);
  const bool bare = column_of_cell_.size() == kColumnCount && cells_.size() == kQw;  // no header and no rotation
  if (cells_.size() != column_of_cell_.size() && !bare) {
    throw bad_use(fmt::format("{} cells, {} are needed", cells_.size(), column_of_cell_.size()));
  }
  std::array<double, kColumnCount> value{};
  value[kQw] = 1;
  row.time_s.reset();
  row.name = "object";
  for (std::size_t at = 0; at < cells_.size(); ++at) {
    const auto column = static_cast<std::size_t>(column_of_cell_[at]);
    if (column == kName) {
      row.name = cells_[at];
      continue;
    }
    if (column == kTime && has_configs_) {
      row.config = cells_[at];
      continue;
    }
    try {
      value[column] = parse_finite(cells_[at]);
    } catch (const Failure&) { throw bad_use(fmt::format("'{}' in column {}", printable(cells_[at]), kNames[column])); }
    if (column == kTime) row.time_s = value[column];
  }
  if (row.name.empty() || row.name.size() > kLongestName)
    throw bad_use(fmt::format("a name of {} bytes, allowed 1 to {}", row.name.size(), kLongestName));
  row.pose.position = Vec3(value[kX], value[kY], value[kZ]);
  row.pose.rotation = rotation_of(value);
}

bool PoseCsv::take_line() {
  if (!first_line_) return lines_.next(text_);
  text_ = std::move(*first_line_);
  first_line_.reset();
  return true;
}

PoseCsv::Found PoseCsv::next(PoseRow& row, std::string& refusal) {
  while (take_line()) {
    if (is_blank_line(text_)) continue;
    try {
      if (lines_.line_was_cut()) throw bad_use(fmt::format("longer than {} bytes", LineReader::kLongestLine));
      if (!started_) {
        started_ = true;
        if (text_.starts_with("\xef\xbb\xbf")) text_.erase(0, 3);  // byte order mark
        if (take_header()) continue;
      }
      read(row);
      return Found::row;
    } catch (const Failure& failure) {
      if (column_of_cell_.empty()) throw;
      refusal = fmt::format("{} line {}: {}", file_.name(), lines_.line_number(), failure.what());
      return Found::refused;
    }
  }
  return Found::end;
}

}  // namespace collided::cli
