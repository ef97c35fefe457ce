#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <collided/codes.hpp>
#include <collided/geometry.hpp>
#include <collided/subscription.hpp>

/// Rays fixed to objects, for measuring clearance.
#pragma GCC visibility push(default)

namespace collided {

/// A ray that is fixed to an object and moves with it, such as one under each wheel. It searches along its direction,
/// from back_m behind the origin to reach_m ahead of it, for the first object that its carrier may collide with. Its
/// clearance is the signed distance from the origin to that hit: positive is a gap, 0 is touching, negative is a
/// collision.
struct Probe {
  std::string name;                 // unique in the server
  std::string object;               // name of its carrier, which need not exist yet
  Vec3 origin = Vec3::Zero();       // in the object's frame
  Vec3 direction = -Vec3::UnitZ();  // in the object's frame, not zero, any length
  double reach_m = 10;              // may be infinite
  double back_m = 1;
};

using Clearance = codes::ProbeState;

/// The reading of a probe in one state of the world.
struct ProbeReading {
  std::string probe;   // its name
  std::string object;  // its carrier; empty if that is absent
  Clearance state = Clearance::absent;
  double clearance_m = 0;  // |truth - clearance_m| <= error_m; the sign is exact
  double error_m = 0;
  std::string met;                         // name of the object that the ray hits; empty: none
  std::uint32_t triangle = kNoTriangle;    // of that object's mesh
  Vec3 point = Vec3::Zero();               // of the hit, in the world
  Vec3 normal = Vec3::Zero();              // unit, of the surface there
  std::uint64_t epoch = 0;                 // grows with each start of a server; 0 from Client::probes
  std::uint64_t version = 0;               // of the state
  std::chrono::nanoseconds world_time{0};  // of the state, since 1970, by the publishers' clocks
};

/// A subscription to the readings of every probe after every step, from its creation on.
using ProbeWatch = Subscription<ProbeReading>;

}  // namespace collided

#pragma GCC visibility pop
