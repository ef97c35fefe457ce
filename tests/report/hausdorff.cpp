#include "tests/report/hausdorff.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>

#include "server/broad_phase/bsp_tree.hpp"
#include "server/exact_phase/closest.hpp"

namespace collided::report {
namespace {

/// Bounds on the largest distance of a point of the piece to the other mesh.
struct Piece {
  Triangle triangle;
  double upper = 0;
  bool operator<(const Piece& other) const { return upper < other.upper; }
};

struct Nearest {
  double upper_m = INFINITY;
  std::uint32_t triangle = 0;
};

class OneSide {
 public:
  explicit OneSide(const TriangleMesh& to) : to_(to), tree_(BspTree::build(to)) {}

  Nearest nearest(const Vec3& point) const {
    struct Walk {
      const TriangleMesh& mesh;
      const Vec3& point;
      Nearest best;
    } walk{to_, point, {}};
    const auto look = [](void* context, std::uint32_t triangle, double) {
      auto& w = *static_cast<Walk*>(context);
      const Closest found = closest(w.point, w.mesh.triangle(triangle));
      const double upper = found.distance_m + found.distance_error_m;
      if (upper < w.best.upper_m) w.best = {upper, triangle};
      return w.best.upper_m * w.best.upper_m * (1 + 0x1p-48);
    };
    WalkCost cost;
    tree_.walk_near(point, INFINITY, 0, look, &walk, cost);
    return walk.best;
  }

  /// The distance to one triangle is convex, so no point of the piece is farther from it than the farthest corner; and
  /// no point is farther from the mesh than a corner is, plus the way to that corner (Lipschitz). The least of these.
  Piece measured(const Triangle& t) {
    Piece piece{t, INFINITY};
    const Vec3 corner[3] = {t.a, t.b, t.c};
    const double longest =
        std::sqrt(std::max({(t.b - t.a).squaredNorm(), (t.c - t.b).squaredNorm(), (t.a - t.c).squaredNorm()}));
    std::uint32_t tried[3];
    for (int i = 0; i < 3; ++i) {
      const Nearest found = nearest(corner[i]);
      reached_ = std::max(reached_, found.upper_m);
      tried[i] = found.triangle;
      piece.upper = std::min(piece.upper, found.upper_m + longest);
      if (std::find(tried, tried + i, found.triangle) != tried + i) continue;
      double farthest = 0;
      for (const Vec3& c : corner) {
        const Closest to = closest(c, to_.triangle(found.triangle));
        farthest = std::max(farthest, to.distance_m + to.distance_error_m);
      }
      piece.upper = std::min(piece.upper, farthest);
    }
    return piece;
  }

  double bound(const TriangleMesh& from, std::size_t pieces_at_most) {
    std::priority_queue<Piece> pieces;
    for (std::uint32_t i = 0; i < from.triangles.size(); ++i) pieces.push(measured(from.triangle(i)));
    // What is within 2 % of a distance that does occur is not worth more cuts.
    for (std::size_t cut = 0; cut < pieces_at_most && pieces.top().upper > 1.02 * reached_; ++cut) {
      const Triangle t = pieces.top().triangle;
      const double upper = pieces.top().upper;
      pieces.pop();
      for (const Triangle& half : halves(t)) {
        Piece piece = measured(half);
        piece.upper = std::min(piece.upper, upper);
        pieces.push(piece);
      }
    }
    // The middles of edges were rounded, each cut by half a unit in the last place of a coordinate.
    double largest = 0;
    for (const Vec3& v : from.vertices) largest = std::max(largest, v.cwiseAbs().maxCoeff());
    return pieces.top().upper * (1 + 0x1p-40) + 0x1p-44 * largest;
  }

 private:
  /// Cut at the middle of the longest edge.
  static std::array<Triangle, 2> halves(const Triangle& t) {
    const double ab = (t.b - t.a).squaredNorm();
    const double bc = (t.c - t.b).squaredNorm();
    const double ca = (t.a - t.c).squaredNorm();
    const Triangle turned = ab >= bc && ab >= ca ? t : bc >= ca ? Triangle{t.b, t.c, t.a} : Triangle{t.c, t.a, t.b};
    const Vec3 middle = (turned.a + turned.b) / 2;
    return {Triangle{turned.a, middle, turned.c}, Triangle{middle, turned.b, turned.c}};
  }

  const TriangleMesh& to_;
  BspTree tree_;
  double reached_ = 0;
};

}  // namespace

double two_sided_hausdorff(const TriangleMesh& a, const TriangleMesh& b, std::size_t pieces_at_most) {
  return std::max(OneSide(b).bound(a, pieces_at_most), OneSide(a).bound(b, pieces_at_most));
}

}  // namespace collided::report
