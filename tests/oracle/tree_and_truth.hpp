#pragma once

#include <memory>
#include <optional>

#include "server/exact_phase/solid/solid_tree.hpp"
#include "tests/oracle/solid_oracle.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/scenes/planted.hpp"

namespace collided::oracle {

/// A mesh with its tree, whose empty cells rationals decide.
struct TreeAndTruth {
  explicit TreeAndTruth(const TriangleMesh& mesh, bool keeps_faces = false)
      : shared(std::make_shared<const TriangleMesh>(mesh)), oracle(mesh) {
    std::mt19937_64 random(1);
    tree = SolidTree::build(shared, [&](const Vec3& p) { return oracle.side(rational(p), random) == SolidSide::in; },
                            {.keeps_faces = keeps_faces});
  }
  std::shared_ptr<const TriangleMesh> shared;
  SolidOracle oracle;
  std::optional<SolidTree> tree;
};

/// The exact height of a point above a triangle's plane, times twice the triangle's area.
inline mpq_class height(const Triangle& t, const RationalPoint& p) {
  const auto a = rational(t.a), b = rational(t.b), c = rational(t.c);
  RationalPoint u, v, w;
  for (int i = 0; i < 3; ++i) {
    u[i] = b[i] - a[i];
    v[i] = c[i] - a[i];
    w[i] = p[i] - a[i];
  }
  return w[0] * (u[1] * v[2] - u[2] * v[1]) + w[1] * (u[2] * v[0] - u[0] * v[2]) + w[2] * (u[0] * v[1] - u[1] * v[0]);
}

/// A box with a cavity, and a second box that meets the first along an edge.
inline TriangleMesh with_cavity() {
  TriangleMesh mesh = scenes::box({1, 1, 1});
  TriangleMesh cavity = scenes::box({0.25, 0.5, 0.25});
  for (TriangleCorners& corners : cavity.triangles) std::swap(corners[1], corners[2]);
  scenes::append(mesh, cavity);
  scenes::append(mesh, scenes::box({1, 1, 1}, {2, 2, 0}));
  return mesh;
}

}  // namespace collided::oracle
