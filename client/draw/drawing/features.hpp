#pragma once

#include <cstdint>
#include <vector>

#include "client/draw/drawing/camera.hpp"

namespace collided::draw {

/// What a line of a technical drawing is; an edge that is several of these is the first.
enum class LineKind : std::uint8_t {
  silhouette,  // between what faces the eye and what does not
  boundary,    // of one triangle, or of three and more
  crease,
  material,
};
inline constexpr int kLineKindCount = 4;

/// A chain of points in the world. Curves are chains that leave their curve by kCurveError_px at most.
struct FeatureLine {
  std::vector<Vec3> points;
  LineKind kind = LineKind::crease;
  std::uint32_t object = 0;  // number in ShownObjects
};

/// How far the image of a curve's chain is from the curve's, for curves that are not nearer to the eye than they are
/// large.
inline constexpr double kCurveError_px = 0.1;

/// Every line that the shapes have for this eye.
///
/// Edges of surfaces are silhouettes by the signs of n . (eye - p), exactly decided, so that on a closed mesh
/// silhouettes are loops. Spheres, capsules, cylinders, cones and ellipsoids have their silhouettes in closed form. An
/// edge to a triangle of an object that is not shown is a boundary. Half-spaces have no lines. Solids that reach into
/// each other keep their lines; those along which they meet are not found.
///
/// shown    asked for with edges
std::vector<FeatureLine> feature_lines(const ShownObjects& shown, const Camera& camera);

/// Corners, ends and poles: what is to be in the picture. Half-spaces give none.
std::vector<Vec3> extreme_points(const ShownObjects& shown);

/// A triangle faces the eye: n . (eye - p) > 0 for its corners' normal n, exactly. As seen along `toward_eye` where the
/// projection is parallel.
bool faces_eye(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& eye);
bool faces_direction(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& toward_eye);

}  // namespace collided::draw
