#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <collided/shapes.hpp>

/// All objects with their shapes and poses, for programs that draw. Metres.
#pragma GCC visibility push(default)

namespace collided {

/// Kinds of an edge, as bits. The server decides them exactly.
enum EdgeKind : std::uint8_t {
  kBoundaryEdge = 1,  // of one triangle only
  kManyEdge = 2,      // of three triangles or more
  kCreaseEdge = 4,    // of two triangles that meet at more than the requested angle
  kMaterialEdge = 8,  // of triangles of different parts of a scene, made from its file's materials and groups
  kTurnedEdge = 16,   // of two triangles that traverse it in the same direction: they are oriented inconsistently
};

/// An edge of a surface.
struct SurfaceEdge {
  std::array<std::uint32_t, 2> ends{};       // vertex indices; for coincident vertices the first one's
  std::array<std::uint32_t, 2> triangles{};  // the first two with this edge; kNoTriangle: there is no second one
  std::uint8_t kinds = 0;                    // EdgeKind bits
};

/// Triangles in the frame of their object, with exactly the doubles that the server decides by. Immutable: any thread
/// may read it.
struct Surface {
  std::uint64_t number = 0;                             // assigned by the server, unique within an epoch
  std::vector<Vec3> vertices;                           // metres
  std::vector<std::array<std::uint32_t, 3>> triangles;  // vertex indices
  std::vector<SurfaceEdge> edges;  // of all triangles with an area; empty unless ShapesOptions::edges
};

/// A range of a surface's triangles. Objects of equal shape share one surface, and each part of a scene is a run of the
/// scene's surface.
struct SurfaceRun {
  std::shared_ptr<const Surface> surface;
  std::uint32_t first_triangle = 0;
  std::uint32_t triangle_count = 0;
  bool is_hull = false;  // a closed surface with triangles facing outward; its interior belongs to the object
};

/// An object with its shape and newest pose. Primitives are `parts`; meshes, height fields and hulls are `runs` of
/// surfaces. Clouds and polylines are returned as balls and capsules. Everything is scaled and in the object's frame,
/// except that the parts of a static scene are in world coordinates and have no pose. The axes of a rotated box or
/// ellipsoid are a quaternion, which is off by some 1e-16.
struct ShownObject {
  std::uint64_t id = 0;  // the server's number for it
  std::string name;
  std::string scene;  // the scene it was loaded with; empty: it was added at run time
  bool moving = false;
  bool stale = false;        // its publisher is lost (LostPolicy::freeze)
  std::uint32_t layers = 0;  // as in ObjectOptions
  std::uint32_t mask = 0;
  std::uint32_t group = 0;
  Pose pose;  // the newest
  Shape parts;
  std::vector<SurfaceRun> runs;
};

/// The objects of one state of the world, as Client::shapes returns them.
struct ShownObjects {
  std::uint64_t epoch = 0;                 // grows with each start of a server
  std::uint64_t version = 0;               // of the state
  std::uint64_t table_version = 0;         // changes when an object is added, removed or reshaped
  std::chrono::nanoseconds world_time{0};  // of the state, since 1970, by the publishers' clocks
  std::vector<ShownObject> objects;
};

/// Which objects Client::shapes returns, and in what detail.
struct ShapesOptions {
  std::string only = {};  // name globs, as in AskOptions
  std::string skip = {};
  std::uint32_t mask = 0xffffffff;  // objects with one of these layers
  std::optional<bool> moving = {};  // true: only moving objects; false: only static ones
  bool edges = false;               // also return the edges of surfaces, with their kinds
  double crease_cosine = 0.5;       // an edge is a crease if the cosine of the angle between its normals is below this
  std::chrono::nanoseconds timeout{10'000'000'000};  // for each page of 8 MiB
};

/// The poses of all moving objects in one state of the world, as parallel columns. Returned by Client::poses.
struct Poses {
  std::uint64_t epoch = 0;                 // grows with each start of a server
  std::uint64_t version = 0;               // of the state
  std::uint64_t table_version = 0;         // if it differs from that of the ShownObjects, fetch the shapes again
  std::chrono::nanoseconds world_time{0};  // of the state
  std::vector<std::uint64_t> ids;          // as in ShownObject
  std::vector<Pose> poses;
  std::vector<std::uint8_t> stale;  // 1: its publisher is lost
};

}  // namespace collided

#pragma GCC visibility pop
