#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/exact_phase/solid/split_plane.hpp"

namespace collided::engine {

/// The convex pieces into which planes cut the triangles of a mesh, exactly: a piece keeps the plane of its triangle,
/// and its corners are corners of the mesh, or where an edge of the mesh meets a plane, or where three planes meet. No
/// corner is ever rounded; its numbers in double, with a bound, serve the filter alone.
///
/// source  Bernstein, Fussell, "Fast, exact, linear booleans", Computer Graphics Forum 28, 2009
class Fragments {
 public:
  static constexpr std::uint32_t kNone = 0xffffffff;

  /// bounds  bounds of the mesh
  Fragments(const TriangleMesh& mesh, const Aabb& bounds);

  /// The triangle as a piece; it must have an area.
  std::uint32_t add(std::uint32_t triangle);
  std::uint32_t triangle_of(std::uint32_t fragment) const { return pieces_[fragment].triangle; }
  std::size_t count() const { return pieces_.size(); }
  /// Bounds of the piece, not exact: for choosing planes.
  Aabb roughly(std::uint32_t fragment) const;
  /// Adds the corners of the piece in their order, rounded.
  void outline(std::uint32_t fragment, std::vector<Vec3>& corners);

  /// Numbers of planes, for the calls below. Neighbouring triangles in one plane that face the same way share a number.
  std::uint32_t plane_of(std::uint32_t triangle);
  std::uint32_t plane_across(int axis, double at);
  /// The number of a plane of another mesh's tree: of a triangle, or across an axis.
  std::uint32_t plane_of_other(const TriangleMesh& other, const SplitPlane& plane);
  const SplitPlane& plane(std::uint32_t number) const { return planes_[number].split; }
  /// Declares that two triangles have the same plane and face the same way; call it before any plane_of().
  void share_plane(std::uint32_t triangle, std::uint32_t with);

  /// On which sides of a plane a piece has points.
  struct FragmentSides {
    bool front = false;
    bool back = false;
  };
  FragmentSides sides(std::uint32_t fragment, std::uint32_t plane);
  /// Computes the sides from doubles alone, counting uncertain corners as in the plane: for choosing planes.
  FragmentSides rough_sides(std::uint32_t fragment, std::uint32_t plane) const;
  /// Cuts a piece with points on both sides.
  struct Halves {
    std::uint32_t front;
    std::uint32_t back;
  };
  Halves cut(std::uint32_t fragment, std::uint32_t plane);

 private:
  /// A side of a piece: along an edge of the mesh, or in a plane that cut it.
  struct FragmentBorder {
    std::uint32_t u = kNone;
    std::uint32_t v = kNone;
    std::uint32_t plane = kNone;
  };
  struct FragmentCorner {
    Vec3 at = Vec3::Zero();
    double error_m = 0;            // per coordinate; infinite: unknown
    std::uint32_t vertex = kNone;  // vertex of the mesh; else the corner is where `border` meets the plane `cut`
    std::uint32_t cut = kNone;
    FragmentBorder border{};
    FragmentBorder next{};  // the side to the next corner
  };
  struct FragmentRun {
    std::uint32_t triangle;
    std::uint32_t first;
    std::uint32_t count;
  };
  /// A corner as (x / weight), exactly.
  struct ExactCorner {
    kernel::Vector<Dyadic> x;
    Dyadic weight;

    Vec3 rounded() const;
  };

  /// A plane and the mesh whose triangle it names.
  struct NumberedPlane {
    SplitPlane split;
    const TriangleMesh* of;

    ExactPlane exact() const { return {*of, split}; }
  };

  std::span<const FragmentCorner> corners_of(const FragmentRun& piece) const {
    return std::span(corners_).subspan(piece.first, piece.count);
  }
  std::uint32_t root_of(std::uint32_t triangle);
  /// True if the plane is known to contain the corner without arithmetic.
  bool is_in_plane(const FragmentCorner& corner, std::uint32_t plane) const;
  int side(const FragmentRun& piece, const FragmentCorner& corner, std::uint32_t plane);
  ExactCorner exact(const FragmentRun& piece, const FragmentCorner& corner);
  FragmentCorner corner_between(const FragmentRun& piece, const FragmentCorner& from, std::uint32_t plane);
  void locate(const FragmentRun& piece, FragmentCorner& corner);
  std::uint32_t push(std::uint32_t triangle, std::span<const FragmentCorner> corners);

  const TriangleMesh& mesh_;
  Aabb bounds_;
  std::vector<FragmentCorner> corners_;
  std::vector<FragmentRun> pieces_;
  std::vector<NumberedPlane> planes_;
  std::vector<std::uint32_t> shared_;        // by triangle: another one in its plane, or itself
  std::vector<std::uint32_t> plane_number_;  // by triangle
  std::vector<std::int8_t> side_of_corner_;  // of the piece last passed to sides()
  std::vector<FragmentCorner> front_;
  std::vector<FragmentCorner> back_;
};

}  // namespace collided::engine
