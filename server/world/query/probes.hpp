#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/world/query/query.hpp"
#include "server/world/world.hpp"

namespace collided::engine {

inline constexpr std::uint32_t kMaxProbes = 4'096;  // of a world

enum class ProbeState : std::uint8_t {
  absent,     // its object is not in the world
  nothing,    // nothing is within reach
  gap,        // a surface ahead of the origin
  touching,   // a surface at the origin exactly
  collision,  // a surface behind the origin: it has sunk in
  deeper,     // sunk in by more than the probe looks back, so the clearance is at most what is reported
  undecided,
};

/// A ray fixed to an object, under a wheel say, that measures its clearance: it begins back_m behind the origin, and
/// what it meets first, less back_m, is the signed distance of the origin from that surface. Looking from behind, an
/// origin that has sunk into the ground is told from one above it, whichever way the ground's triangles are wound.
struct ProbeDefinition {
  std::string name;    // unique, replaces one of that name
  std::string object;  // bound by name, so that a publisher's return or a definition anew keeps its probes
  Vec3 origin = Vec3::Zero();       // in the object's frame
  Vec3 direction = -Vec3::UnitZ();  // finite and non-zero, any length
  double reach_m = 10;              // ahead of the origin; may be infinite
  double back_m = 1;                // behind it; finite
};

/// |truth - clearance_m| <= error_m, and the sign is exact, for the ray from the placed and rounded start; touching is
/// exactly 0. deeper: the start is inside a solid, the clearance at most clearance_m = -back_m.
struct ProbeReading {
  ObjectId object = 0;  // 0: not in the world
  ProbeState state = ProbeState::absent;
  double clearance_m = 0;
  double error_m = 0;
  ObjectId met = 0;
  std::uint32_t triangle = kNoTriangle;
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::Zero();
};

/// The probes of a world. Each meets what its object may meet by layers, masks and groups, and never the object itself.
/// One thread.
class Probes {
 public:
  /// Why not, as a sentence, where it is refused.
  std::optional<Refusal> set(const ProbeDefinition& definition);
  /// Names that match the glob are gone, and told.
  std::vector<std::string> remove(std::string_view glob);
  bool empty() const { return probes_.empty(); }
  std::size_t size() const { return probes_.size(); }
  const ProbeDefinition& definition(std::size_t number) const { return probes_[number].definition; }

  /// One reading a probe, in the order of definition(). A ray each; nothing else where no definition has changed.
  using Find = std::function<std::optional<ObjectId>(std::string_view)>;
  void read(const Snapshot& snapshot, const Find& find, std::vector<ProbeReading>& readings);

 private:
  struct Probe {
    ProbeDefinition definition;
    Vec3 start = Vec3::Zero();  // in the object's frame
    Vec3 direction = Vec3::Zero();
    ObjectId object = 0;
  };
  /// Who may be met by the members of one filter.
  struct Audience {
    Filter filter;
    std::vector<std::uint8_t> allowed;      // by slot
    std::vector<std::uint8_t> open_scenes;  // by scene
  };

  void bind(const Snapshot& snapshot, const Find& find);
  Audience& audience_of(const Snapshot& snapshot, const Filter& filter);
  ProbeReading read(const Snapshot& snapshot, const Probe& probe);

  std::vector<Probe> probes_;
  std::vector<Audience> audiences_;
  std::uint64_t bound_version_ = 0;  // of the table that objects and audiences are of
  bool is_bound_ = false;
  std::vector<AnswerHit> found_;
};

}  // namespace collided::engine
