#include "tests/studies/homework/scene_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "client/draw/svg.hpp"

namespace collided::homework {
namespace {

constexpr double kWidth = 860, kHeight = 760;
constexpr double kEyeDistance = 3.2;  // in sides of the cube
constexpr double kZoom = 1350;        // pixels, for a length of 1 at a distance of 1

/// A pinhole camera that looks at the cube's centre.
class Camera {
 public:
  explicit Camera(double side_m) : eye_(side_m * kEyeDistance * Vec3(0.62, -0.68, 0.40).normalized()) {
    forward_ = -eye_.normalized();
    right_ = forward_.cross(Vec3::UnitZ()).normalized();
    up_ = right_.cross(forward_);
  }
  std::pair<double, double> pixel(const Vec3& p) const {
    const Vec3 away = p - eye_;
    const double scale = kZoom / away.dot(forward_);
    return {kWidth / 2 + scale * away.dot(right_), kHeight / 2 - 5 - scale * away.dot(up_)};
  }
  double distance(const Vec3& p) const { return (p - eye_).norm(); }
  const Vec3& eye() const { return eye_; }

 private:
  Vec3 eye_, forward_, right_, up_;
};

struct Facet {
  double distance;
  std::vector<std::pair<double, double>> corners;
  std::string color;
};

std::string shaded(bool touches, double light) {
  const std::array<double, 3> full =
      touches ? std::array<double, 3>{232, 92, 30} : std::array<double, 3>{120, 150, 178};
  char text[8];
  const double shade = 0.35 + 0.65 * std::clamp(light, 0.0, 1.0);
  std::snprintf(text, sizeof text, "#%02x%02x%02x", static_cast<unsigned>(full[0] * shade),
                static_cast<unsigned>(full[1] * shade), static_cast<unsigned>(full[2] * shade));
  return text;
}

void add_facets(const DrawnSphere& sphere, const Camera& camera, std::vector<Facet>& facets) {
  const Vec3 light = Vec3(0.3, -0.5, 0.9).normalized();
  std::vector<Vec3> vertices;
  for (const Vec3& vertex : sphere.mesh.vertices)
    vertices.push_back(sphere.pose.rotation * vertex + sphere.pose.position);
  for (const auto& t : sphere.mesh.triangles) {
    const Vec3 &a = vertices[t[0]], &b = vertices[t[1]], &c = vertices[t[2]];
    const Vec3 normal = (b - a).cross(c - a).normalized();
    const Vec3 middle = (a + b + c) / 3;
    if (normal.dot(camera.eye() - middle) <= 0) continue;
    facets.push_back({camera.distance(middle),
                      {camera.pixel(a), camera.pixel(b), camera.pixel(c)},
                      shaded(sphere.touches, normal.dot(light))});
  }
}

void draw_edges(draw::Canvas& canvas, const Camera& camera, double half_m, bool front) {
  for (unsigned from = 0; from < 8; ++from) {
    for (unsigned bit = 1; bit < 8; bit *= 2) {
      if ((from & bit) != 0) continue;
      const auto corner = [&](unsigned i) -> Vec3 {
        return half_m * Vec3((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1);
      };
      // The farthest corner is (-1, 1, -1): its three edges are behind everything.
      const bool is_back = from == 2 || (from | bit) == 2 || (from == 0 && bit == 2) || (from == 2 && bit != 2);
      if (is_back == front) continue;
      const auto [x0, y0] = camera.pixel(corner(from));
      const auto [x1, y1] = camera.pixel(corner(from | bit));
      canvas.line(x0, y0, x1, y1, front ? draw::kInk : draw::kQuiet, front ? 1.2 : 0.8, front ? nullptr : "5 4");
    }
  }
}

}  // namespace

std::string scene_picture(const std::string& title, double side_m, const std::vector<DrawnSphere>& spheres,
                          const std::vector<DrawnContact>& contacts) {
  draw::Canvas canvas(kWidth, kHeight, title);
  draw::draw_title(canvas, title);
  const Camera camera(side_m);
  draw_edges(canvas, camera, side_m / 2, false);
  std::vector<Facet> facets;
  for (const DrawnSphere& sphere : spheres) add_facets(sphere, camera, facets);
  std::sort(facets.begin(), facets.end(), [](const Facet& p, const Facet& q) { return p.distance > q.distance; });
  for (const Facet& facet : facets) canvas.polygon(facet.corners, facet.color);
  draw_edges(canvas, camera, side_m / 2, true);
  for (const DrawnContact& contact : contacts) {
    const auto [x0, y0] = camera.pixel(contact.point - 0.08 * side_m * contact.normal);
    const auto [x1, y1] = camera.pixel(contact.point + 0.08 * side_m * contact.normal);
    canvas.line(x0, y0, x1, y1, draw::kInk, 2);
    const auto [x, y] = camera.pixel(contact.point);
    canvas.mark(x, y, 0, draw::kInk, true);
  }
  return std::move(canvas).finish();
}

}  // namespace collided::homework
