#include "client/draw/drawing/camera.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace collided::draw {
namespace {

constexpr double kMargin = 0.04;  // of the picture, on each side
// The least ratio of a picture's sides, so that a wall seen end-on does not give a picture a few pixels wide.
constexpr double kLeastAspect = 0.3;
constexpr double kMostAspect = 1.4;
/// The default direction to the eye: above and to the right of the front, with z up. Three sides of a box are visible
/// from there, in different shapes.
const Vec3 kUsualSide = Vec3(0.5, -1, 0.75).normalized();
/// Tangent of the largest angle from the axis to a side. An eye in the middle of the scene does not see all of it.
constexpr double kWidestTangent = 1.2;
/// Default distance of the eye, in radii of the scene: near enough for visible perspective, far enough not to distort.
constexpr double kUsualDistance = 3.2;

struct Bounds {
  Vec3 low = Vec3::Zero();
  Vec3 high = Vec3::Zero();
  Vec3 center() const { return (low + high) / 2; }
  double radius_m() const { return (high - low).norm() / 2; }
};

Bounds bounds_of(std::span<const Vec3> points) {
  Bounds bounds{points.front(), points.front()};
  for (const Vec3& p : points) {
    bounds.low = bounds.low.cwiseMin(p);
    bounds.high = bounds.high.cwiseMax(p);
  }
  return bounds;
}

struct ImageFrame {
  double left = INFINITY, right = -INFINITY, low = INFINITY, high = -INFINITY;
  void extend(double x, double y) {
    left = std::min(left, x);
    right = std::max(right, x);
    low = std::min(low, y);
    high = std::max(high, y);
  }
  void limit(double most) {
    left = std::clamp(left, -most, most);
    right = std::clamp(right, -most, most);
    low = std::clamp(low, -most, most);
    high = std::clamp(high, -most, most);
  }
};

/// The picture's direction to the right: at right angles to the axis, with `up` pointing up in the picture.
Vec3 right_of(const Vec3& forward, const Vec3& up) {
  const Vec3 right = forward.cross(up);
  if (right.norm() > 1e-9 * up.norm()) return right.normalized();
  return forward.unitOrthogonal();
}

}  // namespace

Camera Camera::fitted(const View& view, std::span<const Vec3> points) {
  const std::vector<Vec3> one_metre{Vec3::Constant(-0.5), Vec3::Constant(0.5)};
  if (points.empty()) points = one_metre;
  const Bounds bounds = bounds_of(points);
  const double radius_m = std::max(bounds.radius_m(), 1e-12 * (1 + bounds.center().norm()));
  Camera camera;
  const Vec3 at = view.at.value_or(bounds.center());
  const Vec3 side = Quat::FromTwoVectors(Vec3::UnitZ(), view.up) * kUsualSide;
  camera.eye_ = view.from.value_or(at + kUsualDistance * radius_m * side);
  const Vec3 displacement = at - camera.eye_;
  camera.forward_ = displacement.norm() > 0 ? Vec3(displacement.normalized()) : Vec3(-side);
  camera.right_ = right_of(camera.forward_, view.up);
  camera.above_ = camera.right_.cross(camera.forward_);
  camera.is_orthographic_ = view.is_orthographic;
  camera.nearest_m_ = view.is_orthographic ? INFINITY : 1e-4 * radius_m;
  ImageFrame frame;
  for (const Vec3& p : points) {
    const Vec3 q = camera.in_camera(p);
    camera.farthest_m_ = std::max(camera.farthest_m_, q.z());
    if (view.is_orthographic) {
      camera.nearest_m_ = std::min(camera.nearest_m_, q.z());
      frame.extend(q.x(), q.y());
    } else if (q.z() > 0.02 * radius_m) {  // a point next to the eye would make the frame infinite
      frame.extend(q.x() / q.z(), q.y() / q.z());
    }
  }
  if (view.is_orthographic) camera.nearest_m_ -= radius_m;
  if (!(frame.left <= frame.right)) frame = {-1, 1, -0.75, 0.75};
  if (!view.is_orthographic) frame.limit(kWidestTangent);
  if (view.field_of_view_rad && !view.is_orthographic) {
    const double half = std::tan(*view.field_of_view_rad / 2);
    frame = {-half, half, -0.75 * half, 0.75 * half};
  }
  const double width = std::max(frame.right - frame.left, 1e-9 * (1 + std::abs(frame.left)));
  const double height =
      std::clamp(frame.high - frame.low, kLeastAspect * width, kMostAspect * std::max(width, frame.high - frame.low));
  const double shown_width = std::max(width, height / kMostAspect);
  camera.width_px_ = view.width_px;
  camera.pixels_per_unit_ = view.width_px * (1 - 2 * kMargin) / shown_width;
  camera.height_px_ = std::ceil(height * camera.pixels_per_unit_ + 2 * kMargin * view.width_px);
  camera.left_ = (frame.left + frame.right) / 2 - camera.width_px_ / camera.pixels_per_unit_ / 2;
  camera.top_ = (frame.low + frame.high) / 2 + camera.height_px_ / camera.pixels_per_unit_ / 2;
  return camera;
}

Vec3 Camera::in_camera(const Vec3& point) const {
  const Vec3 displacement = point - eye_;
  return {right_.dot(displacement), above_.dot(displacement), forward_.dot(displacement)};
}

ImagePoint Camera::project(const Vec3& point) const {
  const Vec3 q = in_camera(point);
  const double shrink = is_orthographic_ ? 1 : 1 / q.z();
  return {(q.x() * shrink - left_) * pixels_per_unit_, (top_ - q.y() * shrink) * pixels_per_unit_, q.z()};
}

Vec3 Camera::toward_eye(const Vec3& point) const {
  return is_orthographic_ ? Vec3(-forward_) : Vec3((eye_ - point).normalized());
}

double Camera::pixel_m(const Vec3& point) const {
  return (is_orthographic_ ? 1 : std::max(in_camera(point).z(), nearest_m_)) / pixels_per_unit_;
}

RayQuestion Camera::through(double x, double y) const {
  const double u = left_ + x / pixels_per_unit_;
  const double v = top_ - y / pixels_per_unit_;
  if (is_orthographic_) {
    return {.origin = eye_ + u * right_ + v * above_ + nearest_m_ * forward_, .direction = forward_};
  }
  return {.origin = eye_, .direction = forward_ + u * right_ + v * above_};
}

RayQuestion Camera::sight(const Vec3& point, double bias_m) const {
  const Vec3 toward = toward_eye(point);
  const double whole_m = is_orthographic_ ? in_camera(point).z() - nearest_m_ : (eye_ - point).norm();
  return {.origin = point + bias_m * toward, .direction = toward, .length_m = std::max(0.0, whole_m - bias_m)};
}

std::optional<std::pair<double, double>> Camera::clip(const Vec3& a, const Vec3& b) const {
  const Vec3 p = in_camera(a);
  const Vec3 q = in_camera(b);
  const double right = left_ + width_px_ / pixels_per_unit_;
  const double bottom = top_ - height_px_ / pixels_per_unit_;
  double from = 0;
  double to = 1;
  // Each side of the frustum is a linear function that is 0 or more inside.
  const auto side = [&](double at_a, double at_b) {
    if (at_a < 0 && at_b < 0) to = -1;
    if (at_a < 0 && at_b >= 0) from = std::max(from, at_a / (at_a - at_b));
    if (at_a >= 0 && at_b < 0) to = std::min(to, at_a / (at_a - at_b));
  };
  const auto depth = [&](const Vec3& v) { return is_orthographic_ ? 1 : v.z(); };
  if (!is_orthographic_) side(p.z() - nearest_m_, q.z() - nearest_m_);
  side(p.x() - left_ * depth(p), q.x() - left_ * depth(q));
  side(right * depth(p) - p.x(), right * depth(q) - q.x());
  side(top_ * depth(p) - p.y(), top_ * depth(q) - q.y());
  side(p.y() - bottom * depth(p), q.y() - bottom * depth(q));
  if (from >= to) return std::nullopt;
  return std::pair(from, to);
}

Vec3 Camera::at_image_fraction(const Vec3& a, const Vec3& b, double a_depth_m, double b_depth_m, double fraction) {
  // Along an image the inverse depth is linear. For a parallel projection both depths are given as 1.
  const double t = fraction * a_depth_m / (b_depth_m + fraction * (a_depth_m - b_depth_m));
  return a + t * (b - a);
}

}  // namespace collided::draw
