#include "server/world/swept_object.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <limits>
#include <variant>
#include <vector>

#include "server/exact_phase/moving_features.hpp"
#include "server/exact_phase/moving_solids.hpp"
#include "server/geometry/aabb.hpp"
#include "server/geometry/bounded.hpp"

namespace collided {
namespace {

/// Above this, a turn is refused.
constexpr int kMostPieces = 4096;
constexpr int kMostWindows = 64;

struct Target {
  const TriangleMesh& mesh;
  const BspTree& tree;
  const SweepOptions& options;
  WalkCost& cost;
};

/// The earliest contact wins; of equal ones that with the lowest numbers.
void take(FirstTouch& best, const TimeBracket& found, std::uint32_t mover_triangle, std::uint32_t triangle) {
  const bool earlier = !best.yes || found.high < best.bracket.high ||
                       (found.high == best.bracket.high &&
                        std::pair(mover_triangle, triangle) < std::pair(best.mover_triangle, best.triangle));
  // One with a later end may begin earlier: the bracket holds the first of all.
  const double low = best.yes ? std::min(best.bracket.low, found.low) : found.low;
  best.bracket = {low, earlier ? found.high : best.bracket.high};
  best.yes = true;
  if (!earlier) return;
  best.mover_triangle = mover_triangle;
  best.triangle = triangle;
}

/// Asks about every triangle whose bounds meet those of the way.
template <class Mover>
void meet_triangles(const Mover& mover, const Aabb& swept, std::uint32_t mover_triangle, const Target& target,
                    FirstTouch& best) {
  struct Context {
    const Mover& mover;
    const Target& target;
    FirstTouch& best;
    std::uint32_t mover_triangle;
  } context{mover, target, best, mover_triangle};
  const auto candidate = [](void* raw, std::uint32_t triangle) {
    Context& c = *static_cast<Context*>(raw);
    TimeBracket found;
    const Triangle other = c.target.mesh.triangle(triangle);
    Verdict verdict;
    if constexpr (std::same_as<Mover, MovingTriangle>) {
      const MovingTriangle resting{{other.a, other.a}, {other.b, other.b}, {other.c, other.c}};
      verdict = first_contact(c.mover, resting, c.target.options.width, found);
    } else {
      verdict = first_contact(c.mover, other, c.target.options.width, found);
    }
    ++c.best.exact_tests;
    c.best.undecided = c.best.undecided || verdict.decision == Decision::undecided;
    if (verdict.yes()) take(c.best, found, c.mover_triangle, triangle);
    return true;
  };
  target.tree.walk_box(swept, candidate, &context, target.cost);
}

/// Bounds of a shape all along its way; each step rounds outward.
Aabb swept_bounds(Aabb box, const Vec3& from, const Vec3& to) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const Aabb start = box;
  for (int k = 0; k < 3; ++k) {
    const double least = std::nextafter(to[k] - from[k], -kInfinity);
    const double most = std::nextafter(to[k] - from[k], kInfinity);
    box.low[k] = std::min(start.low[k], std::nextafter(start.low[k] + least, -kInfinity));
    box.high[k] = std::max(start.high[k], std::nextafter(start.high[k] + most, kInfinity));
  }
  return box;
}

void sweep_primitive(const ObjectWay& way, const Primitive& primitive, const Target& target, FirstTouch& best) {
  const auto sweep = [&](const auto& own) {
    using Shape = std::decay_t<decltype(own)>;
    const Vec3& from = way.from.position;
    const Vec3& to = way.to.position;
    if constexpr (std::same_as<Shape, Sphere>) {
      // A sphere's centre goes straight even where the object turns only about it.
      const MovingSphere mover{place(way.from, own.center), place(way.to, own.center), own.radius_m};
      if (way.from.rotation == way.to.rotation || own.center.isZero(0)) {
        const Aabb swept = bounds(Capsule{mover.start, mover.end, mover.radius_m});
        return meet_triangles(mover, swept, wire_contract::kNoTriangle, target, best);
      }
    } else if constexpr (std::same_as<Shape, Box> || std::same_as<Shape, Capsule>) {
      if (way.from.rotation == way.to.rotation) {
        const Translated<Shape> mover{place(way.from, own), from, to};
        const Aabb swept = swept_bounds(bounds(mover.start), from, to);
        return meet_triangles(mover, swept, wire_contract::kNoTriangle, target, best);
      }
    }
    best.undecided = true;
  };
  std::visit(sweep, primitive);
}

/// The poses at which the pieces begin and end.
std::vector<Frame> pieces(const ObjectWay& way, double radius_m, const SweepOptions& options, FirstTouch& best) {
  if (way.from.rotation == way.to.rotation) return {way.from, way.to};
  const Mat3 turn = way.from.rotation.transpose() * way.to.rotation;
  const Eigen::AngleAxisd about(turn);
  // A curve is off its chord, time for time, by at most its acceleration / 8: r angle^2 / 8.
  const auto deviation_m = [&](int count) {
    const double angle = about.angle() / count;
    return radius_m * angle * angle / 8;
  };
  int count = 1;
  while (count < kMostPieces && deviation_m(count) > options.deviation_m) count *= 2;
  if (deviation_m(count) > options.deviation_m) {
    best.undecided = true;
    return {};
  }
  best.deviation_m = std::max(best.deviation_m, deviation_m(count));
  std::vector<Frame> frames{way.from};
  for (int i = 1; i < count; ++i) {
    const double s = static_cast<double>(i) / count;
    const Mat3 turned = Eigen::AngleAxisd(s * about.angle(), about.axis()).toRotationMatrix();
    frames.push_back({.rotation = way.from.rotation * turned,
                      .position = (1 - s) * way.from.position + s * way.to.position});
  }
  frames.push_back(way.to);
  return frames;
}

/// A piece's own time to that of the whole way; rounded outward.
TimeBracket of_whole(const TimeBracket& piece, std::size_t index, std::size_t count) {
  if (count == 1) return piece;
  const auto number = static_cast<double>(index);
  const auto pieces_count = static_cast<double>(count);  // a power of two
  if (index == 0) return {piece.low / pieces_count, piece.high / pieces_count};
  return {std::nextafter(number + piece.low, 0.0) / pieces_count,
          std::min(1.0, std::nextafter(number + piece.high, pieces_count) / pieces_count)};
}

/// Where a triangle is in a window of time, rounded outward.
Aabb bounds_in(const MovingTriangle& part, double from, double to) {
  Aabb box;
  for (const MovingPoint* p : {&part.a, &part.b, &part.c}) {
    for (const double t : {from, to}) {
      for (int k = 0; k < 3; ++k) {
        const Bounded x = Bounded(1 - t) * Bounded(p->start[k]) + Bounded(t) * Bounded(p->end[k]);
        box.low[k] = std::min(box.low[k], x.low());
        box.high[k] = std::max(box.high[k], x.high());
      }
    }
  }
  return box;
}

/// Long ways are looked along in windows as long as the mover is large, so that few triangles are asked about and none
/// beyond the first contact.
void sweep_piece(const TriangleMesh& mesh, const std::vector<MovingPoint>& vertex, double radius_m, const Target& target,
                 FirstTouch& best) {
  double travel_m = 0;
  for (const MovingPoint& p : vertex) travel_m = std::max(travel_m, (p.end - p.start).cwiseAbs().maxCoeff());
  int windows = 1;
  while (windows < kMostWindows && travel_m > radius_m * windows) windows *= 2;
  for (int window = 0; window < windows; ++window) {
    const double from = static_cast<double>(window) / windows;
    const double to = static_cast<double>(window + 1) / windows;
    if (best.yes && best.bracket.high < from) return;
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      const TriangleCorners& corner = mesh.triangles[i];
      const MovingTriangle part{vertex[corner[0]], vertex[corner[1]], vertex[corner[2]]};
      meet_triangles(part, bounds_in(part, from, to), i, target, best);
    }
  }
}

void sweep_mesh(const ObjectWay& way, const IndexedMesh& mover, const Target& target, FirstTouch& best) {
  const std::vector<Frame> frames = pieces(way, mover.radius_m, target.options, best);
  const TriangleMesh& mesh = *mover.mesh;
  std::vector<MovingPoint> vertex(mesh.vertices.size());
  for (std::size_t piece = 0; piece + 1 < frames.size(); ++piece) {
    for (std::size_t i = 0; i < vertex.size(); ++i) {
      vertex[i] = {place(frames[piece], mesh.vertices[i]), place(frames[piece + 1], mesh.vertices[i])};
    }
    FirstTouch here;
    sweep_piece(mesh, vertex, mover.radius_m, target, here);
    best.exact_tests += here.exact_tests;
    best.undecided = best.undecided || here.undecided;
    if (!here.yes) continue;
    take(best, of_whole(here.bracket, piece, frames.size() - 1), here.mover_triangle, here.triangle);
    return;
  }
}

}  // namespace

FirstTouch first_touch(const ObjectWay& way, const TriangleMesh& mesh, const BspTree& tree, const SweepOptions& options,
                       WalkCost& cost) {
  FirstTouch best;
  const Target target{mesh, tree, options, cost};
  for (const Primitive& primitive : way.info->primitives) sweep_primitive(way, primitive, target, best);
  if (way.info->mesh) sweep_mesh(way, *way.info->mesh, target, best);
  return best;
}

}  // namespace collided
