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

/// How the triangles of a part relate to those of the file, if they are not the same.
///
/// When mending cuts a triangle, its first piece keeps the number, and the other pieces go to the end of the part. If
/// only some of a part's triangles are held, they keep their numbers in the whole part.
struct CutTriangles {
  /// For each of the pieces at the end of the whole part, in order, the number of the triangle that it was cut from.
  /// Null: nothing was cut.
  std::shared_ptr<const std::vector<std::uint32_t>> piece_of{};
  /// For each held triangle its number in the whole part, ascending. Null: all are held.
  std::shared_ptr<const std::vector<std::uint32_t>> held{};
  std::uint32_t whole_count = 0;  // triangles of the whole part, if only some are held

  std::size_t piece_count() const { return piece_of ? piece_of->size() : 0; }
  bool is_whole() const { return held == nullptr; }
  /// The number by which answers name a triangle of the part: that in the file. An invalid number is returned
  /// unchanged.
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

/// Treatment of open meshes that are declared solid: they stay surfaces, or become solid by winding number.
enum class SolidBy : std::uint8_t { closing, winding };

/// A run of the scene mesh's triangles that is one object in answers.
struct Part {
  std::string name;  // "scene/part", or "scene" if the file has one part without a name; unique in the scene
  std::uint32_t first_triangle = 0;
  std::uint32_t triangle_count = 0;
  Filter filter{};
  CutTriangles cut{};
  std::optional<SolidBy> solid{};  // declared by the file
};

/// The index of a mesh in a scene file, in the broad phase's own format. The bytes are unchecked, and valid for as long
/// as the keeper lives. Empty if there is none.
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
  SavedIndex index{};              // for the shape's mesh
  CutTriangles cut{};              // for the shape's mesh
  std::uint32_t number = 0;        // its number in the scene's allowed pairs
  std::optional<SolidBy> solid{};  // declared by the file
};

/// How much of a file in tiles was read.
struct TilesRead {
  std::uint64_t tiles = 0;
  std::uint64_t tiles_of_file = 0;
  std::uint64_t triangles_of_file = 0;
  std::uint64_t parts_of_file = 0;
};

/// The parts of a server's snapshot beyond a scene file; see table Frozen in idl/scene.fbs.
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
  std::shared_ptr<const AllowedPairs> allowed_pairs{};  // between the objects; null: none
  bool is_moving = false;               // its objects take poses, except half-spaces; its triangles do not move
  SavedIndex index{};                   // for the mesh
  CollapseOrder collapses{};            // for the mesh; empty: no levels of detail are made
  std::optional<TilesRead> tiles{};     // nothing: the file is not in tiles
  std::optional<FrozenWorld> frozen{};  // nothing: it is not a snapshot
};

/// The results of loading. Each line is a sentence for the user, with a count.
struct LoadReport {
  std::vector<std::string> notes;  // how the file was interpreted or approximated, with the error
  std::vector<std::string> mended;
  std::vector<std::string> refused;
  std::vector<std::string> warnings;
  std::vector<std::string> placed;  // unit, up axis and origin: from the file, or as assumed
  double seconds = 0;
};

/// How to load a file, and its limits.
struct LoadOptions {
  std::string name{};   // empty: the file's stem
  double unit_m = 1;    // metres per unit of the file
  char up = 0;          // axis of the file that points up: 'y' is turned to z by (x, y, z) -> (x, -z, y); 0: as the
                        // format defines, else z
  double radius_m = 0;  // of the balls around a cloud's points
  bool strict = false;  // refuse what would otherwise be mended
  std::optional<double> mend_m{};  // close T-vertices, and cracks up to this width; 0: the width chosen by mend()
  bool is_foreign = false;         // sent by a client, so not trusted: only the converter process reads it
  std::string solid{};             // name glob of the parts and objects whose meshes are declared solid; empty: none
  bool solid_by_winding = false;   // open ones among them are solid by their winding number
  std::string srdf{};              // for a URDF robot: the file with the links that may touch
  std::vector<std::string> packages{};  // for a URDF robot: folders of packages that it names, as "NAME=DIR"
  // Only what reaches into this box is needed: a file in tiles is read only as far, other files are read whole.
  std::optional<Aabb> within{};
  // Names of the parts that are needed whole if any of them is needed. Empty: none.
  std::function<bool(std::string_view)> needed_whole{};
  std::uint64_t max_triangles = 100'000'000;
  std::uint64_t max_file_bytes = std::uint64_t{8} << 30;
  std::function<void(double)> progress{};  // called with the fraction done, in [0, 1]
  std::function<bool()> cancelled{};       // called often; true ends the load with a LoadError
};

/// Why a file cannot be loaded: where, what, value, limit and consequence, as in "bunny.ply: line 12: ... Nothing was
/// loaded."
struct LoadError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Loads a file: .obj .stl .ply .off .surfaces .gltf .glb .json and .cityjson (CityJSON) .xyz .pcd .bt .csv .urdf
/// .cscene .ctiles in this process; files of any other ending, and foreign ones, by the converter process
/// (collided-import).
///
/// returns   the whole scene; for a file in tiles the content of options.within
/// throws    LoadError: nothing is loaded
/// threads   any; it calls progress and cancelled on the calling thread
Scene load_scene(const std::string& path, const LoadOptions& options, LoadReport& report);

/// True if a file with this ending is read in this process and not by the converter.
bool is_read_here(const std::string& path);

/// The small scene of a server without arguments: a floor, four walls, shelves and pallets.
Scene embedded_scene();

}  // namespace collided::engine
