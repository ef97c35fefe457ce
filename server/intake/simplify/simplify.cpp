#include "server/intake/simplify/simplify.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <queue>

#include "server/geometry/aabb.hpp"
#include "server/intake/simplify/cross_beyond_shared.hpp"
#include "server/intake/simplify/growing_tree.hpp"
#include "server/intake/simplify/quadric.hpp"
#include "server/intake/simplify/shrinking_surface.hpp"
#include "server/intake/simplify/space_order.hpp"
#include "server/intake/weld.hpp"

namespace collided::engine {
namespace {

using UnitNormal = Eigen::Vector3f;

/// Cosine of the largest angle by which a normal may turn, relative to the original mesh and in one step. Far enough
/// above 0 that rounding normals to single precision cannot hide 90 degrees. No exact answer depends on it.
constexpr float kLeastTurnCosine = 0.05f;

/// This fraction of an edge's squared length is added to the mean squared distance of a quadric: among collapses that
/// hardly move the surface, short edges go first, which keeps triangles from becoming slivers.
constexpr double kShortEdgesFirst = 1e-6;

/// Weight, relative to the surface's own planes, of the planes perpendicular to the surface along its border, which
/// keep the border's outline.
constexpr double kBorderWeight = 1;

UnitNormal unit_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = (b - a).cross(c - a);
  const double length = normal.norm();
  return length > 0 ? UnitNormal((normal / length).cast<float>()) : UnitNormal::Zero();
}

/// Rounds a cost down to one of two steps for each power of two. Among equal costs the vertex number decides, which
/// follows the surface in space: so the next collapse is usually near the last one, and its data is still in the cache.
float in_steps(double cost) {
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(static_cast<float>(cost)) & 0xffc00000);
}

/// A vertex and a lower bound on the cost of removing it. If the cost has risen since, that is noticed when the offer
/// reaches the front of the queue.
struct Offer {
  float cost;
  std::uint32_t vertex;
  bool operator<(const Offer& other) const { return cost != other.cost ? cost > other.cost : vertex > other.vertex; }
};

class Simplifier {
 public:
  /// part_of  a number for each triangle
  Simplifier(const TriangleMesh& mesh, const std::vector<std::uint32_t>& part_of, const SimplifyOptions& options,
             SimplifyReport& report)
      : options_(options),
        report_(report),
        part_of_(part_of),
        surface_(mesh),
        offered_(mesh.vertices.size(), kNever),
        tried_(mesh.vertices.size(), 0),
        is_locked_(mesh.vertices.size(), false),
        is_in_ring_(mesh.triangles.size(), 0) {
    lock_between_parts(mesh);
    count_parts();
    find_normals(mesh);
    if (options.cost == CollapseCost::quadric) find_quadrics(mesh);
    rebuild_tree();
  }

  void run(CollapseOrder& order) {
    std::vector<std::uint32_t> ring;
    for (std::uint32_t vertex = 0; vertex < offered_.size(); ++vertex) offer(vertex, ring);
    const std::size_t begin_count = surface_.live_count();
    for (std::size_t looked_at = 0; !offers_.empty() && surface_.live_count() > options_.triangles_at_most;
         ++looked_at) {
      if (looked_at % 0x1000 == 0 && !tell(begin_count)) break;
      const Offer best = offers_.top();
      offers_.pop();
      if (offered_[best.vertex] == best.cost) take(best, order);
    }
    report_.triangle_count = surface_.live_count();
  }

 private:
  using Neighbour = ShrinkingSurface::Neighbour;

  struct CollapseTarget {
    double cost;
    Neighbour kept;
  };

  bool tell(std::size_t begin_count) const {
    if (options_.progress && begin_count > options_.triangles_at_most) {
      const auto all = static_cast<double>(begin_count - options_.triangles_at_most);
      options_.progress(static_cast<double>(begin_count - surface_.live_count()) / all);
    }
    return !(options_.cancelled && options_.cancelled());
  }

  void count_parts() {
    for (const std::uint32_t triangle : surface_.live_triangles()) {
      if (part_of_[triangle] >= left_in_part_.size()) left_in_part_.resize(part_of_[triangle] + 1, 0);
      ++left_in_part_[part_of_[triangle]];
    }
  }

  void lock_between_parts(const TriangleMesh& mesh) {
    constexpr std::uint32_t kNoPart = 0xffffffff;
    std::vector<std::uint32_t> part_at(mesh.vertices.size(), kNoPart);
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      for (const std::uint32_t corner : mesh.triangles[i]) {
        if (part_at[corner] == kNoPart) part_at[corner] = part_of_[i];
        else if (part_at[corner] != part_of_[i]) is_locked_[corner] = true;
      }
    }
  }

  void find_normals(const TriangleMesh& mesh) {
    normals_.reserve(mesh.triangles.size());
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      const Triangle t = mesh.triangle(i);
      normals_.push_back(unit_normal(t.a, t.b, t.c));
    }
  }

  /// Quadrics of the triangles' planes, weighted by area, and of planes perpendicular to the surface along its border.
  /// They are relative to a point of the mesh, so that coordinates far from 0 cost the distances no digits.
  void find_quadrics(const TriangleMesh& mesh) {
    quadrics_.resize(mesh.vertices.size());
    weights_.resize(mesh.vertices.size(), 0);
    if (!mesh.vertices.empty()) origin_ = mesh.vertices.front();
    std::vector<std::uint32_t> ring;
    std::vector<Neighbour> neighbours;
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      if (!surface_.is_live(i)) continue;
      const Triangle t = mesh.triangle(i);
      const Vec3 normal = (t.b - t.a).cross(t.c - t.a);
      const double twice_area = normal.norm();
      if (!(twice_area > 0)) continue;
      add_plane(mesh.triangles[i], normal / twice_area, t.a, 1);
    }
    for (std::uint32_t vertex = 0; vertex < mesh.vertices.size(); ++vertex) {
      surface_.find_ring(vertex, ring);
      surface_.find_neighbours(vertex, ring, neighbours);
      for (const Neighbour& n : neighbours) {
        if (n.triangle_count == 1 && vertex < n.vertex) add_border(mesh, ring, vertex, n.vertex);
      }
    }
  }

  template <class Corners>
  void add_plane(const Corners& corners, const Vec3& normal, const Vec3& on_plane, double weight) {
    for (const std::uint32_t corner : corners) {
      quadrics_[corner].add_plane(normal, -normal.dot(on_plane - origin_), weight);
      weights_[corner] += weight;
    }
  }

  void add_border(const TriangleMesh& mesh, const std::vector<std::uint32_t>& ring, std::uint32_t a, std::uint32_t b) {
    for (const std::uint32_t triangle : ring) {
      const TriangleCorners& c = mesh.triangles[triangle];
      if (c[0] != b && c[1] != b && c[2] != b) continue;
      const Vec3 along = mesh.vertices[b] - mesh.vertices[a];
      const Vec3 across = along.cross(normals_[triangle].cast<double>());
      const double length = across.norm();
      if (length > 0) add_plane(std::array{a, b}, across / length, mesh.vertices[a], kBorderWeight);
    }
  }

  void rebuild_tree() {
    const std::vector<std::uint32_t> live = surface_.live_triangles();
    tree_.build(surface_.vertices(), surface_.corners(), live);
    rebuild_at_ = live.size() / 4 * 3;
  }

  double cost_of(std::uint32_t removed, std::uint32_t kept) const {
    const double length2 = (surface_.vertices()[removed] - surface_.vertices()[kept]).squaredNorm();
    if (options_.cost == CollapseCost::edge_length) return length2;
    const Vec3 at = surface_.vertices()[kept] - origin_;
    const double weight = weights_[removed] + weights_[kept];
    const double error = quadrics_[removed].at(at) + quadrics_[kept].at(at);
    return std::max(error, 0.0) + kShortEdgesFirst * weight * length2;
  }

  /// Fills targets_ with the vertices that this one may be merged into, cheapest first. A border vertex moves only
  /// along the border.
  void find_targets(std::uint32_t vertex, std::vector<std::uint32_t>& ring) {
    targets_.clear();
    if (is_locked_[vertex]) return;
    surface_.find_ring(vertex, ring);
    surface_.find_neighbours(vertex, ring, neighbours_);
    std::size_t border_edges = 0;
    for (const Neighbour& n : neighbours_) {
      if (n.triangle_count > 2) return;
      border_edges += n.triangle_count == 1 ? 1 : 0;
    }
    if (border_edges != 0 && border_edges != 2) return;
    for (const Neighbour& n : neighbours_) {
      if (border_edges == 0 || n.triangle_count == 1) targets_.push_back({cost_of(vertex, n.vertex), n});
    }
  }

  void push(std::uint32_t vertex, float cost) {
    offered_[vertex] = cost;
    if (cost < kNever) offers_.push({cost, vertex});
  }

  void offer(std::uint32_t vertex, std::vector<std::uint32_t>& ring) {
    tried_[vertex] = 0;
    find_targets(vertex, ring);
    const auto best = std::min_element(targets_.begin(), targets_.end(), by_cost);
    push(vertex, best == targets_.end() ? kNever : in_steps(best->cost));
  }

  /// After a collapse into `kept`, updates the offer of a neighbour: only its collapse into `kept` may have become
  /// cheaper.
  void offer_neighbour(std::uint32_t vertex, std::uint32_t kept) {
    if (tried_[vertex] > 0 || offered_[vertex] == kNever) return offer(vertex, ring_);
    const float cost = in_steps(cost_of(vertex, kept));
    if (cost < offered_[vertex]) push(vertex, cost);
  }

  static bool by_cost(const CollapseTarget& a, const CollapseTarget& b) {
    return a.cost != b.cost ? a.cost < b.cost : a.kept.vertex < b.kept.vertex;
  }

  /// Tries the vertex's next target. If a guard refuses it, the target after it is offered at its own cost.
  void take(const Offer& offered, CollapseOrder& order) {
    const std::uint32_t vertex = offered.vertex;
    find_targets(vertex, ring_);
    std::sort(targets_.begin(), targets_.end(), by_cost);
    const std::size_t at = tried_[vertex];
    if (at >= targets_.size()) return push(vertex, kNever);
    if (const float cost = in_steps(targets_[at].cost); cost > offered.cost) return push(vertex, cost);
    const Neighbour kept = targets_[at].kept;
    if (is_allowed(vertex, kept)) {
      collapse(vertex, kept);
      order.push_back({vertex, kept.vertex});
      return;
    }
    const bool is_last = at + 1 >= targets_.size() || at == 0xff;
    tried_[vertex] = static_cast<std::uint8_t>(is_last ? at : at + 1);
    push(vertex, is_last ? kNever : in_steps(targets_[at + 1].cost));
  }

  /// True if all guards allow merging the vertex into `kept`. ring_ and neighbours_ must be those of the vertex.
  bool is_allowed(std::uint32_t vertex, const Neighbour& kept) {
    // An unlocked vertex has triangles of one part only, and each part's last triangle stays.
    const bool empties_part = left_in_part_[part_of_[ring_.front()]] <= kept.triangle_count;
    if (empties_part || !surface_.may_merge(ring_, neighbours_, kept)) {
      ++report_.topology_refusals;
      return false;
    }
    find_moved(vertex, kept.vertex);
    if (turns_too_far()) {
      ++report_.flip_refusals;
      return false;
    }
    if (crosses()) {
      ++report_.crossing_refusals;
      return false;
    }
    return true;
  }

  /// Fills moved_ with the vertex's triangles that would not vanish, as they would be after the collapse.
  void find_moved(std::uint32_t vertex, std::uint32_t kept) {
    moved_.clear();
    for (const std::uint32_t triangle : ring_) {
      TriangleCorners corners = surface_.corners()[triangle];
      if (corners[0] == kept || corners[1] == kept || corners[2] == kept) continue;
      for (std::uint32_t& corner : corners) {
        if (corner == vertex) corner = kept;
      }
      moved_.push_back({triangle, corners});
    }
  }

  UnitNormal normal_of(const TriangleCorners& c) const {
    const std::vector<Vec3>& v = surface_.vertices();
    return unit_normal(v[c[0]], v[c[1]], v[c[2]]);
  }

  bool turns_too_far() const {
    for (const MovedVertex& moved : moved_) {
      const UnitNormal after = normal_of(moved.corners);
      const UnitNormal before = normal_of(surface_.corners()[moved.triangle]);
      const UnitNormal& first = normals_[moved.triangle];
      // A triangle without area has no normal that could turn, but no triangle may lose its area.
      if (after.isZero(0)) return true;
      if (!first.isZero(0) && !(after.dot(first) > kLeastTurnCosine)) return true;
      if (!before.isZero(0) && !(after.dot(before) > kLeastTurnCosine)) return true;
    }
    return false;
  }

  /// Whether one of the moved triangles would meet another one, or one of the other triangles, beyond their shared
  /// part.
  bool crosses() {
    const std::vector<Vec3>& vertices = surface_.vertices();
    moved_sides_.clear();
    moved_bounds_.clear();
    for (const MovedVertex& moved : moved_) {
      Aabb& bounds = moved_bounds_.emplace_back();
      for (const std::uint32_t corner : moved.corners) bounds.extend(vertices[corner]);
      moved_sides_.emplace_back(vertices, moved.corners);
    }
    for (std::size_t i = 0; i < moved_.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) {
        if (cross_beyond_shared(vertices, moved_sides_[i], moved_[k].corners)) return true;
      }
    }
    ++ring_stamp_;
    for (const std::uint32_t triangle : ring_) is_in_ring_[triangle] = ring_stamp_;
    near_.clear();
    tree_.find(moved_bounds_, near_);
    return std::any_of(near_.begin(), near_.end(), [&](const GrowingTree::Meeting& near) {
      return is_in_ring_[near.triangle] != ring_stamp_ &&
             cross_beyond_shared(vertices, moved_sides_[near.asked_index], surface_.corners()[near.triangle]);
    });
  }

  void collapse(std::uint32_t vertex, const Neighbour& merged) {
    const std::uint32_t kept = merged.vertex;
    left_in_part_[part_of_[ring_.front()]] -= merged.triangle_count;
    surface_.merge(vertex, kept);
    offered_[vertex] = kNever;
    for (const std::uint32_t triangle : ring_) {
      if (!surface_.is_live(triangle)) tree_.remove(triangle);
    }
    for (std::size_t i = 0; i < moved_.size(); ++i) tree_.update(moved_[i].triangle, moved_bounds_[i]);
    if (options_.cost == CollapseCost::quadric) {
      quadrics_[kept].add(quadrics_[vertex]);
      weights_[kept] += weights_[vertex];
    }
    if (surface_.live_count() < rebuild_at_) rebuild_tree();
    surface_.find_ring(kept, ring_);
    surface_.find_neighbours(kept, ring_, changed_);
    for (const Neighbour& n : changed_) offer_neighbour(n.vertex, kept);
    offer(kept, ring_);
  }

  struct MovedVertex {
    std::uint32_t triangle;
    TriangleCorners corners;
  };

  const SimplifyOptions& options_;
  SimplifyReport& report_;
  const std::vector<std::uint32_t>& part_of_;
  std::vector<std::uint32_t> left_in_part_;  // live triangles
  ShrinkingSurface surface_;
  GrowingTree tree_;
  std::size_t rebuild_at_ = 0;
  Vec3 origin_ = Vec3::Zero();
  std::vector<UnitNormal> normals_;  // of the triangles in the original mesh
  std::vector<Quadric> quadrics_;    // by vertex, relative to the origin
  std::vector<double> weights_;      // by vertex: sum of the weights in its quadric
  std::priority_queue<Offer> offers_;
  static constexpr float kNever = std::numeric_limits<float>::infinity();
  std::vector<float> offered_;       // by vertex: the cost in its valid offer
  std::vector<std::uint8_t> tried_;  // by vertex: targets that were refused since its neighbourhood changed
  std::vector<bool> is_locked_;
  std::vector<std::uint32_t> is_in_ring_;  // by triangle: the last stamp
  std::uint32_t ring_stamp_ = 0;

  // State of the current vertex; kept to reuse the memory.
  std::vector<std::uint32_t> ring_;
  std::vector<Neighbour> neighbours_;
  std::vector<Neighbour> changed_;
  std::vector<CollapseTarget> targets_;
  std::vector<MovedVertex> moved_;
  std::vector<TriangleSides> moved_sides_;  // by moved triangle
  std::vector<Aabb> moved_bounds_;          // of moved_
  std::vector<GrowingTree::Meeting> near_;
};

/// A mesh whose vertices and triangles are numbered in spatial order, and that uses one vertex for each place.
struct SortedMesh {
  TriangleMesh mesh;
  std::vector<std::uint32_t> original;  // vertex numbers
  std::vector<std::uint32_t> part_of;   // by triangle
};

SortedMesh sorted_in_space(const TriangleMesh& mesh, const std::vector<std::uint32_t>& first_equal,
                           std::span<const std::uint32_t> part_ends) {
  SortedMesh sorted;
  sorted.original = space_order(mesh.vertices);
  std::vector<std::uint32_t> number(sorted.original.size());
  for (std::uint32_t i = 0; i < number.size(); ++i) {
    number[sorted.original[i]] = i;
    sorted.mesh.vertices.push_back(mesh.vertices[sorted.original[i]]);
  }
  std::vector<std::pair<TriangleCorners, std::uint32_t>> triangles;
  std::uint32_t part = 0;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    while (part < part_ends.size() && i >= part_ends[part]) ++part;
    const TriangleCorners& c = mesh.triangles[i];
    triangles.push_back({{number[first_equal[c[0]]], number[first_equal[c[1]]], number[first_equal[c[2]]]}, part});
  }
  std::stable_sort(triangles.begin(), triangles.end(),
                   [](const auto& a, const auto& b) { return a.first[0] < b.first[0]; });
  for (const auto& [corners, part_number] : triangles) {
    sorted.mesh.triangles.push_back(corners);
    sorted.part_of.push_back(part_number);
  }
  return sorted;
}

}  // namespace

CollapseOrder simplify(const TriangleMesh& mesh, const SimplifyOptions& options, SimplifyReport& report) {
  report = {};
  CollapseOrder order;
  const std::vector<std::uint32_t> first_equal = first_equal_vertices(mesh.vertices);
  for (std::uint32_t i = 0; i < first_equal.size(); ++i) {
    if (first_equal[i] != i) order.push_back({i, first_equal[i]});
  }
  const std::size_t welds = order.size();
  const SortedMesh work = sorted_in_space(mesh, first_equal, options.part_ends);
  Simplifier(work.mesh, work.part_of, options, report).run(order);
  for (std::size_t step = welds; step < order.size(); ++step) {
    order[step] = {work.original[order[step].removed], work.original[order[step].kept]};
  }
  return order;
}

}  // namespace collided::engine
