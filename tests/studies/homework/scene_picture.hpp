#pragma once

#include <string>
#include <vector>

#include <collided/client.hpp>

namespace collided::homework {

struct DrawnSphere {
  MeshShape mesh;
  Pose pose;
  bool touches = false;
};

struct DrawnContact {
  Vec3 point;
  Vec3 normal;
};

/// The cube about the origin with what is in it, seen from outside and above: polygons from far to near, those of
/// touching spheres in the accent colour, a mark at each contact and a line along its normal.
std::string scene_picture(const std::string& title, double side_m, const std::vector<DrawnSphere>& spheres,
                          const std::vector<DrawnContact>& contacts);

}  // namespace collided::homework
