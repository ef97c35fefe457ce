#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <collided/client.hpp>

#include "client/cli/input/line_reader.hpp"
#include "client/cli/publish/pose_csv.hpp"

namespace collided::cli {

/// Reads configurations from a file: rows config,name,x,y,z,qw,qx,qy,qz, of which successive ones with the same config
/// are one configuration; or JSON, one a line: {"config": ID, "poses": {NAME: [x, y, z, qw, qx, qy, qz]}}. The rotation
/// may be left out. The first configuration sets the objects of all, in any order. One thread.
class ConfigurationReader {
 public:
  explicit ConfigurationReader(const InputFile& file);

  struct Configuration {
    std::string id;
    std::vector<Pose> poses;  // in the order of objects()
    std::string refusal;      // why it cannot be asked: "plan.csv line 7: 'nan' in column x"; empty: it can
  };
  /// The next one; nothing at the end. Throws Failure if the file's header is not understood.
  std::optional<Configuration> next();
  const std::vector<std::string>& objects() const { return objects_; }

 private:
  struct NamedPose {
    std::string name;
    Pose pose;
  };
  std::optional<Configuration> next_of_csv();
  std::optional<Configuration> next_of_json();
  void put_in_order(const std::vector<NamedPose>& placed, Configuration& configuration);

  void read_row();

  const InputFile& file_;
  LineReader lines_;
  std::string text_;            // the current line of JSON
  bool has_line_ = false;       // it was read, but not yet used
  std::optional<PoseCsv> csv_;  // nothing: the lines are JSON
  std::optional<PoseRow> row_;  // read, but part of the next configuration
  std::string refusal_;         // why that row is invalid
  std::vector<std::string> objects_;
};

}  // namespace collided::cli
