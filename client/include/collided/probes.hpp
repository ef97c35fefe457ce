#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <collided/geometry.hpp>

/// Rays fixed to objects, that measure clearance.
#pragma GCC visibility push(default)

namespace collided {

/// A ray fixed to an object, such as one under each wheel. It looks along the direction from back_m behind the origin to
/// reach_m ahead of it, and its clearance is the signed distance from the origin to the first thing that it meets there,
/// of what the object itself may meet: above 0 a gap, 0 touching, below 0 a collision.
struct Probe {
  std::string name;            // unique in the server
  std::string object;          // by name; it need not be there yet
  Vec3 origin = Vec3::Zero();  // in the object's frame
  Vec3 direction = -Vec3::UnitZ();
  double reach_m = 10;
  double back_m = 1;
};

/// absent: the object is not in the world. deeper: the ray begins inside a solid, the clearance is at most -back_m.
enum class Clearance { absent, nothing, gap, touching, collision, deeper, undecided };

struct ProbeReading {
  std::string probe;
  std::string object;  // empty where it is absent
  Clearance state = Clearance::absent;
  double clearance_m = 0;  // |truth - clearance_m| <= error_m; the sign is exact
  double error_m = 0;
  std::string met;
  std::uint32_t triangle = kNoTriangle;
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::Zero();
  std::uint64_t epoch = 0;
  std::uint64_t version = 0;
  std::chrono::nanoseconds world_time{0};
};

/// Readings of every probe after every step, from when it was made on.
class ProbeWatch {
 public:
  ~ProbeWatch();
  ProbeWatch(ProbeWatch&&) noexcept;
  ProbeWatch& operator=(ProbeWatch&&) noexcept;

  /// The next reading; nothing after `wait`.
  std::optional<ProbeReading> next(std::chrono::nanoseconds wait);
  /// Readings dropped because nobody called next().
  std::uint64_t lost() const;

 private:
  friend class Client;
  struct State;
  explicit ProbeWatch(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace collided

#pragma GCC visibility pop
