#include "server/exact_phase/solid/fragments.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

#include "server/geometry/orientation.hpp"

namespace collided::engine {
namespace {

using kernel::Vector;
using BoundedPoint = Vector<Bounded>;

constexpr double kUnknown = std::numeric_limits<double>::infinity();

/// The double nearest the quotient, or an adjacent one.
double quotient(const Dyadic& over, const Dyadic& under) {
  const auto [fraction, power] = over.split();
  const auto [divisor, divisor_power] = under.split();
  return std::ldexp(fraction / divisor, static_cast<int>(std::clamp(power - divisor_power, -2000L, 2000L)));
}

}  // namespace

Fragments::Fragments(const TriangleMesh& mesh, const Aabb& bounds)
    : mesh_(mesh), bounds_(bounds), shared_(mesh.triangles.size()), plane_number_(mesh.triangles.size(), kNone) {
  std::iota(shared_.begin(), shared_.end(), 0u);
}

std::uint32_t Fragments::add(std::uint32_t triangle) {
  const TriangleCorners& own = mesh_.triangles[triangle];
  std::array<FragmentCorner, 3> corners;
  for (std::size_t k = 0; k < 3; ++k) {
    corners[k].at = mesh_.vertices[own[k]];
    corners[k].vertex = own[k];
    corners[k].next = {.u = own[k], .v = own[(k + 1) % 3], .plane = kNone};
  }
  return push(triangle, corners);
}

std::uint32_t Fragments::push(std::uint32_t triangle, std::span<const FragmentCorner> corners) {
  pieces_.push_back(
      {triangle, static_cast<std::uint32_t>(corners_.size()), static_cast<std::uint32_t>(corners.size())});
  corners_.insert(corners_.end(), corners.begin(), corners.end());
  return static_cast<std::uint32_t>(pieces_.size() - 1);
}

Aabb Fragments::roughly(std::uint32_t fragment) const {
  Aabb box;
  for (const FragmentCorner& corner : corners_of(pieces_[fragment])) box.extend(corner.at);
  return box;
}

Vec3 Fragments::ExactCorner::rounded() const {
  return {quotient(x.x, weight), quotient(x.y, weight), quotient(x.z, weight)};
}

void Fragments::outline(std::uint32_t fragment, std::vector<Vec3>& corners) {
  const FragmentRun piece = pieces_[fragment];
  for (std::uint32_t i = 0; i < piece.count; ++i) {
    const FragmentCorner& corner = corners_[piece.first + i];
    const bool is_near = corner.vertex != kNone || corner.error_m <= 8 * kRoundoff * corner.at.cwiseAbs().maxCoeff();
    corners.push_back(is_near ? corner.at : exact(piece, corner).rounded());
  }
}

std::uint32_t Fragments::root_of(std::uint32_t triangle) {
  while (shared_[triangle] != triangle) triangle = shared_[triangle] = shared_[shared_[triangle]];
  return triangle;
}

void Fragments::share_plane(std::uint32_t triangle, std::uint32_t with) { shared_[root_of(triangle)] = root_of(with); }

std::uint32_t Fragments::plane_of(std::uint32_t triangle) {
  const std::uint32_t root = root_of(triangle);
  if (plane_number_[root] == kNone) {
    plane_number_[root] = static_cast<std::uint32_t>(planes_.size());
    planes_.push_back({plane_of_triangle(mesh_, root, bounds_), &mesh_});
  }
  return plane_number_[root];
}

std::uint32_t Fragments::plane_across(int axis, double at) {
  planes_.push_back({engine::plane_across(axis, at), &mesh_});
  return static_cast<std::uint32_t>(planes_.size() - 1);
}

std::uint32_t Fragments::plane_of_other(const TriangleMesh& other, const SplitPlane& plane) {
  // The filter's error is that for the pieces' own bounds.
  planes_.push_back({plane.is_across() ? plane : plane_of_triangle(other, plane.triangle, bounds_), &other});
  return static_cast<std::uint32_t>(planes_.size() - 1);
}

bool Fragments::is_in_plane(const FragmentCorner& corner, std::uint32_t plane) const {
  if (corner.cut == plane || (corner.vertex == kNone && corner.border.plane == plane)) return true;
  const SplitPlane& given = planes_[plane].split;
  if (given.is_across()) return corner.vertex != kNone && mesh_.vertices[corner.vertex][given.axis()] == given.offset;
  if (planes_[plane].of != &mesh_) return false;
  const TriangleCorners& own = mesh_.triangles[given.triangle];
  const auto has = [&](std::uint32_t vertex) { return own[0] == vertex || own[1] == vertex || own[2] == vertex; };
  if (corner.vertex != kNone) return has(corner.vertex);
  return corner.border.u != kNone && has(corner.border.u) && has(corner.border.v);
}

Fragments::ExactCorner Fragments::exact(const FragmentRun& piece, const FragmentCorner& corner) {
  if (corner.vertex != kNone) return {Vector<Dyadic>(mesh_.vertices[corner.vertex]), 1.0};
  const ExactPlane cut = planes_[corner.cut].exact();
  if (corner.border.u != kNone) {
    const Vec3& u = mesh_.vertices[corner.border.u];
    const Vec3& v = mesh_.vertices[corner.border.v];
    const Dyadic height_u = cut.height(u);
    const Dyadic height_v = cut.height(v);
    return {height_u * Vector<Dyadic>(v) - height_v * Vector<Dyadic>(u), height_u - height_v};
  }
  const ExactPlane own = planes_[plane_of(piece.triangle)].exact();
  const ExactPlane border = planes_[corner.border.plane].exact();
  // Cramer's rule for the point of three planes.
  const Vector<Dyadic> across = cross(border.normal, cut.normal);
  return {own.offset * across + border.offset * cross(cut.normal, own.normal) +
              cut.offset * cross(own.normal, border.normal),
          dot(own.normal, across)};
}

int Fragments::side(const FragmentRun& piece, const FragmentCorner& corner, std::uint32_t plane) {
  if (is_in_plane(corner, plane)) return 0;
  const SplitPlane& given = planes_[plane].split;
  const int quick = given.quick_side(corner.at, corner.error_m);
  if (quick != 0) return quick;
  if (corner.vertex != kNone && !given.is_across()) {
    const Triangle t = planes_[plane].of->triangle(given.triangle);
    if (const auto known = orientation(t.a, t.b, t.c, mesh_.vertices[corner.vertex])) return *known;
  }
  const ExactCorner at = exact(piece, corner);
  const ExactPlane against = planes_[plane].exact();
  const int sign = (dot(against.normal, at.x) - against.offset * at.weight).sign();
  return at.weight.sign() < 0 ? -sign : sign;
}

Fragments::FragmentSides Fragments::sides(std::uint32_t fragment, std::uint32_t plane) {
  const FragmentRun piece = pieces_[fragment];
  side_of_corner_.assign(piece.count, 0);
  if (plane_of(piece.triangle) == plane) return {};
  FragmentSides found;
  for (std::uint32_t i = 0; i < piece.count; ++i) {
    const int at = side(piece, corners_[piece.first + i], plane);
    side_of_corner_[i] = static_cast<std::int8_t>(at);
    found.front = found.front || at > 0;
    found.back = found.back || at < 0;
  }
  return found;
}

Fragments::FragmentSides Fragments::rough_sides(std::uint32_t fragment, std::uint32_t plane) const {
  FragmentSides found;
  for (const FragmentCorner& corner : corners_of(pieces_[fragment])) {
    const int at = is_in_plane(corner, plane) ? 0 : planes_[plane].split.quick_side(corner.at, corner.error_m);
    found.front = found.front || at > 0;
    found.back = found.back || at < 0;
  }
  return found;
}

/// Computes the corner's doubles from its definition, not from other rounded corners, so that errors do not accumulate.
void Fragments::locate(const FragmentRun& piece, FragmentCorner& corner) {
  const auto bounded = [&](std::uint32_t plane) { return BoundedPlane(*planes_[plane].of, planes_[plane].split); };
  const BoundedPlane cut = bounded(corner.cut);
  BoundedPoint x;
  Bounded weight;
  if (corner.border.u != kNone) {
    const BoundedPoint u(mesh_.vertices[corner.border.u]);
    const BoundedPoint v(mesh_.vertices[corner.border.v]);
    const Bounded height_u = dot(cut.normal, u) - cut.offset;
    const Bounded height_v = dot(cut.normal, v) - cut.offset;
    x = height_u * v - height_v * u;
    weight = height_u - height_v;
  } else {
    const BoundedPlane own = bounded(plane_of(piece.triangle));
    const BoundedPlane border = bounded(corner.border.plane);
    const BoundedPoint across = cross(border.normal, cut.normal);
    x = own.offset * across + border.offset * cross(cut.normal, own.normal) +
        cut.offset * cross(own.normal, border.normal);
    weight = dot(own.normal, across);
  }
  const Bounded coordinates[3] = {x.x / weight, x.y / weight, x.z / weight};
  corner.error_m = 0;
  for (int axis = 0; axis < 3; ++axis) {
    corner.at[axis] = coordinates[axis].value;
    corner.error_m = std::max(corner.error_m, coordinates[axis].bound());
  }
  if (corner.at.allFinite() && std::isfinite(corner.error_m)) return;
  corner.at.setZero();
  corner.error_m = kUnknown;
}

/// The corner at which the side that begins at `from` meets the plane.
Fragments::FragmentCorner Fragments::corner_between(const FragmentRun& piece, const FragmentCorner& from,
                                                    std::uint32_t plane) {
  FragmentCorner corner;
  corner.cut = plane;
  corner.border = from.next;
  locate(piece, corner);
  return corner;
}

Fragments::Halves Fragments::cut(std::uint32_t fragment, std::uint32_t plane) {
  [[maybe_unused]] const FragmentSides both = sides(fragment, plane);
  assert(both.front && both.back && "only a piece with points on both sides is cut");
  const FragmentRun piece = pieces_[fragment];
  const FragmentBorder along{.u = kNone, .v = kNone, .plane = plane};
  front_.clear();
  back_.clear();
  // Puts a corner into one half; if the piece leaves that half after the corner, the half's border follows the plane
  // from there.
  const auto keep = [&](std::vector<FragmentCorner>& half, FragmentCorner corner, bool leaves) {
    if (leaves) corner.next = along;
    half.push_back(corner);
  };
  for (std::uint32_t i = 0; i < piece.count; ++i) {
    const FragmentCorner corner = corners_[piece.first + i];
    const int here = side_of_corner_[i];
    const int then = side_of_corner_[i + 1 == piece.count ? 0 : i + 1];
    if (here >= 0) keep(front_, corner, here == 0 && then < 0);
    if (here <= 0) keep(back_, corner, here == 0 && then > 0);
    if (here * then >= 0) continue;
    FragmentCorner between = corner_between(piece, corner, plane);
    between.next = corner.next;
    keep(front_, between, here > 0);
    keep(back_, between, here < 0);
  }
  const std::uint32_t front = push(piece.triangle, front_);
  return {front, push(piece.triangle, back_)};
}

}  // namespace collided::engine
