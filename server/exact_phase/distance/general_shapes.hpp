#pragma once

#include <concepts>
#include <variant>

#include "server/exact_phase/arithmetic/decision.hpp"
#include "server/exact_phase/distance/closest.hpp"
#include "server/exact_phase/distance/contact.hpp"
#include "server/geometry/shapes.hpp"

namespace collided::engine {

/// Shapes without a closed form for pairs: they use one search with certificates (convex_pair.hpp).
template <class Shape>
concept General = std::same_as<Shape, Cylinder> || std::same_as<Shape, Cone> || std::same_as<Shape, Ellipsoid> ||
    std::same_as<Shape, Hull>;

/// A pointer to any convex shape; the shape must outlive the call.
using ShapeView = std::variant<const Sphere*, const Box*, const Capsule*, const Cylinder*, const Cone*,
                               const Ellipsoid*, const Hull*, const Triangle*>;

namespace kernel {
struct Convex;
}
/// The shape as a convex set, which keeps a pointer to a hull.
kernel::Convex convex(const ShapeView& view);

/// Shapes that a ShapeView can point to.
template <class Shape>
concept Viewable = std::constructible_from<ShapeView, const Shape*>;

/// overlaps, contact and closest for the shapes that the views point to.
ExactResult overlaps_in_general(const ShapeView& a, const ShapeView& b);
Contact contact_in_general(const ShapeView& a, const ShapeView& b);
Closest closest_in_general(const Vec3& point, const ShapeView& shape);

/// Decides without filters: planes and points are tested by rationals alone.
Decision overlaps_by_rationals(const ShapeView& a, const ShapeView& b);

template <class A, class B>
requires(Viewable<A>&& Viewable<B> && (General<A> || General<B>)) ExactResult overlaps(const A& a, const B& b) {
  return overlaps_in_general(&a, &b);
}

template <class A, class B>
requires(Viewable<A>&& Viewable<B> && (General<A> || General<B>)) Contact contact(const A& a, const B& b) {
  return contact_in_general(&a, &b);
}

template <General Shape>
Closest closest(const Vec3& point, const Shape& shape) {
  return closest_in_general(point, &shape);
}

}  // namespace collided::engine
