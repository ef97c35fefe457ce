#include "server/intake/simplify/shrinking_surface.hpp"

#include <algorithm>

namespace collided::engine {

ShrinkingSurface::ShrinkingSurface(const TriangleMesh& mesh)
    : mesh_(mesh),
      corners_(mesh.triangles),
      first_(mesh.vertices.size(), kNone),
      next_(3 * mesh.triangles.size(), kNone) {
  for (std::uint32_t i = 0; i < corners_.size(); ++i) {
    TriangleCorners& c = corners_[i];
    if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) {
      c[1] = c[0];  // never live
      continue;
    }
    ++live_count_;
    for (std::uint32_t k = 0; k < 3; ++k) {
      next_[3 * i + k] = first_[c[k]];
      first_[c[k]] = 3 * i + k;
    }
  }
}

std::vector<std::uint32_t> ShrinkingSurface::live_triangles() const {
  std::vector<std::uint32_t> live;
  live.reserve(live_count_);
  for (std::uint32_t i = 0; i < corners_.size(); ++i) {
    if (is_live(i)) live.push_back(i);
  }
  return live;
}

void ShrinkingSurface::find_ring(std::uint32_t vertex, std::vector<std::uint32_t>& ring) {
  ring.clear();
  // Vanished triangles are removed from the list in passing.
  std::uint32_t* link = &first_[vertex];
  while (*link != kNone) {
    const std::uint32_t at = *link;
    if (is_live(at / 3)) {
      ring.push_back(at / 3);
      link = &next_[at];
    } else {
      *link = next_[at];
    }
  }
}

void ShrinkingSurface::find_neighbours(std::uint32_t vertex, const std::vector<std::uint32_t>& ring,
                                       std::vector<Neighbour>& neighbours) const {
  neighbours.clear();
  for (const std::uint32_t triangle : ring) {
    for (const std::uint32_t corner : corners_[triangle]) {
      if (corner == vertex) continue;
      const auto known =
          std::find_if(neighbours.begin(), neighbours.end(), [&](const Neighbour& n) { return n.vertex == corner; });
      if (known != neighbours.end()) ++known->triangle_count;
      else neighbours.push_back({corner, 1});
    }
  }
}

bool ShrinkingSurface::may_merge(const std::vector<std::uint32_t>& ring, const std::vector<Neighbour>& neighbours,
                                 const Neighbour& kept) {
  find_ring(kept.vertex, other_ring_);
  // All triangles at either vertex are at the edge between them: the piece would vanish.
  if (ring.size() == kept.triangle_count && other_ring_.size() == kept.triangle_count) return false;
  find_neighbours(kept.vertex, other_ring_, other_neighbours_);
  std::size_t common_count = 0;
  for (const Neighbour& n : neighbours) {
    common_count += std::any_of(other_neighbours_.begin(), other_neighbours_.end(),
                                [&](const Neighbour& o) { return o.vertex == n.vertex; });
  }
  return common_count == kept.triangle_count;
}

void ShrinkingSurface::merge(std::uint32_t removed, std::uint32_t kept) {
  std::uint32_t* link = &first_[removed];
  while (*link != kNone) {
    const std::uint32_t at = *link;
    TriangleCorners& c = corners_[at / 3];
    const bool is_between = is_live(at / 3) && (c[0] == kept || c[1] == kept || c[2] == kept);
    if (is_between) {
      c[0] = c[1] = kept;
      --live_count_;
    }
    if (!is_live(at / 3)) {
      *link = next_[at];
      continue;
    }
    c[at % 3] = kept;
    link = &next_[at];
  }
  *link = first_[kept];
  first_[kept] = first_[removed];
  first_[removed] = kNone;
}

}  // namespace collided::engine
