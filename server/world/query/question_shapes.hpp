#pragma once

#include "server/geometry/pose.hpp"
#include "server/geometry/ray.hpp"
#include "server/geometry/shapes.hpp"
#include "server/world/objects/contact_search.hpp"

namespace collided::engine {

// Turns a question's numbers (as Questions::numbers, already validated) into the shape that they describe.

inline Vec3 point_of(const double* n) { return {n[0], n[1], n[2]}; }

inline Ray ray_of(const double* n) {
  return {.origin = point_of(n), .direction = {n[3], n[4], n[5]}, .length_m = n[6]};
}

inline Sphere sphere_of(const double* n) { return {.center = point_of(n), .radius_m = n[3]}; }

inline Pose box_pose_of(const double* n) { return {.position = point_of(n), .rotation = Quat(n[6], n[7], n[8], n[9])}; }
/// The box of a question, as placed and as given.
class BoxQuestionShape {
 public:
  explicit BoxQuestionShape(const double* n)
      : pose_(box_pose_of(n)),
        frame_(frame_of(pose_)),
        own_(Box{.center = Vec3::Zero(), .half_m = {n[3], n[4], n[5]}}) {}

  Box placed() const {
    return {.center = pose_.position, .axes = frame_.rotation, .half_m = std::get<Box>(own_).half_m};
  }
  /// The result refers to this object.
  GivenPart given() const { return {.own = &own_, .pose = &pose_, .frame = &frame_}; }
  Aabb bounds() const { return bounds_as_given(frame_, own_); }

 private:
  Pose pose_;
  Frame frame_;
  Primitive own_;
};

inline Box box_of(const double* n) { return BoxQuestionShape(n).placed(); }

}  // namespace collided::engine
