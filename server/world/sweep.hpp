#pragma once

#include <cstdint>
#include <optional>

#include "server/exact_phase/time_of_contact.hpp"
#include "server/world/touch.hpp"

namespace collided {

/// The sphere that an object is, where it is nothing else: such objects are swept between their poses.
std::optional<Sphere> lone_sphere(const ObjectInfo& info);

/// A sphere on its way, and the earliest contact found so far.
struct Sweep {
  MovingSphere mover;
  double width = 0;
  bool yes = false;
  bool undecided = false;
  std::uint32_t exact_tests = 0;
  TimeBracket bracket = {};
  std::uint32_t triangle = wire_contract::kNoTriangle;
  Contact contact = {};  // at bracket.high, normal from the sphere to the other
};

/// Contains the sphere at every time.
Aabb bounds(const MovingSphere& mover);

void sweep_part(Sweep& sweep, const Triangle& part, std::uint32_t triangle);
void sweep_object(Sweep& sweep, const Placed& other, WalkCost& cost);

}  // namespace collided
