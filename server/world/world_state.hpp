#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "server/world/apart_memory.hpp"
#include "server/world/contact_ledger.hpp"
#include "server/world/scene_touch.hpp"
#include "server/world/sweep.hpp"
#include "server/world/world.hpp"

namespace collided {

/// How an object came to where it is since the last step.
enum class Motion : std::uint8_t { none, moved, placed };  // placed: new or teleported, so there is no way between

/// In posed_ns: the pose came with the definition and takes the time of the step that shows it first.
inline constexpr std::int64_t kPosedAtStep = -1;

/// An object that is one sphere, between its last two poses.
struct BallWay {
  Vec3 start = Vec3::Zero();  // where it moved in this step
  Vec3 end = Vec3::Zero();
  Vec3 displacement = Vec3::Zero();  // of its frame, where it moved in this step
  double radius_m = -1;              // negative: not one sphere
};

/// The first contact of a mover with a part of a static scene on its way.
struct PartSweep {
  std::uint32_t part = 0;
  SweptTouch touch;
};

/// What the writer keeps; the snapshots are copies of the first group. By slot unless said otherwise.
struct World::State {
  WorldOptions options;
  SnapshotRing ring;

  std::vector<std::shared_ptr<const StaticScene>> scenes;  // in order of loading
  std::shared_ptr<ObjectTable> objects;                    // replaced when a definition changes
  std::vector<Pose> poses;
  std::vector<Frame> frames;
  std::vector<Aabb> bounds;
  std::vector<std::int64_t> posed_ns;
  std::vector<std::uint8_t> stale;
  std::vector<StaleObject> stale_objects;
  std::map<std::string, std::vector<Aabb>, std::less<>> covers_of;  // by scene; "": of the world
  std::shared_ptr<const std::vector<Aabb>> covers;                  // all of them; null while none was ever stated
  std::vector<std::uint64_t> changed;  // step of the last change

  std::uint64_t table_version = 0;
  bool objects_shared = false;  // a snapshot holds the table: copy before the next change
  std::vector<std::uint32_t> generations;
  std::vector<std::uint32_t> free_slots;
  std::vector<std::uint32_t> freed_this_step;  // free only after the step that ended their contacts
  std::unordered_map<std::string, ObjectId> names;
  std::unordered_multimap<std::size_t, std::weak_ptr<const IndexedMesh>> meshes;  // by a hash of their numbers

  std::vector<ObjectId> movable;  // who may be moved; 0: nobody. Here, since the table's entries lie far apart
  std::vector<std::optional<Sphere>> lone_spheres;  // of objects that are one sphere; here, since every step asks

  std::vector<std::uint8_t> has_way;  // the last two poses are the ends of a way
  std::vector<MoverSize> sizes;
  std::vector<std::uint8_t> fast;  // in this step: farther than its size allows to leave unswept

  std::vector<Motion> motion;
  std::vector<Frame> frames_before;
  std::vector<std::int64_t> posed_before_ns;
  std::vector<std::uint32_t> moved_slots;
  std::vector<std::pair<ObjectId, wire_contract::EndReason>> removed;
  std::uint64_t version = 0;
  std::uint64_t step_count = 0;
  std::int64_t last_step_ns = 0;

  bool looks_at_all = false;  // the last search was cut short: pairs that rest may touch unknown

  ContactLedger ledger;
  ApartMemory apart;  // of meshes without primitives, with each other and with scenes
  StepCost cost;
  PartTouches part_touches{true};
  std::vector<PartSweep> part_sweeps;
  std::vector<Aabb> swept_bounds;
  std::vector<BallWay> balls;  // pairs of balls are looked at before anything else of them is

  ObjectTable& table();  // for changing
  const ObjectInfo* info(ObjectId id) const;
  std::shared_ptr<const IndexedMesh> mesh_for(const ObjectDefinition& definition);
  void mark(std::uint32_t slot, Motion how);
  bool move(ObjectId id, const Pose& pose, std::int64_t time_ns, Motion how);
  void prefetch(std::uint32_t slot) const;
  ObjectId take_slot();
  void forget_stale(ObjectId id);
  void gather_covers();
};

}  // namespace collided
