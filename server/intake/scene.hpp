#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "server/geometry/mesh.hpp"
#include "server/geometry/pose.hpp"
#include "server/geometry/shape.hpp"
#include "server/intake/simplify/collapse_order.hpp"

namespace collided::engine {

/// Mending cuts triangles of a part: the first piece of each keeps its number, the others come last in the part. For
/// those, in their order, the numbers of the triangles they are of. Null for a part as the file has it.
struct CutTriangles {
  std::shared_ptr<const std::vector<std::uint32_t>> piece_of{};

  std::size_t piece_count() const { return piece_of ? piece_of->size() : 0; }
  /// What answers call a triangle of the part: its number in the file. Others than the part's are left as they are.
  std::uint32_t told(std::uint32_t triangle, std::uint32_t triangle_count) const {
    const std::size_t first_piece = triangle_count - piece_count();
    return triangle < first_piece || triangle >= triangle_count ? triangle : (*piece_of)[triangle - first_piece];
  }
};

/// A run of triangles that answers name: one object of the scene.
struct Part {
  std::string name;  // "scene/part", or "scene" where the file holds one part without a name; unique in the scene
  std::uint32_t first_triangle = 0;
  std::uint32_t triangle_count = 0;
  Filter filter{};
  CutTriangles cut{};
};

/// The index of a mesh as a scene file holds it: bytes of the broad phase, unchecked, for as long as keeper lives.
/// Empty: there is none.
struct SavedIndex {
  std::span<const std::byte> bytes{};
  std::shared_ptr<const void> keeper{};
};

struct SceneObject {
  std::string name;
  Shape shape{};
  Pose pose{};
  Filter filter{};
  SavedIndex index{};  // of the shape's mesh
  CutTriangles cut{};  // of the shape's mesh
};

/// One loaded file: static triangles in world coordinates, split into parts without gap, and objects with a pose.
struct Scene {
  std::string name;
  TriangleMesh mesh{};
  std::vector<Part> parts{};
  std::vector<SceneObject> objects{};
  SavedIndex index{};         // of the mesh
  CollapseOrder collapses{};  // of the mesh; empty: no levels of detail are made
};

/// What loading did; each line is a sentence for the user with a count.
struct LoadReport {
  std::vector<std::string> notes;  // what was made of the file, with its error
  std::vector<std::string> mended;
  std::vector<std::string> refused;
  std::vector<std::string> warnings;
  std::vector<std::string> placed;  // unit, up axis and origin: what the file says, what was taken where it is silent
  double seconds = 0;
};

struct LoadOptions {
  std::string name{};   // empty: the file's stem
  double unit_m = 1;    // metres per unit of the file
  char up = 0;          // axis of the file that points up: 'y' is turned to z by (x, y, z) -> (x, -z, y); 0: what the
                        // format says, else z
  double radius_m = 0;  // of the balls about a cloud's points
  bool strict = false;  // refuse what would be mended
  std::optional<double> mend_m{};  // close cracks up to this width and T-vertices; 0: what mend.hpp takes by itself
  bool is_foreign = false;  // came from somebody who could not read the server's files: read by the converter process
  std::string srdf{};       // of a URDF robot: the file that says which links may touch
  std::uint64_t max_triangles = 100'000'000;
  std::uint64_t max_file_bytes = std::uint64_t{8} << 30;
  std::function<void(double)> progress{};  // fraction done in [0, 1]
  std::function<bool()> cancelled{};       // true ends the load with a LoadError
};

/// Says where, what, value, limit and consequence: "bunny.ply: line 12: ... Nothing was loaded."
struct LoadError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Reads .obj .stl .ply .off .surfaces .gltf .glb .json (CityJSON) .xyz .pcd .bt .csv .urdf .cscene here; any other ending
/// goes to the converter process (collided-import), as do foreign files of any ending.
/// Either the whole scene comes back or a LoadError is thrown.
Scene load_scene(const std::string& path, const LoadOptions& options, LoadReport& report);

/// Whether a file of this name is read here, and not by the converter process.
bool is_read_here(const std::string& path);

/// The small scene that a server without an argument serves: a floor, four walls, shelves and pallets.
Scene embedded_scene();

}  // namespace collided::engine
