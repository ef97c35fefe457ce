#include "server/intake/mesh/tessellate.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "server/geometry/surface_tolerance.hpp"
#include "server/geometry/tolerance.hpp"
#include "server/intake/mesh/sphere_mesh.hpp"

namespace collided::engine {
namespace {

using std::numbers::pi;

void require(bool holds, const char* what) {
  if (!holds) throw std::invalid_argument(what);
}

bool is_size(double size_m) { return size_m > 0 && std::isfinite(size_m); }

/// Numbers of pieces along the two parameters.
struct GridCounts {
  double first;
  double second;
};

/// The given counts, or else the least ones, increased until the bound is within the error, each time along the
/// parameter that reduces the bound more.
template <class Bound>
GridCounts counts_for(const Fineness& fineness, GridCounts least, const Bound& bound) {
  if (fineness.error_m == 0) {
    require(fineness.first >= least.first && fineness.second >= least.second,
            "tessellation: too few pieces to make the surface");
    return {static_cast<double>(fineness.first), static_cast<double>(fineness.second)};
  }
  require(is_size(fineness.error_m), "tessellation: the error must be finite and above 0");
  const auto grown = [](double count) { return std::floor(count * 1.02) + 1; };
  GridCounts counts = least;
  while (bound(counts.first, counts.second) > fineness.error_m) {
    require(2 * counts.first * counts.second <= static_cast<double>(fineness.triangles_at_most),
            "tessellation: the error asked for takes too many triangles");
    const bool first_helps = bound(grown(counts.first), counts.second) <= bound(counts.first, grown(counts.second));
    double& count = first_helps ? counts.first : counts.second;
    count = grown(count);
  }
  return counts;
}

void check_count(double triangle_count, const Fineness& fineness) {
  if (!(triangle_count <= static_cast<double>(fineness.triangles_at_most))) {
    throw std::invalid_argument("tessellation: more than " + std::to_string(fineness.triangles_at_most) + " triangles");
  }
}

double with_roundings(double bound_m, double reach_m) {
  return bound_m * (1 + kBoundSlack) + kVertexRounding * reach_m;
}

/// 1 - cos, accurate for small angles too.
double versine(double angle_rad) {
  const double half = std::sin(angle_rad / 2);
  return 2 * half * half;
}

/// The greatest depth of the mesh's faces inside a sphere of radius 1.
double unit_sphere_error(double slices, double bands) {
  return versine(pi / (2 * bands)) + std::cos(pi / (2 * bands)) * versine(pi / slices);
}

GridCounts sphere_counts(const Fineness& fineness, double longest_m) {
  const GridCounts counts = counts_for(
      fineness, {3, 2}, [&](double slices, double bands) { return longest_m * unit_sphere_error(slices, bands); });
  check_count(2 * counts.first * (counts.second - 1), fineness);
  return counts;
}

/// Adds a ring of vertices around the axis, the first one at y = 0.
void add_ring(double radius_m, double z, unsigned slices, TriangleMesh& mesh) {
  for (unsigned i = 0; i < slices; ++i) {
    const double angle = 2 * pi * i / slices;
    mesh.vertices.emplace_back(radius_m * std::cos(angle), radius_m * std::sin(angle), z);
  }
}

/// Adds triangles from a ring to a vertex above or below it, facing away from the axis' middle.
void add_cap(std::uint32_t first, unsigned slices, std::uint32_t tip, bool is_up, TriangleMesh& mesh) {
  for (std::uint32_t i = 0; i < slices; ++i) {
    const std::uint32_t a = first + i;
    const std::uint32_t b = first + (i + 1) % slices;
    mesh.triangles.push_back(is_up ? TriangleCorners{a, b, tip} : TriangleCorners{b, a, tip});
  }
}

unsigned slices_for(double radius_m, Fineness fineness) {
  fineness.second = 1;
  const GridCounts counts =
      counts_for(fineness, {3, 1}, [&](double slices, double) { return radius_m * versine(pi / slices); });
  check_count(4 * counts.first, fineness);
  return static_cast<unsigned>(counts.first);
}

}  // namespace

double SecondDerivatives::chord_error(double first_step, double second_step) const {
  return (first_step * first_step * first_first + 2 * first_step * second_step * first_second +
          second_step * second_step * second_second) /
         8;
}

Tessellation tessellate_sphere(double radius_m, const Fineness& fineness) {
  return tessellate_ellipsoid(Vec3::Constant(radius_m), fineness);
}

Tessellation tessellate_ellipsoid(const Vec3& half_m, const Fineness& fineness) {
  require(is_size(half_m.minCoeff()) && is_size(half_m.maxCoeff()),
          "sphere or ellipsoid: radii must be finite and above 0");
  const GridCounts counts = sphere_counts(fineness, half_m.maxCoeff());
  Tessellation surface{
      latitude_longitude_sphere(1, static_cast<unsigned>(counts.first), static_cast<unsigned>(counts.second))};
  for (Vec3& vertex : surface.mesh.vertices) vertex = vertex.cwiseProduct(half_m);
  surface.off_by_m =
      with_roundings(half_m.maxCoeff() * unit_sphere_error(counts.first, counts.second), half_m.maxCoeff());
  return surface;
}

Tessellation tessellate_cylinder(double radius_m, double length_m, const Fineness& fineness) {
  require(is_size(radius_m) && is_size(length_m), "cylinder: radius and length must be finite and above 0");
  const unsigned slices = slices_for(radius_m, fineness);
  Tessellation surface;
  TriangleMesh& mesh = surface.mesh;
  add_ring(radius_m, -length_m / 2, slices, mesh);
  add_ring(radius_m, length_m / 2, slices, mesh);
  mesh.vertices.emplace_back(0, 0, -length_m / 2);
  mesh.vertices.emplace_back(0, 0, length_m / 2);
  for (std::uint32_t i = 0; i < slices; ++i) {
    const std::uint32_t next = (i + 1) % slices;
    mesh.triangles.push_back({i, next, slices + next});
    mesh.triangles.push_back({i, slices + next, slices + i});
  }
  add_cap(0, slices, 2 * slices, false, mesh);
  add_cap(slices, slices, 2 * slices + 1, true, mesh);
  surface.off_by_m = with_roundings(radius_m * versine(pi / slices), radius_m + length_m);
  return surface;
}

Tessellation tessellate_cone(double radius_m, double height_m, const Fineness& fineness) {
  require(is_size(radius_m) && is_size(height_m), "cone: radius and height must be finite and above 0");
  const unsigned slices = slices_for(radius_m, fineness);
  Tessellation surface;
  TriangleMesh& mesh = surface.mesh;
  add_ring(radius_m, -height_m / 2, slices, mesh);
  mesh.vertices.emplace_back(0, 0, -height_m / 2);
  mesh.vertices.emplace_back(0, 0, height_m / 2);
  add_cap(0, slices, slices, false, mesh);
  add_cap(0, slices, slices + 1, true, mesh);
  surface.off_by_m = with_roundings(radius_m * versine(pi / slices), radius_m + height_m);
  return surface;
}

Tessellation tessellate_torus(double ring_m, double tube_m, const Fineness& fineness) {
  require(is_size(ring_m) && is_size(tube_m) && tube_m < ring_m,
          "torus: ring and tube must be finite and above 0, the tube thinner than the ring");
  const SecondDerivatives bounds{ring_m + tube_m, tube_m, tube_m};
  const auto error = [&](double slices, double around) { return bounds.chord_error(2 * pi / slices, 2 * pi / around); };
  const GridCounts counts = counts_for(fineness, {3, 3}, error);
  check_count(2 * counts.first * counts.second, fineness);
  const auto slices = static_cast<std::uint32_t>(counts.first);
  const auto around = static_cast<std::uint32_t>(counts.second);
  Tessellation surface;
  for (std::uint32_t i = 0; i < slices; ++i) {
    const double u = 2 * pi * i / slices;
    for (std::uint32_t k = 0; k < around; ++k) {
      const double v = 2 * pi * k / around;
      const double out_m = ring_m + tube_m * std::cos(v);
      surface.mesh.vertices.emplace_back(out_m * std::cos(u), out_m * std::sin(u), tube_m * std::sin(v));
      const std::uint32_t next_i = (i + 1) % slices;
      const std::uint32_t next_k = (k + 1) % around;
      surface.mesh.triangles.push_back({i * around + k, next_i * around + k, next_i * around + next_k});
      surface.mesh.triangles.push_back({i * around + k, next_i * around + next_k, i * around + next_k});
    }
  }
  surface.off_by_m = with_roundings(error(counts.first, counts.second), ring_m + tube_m);
  return surface;
}

Tessellation tessellate_heights(const HeightFunction& function, const Fineness& fineness) {
  const Eigen::Vector2d size = function.high - function.low;
  require(is_size(size.minCoeff()) && is_size(size.maxCoeff()),
          "height function: the rectangle must be finite and have an area");
  const auto error = [&](double columns, double rows) {
    return function.bounds.chord_error(size[0] / columns, size[1] / rows);
  };
  const GridCounts counts = counts_for(fineness, {1, 1}, error);
  check_count(2 * counts.first * counts.second, fineness);
  Tessellation surface;
  double reach_m = function.low.cwiseAbs().maxCoeff() + function.high.cwiseAbs().maxCoeff();
  const auto columns = static_cast<std::uint32_t>(counts.first);
  for (std::uint32_t row = 0; row <= counts.second; ++row) {
    for (std::uint32_t column = 0; column <= columns; ++column) {
      const double x = function.low[0] + size[0] * (column / counts.first);
      const double y = function.low[1] + size[1] * (row / counts.second);
      const double z = function.height(x, y);
      require(std::isfinite(z), "height function: a height is not finite");
      reach_m = std::max(reach_m, std::abs(z));
      const auto here = static_cast<std::uint32_t>(surface.mesh.vertices.size());
      surface.mesh.vertices.emplace_back(x, y, z);
      if (row == 0 || column == 0) continue;
      const std::uint32_t below = here - columns - 1;
      surface.mesh.triangles.push_back({below - 1, below, here});
      surface.mesh.triangles.push_back({below - 1, here, here - 1});
    }
  }
  surface.off_by_m = with_roundings(error(counts.first, counts.second), reach_m);
  return surface;
}

Tessellation tessellate_patch(const SplinePatch& patch, const Fineness& fineness) {
  const unsigned rows = patch.rows();
  const auto fits = [](unsigned degree, unsigned count) { return degree >= 1 && degree <= 8 && count > degree; };
  require(patch.columns != 0 && patch.points.size() % patch.columns == 0 && fits(patch.first_degree, patch.columns) &&
              fits(patch.second_degree, rows),
          "spline patch: degrees from 1 to 8, and more points than the degree along each parameter");
  double reach_m = 0;
  for (const Vec3& point : patch.points) reach_m = std::max(reach_m, point.cwiseAbs().maxCoeff());
  require(std::isfinite(reach_m), "spline patch: a point is not finite");
  const SecondDerivatives bounds = patch.second_derivatives();
  const auto error = [&](double first, double second) { return bounds.chord_error(1 / first, 1 / second); };
  const GridCounts counts = counts_for(fineness, {1, 1}, error);
  const double across = counts.first * (patch.columns - patch.first_degree);
  const double along = counts.second * (rows - patch.second_degree);
  check_count(2 * across * along, fineness);
  HeightFunction grid{[](double, double) { return 0.0; }, Eigen::Vector2d::Zero(), {across, along}, {}};
  Tessellation surface = tessellate_heights(
      grid, {static_cast<unsigned>(across), static_cast<unsigned>(along), 0, fineness.triangles_at_most});
  for (Vec3& vertex : surface.mesh.vertices) vertex = patch.at(vertex[0] / counts.first, vertex[1] / counts.second);
  surface.off_by_m = with_roundings(error(counts.first, counts.second), reach_m);
  return surface;
}

Vec3 sphere_point(const SphereParameters& at, double radius_m) {
  const double out = radius_m * std::sin(at.colatitude_rad);
  return {out * std::cos(at.longitude_rad), out * std::sin(at.longitude_rad), radius_m * std::cos(at.colatitude_rad)};
}

SphereParameters sphere_parameters(const Vec3& point) {
  const double out = std::hypot(point[0], point[1]);
  if (out == 0) return {0, point[2] < 0 ? pi : 0};
  const double longitude = std::atan2(point[1], point[0]);
  return {longitude < 0 ? std::min(longitude + 2 * pi, std::nextafter(2 * pi, 0)) : longitude,
          std::atan2(out, point[2])};
}

}  // namespace collided::engine
