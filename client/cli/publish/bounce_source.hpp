#pragma once

#include <memory>
#include <string>

#include "client/cli/publish/bounce.hpp"
#include "client/cli/publish/source.hpp"

namespace collided::cli {

/// The spheres as objects to publish.
struct BounceSourceOptions {
  BounceOptions bounce;
  std::string name = "spheres";  // the spheres' names are name/0, name/1, ...; that of the walls is name/cube
  std::size_t polygon_count = 256;
  bool round = false;    // exact spheres instead of meshes
  bool bounces = false;  // false: contacts between spheres are ignored; the walls reflect them in any case
  double rate_hz = 60;
  ObjectTexts objects = {};
};

/// The homework as a source: it moves the spheres, gets their contacts from the server, and changes their velocities.
std::unique_ptr<MotionSource> make_bounce_source(const BounceSourceOptions& options);

}  // namespace collided::cli
