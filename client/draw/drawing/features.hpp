#pragma once

#include <cstdint>
#include <vector>

#include "client/draw/drawing/camera.hpp"

namespace collided::draw {

/// What a line of a technical drawing shows. An edge that is several of these counts as the first.
enum class LineKind : std::uint8_t {
  silhouette,  // between triangles that face the eye and others that do not
  boundary,    // an edge of one triangle, or of three and more
  crease,
  material,
};
inline constexpr int kLineKindCount = 4;

/// A line as a chain of points in the world. A curve's chain is off by at most kCurveError_px.
struct FeatureLine {
  std::vector<Vec3> points;
  LineKind kind = LineKind::crease;
  std::uint32_t object = 0;  // index in ShownObjects
};

/// The distance between the images of a curve and its chain, in pixels. It holds for curves that are no nearer to the
/// eye than their size.
inline constexpr double kCurveError_px = 0.1;

/// All lines of the objects that matter to this camera.
///
/// Whether an edge of a surface is a silhouette is decided by the exact signs of n . (eye - p), so that silhouettes of
/// a closed mesh are loops. Silhouettes of spheres, capsules, cylinders, cones and ellipsoids are in closed form. An
/// edge whose other triangle belongs to an object that is not shown is a boundary. Half-spaces have no lines. If solids
/// overlap, the lines along which their surfaces meet are not found.
///
/// shown  fetched with ShapesOptions::edges
std::vector<FeatureLine> feature_lines(const ShownObjects& shown, const Camera& camera);

/// Corners, ends and poles of the objects, which the picture should contain. Half-spaces have none.
std::vector<Vec3> extreme_points(const ShownObjects& shown);

/// Whether a triangle faces the eye: n . (eye - p) > 0 for its normal n, exactly. The second is for a parallel
/// projection.
bool faces_eye(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& eye);
bool faces_direction(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& toward_eye);

}  // namespace collided::draw
