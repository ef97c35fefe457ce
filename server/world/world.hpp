#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <variant>
#include <vector>

#include "server/intake/scene.hpp"
#include "server/world/events/events.hpp"
#include "server/world/objects/attachments.hpp"
#include "server/world/objects/object.hpp"
#include "server/world/objects/snapshot.hpp"
#include "server/world/query/pose_memory.hpp"

namespace collided::engine {

/// Limits and tolerances of a world, fixed for its lifetime.
struct WorldOptions {
  std::uint64_t epoch = 1;                  // epoch of the first snapshots; see World::set_epoch()
  std::uint32_t max_objects = 100'000;      // static parts and moving objects together
  std::uint32_t max_contacts = 10'000'000;  // limit per step; more set StepCost::truncated
  std::uint32_t max_intervals = 64;         // most contacts of one pair between two poses; then the pair is in doubt
  double sweep_width = 1e-9;        // width of the bracket of a lone sphere's first contact, as a fraction of the step
  std::int64_t clock_error_ns = 0;  // largest difference between two publishers' clocks; only widens brackets
  PoseMemoryOptions memory = {};    // how far back questions about a past instant reach
  std::uint32_t step_threads = 1;   // threads that compute a step; the results do not depend on it
  /// Work, in pairs of balls, that a step does before it wakes other threads: about 3 ms. On a busy machine a woken
  /// thread may start its block that late, and the step waits for it.
  std::uint32_t step_alone = 50'000;
  double sweep_width_s = 1e-6;  // width of the bracket of any other mover's first contact, seconds of world time
  // For a shard: the box whose whole content it holds. This box is the covered region, whatever scenes state, until
  // cover_nothing().
  std::optional<Aabb> held = {};
};

/// Input of World::define() for a new object.
struct ObjectDefinition {
  std::string name;
  std::string scene;  // scene that it was loaded with; empty: added at run time
  Shape shape;
  /// lengths in metres, in the object's own frame
  Pose pose;
  Filter filter;
  bool moving = true;
  LostPolicy lost_policy = LostPolicy::remove;
  std::uint64_t publisher = 0;                   // publisher of its poses; 0: the server itself
  std::shared_ptr<const IndexedMesh> indexed{};  // the shape's mesh with its index, if it exists already
  CutTriangles cut{};                            // which pieces belong to which original triangle of the shape's mesh
  std::shared_ptr<const SolidMesh> solid{};      // what the shape's mesh encloses; null: it is a surface
  std::shared_ptr<const WindingMesh> winding{};  // what an open mesh holds by its winding number
  AllowedPartners allowed{};
};

/// Returns the definition that recreates an existing object at a pose. Not for a part of a static scene.
ObjectDefinition definition_of(const ObjectInfo& info, const Pose& pose);

/// Why something was refused, as a sentence for the user.
struct Refusal {
  std::string reason;
};

/// Counts and durations of one step's stages; the step fills it, callers only read it.
struct StepCost {
  std::uint32_t moved = 0;  // objects with a new pose, new ones included
  std::uint32_t candidate_pairs = 0;
  std::uint32_t exact_tests = 0;
  std::uint32_t undecided = 0;   // pairs that the exact phase could not decide
  std::uint32_t swept = 0;       // pairs decided over their motion, not only at its end
  std::uint32_t filtered = 0;    // pairs of movers near each other that layers, masks or groups exclude
  std::uint32_t kept_apart = 0;  // pairs of meshes not tested: farther apart before than both have moved since
  /// Pairs with a mover whose motion could not be searched to its end: a contact between two poses may be missing.
  std::uint32_t sweeps_skipped = 0;
  std::uint32_t sweep_looks = 0;  // tests of pairs of parts, each at one time, in all searches along motions
  std::uint32_t contacts = 0;     // contacts found, continuing ones included
  /// The step met more than max_contacts, or too many candidates for them. Later contacts are not reported, and the
  /// next step with any motion tests all pairs again. Reported contacts and their ends are still right.
  bool truncated = false;
  std::int64_t update_ns = 0;  // elapsed time of each stage
  std::int64_t broad_ns = 0;
  std::int64_t exact_ns = 0;
  std::int64_t events_ns = 0;  // inner edges, the ledger, and the new state made visible
};

/// What the subscribers need; the step computes nothing else.
struct StepOptions {
  bool contacts = true;    // points, normals, depths
  bool persisted = false;  // an event for each contact that continues and whose objects moved
};

/// A scene on its way into a world: a loading thread makes it, the world's thread adds it.
struct IndexedScene {
  Scene scene;  // without its triangles and saved indexes
  std::shared_ptr<StaticScene> geometry;
};

/// An attachment that ended because one of the two objects was removed.
struct EndedAttachment {
  std::string child;
  std::string parent;
  bool is_child_there = false;  // the child remains, where the parent last put it
};

struct FenceDefinition;  // fences/fence.hpp
class Fences;            // fences/fences.hpp

/// The state of the world and the only means to change it.
///
/// Changes collect until step(), which finds the contacts that began and ended and publishes the next snapshot.
/// threads  one thread writes and calls everything but newest() and memory(); any thread reads snapshots
class World {
 public:
  struct State;  // world_state.hpp: what only the writing thread sees

  explicit World(const WorldOptions& options);
  ~World();
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  /// Indexes a scene's triangles and the meshes of its objects; add_scene() then makes them part of the world. Uses the
  /// indexes saved with the scene where they are valid, and leaves a warning otherwise.
  /// cost  slow: call it on a loading thread
  static IndexedScene index_scene(Scene scene, const BvhOptions& options);
  /// Why add_scene() would refuse this scene: a name that is taken, or a limit that would be exceeded.
  ///
  /// replaces  as if the loaded scene of its name, if there is one, had been removed
  std::optional<Refusal> refusal_of(const Scene& scene, bool replaces) const;
  /// Adds static triangles and the scene's objects; returns how many objects. All or nothing: a name that is taken or a
  /// limit that would be exceeded refuses the whole scene.
  std::variant<std::uint32_t, Refusal> add_scene(const IndexedScene& indexed);
  /// States that the geometry of a scene ("": of the whole world) is complete inside these boxes. After the first
  /// statement, with or without boxes, space outside all boxes is not covered. That remains so when the scenes that
  /// stated the boxes are removed, since removing a scene must not make more of the world known. A shard covers the box
  /// that it holds.
  void state_covers(std::string_view scene, std::span<const Aabb> boxes);
  /// For a shard that has handed over its part: from the next step on nothing is covered, not even at past instants.
  void cover_nothing();
  /// The epoch that the snapshots carry from the next step on.
  void set_epoch(std::uint64_t epoch);
  /// Returns the number of objects removed; their contacts end with geometry_changed.
  std::uint32_t remove_scene(std::string_view name);

  /// Adds an object at its pose; refuses a name that is taken, one object over the limit, and a half-space that moves.
  std::variant<ObjectId, Refusal> define(const ObjectDefinition& definition);
  /// Removes an object; its contacts end with the reason at the next step. False: no such object.
  bool remove(ObjectId id, EndReason reason);
  /// Sets an object's pose, which must be finite with a unit quaternion (the service has checked and normalised it). An
  /// object takes one pose per step: if has_moved() is true, a step must come first. False: no such object.
  ///
  /// time_ns   world time of the pose
  /// teleport  the object was placed there; it did not touch what lies between
  bool move(ObjectId id, const Pose& pose, std::int64_t time_ns, bool teleport);
  /// Moves many objects of one publisher, prefetching rows ahead; moved[i] is what move() returns for ids[i].
  /// is_streamed: each object moves between its own poses, independent of the publisher's other objects.
  void move(std::span<const ObjectId> ids, std::span<const Pose> poses, std::int64_t time_ns, bool teleport,
            std::span<bool> moved, bool is_streamed = false);
  /// Declares that the publisher has reported everything up to an instant: objects that it has not named rested until
  /// then, and pairs with other publishers' objects are decided as far as both are known. True: the world has several
  /// sources, so other pairs may wait for this instant.
  ///
  /// is_only_alive  the publisher lives but reports nothing about its objects: each is known up to one gap before
  bool advance(std::uint64_t publisher, std::int64_t time_ns, bool is_only_alive = false);
  /// Sets the longest time between two connected poses of one of the publisher's objects: between them it moves
  /// straight. Over a longer time it rests until one gap before the later pose. Call it before the publisher's first
  /// instant. Default: kDefaultGapNs.
  void set_gap(std::uint64_t publisher, std::int64_t gap_ns);
  /// Makes time wait for the publisher's instants, until lose(), even while it has no objects here: some may come.
  void expect_objects(std::uint64_t publisher);
  /// The publisher sends nothing more; its objects rest from now on.
  void lose(std::uint64_t publisher);
  /// True if the world holds its maximum of objects; define() then refuses another.
  bool is_full() const;
  /// True if the object already has a change that the next step will take.
  bool has_moved(ObjectId id) const;
  /// Marks an object whose publisher is lost, or was found again; queries then allow for how far it may have moved.
  void set_stale(ObjectId id, bool stale);

  /// Adds a fence; refuses a name that another fence has, and a shape that holds nothing. Objects inside enter at the
  /// next step.
  std::variant<ObjectId, Refusal> add_fence(const FenceDefinition& definition);
  /// Objects inside leave at the next step. False: no such fence.
  bool remove_fence(std::string_view name);
  /// The fences, the objects inside them, and their events of the last step; null if there never was a fence.
  const Fences* fences() const;

  /// The collision step (collision_step.cpp): all changes since the last one become events and a new snapshot. Does
  /// nothing and returns false while readers hold every free snapshot; the changes stay for the next call.
  ///
  /// batches  how many applied batches this step stands for: the version grows by it
  bool step(std::int64_t world_time_ns, std::uint64_t batches, const StepOptions& step_options);
  /// Events of the last step; valid until the next call of step().
  const std::vector<Event>& events() const;
  const StepCost& cost() const;
  const std::vector<OpenContact>& contacts() const;  // open contacts and pairs in doubt, in no order
  std::size_t doubt_count() const;
  std::uint64_t last_event_sequence() const;
  /// World time up to which all contacts are decided, if nothing has changed since the last step. Publishers that have
  /// moving objects here and give instants limit it; everything else rests, up to now_ns.
  std::int64_t settled_ns(std::int64_t now_ns) const;

  /// The object with that name, or nothing.
  std::optional<ObjectId> find(std::string_view name) const;
  /// Replaces the rules for pairs that may touch, at most PairRules::kMost. The next step ends the contacts of pairs
  /// that are now allowed, and begins those of touching pairs that are no longer allowed.
  void set_pair_rules(std::vector<PairRule> rules);
  std::vector<PairRule> pair_rules() const;

  /// Attaches an object without a publisher to a parent: it keeps its place relative to the parent until either is
  /// removed. Refuses an object that is attached already, that has a publisher or that stands still, and a cycle.
  ///
  /// in_parent  the place, as a pose in the parent's frame; nothing: the current one
  std::optional<Refusal> attach(ObjectId child, ObjectId parent, const std::optional<Pose>& in_parent = {});
  /// The object stays where it is. False: it is not attached.
  bool detach(ObjectId child);
  const Attachments& attachments() const;
  /// Returns the attachments that ended with a removed object since the last call.
  std::vector<EndedAttachment> take_ended_attachments();
  /// Null if there is no such object.
  const ObjectInfo* info(ObjectId id) const;
  const ObjectTable& objects() const;

  /// The last published state. Any thread.
  SnapshotRing::Lease newest() const;
  /// Where objects were at recent instants. Any thread.
  const PoseMemory& memory() const;

 private:
  std::unique_ptr<State> state_;
};

}  // namespace collided::engine
