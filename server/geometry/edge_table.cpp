#include "server/geometry/edge_table.hpp"

#include <algorithm>
#include <cassert>

namespace collided::engine {
namespace {

struct TriangleSide {
  std::uint32_t high;
  HalfEdge half;
};

/// The sides sorted by their lower point (counting sort): bucket p is [starts[p], starts[p + 1]).
struct Buckets {
  std::vector<std::uint32_t> starts;
  std::vector<TriangleSide> sides;
};

/// Calls visit(from, to, half) for each side that is an edge.
template <class Visit>
void visit_sides(const TriangleMesh& mesh, std::span<const std::uint32_t> point_of, const std::vector<bool>& left_out,
                 Visit&& visit) {
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    if (!left_out.empty() && left_out[i]) continue;
    TriangleCorners corners = mesh.triangles[i];
    if (!point_of.empty()) {
      for (std::uint32_t& corner : corners) corner = point_of[corner];
    }
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t to = corners[k == 2 ? 0 : k + 1];
      if (corners[k] != to) visit(corners[k], to, 3 * i + k);
    }
  }
}

Buckets buckets_of(const TriangleMesh& mesh, std::span<const std::uint32_t> point_of,
                   const std::vector<bool>& left_out) {
  Buckets buckets;
  buckets.starts.assign(mesh.vertices.size() + 2, 0);
  visit_sides(mesh, point_of, left_out,
              [&](std::uint32_t from, std::uint32_t to, HalfEdge) { ++buckets.starts[std::min(from, to) + 2]; });
  for (std::size_t i = 2; i < buckets.starts.size(); ++i) buckets.starts[i] += buckets.starts[i - 1];
  buckets.sides.resize(buckets.starts.back());
  // starts[p + 1] moves from the bucket's beginning to its end, where the next one begins.
  visit_sides(mesh, point_of, left_out, [&](std::uint32_t from, std::uint32_t to, HalfEdge half) {
    buckets.sides[buckets.starts[std::min(from, to) + 1]++] = {std::max(from, to), half};
  });
  return buckets;
}

/// Insertion sort for the usual few: only the centre of a fan has many sides.
void sort(std::span<TriangleSide> sides) {
  const auto before = [](const TriangleSide& a, const TriangleSide& b) {
    return a.high != b.high ? a.high < b.high : a.half < b.half;
  };
  if (sides.size() > 24) {
    std::sort(sides.begin(), sides.end(), before);
    return;
  }
  for (std::size_t i = 1; i < sides.size(); ++i) {
    const TriangleSide moved = sides[i];
    std::size_t k = i;
    for (; k > 0 && before(moved, sides[k - 1]); --k) sides[k] = sides[k - 1];
    sides[k] = moved;
  }
}

}  // namespace

EdgeTable edge_table(const TriangleMesh& mesh, std::span<const std::uint32_t> point_of,
                     const std::vector<bool>& left_out) {
  assert(mesh.triangles.size() <= 0xffffffffu / 3 && "sides are numbered in 32 bits");
  Buckets buckets = buckets_of(mesh, point_of, left_out);
  EdgeTable table;
  table.uses.reserve(buckets.sides.size());
  table.is_upward.reserve(buckets.sides.size());
  table.edges.reserve(buckets.sides.size() / 2 + 2);
  for (std::uint32_t low = 0; low < mesh.vertices.size(); ++low) {
    const std::span<TriangleSide> sides =
        std::span(buckets.sides).subspan(buckets.starts[low], buckets.starts[low + 1] - buckets.starts[low]);
    sort(sides);
    for (std::size_t i = 0; i < sides.size(); ++i) {
      if (i == 0 || sides[i].high != sides[i - 1].high) {
        table.edges.push_back({low, sides[i].high, static_cast<std::uint32_t>(table.uses.size())});
      }
      const HalfEdge half = sides[i].half;
      const std::uint32_t corner = mesh.triangles[half / 3][half % 3];
      table.uses.push_back(half);
      table.is_upward.push_back((point_of.empty() ? corner : point_of[corner]) == low);
    }
  }
  table.edges.push_back({0, 0, static_cast<std::uint32_t>(table.uses.size())});
  return table;
}

}  // namespace collided::engine
