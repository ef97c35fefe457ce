#include "server/geometry/bounding_volumes.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "server/geometry/expansion.hpp"
#include "server/geometry/guess_tolerance.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine {
namespace {

constexpr double kEndless = std::numeric_limits<double>::infinity();

double ulp_up(double value) { return std::nextafter(value, kEndless); }
double ulp_down(double value) { return std::nextafter(value, -kEndless); }

/// An upper bound on the length of a vector with such components, none below 0. Monotone in each of them.
double length_at_most(const Vec3& sizes) {
  const double largest = sizes.maxCoeff();
  if (largest == 0) return 0;
  const int exponent = std::clamp(std::ilogb(largest), -1000, 1000);
  double square = 0;
  for (const double size : sizes) {
    const double scaled = std::ldexp(size, -exponent);
    square = ulp_up(square + ulp_up(scaled * scaled));
  }
  return ulp_up(std::ldexp(ulp_up(std::sqrt(square)), exponent));
}

/// An upper bound on how far the point is from the centre, along each axis.
Vec3 away_at_most(const Vec3& point, const Vec3& center) {
  Vec3 away;
  for (int axis = 0; axis < 3; ++axis) {
    const double rounded = std::abs(point[axis] - center[axis]);
    away[axis] = rounded == 0 ? 0 : ulp_up(rounded);  // differences of distinct doubles are never rounded to 0
  }
  return away;
}

Vec3 middle_of(const Aabb& box) { return box.low / 2 + box.high / 2; }

/// normal . point in double, and whether that is exact: products with 0, 1 and -1 are; their sum is if it rounds
/// nothing.
struct SupportValue {
  double value;
  bool is_exact;
};

bool is_simple(const Vec3& normal) { return (normal.array() == 0 || normal.array().abs() == 1).all(); }

SupportValue simple_reach(const Vec3& normal, const Vec3& point) {
  double sum = 0;
  bool is_exact = true;
  for (int axis = 0; axis < 3; ++axis) {
    if (normal[axis] == 0) continue;
    const double part = normal[axis] < 0 ? -point[axis] : point[axis];
    const double next = sum + part;
    const double part_in = next - sum;
    is_exact = is_exact && (sum - (next - part_in)) + (part - part_in) == 0;
    sum = next;
  }
  return {sum, is_exact};
}

/// The error of a dot product of three terms, at most five roundings on each.
double reach_error(const Vec3& normal, const Vec3& point) {
  return 6 * kRoundoff * normal.cwiseAbs().dot(point.cwiseAbs()) + kUnderflow;
}

}  // namespace

Aabb bounding_aabb(std::span<const Vec3> points) {
  Aabb box;
  for (const Vec3& point : points) box.extend(point);
  return box;
}

std::vector<Vec3> kdop_normals(int sides) {
  const bool has_corners = sides == 14 || sides == 26;
  const bool has_edges = sides == 18 || sides == 26;
  if (sides != 6 && !has_corners && !has_edges)
    throw std::invalid_argument("k-DOP of " + std::to_string(sides) + " sides; offered are 6, 14, 18 and 26");
  std::vector<Vec3> normals{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  if (has_corners) normals.insert(normals.end(), {{1, 1, 1}, {1, 1, -1}, {1, -1, 1}, {-1, 1, 1}});
  if (has_edges) normals.insert(normals.end(), {{1, 1, 0}, {1, -1, 0}, {1, 0, 1}, {1, 0, -1}, {0, 1, 1}, {0, 1, -1}});
  return normals;
}

Kdop bounding_kdop(std::span<const Vec3> points, const std::vector<Vec3>& normals) {
  Kdop kdop{normals, std::vector<double>(normals.size(), kEndless), std::vector<double>(normals.size(), -kEndless)};
  std::vector<bool> simple;
  for (const Vec3& normal : normals) simple.push_back(is_simple(normal));
  for (const Vec3& point : points) {
    for (std::size_t i = 0; i < normals.size(); ++i) {
      const SupportValue reach =
          simple[i] ? simple_reach(normals[i], point) : SupportValue{normals[i].dot(point), false};
      double low = reach.value;
      double high = reach.value;
      // Keeps bounds that are exact; widens other products by their rounding.
      if (!reach.is_exact) {
        const double error = reach_error(normals[i], point);
        low = ulp_down(reach.value - error);
        high = ulp_up(reach.value + error);
      }
      kdop.low[i] = std::min(kdop.low[i], low);
      kdop.high[i] = std::max(kdop.high[i], high);
      if (!(low <= high)) kdop.low[i] = -kEndless, kdop.high[i] = kEndless;  // out of range: the slab is unbounded
    }
  }
  return kdop;
}

std::optional<bool> contains(const Kdop& kdop, const Vec3& point) {
  for (std::size_t i = 0; i < kdop.normals.size(); ++i) {
    Expansion reach(0);
    for (int axis = 0; axis < 3; ++axis) reach = reach + Expansion(kdop.normals[i][axis]) * Expansion(point[axis]);
    for (const auto& [bound, outside] : {std::pair{kdop.low[i], -1.0}, std::pair{kdop.high[i], 1.0}}) {
      if (std::isinf(bound)) {
        if (bound * outside < 0) return false;
        continue;
      }
      const Expansion beyond = reach - Expansion(bound);
      if (beyond.lost()) return std::nullopt;
      if (beyond.leading() * outside > 0) return false;
    }
  }
  return true;
}

Box bounding_obb(std::span<const Vec3> points) {
  const Aabb aligned = bounding_aabb(points);
  if (aligned.empty()) return {};
  const auto box_along = [&](const Mat3& axes) {
    // {x : axes^T (x - c) in half} would be enough for exact axes. These are off by at most `defect`, so the u of a
    // point err by that share of its distance, and by the roundings of the products.
    const double defect =
        (axes.transpose() * axes - Mat3::Identity()).cwiseAbs().rowwise().sum().maxCoeff() + 16 * kRoundoff;
    Aabb turned;
    for (const Vec3& point : points) turned.extend(Vec3(axes.transpose() * point));
    Box box{axes * middle_of(turned), axes, Vec3::Zero()};
    double farthest = 0;
    for (const Vec3& point : points) {
      const Vec3 away = point - box.center;
      box.half_m = box.half_m.cwiseMax((axes.transpose() * away).cwiseAbs());
      farthest = std::max(farthest, away.cwiseAbs().maxCoeff());
    }
    const double slack = farthest * (8 * defect + 16 * kRoundoff);
    for (double& half : box.half_m) half = ulp_up(ulp_up(half + slack));
    return box;
  };
  const Vec3 center = middle_of(aligned);
  const double scale = std::max(kVanishingSquare, (aligned.high - aligned.low).maxCoeff());
  Mat3 inertia = Mat3::Zero();
  Vec3 mean = Vec3::Zero();
  for (const Vec3& point : points) mean += (point - center) / scale;
  mean /= static_cast<double>(points.size());
  for (const Vec3& point : points) {
    const Vec3 away = (point - center) / scale - mean;
    inertia += away * away.transpose();
  }
  Mat3 axes = Eigen::SelfAdjointEigenSolver<Mat3>(inertia).eigenvectors();
  // Orthogonalise once more: the solver leaves a few roundings too many.
  axes.col(0).normalize();
  axes.col(1) = (axes.col(1) - axes.col(0) * axes.col(0).dot(axes.col(1))).normalized();
  axes.col(2) = axes.col(0).cross(axes.col(1)).normalized();
  const Vec3 plain_half = ((aligned.high - center).cwiseMax(center - aligned.low)).unaryExpr([](double half) {
    return half == 0 ? 0 : ulp_up(half);
  });
  const Box plain{center, Mat3::Identity(), plain_half};
  if (!axes.allFinite()) return plain;
  const Box turned = box_along(axes);
  return volume(turned) < volume(plain) ? turned : plain;
}

Sphere diagonal_sphere(std::span<const Vec3> points) {
  const Aabb box = bounding_aabb(points);
  if (box.empty()) return {Vec3::Zero(), 0};
  const Vec3 center = middle_of(box);
  return {center, length_at_most(away_at_most(box.low, center).cwiseMax(away_at_most(box.high, center)))};
}

Sphere farthest_point_sphere(std::span<const Vec3> points) {
  Sphere sphere = diagonal_sphere(points);
  sphere.radius_m = std::min(sphere.radius_m, sphere_about(points, sphere.center).radius_m);
  return sphere;
}

Sphere sphere_about(std::span<const Vec3> points, const Vec3& center) {
  Sphere sphere{center, 0};
  for (const Vec3& point : points)
    sphere.radius_m = std::max(sphere.radius_m, length_at_most(away_at_most(point, center)));
  return sphere;
}

double volume(const Aabb& box) { return box.empty() ? 0 : (box.high - box.low).prod(); }
double volume(const Box& box) { return 8 * box.half_m.prod(); }
double volume(const Sphere& sphere) {
  return 4 * std::numbers::pi / 3 * sphere.radius_m * sphere.radius_m * sphere.radius_m;
}

}  // namespace collided::engine
