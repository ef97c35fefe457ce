#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "client/cli/io.hpp"
#include "client/cli/publish/source.hpp"

namespace collided::cli {

/// A polyline whose points are found by the distance along it. Immutable.
class Path {
 public:
  /// Throws Failure for fewer than two points and for a length of 0.
  explicit Path(std::vector<Vec3> points);
  double length_m() const { return distance_m_.back(); }
  /// The point at this distance from the start; the ends for distances beyond them.
  Vec3 at(double along_m) const;
  /// Unit direction of travel there.
  Vec3 direction(double along_m) const;

 private:
  std::size_t segment(double along_m) const;
  std::vector<Vec3> points_;
  std::vector<double> distance_m_;  // from the start to each point
};

/// The points of a text such as "0,0,1 2,0,1 2,2,1". Throws Failure.
std::vector<Vec3> parse_waypoints(std::string_view text);
/// The points of a CSV file of x,y,z. With a header, other columns are ignored. Throws Failure with file, line, column
/// and value.
std::vector<Vec3> read_waypoints(Io& io, const std::string& path);

/// The object and its motion.
struct PathOptions {
  std::string name = "drone";
  ShapePart shape = SphereShape{.radius_m = 0.1};
  double speed_m_s = 1;
  double rate_hz = 100;
  bool face_forward = false;  // its x axis points in the direction of travel
  ObjectTexts objects = {};
};

/// A source of one object that flies along a path. The last frame is at the path's end; a closed path returns to its
/// start in a straight line.
std::unique_ptr<MotionSource> make_path_source(std::vector<Vec3> points, bool closed, const PathOptions& options);

}  // namespace collided::cli
