#pragma once

#include <optional>
#include <string>
#include <vector>

#include <collided/client.hpp>

#include "client/cli/input/line_reader.hpp"

namespace collided::cli {

/// A row of poses.
struct PoseRow {
  std::optional<double> time_s;
  std::string config;  // its configuration's name, if the file has configurations instead of times
  std::string name;
  Pose pose;
};

/// Reads rows of poses from a file: t,name,x,y,z,qw,qx,qy,qz, separated by commas or blanks. A header may leave out t,
/// name or the rotation, and have the columns in any order. A quaternion whose norm is within 1e-3 of 1 is normalised,
/// since recordings round them. One thread.
class PoseCsv {
 public:
  enum class Found { row, refused, end };

  explicit PoseCsv(const InputFile& file) : file_(file), lines_(file.descriptor()) {}
  /// For configurations: the first column is the name of one, any text, instead of the time.
  ///
  /// lines       of the file, after its first
  /// first_line  the first line
  PoseCsv(const InputFile& file, LineReader lines, std::string first_line)
      : file_(file), lines_(std::move(lines)), has_configs_(true), first_line_(std::move(first_line)) {}

  /// Reads the next row. If it is refused, `refusal` gives the reason: "poses.csv line 7: 'nan' in column x", and the
  /// row has its config if that was read. Throws Failure if the header is not understood.
  Found next(PoseRow& row, std::string& refusal);
  /// See LineReader::when_waiting.
  void when_waiting(std::function<void()> call) { lines_.when_waiting(std::move(call)); }
  /// Whether next() would not wait.
  bool ready() { return lines_.ready(); }
  /// Whether rows have times; known once a row was read.
  bool has_time() const { return has_time_; }
  std::size_t line_number() const { return lines_.line_number(); }

 private:
  bool take_line();
  bool take_header();
  void read(PoseRow& row);

  const InputFile& file_;
  LineReader lines_;
  bool has_configs_ = false;
  std::optional<std::string> first_line_;  // read, but not yet used
  bool started_ = false;
  bool has_time_ = true;
  char separator_ = ',';
  std::vector<int> column_of_cell_;
  std::string text_;
  std::vector<std::string> cells_;
};

}  // namespace collided::cli
