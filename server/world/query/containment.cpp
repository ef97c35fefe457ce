#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "server/exact_phase/ray/ray_cast.hpp"
#include "server/intake/weld.hpp"
#include "server/world/objects/object_placing.hpp"
#include "server/world/query/pair_report.hpp"
#include "server/world/solids/within.hpp"

namespace collided::engine {
namespace {

/// The edges of a mesh and the directions of its triangles along them, in a table of open addressing with linear
/// probing (Knuth, TAOCP 3, 6.4, Algorithm L).
class EdgeRuns {
 public:
  explicit EdgeRuns(std::size_t triangles)
      : most_(3 * triangles / 2), runs_(std::bit_ceil(2 * most_ + 1)), mask_(runs_.size() - 1) {}

  /// False if there are more edges than a closed mesh of that many triangles has.
  bool add(std::uint32_t from, std::uint32_t to) {
    const auto [low, high] = std::minmax(from, to);
    const std::uint64_t key = std::uint64_t{low} << 32 | high;
    // The upper half of a product depends on all bits of the key.
    std::size_t at = (key * 0x9e3779b97f4a7c15u) >> 32 & mask_;
    while (runs_[at].count > 0 && runs_[at].key != key) at = (at + 1) & mask_;
    if (runs_[at].count == 0 && count_++ == most_) return false;
    runs_[at].key = key;
    ++runs_[at].count;
    runs_[at].sum += from < to ? 1 : -1;
    return true;
  }
  /// True if each edge has exactly two triangles, which run along it in opposite directions.
  bool are_closed() const {
    return std::all_of(runs_.begin(), runs_.end(),
                       [](const EdgeUse& run) { return run.count == 0 || (run.count == 2 && run.sum == 0); });
  }

 private:
  struct EdgeUse {
    std::uint64_t key = 0;
    int count = 0;
    int sum = 0;
  };
  std::size_t most_;
  std::vector<EdgeUse> runs_;
  std::size_t mask_;
  std::size_t count_ = 0;
};

/// True if every edge has exactly two triangles, which run along it in opposite directions; vertices with equal
/// coordinates count as one.
bool is_closed(const TriangleMesh& mesh, Deadline& deadline) {
  const std::vector<std::uint32_t> of_vertex = first_equal_vertices(mesh.vertices);
  EdgeRuns edges(mesh.triangles.size());
  for (const TriangleCorners& triangle : mesh.triangles) {
    if (deadline.is_over()) return false;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t from = of_vertex[triangle[i]];
      const std::uint32_t to = of_vertex[triangle[(i + 1) % 3]];
      if (from == to || !edges.add(from, to)) return false;
    }
  }
  return !mesh.triangles.empty() && edges.are_closed();
}

/// Counts the crossings of a ray and a mesh; doubtful if the ray passes too near an edge to count them.
struct Crossings {
  const Placed& object;
  Ray ray;
  std::vector<std::uint32_t> crossed = {};
  bool doubtful = false;

  double operator()(std::uint32_t number, double limit) {
    constexpr double kNearEdge = 1e-6;
    RayHit hit;
    const ExactResult verdict = cast_ray(ray, place(object.frame, object.info->mesh->mesh->triangle(number)), hit);
    if (verdict.decision == Decision::undecided) doubtful = true;
    if (verdict.yes()) {
      doubtful = doubtful || hit.weights.minCoeff() < kNearEdge;
      crossed.push_back(number);
    }
    return limit;
  }

  bool count(WalkCost& cost) {
    const IndexedMesh& mesh = *object.info->mesh;
    const Mat3 back = object.frame.rotation.transpose();
    const Ray local{.origin = back * (ray.origin - object.frame.position), .direction = back * ray.direction};
    const double slack_m = placement_slack(object.frame, ray.origin.lpNorm<1>() * 2, mesh.radius_m);
    mesh.tree.walk_ray(local, std::numeric_limits<double>::infinity(), slack_m, *this, cost);
    std::sort(crossed.begin(), crossed.end());
    crossed.erase(std::unique(crossed.begin(), crossed.end()), crossed.end());
    return !doubtful;
  }
};

/// Decides by the parity of a ray's crossings; undecided if every ray passes too near an edge.
Decision is_within(const Placed& outer, const Vec3& point) {
  constexpr int kMostRays = 32;
  WalkCost cost;
  for (int i = 0; i < kMostRays; ++i) {
    // A spiral of directions (golden angle): no edge of a usual mesh is likely to lie along one.
    const double turn = 0.7 + 2.39996 * i;
    const double height = -0.97 + 1.94 * (i + 0.5) / kMostRays;
    const double across = std::sqrt(1 - height * height);
    Crossings crossings{outer,
                        {.origin = point,
                         .direction = {across * std::cos(turn), across * std::sin(turn), height},
                         .length_m = std::numeric_limits<double>::infinity()}};
    if (crossings.count(cost)) return crossings.crossed.size() % 2 == 1 ? Decision::yes : Decision::no;
  }
  return Decision::undecided;
}

/// True if the inner object lies within the outer one's closed mesh; the two surfaces must not touch. A declared solid
/// is known to be closed, and its side of a point is exact.
bool lies_in(const Placed& inner, const Placed& outer, Deadline& deadline) {
  if (!outer.info->mesh || !overlaps(inner.bounds, outer.bounds)) return false;
  if (outer.info->rare->solid) {
    WalkCost cost;
    std::uint32_t tests = 0;
    const std::vector<Vec3> points = points_of_pieces(*inner.info);
    return pieces_within(*outer.info->rare->solid, outer, inner, points, deadline, cost, tests).all;
  }
  // Most objects are outside, and testing one point is faster than checking all edges of the outer mesh. The surfaces
  // do not meet, so one point decides for its whole connected piece.
  const auto is_in = [&](const Vec3& own) { return is_within(outer, place(inner.frame, own)); };
  const bool has_primitives = !inner.info->primitives.empty();
  if (is_in(has_primitives ? inner_ball(inner.info->primitives.front()).point
                           : inner.info->mesh->mesh->triangle(0).a) == Decision::no)
    return false;
  if (!is_closed(*outer.info->mesh->mesh, deadline)) return false;
  const std::vector<Vec3> points = points_of_pieces(*inner.info);
  return std::all_of(points.begin(), points.end(),
                     [&](const Vec3& own) { return !deadline.is_over() && is_in(own) == Decision::yes; });
}

}  // namespace

Contained containment(const Placed& a, const Placed& b, Deadline& deadline) {
  if (lies_in(a, b, deadline)) return Contained::a_in_b;
  return lies_in(b, a, deadline) ? Contained::b_in_a : Contained::none;
}

std::optional<Contact> contact_of_contained(const Placed& a, const Placed& b, Contained which) {
  const Placed& outer = which == Contained::a_in_b ? b : a;
  const Placed& inner = which == Contained::a_in_b ? a : b;
  if (which == Contained::none || !outer.info->rare->solid) return std::nullopt;
  WalkCost cost;
  std::uint32_t tests = 0;
  const Vec3 point = place(inner.frame, points_of_pieces(*inner.info).front());
  Contact found = contact_within(*outer.info->rare->solid, outer, inner, point, cost, tests).contact;
  found.depth_error_m += placing_error_m(outer, kNoTriangle, inner, kNoTriangle);
  if (which == Contained::a_in_b) found.normal = -found.normal;
  return found;
}

}  // namespace collided::engine
