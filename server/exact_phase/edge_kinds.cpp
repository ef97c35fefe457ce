#include "server/exact_phase/edge_kinds.hpp"

#include <cmath>

#include "server/exact_phase/arithmetic/number.hpp"

namespace collided::engine {
namespace {

using kernel::Vector;

template <class N>
Vector<N> normal(const Triangle& t) {
  const Vector<N> a(t.a);
  return cross(Vector<N>(t.b) - a, Vector<N>(t.c) - a);
}

/// Whether the normals n and m (m flipped if turned_over) form an angle larger than the cosine's: n.m < cosine |n| |m|.
template <class N>
Decision is_crease(const Triangle& one, const Triangle& other, bool turned_over, double cosine) {
  const Vector<N> n = normal<N>(one);
  const Vector<N> m = normal<N>(other);
  const N along = turned_over ? -dot(n, m) : dot(n, m);
  const Decision is_blunt = kernel::opposite(kernel::is_positive(-along));  // along >= 0
  if (is_blunt == Decision::undecided) return Decision::undecided;
  // If both sides have the same sign, their squares compare in the same order, or in reverse if both are negative.
  if (is_blunt == Decision::yes && cosine <= 0) return Decision::no;
  if (is_blunt == Decision::no && cosine >= 0) return Decision::yes;
  const N left = along * along;
  const N right = N(cosine) * N(cosine) * (dot(n, n) * dot(m, m));
  return cosine > 0 ? kernel::less(left, right) : kernel::less(right, left);
}

/// The side of the triangle's plane on which the eye is: +1 if the corners run anticlockwise, 0 in the plane.
std::int8_t side_of(const Vec3& eye, const Triangle& t) {
  const auto height = [&]<class N>() { return dot(normal<N>(t), Vector<N>(eye) - Vector<N>(t.a)); };
  if (kernel::climb([&]<class N>() { return kernel::is_positive(height.template operator()<N>()); }).yes()) return 1;
  return kernel::climb([&]<class N>() { return kernel::is_positive(-height.template operator()<N>()); }).yes() ? -1 : 0;
}

class Kinds {
 public:
  Kinds(const TriangleMesh& mesh, const EdgeTable& table, const EdgeView& view)
      : mesh_(mesh), table_(table), view_(view) {
    if (!view.eye) return;
    sides_.resize(mesh.triangles.size());
    for (std::uint32_t i = 0; i < sides_.size(); ++i) sides_[i] = side_of(*view.eye, mesh.triangle(i));
  }

  /// All kinds of one edge.
  std::uint8_t of(std::size_t edge) const {
    const std::span<const HalfEdge> uses = table_.uses_of(edge);
    unsigned kind = uses.size() == 1 ? kBoundaryEdge : uses.size() > 2 ? kManyEdge : 0;
    if (parts_materials(uses)) kind |= kMaterialEdge;
    if (uses.size() != 2) return static_cast<std::uint8_t>(kind);
    const Triangle one = mesh_.triangle(triangle_of(uses[0]));
    const Triangle other = mesh_.triangle(triangle_of(uses[1]));
    const bool turned_over = table_.is_inconsistent(edge);
    const ExactResult crease =
        kernel::climb([&]<class N>() { return is_crease<N>(one, other, turned_over, view_.crease_cosine); });
    if (crease.yes()) kind |= kCreaseEdge;
    if (view_.eye) {
      const std::int8_t other_side = sides_[triangle_of(uses[1])];
      const bool other_faces = turned_over ? other_side < 0 : other_side > 0;
      if ((sides_[triangle_of(uses[0])] > 0) != other_faces) kind |= kSilhouetteEdge;
    }
    return static_cast<std::uint8_t>(kind);
  }

 private:
  bool parts_materials(std::span<const HalfEdge> uses) const {
    if (view_.material.empty()) return false;
    for (const HalfEdge use : uses) {
      if (view_.material[triangle_of(use)] != view_.material[triangle_of(uses[0])]) return true;
    }
    return false;
  }

  const TriangleMesh& mesh_;
  const EdgeTable& table_;
  const EdgeView& view_;
  std::vector<std::int8_t> sides_;  // by triangle: side of the eye
};

}  // namespace

std::vector<std::uint8_t> edge_kinds(const TriangleMesh& mesh, const EdgeTable& table, const EdgeView& view) {
  const Kinds kinds(mesh, table, view);
  std::vector<std::uint8_t> result(table.size());
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = kinds.of(i);
  return result;
}

}  // namespace collided::engine
