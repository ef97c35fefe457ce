#include <fmt/format.h>

#include "server/intake/limits.hpp"
#include "server/intake/readers/reading.hpp"
#include "server/intake/readers/text_cursor.hpp"

namespace collided::engine {

/// Each line has the three coordinates of a point. Further columns (intensity, colour) are ignored.
Scene read_xyz(const Reading& reading) {
  TextCursor cursor(reading, {reading.begin(), reading.bytes.size()}, TextCursor::LineEnd::newline_or_comment, false);
  SceneObject cloud;
  while (cursor.find_word()) {
    Vec3 point;
    for (double& coordinate : point) {
      if (cursor.at_line_end()) cursor.complain("a point takes three coordinates");
      coordinate = cursor.finite_number("point coordinate");
    }
    if (cloud.shape.primitives.size() == kMaxCloudPoints) {
      cursor.complain(fmt::format("more than {} points, the most that a cloud may have", kMaxCloudPoints));
    }
    cloud.shape.primitives.push_back(Sphere{.center = point});
    cursor.next_line();
  }
  if (cloud.shape.primitives.empty()) refuse(reading, "no points");
  Scene scene;
  scene.objects.push_back(std::move(cloud));
  return scene;
}

}  // namespace collided::engine
