#pragma once

#include <array>
#include <optional>
#include <vector>

#include "server/exact_phase/distance/convex.hpp"
#include "server/exact_phase/round_solids/flat_features.hpp"

namespace collided::engine::kernel {

/// A convex set in exact coordinates, all of which may be multiplied by one positive factor. The counterpart of Convex
/// for algebra in rationals: for a shape in world coordinates, or one given with a pose.
struct ExactSolid {
  /// In the order in which round_pair.cpp takes pairs.
  enum class Kind { flat, ball, capsule, axial, ellipsoid };

  Kind kind = Kind::flat;
  std::vector<Vector<Dyadic>> points;       // corners; the centre; or ends of the axis, a cone's apex first
  Dyadic radius = {};                       // radius of the ball or disc around each point
  int first_disc = 0;                       // 1 for a cone, whose apex has no disc
  std::array<Vector<Dyadic>, 3> half = {};  // half axes of an ellipsoid
  std::optional<FlatBorder> border =
      {};  // of a flat one, by the numbers of its points; set only if needed for cylinders

  ExactSolid() = default;
  /// Leaves out the border.
  explicit ExactSolid(const Convex& set);

  bool tapers() const { return first_disc > 0; }
  Vector<Dyadic> axis() const { return points[1] - points[0]; }
};

ExactSolid::Kind kind_of(const Convex& set);

/// As for Convex: the reach of the set along n from `origin`, times |n|.
ReachAlong<Dyadic> reach_along(const ExactSolid& set, const Vector<Dyadic>& n, const Vector<Dyadic>& origin);
/// As for Convex.
Decision parted_along(const Vector<Dyadic>& n, const ExactSolid& a, const ExactSolid& b);

}  // namespace collided::engine::kernel
