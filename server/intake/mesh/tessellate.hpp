#pragma once

#include <functional>
#include <vector>

#include "server/geometry/mesh.hpp"
#include "server/intake/limits.hpp"

namespace collided::engine {

/// A curved surface as triangles. No point of the mesh is farther than off_by_m from the surface, and no point of the
/// surface farther than that from the mesh.
struct Tessellation {
  TriangleMesh mesh;
  double off_by_m = 0;
};

/// How finely to tessellate: the numbers of pieces along the two parameters, or, with error_m above 0, as many as keep
/// the error below it.
struct Fineness {
  unsigned first = 0;
  unsigned second = 0;
  double error_m = 0;
  std::uint64_t triangles_at_most = kMaxTessellationTriangles;
};

// The tessellate functions below. Surfaces are centred on the origin and the z axis. Closed surfaces give closed
// meshes, with shared vertices at seams and poles and normals outward. off_by_m is a proved bound, stated for each
// function, plus the rounding of the vertices. All throw std::invalid_argument for sizes that are not finite and above
// 0, for too few pieces to form a surface, and for too many triangles.

/// first: slices around the axis, at least 3; second: bands from pole to pole, at least 2.
/// bound  the deepest point of a face, r (1 - cos(pi / (2 bands)) cos(pi / slices))
Tessellation tessellate_sphere(double radius_m, const Fineness& fineness);
/// bound  the sphere's, times the longest half axis
Tessellation tessellate_ellipsoid(const Vec3& half_m, const Fineness& fineness);
/// With both end discs. first: slices around the axis; second is ignored.
/// bound  the sagitta r (1 - cos(pi / slices))
Tessellation tessellate_cylinder(double radius_m, double length_m, const Fineness& fineness);
/// With its base, the apex up; otherwise like the cylinder.
Tessellation tessellate_cone(double radius_m, double height_m, const Fineness& fineness);
/// first: slices around the axis; second: slices around the tube; at least 3 each.
/// bound  SecondDerivatives::chord_error
Tessellation tessellate_torus(double ring_m, double tube_m, const Fineness& fineness);

/// Upper bounds on the lengths of a surface's second derivatives by its two parameters, in metres by parameter squared.
struct SecondDerivatives {
  double first_first = 0;
  double first_second = 0;
  double second_second = 0;

  /// The largest distance from the surface, at equal parameters, of a triangle over half a cell of the parameters of
  /// these steps.
  /// source  Filip, Magedson, Markot, "Surface algorithms using bounds on derivatives", 1986
  double chord_error(double first_step, double second_step) const;
};

/// A tensor-product B-spline surface. Its control points are given row by row, `columns` to a row, with the first
/// parameter along a row. Degrees are 1 to 8; knots are uniform, clamped at the ends. With degree + 1 points in each
/// direction it is a Bezier patch.
struct SplinePatch {
  unsigned first_degree = 3;
  unsigned second_degree = 3;
  unsigned columns = 4;
  std::vector<Vec3> points;

  unsigned rows() const { return columns == 0 ? 0 : static_cast<unsigned>(points.size() / columns); }
  /// The point at these parameters, each from 0 to the number of spans in its direction.
  Vec3 at(double first, double second) const;
  SecondDerivatives second_derivatives() const;
};

/// first, second: pieces of each span.
/// bound  chord_error from the control points of the second derivatives, whose hull contains these
Tessellation tessellate_patch(const SplinePatch& patch, const Fineness& fineness);

/// The surface z = height(x, y) over the rectangle from low to high, normals up. The error bound holds if `bounds` is
/// correct for the function, which is not checked.
struct HeightFunction {
  std::function<double(double, double)> height;
  Eigen::Vector2d low;
  Eigen::Vector2d high;
  SecondDerivatives bounds;
};
/// first, second: pieces along x and y.
Tessellation tessellate_heights(const HeightFunction& function, const Fineness& fineness);

/// A point of a sphere by longitude, in [0, 2 pi), and colatitude, in [0, pi] from the upper pole. At the poles the
/// longitude is 0.
struct SphereParameters {
  double longitude_rad = 0;
  double colatitude_rad = 0;
};
/// The inverse of sphere_parameters.
Vec3 sphere_point(const SphereParameters& at, double radius_m);
/// The parameters of a point on the sphere, or of the point of the sphere on the same ray from the centre.
SphereParameters sphere_parameters(const Vec3& point);

}  // namespace collided::engine
