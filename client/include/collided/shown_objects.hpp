#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <collided/shapes.hpp>

/// What is where, with every shape: for programs that draw. Metres.
#pragma GCC visibility push(default)

namespace collided {

/// Bits of an edge's kind. The server decides them exactly.
enum EdgeKind : std::uint8_t {
  kBoundaryEdge = 1,  // of one triangle only
  kManyEdge = 2,      // of three triangles or more
  kCreaseEdge = 4,    // of two triangles that meet at more than the angle asked for
  kMaterialEdge = 8,  // of triangles of different parts of a scene, made from its file's materials and groups
  kTurnedEdge = 16,   // of two triangles that run along it in the same direction: they are not oriented alike
};

/// An edge of a surface.
struct SurfaceEdge {
  std::array<std::uint32_t, 2> ends{};       // vertex numbers; of vertices at one place it is the first one's
  std::array<std::uint32_t, 2> triangles{};  // the first two that have the edge; kNoTriangle: there is no second
  std::uint8_t kinds = 0;                    // EdgeKind bits
};

/// Triangles as the server has them, in the frame of the object they belong to and with the very doubles that decide.
/// Immutable: any thread may read it.
struct Surface {
  std::uint64_t number = 0;                             // the server's; within an epoch no other surface ever has it
  std::vector<Vec3> vertices;                           // metres
  std::vector<std::array<std::uint32_t, 3>> triangles;  // vertex numbers
  std::vector<SurfaceEdge> edges;  // of all triangles with an area; empty unless ShapesOptions::edges
};

/// Some of a surface's triangles. Objects of equal shape share one surface, and the parts of a scene have a run each of
/// the scene's surface.
struct SurfaceRun {
  std::shared_ptr<const Surface> surface;
  std::uint32_t first_triangle = 0;
  std::uint32_t triangle_count = 0;
  bool is_hull = false;  // a closed surface, its triangles facing outward, and the inside belongs to the object
};

/// An object as it stands. Primitives are `parts`; meshes, height fields and hulls are `runs` of surfaces. Clouds and
/// polylines are the balls and capsules that they consist of. All of it is scaled already and in the object's frame;
/// the parts of a static scene are in world coordinates and have no pose. A rotated box or ellipsoid has its axes as a
/// quaternion, which is off by some 1e-16.
struct ShownObject {
  std::uint64_t id = 0;  // the server's number for it
  std::string name;
  std::string scene;  // the scene that it was loaded with; empty: it was added at run time
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
  std::uint64_t table_version = 0;         // changes when an object comes, goes or gets another shape
  std::chrono::nanoseconds world_time{0};  // of the state, since 1970, by the publishers' clocks
  std::vector<ShownObject> objects;
};

/// Which objects Client::shapes returns, and what of them.
struct ShapesOptions {
  std::string only = {};  // name globs, as in AskOptions
  std::string skip = {};
  std::uint32_t mask = 0xffffffff;  // objects with one of these layers
  std::optional<bool> moving = {};  // true: only what moves; false: only what does not
  bool edges = false;               // the edges of surfaces too, with their kinds
  double crease_cosine = 0.5;  // an edge is a crease where the cosine of the angle between its normals is below this
  std::chrono::nanoseconds timeout{10'000'000'000};  // for each page of 8 MiB
};

/// Where everything that moves is in one state of the world, as parallel columns. Client::poses returns it.
struct Poses {
  std::uint64_t epoch = 0;          // grows with each start of a server
  std::uint64_t version = 0;        // of the state
  std::uint64_t table_version = 0;  // not that of the ShownObjects at hand: they are out of date, ask for shapes again
  std::chrono::nanoseconds world_time{0};  // of the state
  std::vector<std::uint64_t> ids;          // as in ShownObject
  std::vector<Pose> poses;
  std::vector<std::uint8_t> stale;  // 1: its publisher is lost
};

}  // namespace collided

#pragma GCC visibility pop
