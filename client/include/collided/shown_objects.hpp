#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <collided/shapes.hpp>

/// What is where, with every shape: for whoever draws.
#pragma GCC visibility push(default)

namespace collided {

/// Bits of an edge's kind. Decided exactly, by the server.
enum EdgeKind : std::uint8_t {
  kBoundaryEdge = 1,  // of one triangle only
  kManyEdge = 2,      // of three and more
  kCreaseEdge = 4,    // of two that meet at more than the asked angle
  kMaterialEdge =
      8,  // of triangles of different parts of a scene, which are what its file's materials and groups became
  kTurnedEdge = 16,  // of two that run along it the same way: one counts as turned over
};

/// ends       vertex numbers; places that vertices share have one number, the first
/// triangles  the first two that have the edge; kNoTriangle: there is no second
struct SurfaceEdge {
  std::array<std::uint32_t, 2> ends{};
  std::array<std::uint32_t, 2> triangles{};
  std::uint8_t kinds = 0;
};

/// Triangles as the server has them, in the frame of what they are of, in the very doubles that decide; immutable.
struct Surface {
  std::uint64_t number = 0;  // the server's, of its epoch; another surface never has it
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<SurfaceEdge> edges;  // of all triangles with an area; empty unless they were asked for
};

/// A run of a surface's triangles: many objects may share one surface, and the parts of a scene have one each of theirs.
struct SurfaceRun {
  std::shared_ptr<const Surface> surface;
  std::uint32_t first_triangle = 0;
  std::uint32_t triangle_count = 0;
  bool is_hull = false;  // closed, its triangles outward, and the inside counts too
};

/// An object as it stands. The parts are spheres, boxes, capsules, cylinders, cones, ellipsoids and half-spaces, clouds
/// and lines as the balls and capsules that they are; everything else is runs of surfaces. All in the object's own frame,
/// scaled already; parts of a static scene in world coordinates, with no pose. Turned boxes and ellipsoids have their axes
/// as a quaternion, off by some 1e-16.
struct ShownObject {
  std::uint64_t id = 0;
  std::string name;
  std::string scene;  // that it was loaded with; empty: added at run time
  bool moving = false;
  bool stale = false;  // its publisher is lost
  std::uint32_t layers = 0;
  std::uint32_t mask = 0;
  std::uint32_t group = 0;
  Pose pose;  // the newest
  Shape parts;
  std::vector<SurfaceRun> runs;
};

/// Objects of one state of the world.
struct ShownObjects {
  std::uint64_t epoch = 0;
  std::uint64_t version = 0;
  std::uint64_t table_version = 0;  // changes when an object comes, goes or gets another shape
  std::chrono::nanoseconds world_time{0};
  std::vector<ShownObject> objects;
};

struct ShapesOptions {
  std::string only = {};  // name globs, as in AskOptions
  std::string skip = {};
  std::uint32_t mask = 0xffffffff;
  std::optional<bool> moving = {};  // only what moves, or only what does not
  bool edges = false;               // of surfaces, with their kinds
  double crease_cosine = 0.5;       // of the angle between two normals beyond which their edge is a crease
  std::chrono::nanoseconds timeout{10'000'000'000};  // of each page of 8 MiB
};

/// Where everything that moves is, in one state of the world; parallel.
struct Poses {
  std::uint64_t epoch = 0;
  std::uint64_t version = 0;
  std::uint64_t table_version = 0;  // other than that of the ShownObjects at hand: ask for shapes again
  std::chrono::nanoseconds world_time{0};
  std::vector<std::uint64_t> ids;
  std::vector<Pose> poses;
  std::vector<std::uint8_t> stale;  // 1: its publisher is lost
};

}  // namespace collided

#pragma GCC visibility pop
