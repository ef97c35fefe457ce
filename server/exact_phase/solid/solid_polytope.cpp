#include "server/exact_phase/solid/solid_polytope.hpp"

#include <algorithm>

#include "server/exact_phase/solid/fragments.hpp"
#include "server/exact_phase/solid/point_signs.hpp"

namespace collided::engine {

/// One polytope's state on its walk through a tree.
class SolidPolytope {
 public:
  SolidPolytope(const SolidTree& tree, const TriangleMesh& polytope)
      : tree_(tree), polytope_(polytope), bounds_(bounds_of(polytope)), faces_(polytope, bounds_) {}

  PolytopeSide side();

 private:
  /// Pieces of the polytope's faces that reached a node or leaf.
  struct PiecesAt {
    std::uint32_t at;
    std::vector<std::uint32_t> pieces;
  };

  static Aabb bounds_of(const TriangleMesh& mesh) {
    Aabb box;
    for (const Vec3& vertex : mesh.vertices) box.extend(vertex);
    return box;
  }
  void divide(const PiecesAt& pieces);
  std::uint32_t inner_child(const SolidTree::SplitNode& node) const;
  void reach(std::uint32_t leaf) { (leaf == SolidTree::kIn ? is_in_ : is_out_) = true; }
  bool holds_surface() const;
  bool reaches_inside(const Triangle& triangle) const;

  const SolidTree& tree_;
  const TriangleMesh& polytope_;
  Aabb bounds_;
  Fragments faces_;
  std::vector<PiecesAt> waiting_;
  // Whether the space directly under the faces is inside.
  bool is_in_ = false;
  bool is_out_ = false;
};

/// The half that contains the polytope, which has a face in the node's plane.
std::uint32_t SolidPolytope::inner_child(const SolidTree::SplitNode& node) const {
  for (const Vec3& vertex : polytope_.vertices) {
    const int side = tree_.side_of(node, vertex);
    if (side != 0) return side > 0 ? node.front : node.back;
  }
  return node.front;  // impossible if the polytope has a volume
}

void SolidPolytope::divide(const PiecesAt& pieces) {
  if (pieces.at >= SolidTree::kIn) return reach(pieces.at);
  const SolidTree::SplitNode& node = tree_.nodes_[pieces.at];
  const std::uint32_t plane = faces_.plane_of_other(*tree_.mesh_, node.plane);
  PiecesAt front{node.front, {}};
  PiecesAt back{node.back, {}};
  for (const std::uint32_t piece : pieces.pieces) {
    const Fragments::FragmentSides sides = faces_.sides(piece, plane);
    if (sides.front && sides.back) {
      const Fragments::Halves halves = faces_.cut(piece, plane);
      front.pieces.push_back(halves.front);
      back.pieces.push_back(halves.back);
    } else if (sides.front || sides.back) {
      (sides.front ? front : back).pieces.push_back(piece);
    } else {
      (inner_child(node) == node.front ? front : back).pieces.push_back(piece);
    }
  }
  for (PiecesAt* half : {&front, &back}) {
    if (!half->pieces.empty()) waiting_.push_back(std::move(*half));
  }
}

/// True if an inner point of the triangle is inside the polytope; no face may cut the triangle in two.
bool SolidPolytope::reaches_inside(const Triangle& triangle) const {
  const Vec3* const corners[3] = {&triangle.a, &triangle.b, &triangle.c};
  for (const Vec3* corner : corners) {
    if ((corner->array() < bounds_.low.array()).any() || (corner->array() > bounds_.high.array()).any()) return false;
  }
  for (std::uint32_t i = 0; i < polytope_.triangles.size(); ++i) {
    const Triangle face = polytope_.triangle(i);
    int in_plane = 0;
    for (const Vec3* corner : corners) {
      const int height = PlainPoint(*corner).height(face);
      if (height > 0) return false;
      in_plane += height == 0 ? 1 : 0;
    }
    if (in_plane == 3) return false;
  }
  return true;
}

/// If all faces are on one side, any surface in the polytope is a whole component, with every corner inside: not beyond
/// the polytope's faces, though possibly in them.
bool SolidPolytope::holds_surface() const {
  for (std::uint32_t i = 0; i < tree_.mesh_->triangles.size(); ++i) {
    if (reaches_inside(tree_.mesh_->triangle(i))) return true;
  }
  return false;
}

PolytopeSide SolidPolytope::side() {
  if (!overlaps(bounds_, tree_.bounds_)) return PolytopeSide::out;
  PiecesAt all{0, {}};
  for (std::uint32_t i = 0; i < polytope_.triangles.size(); ++i) all.pieces.push_back(faces_.add(i));
  waiting_.push_back(std::move(all));
  while (!waiting_.empty() && !(is_in_ && is_out_)) {
    const PiecesAt pieces = std::move(waiting_.back());
    waiting_.pop_back();
    divide(pieces);
  }
  if ((is_in_ && is_out_) || holds_surface()) return PolytopeSide::crosses;
  return is_in_ ? PolytopeSide::in : PolytopeSide::out;
}

PolytopeSide polytope_side(const SolidTree& tree, const TriangleMesh& polytope) {
  return SolidPolytope(tree, polytope).side();
}

}  // namespace collided::engine
