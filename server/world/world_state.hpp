#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "server/world/fences/fences.hpp"
#include "server/world/objects/object_rows.hpp"
#include "server/world/objects/pair_rules.hpp"
#include "server/world/objects/shared_primitives.hpp"
#include "server/world/step/inner_edges.hpp"
#include "server/world/step/step_motion.hpp"
#include "server/world/step/step_pool.hpp"
#include "server/world/world.hpp"

namespace collided::engine {

/// The writing thread's own state; snapshots are copies of parts of it.
struct World::State {
  explicit State(const WorldOptions& asked) : options(asked), memory(asked.memory) {
    if (asked.held) gather_covers();
    ledger.set_has_faces([this](ObjectId id) {
      // Most objects of a large world are balls, which the row shows that the step has just read.
      return !rows[slot_of(id)].is_lone_sphere() && has_flat_faces(*rows.info(slot_of(id)));
    });
  }

  WorldOptions options;
  PoseMemory memory;
  SnapshotRing ring;

  ObjectRows rows;
  Sources sources;
  SceneList scenes;
  std::vector<StaleObject> stale_objects;
  std::unordered_map<ObjectId, std::size_t> stale_places;           // index in stale_objects
  std::map<std::string, std::vector<Aabb>, std::less<>> covers_of;  // by scene; "" for statements about the whole world
  bool is_over = false;                                             // see cover_nothing()
  // all boxes together; null if none was ever stated
  std::shared_ptr<const std::vector<Aabb>> covers;
  std::unordered_multimap<std::size_t, std::weak_ptr<const IndexedMesh>> meshes;  // by a hash of vertices and triangles
  RecentPrimitives primitives;
  std::size_t meshes_looked_through_at = 64;  // number of entries at which expired ones are removed

  std::vector<std::pair<ObjectId, EndReason>> removed;  // since the last step
  std::vector<std::pair<ObjectId, bool>> lost;          // true: stale, false: found again; since the last step
  std::uint64_t version = 0;
  std::int64_t last_step_ns = 0;
  std::shared_ptr<const PairRules> pair_rules;  // null: none
  bool has_new_pair_rules = false;              // since the last step
  Attachments attachments;
  bool has_lost_attached = false;  // an attached object, or a parent, was removed since the last step
  std::vector<EndedAttachment> ended_attachments;
  bool looks_at_all = false;  // the last search was cut short: objects at rest may touch without a contact

  StepMotion motion{rows};
  ContactLedger ledger;
  SeparationCache apart;  // pairs of objects that are a mesh only, with each other and with scenes
  DecisionLists lists;
  std::unique_ptr<StepPool> step_pool;  // null: the world's thread steps alone
  const std::unique_ptr<StepBlocks> step_blocks = std::make_unique<StepBlocks>();
  StepCost cost;
  std::unique_ptr<Fences> fences;  // null until the first fence

  // The definition's mesh with an index, shared with every object that has an equal one.
  std::shared_ptr<const IndexedMesh> mesh_for(const ObjectDefinition& definition);
  // Copies the changes into the next snapshot.
  void fill(Snapshot& next, std::int64_t world_time_ns);
  // Decides all pairs of the step: fills lists, cost and ledger.
  void decide(const StepView& step, const Grid& grid);
  void mark_unsure_ends();
  bool move(ObjectId id, const Pose& pose, std::int64_t time_ns, bool teleport, bool is_streamed);
  // Takes pair rules that changed since the last step: ends contacts that are now allowed, and has pairs that may now
  // touch tested again.
  void take_pair_rules();
  void forget_stale(ObjectId id);
  void set_stale(ObjectId id, bool is_stale);
  void carry(ObjectId parent, const Pose& pose, std::int64_t time_ns, bool teleport, bool is_streamed);
  void give_time_of(std::uint64_t publisher, ObjectId id);
  void join_parent(ObjectId child, ObjectId parent);
  void take_pivot(ObjectId id);
  void settle_attachments();
  void set_scenes(SceneList::Scenes loaded);
  void gather_covers();
};

}  // namespace collided::engine
