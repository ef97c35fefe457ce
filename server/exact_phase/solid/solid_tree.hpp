#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "server/exact_phase/solid/split_plane.hpp"
#include "server/exact_phase/solid/surface_crossing.hpp"
#include "server/geometry/function_ref.hpp"

namespace collided::engine {

/// Size and shape of a solid's tree.
struct SolidTreeReport {
  std::uint32_t nodes = 0;
  std::uint32_t across_nodes = 0;  // nodes that split across a coordinate axis
  std::uint32_t depth = 0;
  std::uint64_t fragments = 0;  // final pieces of triangles
  std::uint64_t triangles = 0;  // with an area
  std::uint64_t bytes = 0;
  double build_s = 0;  // seconds
};

struct SolidTreeOptions {
  std::function<bool()> cancelled{};       // called now and then; true ends the build with nothing
  double most_fragments_per_triangle = 8;  // more end the build with nothing: the tree would be large and slow
  bool keeps_faces = false;                // for show_front_to_back(); some 100 bytes more per fragment
};

/// A binary space partition of a closed mesh whose leaves are wholly inside or wholly outside. Splits first across the
/// coordinate axes, until a cell holds few triangles, then along their planes: with the triangles' planes alone, a
/// convex body would give a list, not a tree.
///
/// threads  immutable after build; any number may query it
/// source   Fuchs, Kedem, Naylor, "On visible surface generation by a priori tree structures", SIGGRAPH 1980; solid
///          leaves: Naylor, Amanatides, Thibault, "Merging BSP trees yields polyhedral set operations", SIGGRAPH 1990;
///          axes first: Trettner, Nehring-Wirxel, Kobbelt, "EMBER: exact mesh booleans via efficient and robust local
///          arrangements", ACM Transactions on Graphics 41, 2022
class SolidTree {
 public:
  /// mesh       closed; no two triangles cross or overlap (world/solids checks it)
  /// is_inside  whether a point that is not on the surface is inside: called for cells without a triangle
  /// returns    nothing if cancelled, if planes cut too many triangles, or if the mesh is not of that kind
  /// cost       about 10 us a triangle; memory for its fragments
  static std::optional<SolidTree> build(std::shared_ptr<const TriangleMesh> mesh,
                                        FunctionRef<bool(const Vec3& point)> is_inside,
                                        const SolidTreeOptions& options);

  /// The exact side of the point. Nothing if it lies on more planes than the walk can follow.
  /// cost  one comparison per level, with more than one path only for points on a plane of the tree
  std::optional<SolidSide> side(const Vec3& point, std::uint32_t& nodes) const;

  const SolidTreeReport& report() const { return report_; }

 private:
  friend class SolidTreeBuild;
  friend class SolidSegment;
  friend class SolidPolytope;
  friend class FaceOrder;
  static constexpr std::uint32_t kOut = 0xffffffff;
  static constexpr std::uint32_t kIn = 0xfffffffe;

  struct SplitNode {
    SplitPlane plane;
    std::uint32_t front = kOut;
    std::uint32_t back = kOut;
  };

  /// A piece of a triangle in the plane of a node; its corners are outlines_[first, first + count).
  struct KeptFace {
    std::uint32_t triangle = 0;
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  };

  int side_of(const SplitNode& node, const Vec3& point) const;

  std::shared_ptr<const TriangleMesh> mesh_;
  Aabb bounds_;
  std::vector<SplitNode> nodes_;
  // If faces are kept: those in the plane of node i are faces_[first_face_[i], first_face_[i + 1]).
  std::vector<std::uint32_t> first_face_;
  std::vector<KeptFace> faces_;
  std::vector<Vec3> outlines_;
  SolidTreeReport report_;
};

}  // namespace collided::engine
