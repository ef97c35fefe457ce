#include "tests/drawing/methods/back_faces.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

namespace collided::drawing_test {
namespace {

/// Neighbours in the picture may round differently: as much as this share of its depth is the same depth.
constexpr double kSameDepth = 1e-9;

struct Plane {
  Vec3 point;
  Vec3 normal;
  /// Along the camera's axis, where the ray through a place of the picture meets the plane.
  double depth_m(const draw::Camera& camera, double x, double y) const {
    const RayQuestion ray = camera.through(x, y);
    const double t = normal.dot(point - ray.origin) / normal.dot(ray.direction);
    return camera.forward().dot(ray.origin + t * ray.direction - camera.eye());
  }
};

using Place = std::array<double, 2>;

/// Calls for the middle of every pixel in a convex polygon of the picture, its corners in either order.
void for_pixels(const std::vector<Place>& corners, const Buffers& front, const std::function<void(int, int)>& use) {
  double area = 0;
  Place low = corners[0], high = corners[0];
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Place& a = corners[i];
    const Place& b = corners[(i + 1) % corners.size()];
    area += a[0] * b[1] - a[1] * b[0];
    for (std::size_t k = 0; k < 2; ++k) {
      low[k] = std::min(low[k], a[k]);
      high[k] = std::max(high[k], a[k]);
    }
  }
  const double turn = area < 0 ? -1 : 1;
  for (int y = std::max(0, static_cast<int>(low[1])); y <= std::min(front.height - 1, static_cast<int>(high[1])); ++y) {
    for (int x = std::max(0, static_cast<int>(low[0])); x <= std::min(front.width - 1, static_cast<int>(high[0]));
         ++x) {
      bool is_inside = true;
      for (std::size_t i = 0; i < corners.size() && is_inside; ++i) {
        const Place& a = corners[i];
        const Place& b = corners[(i + 1) % corners.size()];
        is_inside = turn * ((b[0] - a[0]) * (y + 0.5 - a[1]) - (b[1] - a[1]) * (x + 0.5 - a[0])) >= 0;
      }
      if (is_inside) use(x, y);
    }
  }
}

Place place(const draw::Camera& camera, const Vec3& p) {
  const draw::ImagePoint image = camera.project(p);
  return {image.x, image.y};
}

void for_back_faces(const Polygons& polygons, const draw::Camera& camera,
                    const std::function<void(const std::array<Vec3, 3>&, const Plane&)>& use) {
  for (const auto& [a, b, c] : polygons.triangles) {
    const auto& v = polygons.vertices;
    if (draw::faces_eye(v[a], v[b], v[c], camera.eye())) continue;
    const Vec3 normal = (v[b] - v[a]).cross(v[c] - v[a]);
    if (normal.norm() > 0) use({v[a], v[b], v[c]}, {v[a], normal.normalized()});
  }
}

double biased(double depth_m, double slope_m, Bias bias, double amount) {
  switch (bias) {
    case Bias::fixed: return depth_m - amount;
    case Bias::non_linear: return 1 / (1 / depth_m + amount);
    case Bias::by_angle: break;
  }
  return depth_m - amount * slope_m;
}

}  // namespace

Mask biased_back_faces(const Polygons& polygons, const draw::Camera& camera, const Buffers& front, Bias bias,
                       double amount) {
  Mask mask(front.width, front.height);
  for_back_faces(polygons, camera, [&](const std::array<Vec3, 3>& corners, const Plane& plane) {
    for_pixels({place(camera, corners[0]), place(camera, corners[1]), place(camera, corners[2])}, front,
               [&](int x, int y) {
                 const double depth_m = plane.depth_m(camera, x + 0.5, y + 0.5);
                 const double slope_m = std::max(std::abs(plane.depth_m(camera, x + 1.5, y + 0.5) - depth_m),
                                                 std::abs(plane.depth_m(camera, x + 0.5, y + 1.5) - depth_m));
                 if (biased(depth_m, slope_m, bias, amount) <= front.depth_m[front.index(x, y)])
                   mask.black[front.index(x, y)] = 1;
               });
  });
  return mask;
}

Mask fattened_back_faces(const Polygons& polygons, const draw::Camera& camera, const Buffers& front, double width_px) {
  Mask mask(front.width, front.height);
  for_back_faces(polygons, camera, [&](const std::array<Vec3, 3>& corners, const Plane& plane) {
    std::array<Place, 3> p{place(camera, corners[0]), place(camera, corners[1]), place(camera, corners[2])};
    const double area = (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[1][1] - p[0][1]) * (p[2][0] - p[0][0]);
    if (area < 0) std::swap(p[1], p[2]);
    std::vector<Place> grown;
    for (std::size_t i = 0; i < 3; ++i) {
      // Where the two sides at this corner meet once each was moved outward.
      const Place &before = p[(i + 2) % 3], &at = p[i], &after = p[(i + 1) % 3];
      const double in = std::hypot(at[0] - before[0], at[1] - before[1]);
      const double out = std::hypot(after[0] - at[0], after[1] - at[1]);
      const Place u{(at[0] - before[0]) / in, (at[1] - before[1]) / in};
      const Place v{(after[0] - at[0]) / out, (after[1] - at[1]) / out};
      const double sine = u[0] * v[1] - u[1] * v[0];
      if (!(in > 0 && out > 0 && sine > 1e-6)) return;
      grown.push_back({at[0] + width_px * (u[0] - v[0]) / sine, at[1] + width_px * (u[1] - v[1]) / sine});
    }
    for_pixels(grown, front, [&](int x, int y) {
      const double depth_m = plane.depth_m(camera, x + 0.5, y + 0.5);
      const double front_m = front.depth_m[front.index(x, y)];
      if (std::isinf(front_m) || (depth_m > 0 && depth_m < front_m * (1 - kSameDepth)))
        mask.black[front.index(x, y)] = 1;
    });
  });
  return mask;
}

Mask expanded_shell(const Polygons& polygons, const std::vector<Vec3>& normals, double distance_m,
                    const draw::Camera& camera, const Buffers& front) {
  Polygons shell = polygons;
  for (std::size_t i = 0; i < shell.vertices.size(); ++i) shell.vertices[i] += distance_m * normals[i];
  return biased_back_faces(shell, camera, front, Bias::fixed, 0);
}

std::vector<Vec3> flat_normals(const Polygons& polygons) {
  std::vector<Vec3> normals(polygons.vertices.size(), Vec3::Zero());
  for (const auto& [a, b, c] : polygons.triangles) {
    const auto& v = polygons.vertices;
    for (const std::uint32_t corner : {a, b, c}) normals[corner] = (v[b] - v[a]).cross(v[c] - v[a]).normalized();
  }
  return normals;
}

std::vector<Vec3> smooth_normals(const Polygons& polygons) {
  std::map<std::array<double, 3>, Vec3> sums;
  const std::vector<Vec3> flat = flat_normals(polygons);
  const auto key = [&](std::size_t i) {
    const Vec3& v = polygons.vertices[i];
    return std::array<double, 3>{v.x(), v.y(), v.z()};
  };
  for (std::size_t i = 0; i < flat.size(); ++i) {
    const auto [sum, is_new] = sums.try_emplace(key(i), Vec3::Zero());
    sum->second += flat[i];
  }
  std::vector<Vec3> normals;
  for (std::size_t i = 0; i < flat.size(); ++i) normals.push_back(sums.at(key(i)).normalized());
  return normals;
}

}  // namespace collided::drawing_test
