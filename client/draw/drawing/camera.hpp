#pragma once

#include <optional>
#include <span>
#include <utility>

#include <collided/client.hpp>

namespace collided::draw {

/// How the user wants to see; what is left out is fitted to the points that are to be seen.
struct View {
  std::optional<Vec3> from{};
  std::optional<Vec3> at{};
  Vec3 up = Vec3::UnitZ();
  bool is_orthographic = false;
  std::optional<double> field_of_view_rad{};  // of the picture's width; none: just so that everything is in it
  double width_px = 1200;
};

/// A picture's coordinates, y downward, and how far away along the camera's axis.
struct ImagePoint {
  double x = 0;
  double y = 0;
  double depth_m = 0;
};

/// A pinhole with the picture on a plane before it, or a parallel projection. All in double; immutable.
class Camera {
 public:
  /// points  what is to be in the picture, finite; with none of them a metre about the origin is. Those behind the eye
  ///         are left out.
  static Camera fitted(const View& view, std::span<const Vec3> points);

  double width_px() const { return width_px_; }
  double height_px() const { return height_px_; }
  const Vec3& eye() const { return eye_; }
  bool is_orthographic() const { return is_orthographic_; }
  const Vec3& right() const { return right_; }
  const Vec3& above() const { return above_; }
  const Vec3& forward() const { return forward_; }

  /// Before the eye only: depth_m > 0 unless the projection is parallel.
  ImagePoint project(const Vec3& point) const;
  /// Unit vector to the eye.
  Vec3 toward_eye(const Vec3& point) const;
  /// How long a pixel is at that point.
  double pixel_m(const Vec3& point) const;
  /// What is seen at a place of the picture, from the eye or from a plane before everything.
  RayQuestion through(double x, double y) const;
  /// From bias_m before the point to the eye: the point is seen where this meets nothing.
  RayQuestion sight(const Vec3& point, double bias_m) const;
  /// The share of a segment that is in the picture, as fractions of it in space; nothing: none is.
  std::optional<std::pair<double, double>> clip(const Vec3& a, const Vec3& b) const;
  /// The point of a segment (of both depths above 0) that is drawn at this fraction of its image.
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
  double nearest_m_ = 0;   // what is nearer is not drawn; parallel: where rays begin
  double farthest_m_ = 0;  // of what was fitted
};

}  // namespace collided::draw
