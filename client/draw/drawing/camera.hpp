#pragma once

#include <optional>
#include <span>
#include <utility>

#include <collided/client.hpp>

namespace collided::draw {

/// How the user wants to see the scene. Empty values are chosen to fit the points of the scene.
struct View {
  std::optional<Vec3> from{};
  std::optional<Vec3> at{};
  Vec3 up = Vec3::UnitZ();
  bool is_orthographic = false;
  std::optional<double> field_of_view_rad{};  // across the picture's width; none: as much as the scene needs
  double width_px = 1200;
};

/// A point of the picture in pixels, y downward, with the depth along the camera's axis.
struct ImagePoint {
  double x = 0;
  double y = 0;
  double depth_m = 0;
};

/// A perspective or parallel projection from the world to the picture. All in double. Immutable, so any thread may use
/// it.
class Camera {
 public:
  /// A camera for a view.
  /// points  that must be in the picture, finite; those behind the eye are ignored. Without any, a metre about the
  ///         origin is shown
  static Camera fitted(const View& view, std::span<const Vec3> points);

  double width_px() const { return width_px_; }
  double height_px() const { return height_px_; }
  const Vec3& eye() const { return eye_; }
  bool is_orthographic() const { return is_orthographic_; }
  const Vec3& right() const { return right_; }
  const Vec3& above() const { return above_; }
  const Vec3& forward() const { return forward_; }

  /// The image of a point, which must be in front of the eye (depth_m > 0) unless the projection is parallel.
  ImagePoint project(const Vec3& point) const;
  /// The unit vector from a point to the eye.
  Vec3 toward_eye(const Vec3& point) const;
  /// The size of a pixel at that point, in metres.
  double pixel_m(const Vec3& point) const;
  /// The ray through a place of the picture. It begins at the eye or, for a parallel projection, at a plane in front of
  /// everything.
  RayQuestion through(double x, double y) const;
  /// The ray from bias_m in front of a point to the eye. The point is visible if it hits nothing.
  RayQuestion sight(const Vec3& point, double bias_m) const;
  /// The part of a segment that is in the picture, as fractions of its length in space; nothing: no part.
  std::optional<std::pair<double, double>> clip(const Vec3& a, const Vec3& b) const;
  /// The point of a segment that appears at this fraction of its image. Both depths must be above 0.
  static Vec3 at_image_fraction(const Vec3& a, const Vec3& b, double a_depth_m, double b_depth_m, double fraction);

 private:
  Vec3 in_camera(const Vec3& point) const;  // right, above, forward

  Vec3 eye_ = Vec3::Zero();
  Vec3 right_ = Vec3::UnitX();
  Vec3 above_ = Vec3::UnitZ();
  Vec3 forward_ = Vec3::UnitY();
  bool is_orthographic_ = false;
  double width_px_ = 0;
  double height_px_ = 0;
  // The picture's frame: on the plane at distance 1, or in metres.
  double left_ = 0;
  double top_ = 0;
  double pixels_per_unit_ = 1;
  double nearest_m_ = 0;   // nothing nearer is drawn; for a parallel projection, where rays begin
  double farthest_m_ = 0;  // depth of the farthest fitted point
};

}  // namespace collided::draw
