#pragma once

#include <functional>
#include <vector>

#include "server/geometry/mesh.hpp"
#include "server/intake/limits.hpp"

namespace collided::engine {

/// A curved surface as triangles: no point of either is farther than off_by_m from the other.
struct Tessellation {
  TriangleMesh mesh;
  double off_by_m = 0;
};

/// How finely: by numbers of pieces along both parameters, or (error_m > 0) so many as keep the error.
struct Fineness {
  unsigned first = 0;
  unsigned second = 0;
  double error_m = 0;
  std::uint64_t triangles_at_most = kMaxTessellationTriangles;
};

/// The surfaces. Closed ones are closed as meshes too, with seams and poles shared, normals outward, about the origin and
/// the z axis.
///
/// returns  bounds proved as each says, and widened by the roundings of the vertices
/// throws   std::invalid_argument: sizes that are not finite and above 0, fewer pieces than make a surface, too many
///          triangles

/// first: slices round the axis, at least 3; second: bands from pole to pole, at least 2.
/// bound  the deepest point of a face, r (1 - cos(pi / (2 bands)) cos(pi / slices))
Tessellation tessellate_sphere(double radius_m, const Fineness& fineness);
/// bound  the sphere's, times the longest half axis
Tessellation tessellate_ellipsoid(const Vec3& half_m, const Fineness& fineness);
/// With both ends; first: slices. bound: the sagitta r (1 - cos(pi / slices)).
Tessellation tessellate_cylinder(double radius_m, double length_m, const Fineness& fineness);
/// With its base, the apex up. bound: as of the cylinder
Tessellation tessellate_cone(double radius_m, double height_m, const Fineness& fineness);
/// first: slices round the axis, second: round the tube, at least 3 each. bound: SecondDerivatives::chord_error
Tessellation tessellate_torus(double ring_m, double tube_m, const Fineness& fineness);

/// Bounds on the lengths of a surface's second derivatives by its two parameters.
struct SecondDerivatives {
  double first_first = 0;
  double first_second = 0;
  double second_second = 0;

  /// How far a triangle over half of a step by step cell of the parameters is from the surface at most, point by point.
  /// source  Filip, Magedson, Markot, "Surface algorithms using bounds on derivatives", 1986
  double chord_error(double first_step, double second_step) const;
};

/// A tensor-product B-spline: points row after row, `columns` a row, the first parameter along a row. Between 1 and 8 each
/// way; knots are uniform, the ends clamped. One with degree + 1 points is a Bezier patch.
struct SplinePatch {
  unsigned first_degree = 3;
  unsigned second_degree = 3;
  unsigned columns = 4;
  std::vector<Vec3> points;

  unsigned rows() const { return columns == 0 ? 0 : static_cast<unsigned>(points.size() / columns); }
  /// Parameters from 0 to the number of spans along each.
  Vec3 at(double first, double second) const;
  SecondDerivatives second_derivatives() const;
};

/// first, second: pieces of each span. bound: the control points of the second derivatives, whose hull holds these
Tessellation tessellate_patch(const SplinePatch& patch, const Fineness& fineness);

/// z = height(x, y) over a rectangle from low to high; normals up. Where second derivatives are bounded as said, so is the
/// error; the function is believed.
struct HeightFunction {
  std::function<double(double, double)> height;
  Eigen::Vector2d low;
  Eigen::Vector2d high;
  SecondDerivatives bounds;
};
Tessellation tessellate_heights(const HeightFunction& function, const Fineness& fineness);

/// The sphere as an explicit surface: by longitude in [0, 2 pi) and colatitude in [0, pi] from the pole up. At the poles
/// the longitude is 0.
struct SphereParameters {
  double longitude_rad = 0;
  double colatitude_rad = 0;
};
Vec3 sphere_point(const SphereParameters& at, double radius_m);
/// Of a point on the sphere, or of the one on the same ray from the centre.
SphereParameters sphere_parameters(const Vec3& point);

}  // namespace collided::engine
