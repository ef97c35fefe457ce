#pragma once

#include "server/exact_phase/distance/general_shapes.hpp"

namespace collided::engine {

/// Half-spaces against all shapes: the reach along one normal decides, and the depth is along that normal.
/// The same guarantees as in overlap.hpp, contact.hpp and closest.hpp.
ExactResult overlaps_half_space(const HalfSpace& a, const ShapeView& b);
Contact contact_half_space(const HalfSpace& a, const ShapeView& b);
Closest closest(const Vec3& point, const HalfSpace& half_space);

/// Separate only with opposite normals and a gap between the planes. Neither moves, so the world never needs their
/// contact.
ExactResult overlaps(const HalfSpace& a, const HalfSpace& b);
Contact contact(const HalfSpace& a, const HalfSpace& b);

template <Viewable Shape>
ExactResult overlaps(const HalfSpace& a, const Shape& b) {
  return overlaps_half_space(a, &b);
}
template <Viewable Shape>
ExactResult overlaps(const Shape& a, const HalfSpace& b) {
  return overlaps_half_space(b, &a);
}
template <Viewable Shape>
Contact contact(const HalfSpace& a, const Shape& b) {
  return contact_half_space(a, &b);
}
template <Viewable Shape>
Contact contact(const Shape& a, const HalfSpace& b) {
  Contact turned = contact_half_space(b, &a);
  turned.normal = -turned.normal;
  return turned;
}

/// The decision by rationals alone, for audits.
Decision half_space_by_rationals(const HalfSpace& a, const ShapeView& b);
Decision half_space_by_rationals(const HalfSpace& a, const HalfSpace& b);

template <class A, class B>
Decision overlaps_half_space_by_rationals(const A& a, const B& b) {
  if constexpr (std::same_as<A, HalfSpace> && std::same_as<B, HalfSpace>) return half_space_by_rationals(a, b);
  else if constexpr (std::same_as<A, HalfSpace>) return half_space_by_rationals(a, &b);
  else return half_space_by_rationals(b, &a);
}

}  // namespace collided::engine
