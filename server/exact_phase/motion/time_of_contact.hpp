#pragma once

#include "server/exact_phase/arithmetic/decision.hpp"
#include "server/geometry/common_origin.hpp"
#include "server/geometry/shapes.hpp"

namespace collided::engine {

/// A sphere whose centre moves from start to end at constant speed while time runs from 0 to 1.
struct MovingSphere {
  Vec3 start;
  Vec3 end;
  double radius_m = 0;
};

/// The motion in coordinates relative to the origin (common_origin.hpp).
inline MovingSphere seen_from(const Vec3& origin, const MovingSphere& mover) {
  return {.start = seen_from(origin, mover.start), .end = seen_from(origin, mover.end), .radius_m = mover.radius_m};
}

/// No contact anywhere in [0, low]; contact at some time in [low, high]. Both 0 when the start touches.
struct TimeBracket {
  double low = 0;
  double high = 0;
};

/// Whether the moving sphere meets the set at any time in [0, 1], and a bracket of the first contact, no wider than
/// `width` unless rounding forbids that (then as narrow as possible). Never late, never missed.
ExactResult first_contact(const MovingSphere& mover, const Sphere& other, double width, TimeBracket& bracket);
ExactResult first_contact(const MovingSphere& mover, const Box& other, double width, TimeBracket& bracket);
ExactResult first_contact(const MovingSphere& mover, const Capsule& other, double width, TimeBracket& bracket);
ExactResult first_contact(const MovingSphere& mover, const Cylinder& other, double width, TimeBracket& bracket);
ExactResult first_contact(const MovingSphere& mover, const Cone& other, double width, TimeBracket& bracket);
ExactResult first_contact(const MovingSphere& mover, const Ellipsoid& other, double width, TimeBracket& bracket);
ExactResult first_contact(const MovingSphere& mover, const Hull& other, double width, TimeBracket& bracket);
ExactResult first_contact(const MovingSphere& mover, const HalfSpace& other, double width, TimeBracket& bracket);
ExactResult first_contact(const MovingSphere& mover, const Triangle& other, double width, TimeBracket& bracket);
ExactResult first_contact(const MovingSphere& mover, const Primitive& other, double width, TimeBracket& bracket);

}  // namespace collided::engine
