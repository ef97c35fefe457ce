#include "server/exact_phase/round_solids/flat_features.hpp"

#include <algorithm>

#include "server/geometry/convex_hull.hpp"
#include "server/geometry/mesh.hpp"
#include "server/geometry/orientation.hpp"

namespace collided::engine::kernel {
namespace {

/// One side of a face: its edge, and the face's corner opposite.
struct FaceSide {
  std::uint32_t low;
  std::uint32_t high;
  std::uint32_t face;
  std::uint32_t across;
};

/// Whether d is in front of the plane through the other three. Exact.
bool is_in_front(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  if (const std::optional<int> side = orientation(a, b, c, d)) return *side > 0;
  const Vector<Dyadic> from(a);
  const Vector<Dyadic> n = cross(Vector<Dyadic>(b) - from, Vector<Dyadic>(c) - from);
  return dot(n, Vector<Dyadic>(d) - from).sign() > 0;
}

/// True if faces of a convex surface still form one after each corner was rounded separately: every face has area, and
/// none has its neighbour's corner in front (local convexity of a closed surface makes the whole convex).
bool is_still_convex(const std::vector<Vec3>& corners, const std::vector<TriangleCorners>& faces) {
  std::vector<FaceSide> sides;
  for (std::uint32_t face = 0; face < faces.size(); ++face) {
    const TriangleCorners& corner = faces[face];
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [low, high] = std::minmax(corner[i], corner[(i + 1) % 3]);
      sides.push_back({low, high, face, corner[(i + 2) % 3]});
    }
  }
  std::sort(sides.begin(), sides.end(),
            [](const FaceSide& a, const FaceSide& b) { return std::pair(a.low, a.high) < std::pair(b.low, b.high); });
  if (sides.size() % 2 != 0) return false;
  for (std::size_t i = 0; i < sides.size(); i += 2) {
    if (sides[i].low != sides[i + 1].low || sides[i].high != sides[i + 1].high) return false;
    const TriangleCorners& face = faces[sides[i].face];
    if (is_in_front(corners[face[0]], corners[face[1]], corners[face[2]], corners[sides[i + 1].across])) return false;
  }
  return std::all_of(faces.begin(), faces.end(), [&](const TriangleCorners& face) {
    const Vector<Bounded> a(corners[face[0]]);
    const Vector<Bounded> n = cross(Vector<Bounded>(corners[face[1]]) - a, Vector<Bounded>(corners[face[2]]) - a);
    return is_positive(square(n)) == Decision::yes;
  });
}

}  // namespace

std::optional<FlatFeatures> FlatFeatures::of(const Convex& set) {
  FlatFeatures features;
  if (set.plus == Convex::Plus::box) {
    features.take_box(set);
  } else if (set.hull != nullptr) {
    if (!features.take_hull(set)) return std::nullopt;
  } else {
    features.corners_.assign(set.carrier, set.carrier + set.count());
    if (set.count() < 3) features.border_.edges.push_back({0, static_cast<std::uint32_t>(set.count() - 1)});
    else features.border_.edges = {{0, 1}, {1, 2}, {2, 0}};
    if (set.count() == 3) features.border_.faces.push_back({{0, 1, 2, 0}, 3});
  }
  return features;
}

/// Numbers corners by the signs of their three half axes, one bit each.
void FlatFeatures::take_box(const Convex& set) {
  box_ = &set;
  border_.is_solid = true;
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    const std::uint32_t along = 1u << axis;
    const std::uint32_t u = 1u << (axis + 1) % 3;
    const std::uint32_t v = 1u << (axis + 2) % 3;
    for (const std::uint32_t at : {0u, u, v, u | v}) border_.edges.push_back({at, at | along});
    for (const std::uint32_t at : {0u, along}) border_.faces.push_back({{at, at | u, at | u | v, at | v}, 4});
  }
}

bool FlatFeatures::take_hull(const Convex& set) {
  for (int i = 0; i < set.count(); ++i) corners_.push_back(set.point(i));
  border_.is_solid = true;
  const std::vector<TriangleCorners>& own = set.hull->mesh->triangles;
  if (!own.empty() && is_still_convex(corners_, own)) {
    take_faces(own);
    return true;
  }
  if (corners_.size() > kMostRebuilt) return false;
  std::optional<TriangleMesh> rebuilt = convex_hull(corners_);
  if (!rebuilt) return false;
  corners_ = std::move(rebuilt->vertices);
  take_faces(rebuilt->triangles);
  return true;
}

void FlatFeatures::take_faces(const std::vector<TriangleCorners>& triangles) {
  for (const TriangleCorners& corner : triangles) {
    border_.faces.push_back({{corner[0], corner[1], corner[2], 0}, 3});
    // Each edge belongs to two faces, which run along it in opposite directions.
    for (std::size_t i = 0; i < 3; ++i) {
      if (corner[i] < corner[(i + 1) % 3]) border_.edges.push_back({corner[i], corner[(i + 1) % 3]});
    }
  }
}

}  // namespace collided::engine::kernel
