#include "server/world/objects/surface_distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <mutex>
#include <queue>
#include <set>

#include "server/exact_phase/distance/nearest_filter.hpp"
#include "server/geometry/tolerance.hpp"
#include "server/intake/parallel.hpp"
#include "server/world/objects/surface_cover.hpp"

namespace collided::engine {
namespace {

constexpr double kNoBound = std::numeric_limits<double>::infinity();

/// A bound within this factor of an actual distance is not worth more cuts.
constexpr double kCloseEnough = 1.02;

/// Triangles per batch of a thread.
constexpr std::size_t kBatch = 2048;

/// A triangle, or a piece of one, with its bound.
struct TrianglePiece {
  Triangle triangle;
  std::uint32_t part = 0;
  double upper_m = kNoBound;  // largest distance of a point from the other surface
  bool operator<(const TrianglePiece& other) const { return upper_m < other.upper_m; }
};

struct NearestTriangle {
  double upper_m = kNoBound;
  std::uint32_t triangle = TriangleNeighbours::kNone;
};

double distance_at_most(const Vec3& point, const Triangle& triangle) {
  // The factor covers the rounding of the square root.
  return std::sqrt(kernel::quick_square_distance(point, triangle).high2_m2) * (1 + kFewSlack);
}

/// The nearest triangle of a part, and a bound on its distance.
NearestTriangle nearest(const Vec3& point, std::uint32_t part, const PartedSurface& to) {
  NearestTriangle best;
  const auto look = [&](std::uint32_t triangle, double limit_m2) {
    if (to.part_of[triangle] != part) return limit_m2;
    const double upper_m = distance_at_most(point, to.mesh.triangle(triangle));
    if (upper_m < best.upper_m) best = {upper_m, triangle};
    return best.upper_m * best.upper_m * (1 + kChainSlack);
  };
  WalkCost cost;
  to.tree.walk_near(point, kNoBound, 0, look, cost);
  return best;
}

/// Bounds the distance from the points of one surface to the other.
class OneSide {
 public:
  OneSide(const PartedSurface& from, const PartedSurface& to, const DistanceOptions& options)
      : from_(from), to_(to), options_(options), neighbours_(to.mesh, to.part_of) {}

  /// owed_m  a bound that the caller has to report anyway; smaller distances need no refinement
  double bound(double owed_m) {
    reached_m_ = owed_m;
    measure_all();
    std::priority_queue<TrianglePiece> pieces;
    double upper_m = 0;
    for (TrianglePiece& piece : open_) {
      if (piece.upper_m > kCloseEnough * reached_m_) pieces.push(piece);
      else upper_m = std::max(upper_m, piece.upper_m);
    }
    // Always cuts the piece with the largest bound: only it can lower the result.
    for (std::size_t cuts = 0; cuts < options_.pieces_at_most && !pieces.empty(); ++cuts) {
      const TrianglePiece piece = pieces.top();
      if (!(piece.upper_m > kCloseEnough * reached_m_) || (options_.cancelled && options_.cancelled())) break;
      pieces.pop();
      for (const Triangle& half : halves(piece.triangle)) {
        TrianglePiece smaller{half, piece.part, piece.upper_m};
        smaller.upper_m = std::min(piece.upper_m, measured(half, piece.part));
        pieces.push(smaller);
      }
    }
    if (!pieces.empty()) upper_m = std::max(upper_m, pieces.top().upper_m);
    // Each cut rounded middles of edges by half a unit in the last place of a coordinate.
    double largest = 0;
    for (const Vec3& v : from_.mesh.vertices) largest = std::max(largest, v.cwiseAbs().maxCoeff());
    constexpr double kCoordinateSlack = 0x1p-44;  // covers 2^9 cuts, each half a unit in the last place
    return std::max(upper_m, upper_of_rest_m_) * (1 + kBoundSlack) + kCoordinateSlack * largest;
  }

 private:
  /// Bounds every triangle, first as a table under the other surface, then, if that bound is too large, by its corners.
  void measure_all() {
    const std::size_t count = from_.mesh.triangles.size();
    run_in_parallel((count + kBatch - 1) / kBatch,
                    [&](std::size_t batch) {
                      SheetOverTable sheet(to_.mesh, neighbours_);
                      std::vector<TrianglePiece> open;
                      double reached_m = 0;
                      for (std::size_t i = batch * kBatch; i < std::min(count, (batch + 1) * kBatch); ++i) {
                        const auto number = static_cast<std::uint32_t>(i);
                        TrianglePiece piece{from_.mesh.triangle(number), from_.part_of[number], kNoBound};
                        const NearestTriangle at_middle =
                            nearest((piece.triangle.a + piece.triangle.b + piece.triangle.c) / 3, piece.part, to_);
                        if (at_middle.triangle != TriangleNeighbours::kNone) {
                          piece.upper_m = sheet.height_at_most(piece.triangle, at_middle.triangle);
                          reached_m = std::max(reached_m, at_middle.upper_m);
                        }
                        open.push_back(piece);
                      }
                      const std::lock_guard lock(mutex_);
                      reached_m_ = std::max(reached_m_, reached_m);
                      waiting_.insert(waiting_.end(), open.begin(), open.end());
                    },
                    [](std::size_t) {});
    measure_what_stands_out();
  }

  /// Bounds by their corners the triangles whose table bound exceeds the distances seen so far.
  void measure_what_stands_out() {
    std::vector<TrianglePiece> doubtful;
    for (const TrianglePiece& piece : waiting_) {
      if (piece.upper_m > kCloseEnough * reached_m_) doubtful.push_back(piece);
      else upper_of_rest_m_ = std::max(upper_of_rest_m_, piece.upper_m);
    }
    waiting_ = {};
    run_in_parallel((doubtful.size() + kBatch - 1) / kBatch,
                    [&](std::size_t batch) {
                      for (std::size_t i = batch * kBatch; i < std::min(doubtful.size(), (batch + 1) * kBatch); ++i) {
                        doubtful[i].upper_m =
                            std::min(doubtful[i].upper_m, measured(doubtful[i].triangle, doubtful[i].part));
                      }
                    },
                    [](std::size_t) {});
    open_ = std::move(doubtful);
  }

  /// The smaller of two bounds. The distance to one triangle is convex, so no point of the piece is farther from it
  /// than the farthest corner; and no point is farther from the surface than a corner plus the longest edge.
  double measured(const Triangle& t, std::uint32_t part) {
    const std::array<Vec3, 3> corners{t.a, t.b, t.c};
    const double longest_m =
        std::sqrt(std::max({(t.b - t.a).squaredNorm(), (t.c - t.b).squaredNorm(), (t.a - t.c).squaredNorm()}));
    double upper_m = kNoBound;
    double reached_m = 0;
    for (const Vec3& corner : corners) {
      const NearestTriangle found = nearest(corner, part, to_);
      if (found.triangle == TriangleNeighbours::kNone) return kNoBound;
      reached_m = std::max(reached_m, found.upper_m);
      double farthest_m = 0;
      for (const Vec3& c : corners)
        farthest_m = std::max(farthest_m, distance_at_most(c, to_.mesh.triangle(found.triangle)));
      upper_m = std::min({upper_m, farthest_m, found.upper_m + longest_m * (1 + kChainSlack)});
    }
    const std::lock_guard lock(mutex_);
    reached_m_ = std::max(reached_m_, reached_m);
    return upper_m;
  }

  /// Halves the triangle at the middle of its longest edge.
  static std::array<Triangle, 2> halves(const Triangle& t) {
    const double ab = (t.b - t.a).squaredNorm();
    const double bc = (t.c - t.b).squaredNorm();
    const double ca = (t.a - t.c).squaredNorm();
    const Triangle turned = ab >= bc && ab >= ca ? t : bc >= ca ? Triangle{t.b, t.c, t.a} : Triangle{t.c, t.a, t.b};
    const Vec3 middle = (turned.a + turned.b) / 2;
    return {Triangle{turned.a, middle, turned.c}, Triangle{middle, turned.b, turned.c}};
  }

  const PartedSurface& from_;
  const PartedSurface& to_;
  const DistanceOptions& options_;
  const TriangleNeighbours neighbours_;
  std::mutex mutex_;
  double reached_m_ = 0;                // an actual distance, up to rounding
  std::vector<TrianglePiece> waiting_;  // bounded as tables only
  std::vector<TrianglePiece> open_;     // may be worth cutting
  double upper_of_rest_m_ = 0;
};

}  // namespace

double surface_distance(const PartedSurface& a, const PartedSurface& b, const DistanceOptions& options) {
  const std::set<std::uint32_t> parts_of_a(a.part_of.begin(), a.part_of.end());
  if (parts_of_a != std::set<std::uint32_t>(b.part_of.begin(), b.part_of.end())) return kNoBound;
  const double from_a_m = OneSide(a, b, options).bound(0);
  return std::max(from_a_m, OneSide(b, a, options).bound(from_a_m));
}

}  // namespace collided::engine
