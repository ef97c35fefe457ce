#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "server/geometry/aabb.hpp"
#include "server/geometry/mesh.hpp"
#include "server/geometry/pose.hpp"
#include "server/geometry/shape.hpp"
#include "server/intake/simplify/collapse_order.hpp"

namespace collided::engine {

/// How the triangles of a part relate to those of the file, where they are not the same.
///
/// When mending cuts a triangle, its first piece keeps the number, and the other pieces go to the end of the part.
/// Of a part that is here only in part, the triangles keep the numbers that they have in the whole one.
struct CutTriangles {
  /// For each of the pieces at the end of the whole part, in order, the number of the triangle that it was cut from. Null:
  /// nothing was cut.
  std::shared_ptr<const std::vector<std::uint32_t>> piece_of{};
  /// For each triangle that is here its number in the whole part, ascending. Null: all of them are here.
  std::shared_ptr<const std::vector<std::uint32_t>> held{};
  std::uint32_t whole_count = 0;  // triangles of the whole part, where only some are held

  std::size_t piece_count() const { return piece_of ? piece_of->size() : 0; }
  bool is_whole() const { return held == nullptr; }
  /// The number that answers report for a triangle of the part: that in the file. A number that is not one of the
  /// part's comes back unchanged.
  std::uint32_t told(std::uint32_t triangle, std::uint32_t triangle_count) const {
    if (triangle >= triangle_count) return triangle;
    if (held) {
      triangle = (*held)[triangle];
      triangle_count = whole_count;
    }
    const std::size_t first_piece = triangle_count - piece_count();
    return triangle < first_piece ? triangle : (*piece_of)[triangle - first_piece];
  }
};

/// What becomes of meshes declared solid that do not close: they stay surfaces, or are solid by winding number.
enum class SolidBy : std::uint8_t { closing, winding };

/// A run of the scene mesh's triangles that is one object: answers name it.
struct Part {
  std::string name;  // "scene/part", or "scene" where the file holds one part without a name; unique in the scene
  std::uint32_t first_triangle = 0;
  std::uint32_t triangle_count = 0;
  Filter filter{};
  CutTriangles cut{};
  std::optional<SolidBy> solid{};  // declared by the file
};

/// The index of a mesh as a scene file holds it, in the broad phase's own format. The bytes are unchecked, and valid
/// for as long as the keeper lives. Empty: there is none.
struct SavedIndex {
  std::span<const std::byte> bytes{};
  std::shared_ptr<const void> keeper{};
};

/// An object of a scene that is not part of its static mesh.
struct SceneObject {
  std::string name;
  Shape shape{};
  Pose pose{};
  Filter filter{};
  SavedIndex index{};              // of the shape's mesh
  CutTriangles cut{};              // of the shape's mesh
  std::uint32_t number = 0;        // by which the scene's allowed pairs name it
  std::optional<SolidBy> solid{};  // declared by the file
};

/// How much of a file in tiles was read.
struct TilesRead {
  std::uint64_t tiles = 0;
  std::uint64_t tiles_of_file = 0;
  std::uint64_t triangles_of_file = 0;
  std::uint64_t parts_of_file = 0;
};

/// What a snapshot of a server's world has beyond the file of a scene; see table Frozen in idl/scene.fbs.
struct FrozenWorld {
  std::uint64_t version = 0;
  std::int64_t world_time_ns = 0;
  std::vector<std::uint32_t> order{};         // of all parts and objects; empty: as they stand
  std::optional<std::vector<Aabb>> covers{};  // nothing: its geometry is complete everywhere
  std::vector<std::string> lacks{};
};

/// One loaded file: static triangles in world coordinates, metres, each of which belongs to exactly one part, and
/// objects with a pose.
struct Scene {
  std::string name;
  TriangleMesh mesh{};
  std::vector<Part> parts{};
  std::vector<SceneObject> objects{};
  std::shared_ptr<const AllowedPairs> allowed_pairs{};  // of the objects; null: none
  bool is_moving = false;               // its objects take poses, half-spaces apart; its triangles stand still
  SavedIndex index{};                   // of the mesh
  CollapseOrder collapses{};            // of the mesh; empty: no levels of detail are made
  std::optional<TilesRead> tiles{};     // nothing: the file is not in tiles
  std::optional<FrozenWorld> frozen{};  // nothing: it is no snapshot
};

/// What loading did. Each line is a sentence for the user, with a count.
struct LoadReport {
  std::vector<std::string> notes;  // how the file was interpreted or approximated, with the error
  std::vector<std::string> mended;
  std::vector<std::string> refused;
  std::vector<std::string> warnings;
  std::vector<std::string> placed;  // unit, up axis and origin: as the file says, or as assumed where it does not
  double seconds = 0;
};

/// How to load a file, and its limits.
struct LoadOptions {
  std::string name{};   // empty: the file's stem
  double unit_m = 1;    // metres per unit of the file
  char up = 0;          // axis of the file that points up: 'y' is turned to z by (x, y, z) -> (x, -z, y); 0: what the
                        // format says, else z
  double radius_m = 0;  // of the balls about a cloud's points
  bool strict = false;  // refuse what would otherwise be mended
  std::optional<double> mend_m{};  // close T-vertices, and cracks up to this width; 0: the width that mend() chooses
  bool is_foreign = false;         // sent by a client, so not trusted: only the converter process reads it
  std::string solid{};             // name glob of the parts and objects whose meshes are declared solid; empty: none
  bool solid_by_winding = false;   // those of them that do not close are solid by their winding number
  std::string srdf{};              // of a URDF robot: the file that says which links may touch
  std::vector<std::string> packages{};  // of a URDF robot: folders of packages that it names, as "NAME=DIR"
  // Needed is only what comes into this box: a file in tiles is read no further than that, other files are read whole.
  std::optional<Aabb> within{};
  // The parts of which all is needed where any of it is, by their names. Empty: there are none.
  std::function<bool(std::string_view)> needed_whole{};
  std::uint64_t max_triangles = 100'000'000;
  std::uint64_t max_file_bytes = std::uint64_t{8} << 30;
  std::function<void(double)> progress{};  // called with the fraction done, in [0, 1]
  std::function<bool()> cancelled{};       // called often; true ends the load with a LoadError
};

/// Why a file cannot be loaded: where, what, value, limit and consequence, as in
/// "bunny.ply: line 12: ... Nothing was loaded."
struct LoadError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Loads a file: .obj .stl .ply .off .surfaces .gltf .glb .json and .cityjson (CityJSON) .xyz .pcd .bt .csv .urdf
/// .cscene .ctiles in this process; files of any other ending, and foreign ones, by the converter process (collided-import).
///
/// returns   the whole scene; of a file in tiles what options.within asks for
/// throws    LoadError: nothing is loaded
/// threads   any; it calls progress and cancelled on the calling thread
Scene load_scene(const std::string& path, const LoadOptions& options, LoadReport& report);

/// Whether a file of this name is read in this process and not by the converter, by its ending.
bool is_read_here(const std::string& path);

/// The small scene that a server without an argument serves: a floor, four walls, shelves and pallets.
Scene embedded_scene();

}  // namespace collided::engine
