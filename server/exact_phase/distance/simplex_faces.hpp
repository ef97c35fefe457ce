#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "server/exact_phase/arithmetic/number.hpp"

namespace collided::engine::kernel {

// The point of a simplex nearest to the origin, in arithmetic that does not round, or rounds far less than double.

/// A corner of a minus one of b.
template <class N>
struct MinkowskiVertex {
  Vector<N> w;
  std::size_t of_a = 0;
  std::size_t of_b = 0;
};

/// The point nearest to the origin as sum / total, and its weights of the corners.
template <class N>
struct Foot {
  Vector<N> sum;
  N total;
  std::vector<MinkowskiVertex<N>> corners;
  std::vector<N> weights;
};

/// The weights of the origin's foot on the plane, line or point through all corners; their sum is at least zero.
template <class N>
std::vector<N> weights_of(const std::vector<MinkowskiVertex<N>>& corners) {
  if (corners.size() == 1) return {N(1.0)};
  std::vector<Vector<N>> w;
  for (const MinkowskiVertex<N>& corner : corners) w.push_back(corner.w);
  if (w.size() == 2) return {dot(w[1], w[1] - w[0]), dot(w[0], w[0] - w[1])};
  const Vector<N> n = cross(w[1] - w[0], w[2] - w[0]);
  if (w.size() == 3) return {dot(n, cross(w[1], w[2])), dot(n, cross(w[2], w[0])), dot(n, cross(w[0], w[1]))};
  const N volume = dot(n, w[3] - w[0]);
  const N turn(volume.sign() < 0 ? -1.0 : 1.0);
  // Volumes of the tetrahedra with the origin in place of each corner.
  return {turn * dot(w[1], cross(w[2], w[3])), -turn * dot(w[0], cross(w[2], w[3])),
          turn * dot(w[0], cross(w[1], w[3])), -turn * dot(w[0], cross(w[1], w[2]))};
}

/// The simplex's point nearest to the origin lies inside exactly one of its faces: the one for which no other corner is
/// nearer along the foot. Tests one face.
template <class N>
bool nearest_in(const std::vector<MinkowskiVertex<N>>& simplex, unsigned which, Foot<N>& foot) {
  std::vector<MinkowskiVertex<N>> face;
  for (std::size_t i = 0; i < simplex.size(); ++i) {
    if (which >> i & 1) face.push_back(simplex[i]);
  }
  Foot<N> found{Vector<N>(Vec3(Vec3::Zero())), N(0.0), face, weights_of(face)};
  for (std::size_t i = 0; i < face.size(); ++i) {
    if (found.weights[i].sign() <= 0) return false;
    found.sum = found.sum + found.weights[i] * face[i].w;
    found.total = found.total + found.weights[i];
  }
  const N level = square(found.sum);
  // The face's own corners are as far along as the foot.
  for (std::size_t i = 0; i < simplex.size(); ++i) {
    if (which >> i & 1) continue;
    if ((dot(found.sum, simplex[i].w) * found.total - level).sign() < 0) return false;
  }
  foot = std::move(found);
  return true;
}

template <class N>
bool nearest_of(const std::vector<MinkowskiVertex<N>>& simplex, Foot<N>& foot) {
  for (unsigned which = 1; which < 1u << simplex.size(); ++which) {
    if (nearest_in(simplex, which, foot)) return true;
  }
  return false;
}

}  // namespace collided::engine::kernel
