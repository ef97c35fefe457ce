#pragma once

#include <memory>
#include <string>

#include "client/cli/publish/bounce.hpp"
#include "client/cli/publish/source.hpp"

namespace collided::cli {

struct BounceSourceOptions {
  BounceOptions bounce;
  std::string name = "spheres";  // spheres are called name/0, name/1, ...; the walls name/cube
  std::size_t polygon_count = 256;
  bool round = false;    // real spheres instead of polygons
  bool bounces = false;  // without: they only move, reflected by the walls
  double rate_hz = 60;
  ObjectTexts objects = {};
};

/// The homework as a publisher: it moves the spheres, hears of their contacts from the server, and answers with velocities.
std::unique_ptr<Source> make_bounce_source(const BounceSourceOptions& options);

}  // namespace collided::cli
