#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/world/query/query.hpp"
#include "server/world/query/unknown_space.hpp"
#include "server/world/world.hpp"

namespace collided::engine {

inline constexpr std::uint32_t kMaxProbes = 4'096;  // per world

using codes::ProbeState;

/// A ray fixed to an object, for example under a wheel, that measures its clearance. It starts back_m behind the
/// origin; the distance to the first hit, less back_m, is the signed distance from the origin to that surface. Because
/// the ray starts behind it, an origin that sank into the ground differs from one above it, whichever way the ground's
/// triangles are wound.
struct ProbeDefinition {
  std::string name;                 // unique; replaces a probe of that name
  std::string object;               // bound by name, so that probes survive a publisher's return and a new definition
  Vec3 origin = Vec3::Zero();       // in the object's frame
  Vec3 direction = -Vec3::UnitZ();  // finite and non-zero, any length
  double reach_m = 10;              // ahead of the origin, metres; may be infinite
  double back_m = 1;                // behind it, metres; finite
};

/// |truth - clearance_m| <= error_m, with an exact sign, for the ray from the placed and rounded start; touching is
/// exactly 0. State `deeper`: the start is inside a solid, and the true clearance is at most clearance_m = -back_m.
struct ProbeReading {
  ObjectId object = 0;  // 0: the object does not exist
  ProbeState state = ProbeState::absent;
  double clearance_m = 0;
  double error_m = 0;
  // The first hit: object, triangle, point and normal in world coordinates.
  ObjectId met = 0;
  std::uint32_t triangle = kNoTriangle;
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::Zero();
};

/// The probes of a world. A probe hits whatever its object may meet by layers, masks and groups, but never the object
/// itself.
/// threads  one
class Probes {
 public:
  /// Adds or replaces a probe; returns the reason if it is refused.
  std::optional<Refusal> set(const ProbeDefinition& definition);
  /// Removes the probes whose names match the glob; returns their names.
  std::vector<std::string> remove(std::string_view glob);
  bool empty() const { return probes_.empty(); }
  std::size_t size() const { return probes_.size(); }
  const ProbeDefinition& definition(std::size_t number) const { return probes_[number].definition; }

  /// Reads all probes: one reading each, in the order of definition(). Costs one ray per probe, up to three near
  /// touching; names are looked up only after a change of objects.
  using Find = std::function<std::optional<ObjectId>(std::string_view)>;
  void read(const Snapshot& snapshot, const Find& find, std::vector<ProbeReading>& readings);

 private:
  struct Probe {
    ProbeDefinition definition;
    Vec3 start = Vec3::Zero();  // in the object's frame
    Vec3 direction = Vec3::Zero();
    ObjectId object = 0;
  };
  /// The objects and scenes that an object with this filter and these allowed pairs may meet.
  struct Audience {
    Filter filter;
    AllowedPartners partners;
    SlotMarks allowed;
    std::vector<std::uint8_t> open_scenes;  // by scene: every part of it is allowed
    std::uint64_t table_version = 0;        // version of the table for `allowed`
    std::uint64_t parts_version = 0;        // version for open_scenes
  };

  void bind(const Snapshot& snapshot, const Find& find);
  Audience& audience_of(const Snapshot& snapshot, const ObjectInfo& object);
  ProbeReading read(const Snapshot& snapshot, const Probe& probe);
  bool reaches_unknown_space(const Snapshot& snapshot, const Vec3& start, const Vec3& direction, double length_m);

  std::vector<Probe> probes_;
  std::vector<Audience> audiences_;
  std::uint64_t bound_version_ = 0;  // version of the object table for objects and audiences
  bool is_bound_ = false;
  std::vector<AnswerHit> found_;
  UnknownSpace unknown_;
};

}  // namespace collided::engine
