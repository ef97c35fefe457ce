#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "client/cli/io.hpp"
#include "client/cli/publish/source.hpp"

namespace collided::cli {

/// A polyline with its length along the way.
class Path {
 public:
  /// At least two points and a length above 0, else Failure.
  explicit Path(std::vector<Vec3> points);
  double length_m() const { return distance_m_.back(); }
  /// The point so far along; clamped to the ends.
  Vec3 at(double along_m) const;
  /// Unit direction of travel there.
  Vec3 direction(double along_m) const;

 private:
  std::size_t segment(double along_m) const;
  std::vector<Vec3> points_;
  std::vector<double> distance_m_;  // from the start to each point
};

/// "0,0,1 2,0,1 2,2,1"
std::vector<Vec3> parse_waypoints(std::string_view text);
/// A CSV of x,y,z, with or without a header (other columns are ignored then). Throws Failure: file, line, column, value.
std::vector<Vec3> read_waypoints(Io& io, const std::string& path);

struct PathOptions {
  std::string name = "drone";
  ShapePart shape = SphereShape{.radius_m = 0.1};
  double speed_m_s = 1;
  double rate_hz = 100;
  bool face_forward = false;  // its x axis points along the way
  ObjectTexts objects = {};
};

/// One object that flies along a path; the last frame is its end. With --loop it flies back to the start in a straight line.
std::unique_ptr<Source> make_path_source(std::vector<Vec3> points, bool closed, const PathOptions& options);

}  // namespace collided::cli
