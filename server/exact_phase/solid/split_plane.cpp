#include "server/exact_phase/solid/split_plane.hpp"

namespace collided::engine {
namespace {

using kernel::Vector;

template <class N>
Vector<N> normal_of(const Triangle& t) {
  const Vector<N> a(t.a);
  return cross(Vector<N>(t.b) - a, Vector<N>(t.c) - a);
}

/// Rounding of three products, three sums and a difference, including that of the bound itself; relative to the sum of
/// the products' magnitudes.
constexpr double kHeightError = 8 * kRoundoff;

}  // namespace

SplitPlane plane_of_triangle(const TriangleMesh& mesh, std::uint32_t triangle, const Aabb& within) {
  const Triangle corners = mesh.triangle(triangle);
  const Vector<Bounded> normal = normal_of<Bounded>(corners);
  const Bounded offset = dot(normal, Vector<Bounded>(corners.a));
  const Vec3 reach = within.low.cwiseAbs().cwiseMax(within.high.cwiseAbs());
  SplitPlane plane;
  plane.normal = {normal.x.value, normal.y.value, normal.z.value};
  plane.offset = offset.value;
  plane.triangle = triangle;
  const Vec3 unsure(normal.x.bound(), normal.y.bound(), normal.z.bound());
  plane.normal_error = unsure.sum() * (1 + kBoundSlack);
  plane.error = (unsure.dot(reach) + offset.bound() +
                 kHeightError * (plane.normal.cwiseAbs().dot(reach) + std::abs(plane.offset)) + kUnderflow) *
                (1 + kBoundSlack);
  return plane;
}

SplitPlane plane_across(int axis, double at) {
  SplitPlane plane;
  plane.normal[axis] = 1;
  plane.offset = at;
  plane.triangle = SplitPlane::kAcross + static_cast<std::uint32_t>(axis);
  return plane;
}

int SplitPlane::quick_side(const Vec3& at, double error_m) const {
  if (is_across()) {
    const double height_m = at[axis()] - offset;
    return height_m > error_m ? 1 : height_m < -error_m ? -1 : 0;
  }
  const double height = normal.dot(at) - offset;
  // The plane's error holds for the true point; `at` may be off by its own error.
  const double off = (normal.lpNorm<1>() + 2 * normal_error) * error_m;
  const double bound = (error + off) * (1 + kBoundSlack);
  return height > bound ? 1 : height < -bound ? -1 : 0;
}

template <class N>
PlaneIn<N>::PlaneIn(const TriangleMesh& mesh, const SplitPlane& plane) {
  if (plane.is_across()) {
    normal = Vector<N>(plane.normal);
    offset = plane.offset;
    return;
  }
  const Triangle corners = mesh.triangle(plane.triangle);
  normal = normal_of<N>(corners);
  offset = dot(normal, Vector<N>(corners.a));
}

template struct PlaneIn<Dyadic>;
template struct PlaneIn<Bounded>;

}  // namespace collided::engine
