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
  std::uint64_t epoch = 1;                  // of its first snapshots; see World::set_epoch()
  std::uint32_t max_objects = 100'000;      // static parts and moving objects together
  std::uint32_t max_contacts = 10'000'000;  // that one step may find; more set StepCost::truncated
  std::uint32_t max_intervals = 64;         // contacts of a pair between two poses; beyond them it is in doubt
  double sweep_width = 1e-9;        // of the bracket of a lone sphere's first contact, as a fraction of the step
  std::int64_t clock_error_ns = 0;  // between two publishers' clocks: widens brackets and nothing else
  PoseMemoryOptions memory = {};    // how far back questions about a past instant reach
  std::uint32_t step_threads = 1;   // that decide what a step has to; the results are the same
  /// Pairs of balls, or as much else, that a step decides before it wakes others: some 3 ms. On a busy machine a thread that
  /// was woken may be kept from its block for that long, and the step waits.
  std::uint32_t step_alone = 50'000;
  double sweep_width_s = 1e-6;  // of the bracket of any other mover's first contact, seconds of world time
  // The world is a shard: it has everything that comes into this box, which is what it covers whatever is stated, until
  // cover_nothing().
  std::optional<Aabb> held = {};
};

/// What World::define() needs to know of a new object.
struct ObjectDefinition {
  std::string name;
  std::string scene;  // that it was loaded with; empty: added at run time
  Shape shape;
  /// lengths in metres, in the object's own frame
  Pose pose;
  Filter filter;
  bool moving = true;
  LostPolicy lost_policy = LostPolicy::remove;
  std::uint64_t publisher = 0;                   // whose poses move it; 0: the server's own
  std::shared_ptr<const IndexedMesh> indexed{};  // the shape's mesh with its index, where that exists already
  CutTriangles cut{};                            // of the shape's mesh: which pieces belong to which original triangle
  std::shared_ptr<const SolidMesh> solid{};      // what the shape's mesh encloses; null: it is a surface
  std::shared_ptr<const WindingMesh> winding{};  // what it holds by winding number, where it does not close
  AllowedPartners allowed{};
};

/// What defines again an object that is in the world, at a pose. Not for a part of a static scene.
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
  std::uint32_t kept_apart = 0;  // pairs of meshes not tested: known to be farther apart than both have moved since
  /// Pairs with a mover whose motion could not be searched to its end: a contact between two poses may be missing.
  std::uint32_t sweeps_skipped = 0;
  std::uint32_t sweep_looks = 0;  // tests of pairs of parts, each at one time, by all searches along motions
  std::uint32_t contacts = 0;     // found, those that held before included
  /// The step met more than max_contacts, or too many candidates for them. What came after is not reported, and the
  /// next step with any motion looks at all pairs again. Contacts that are reported are right all the same, and so are
  /// their ends.
  bool truncated = false;
  std::int64_t update_ns = 0;  // these four: elapsed time of the stages
  std::int64_t broad_ns = 0;
  std::int64_t exact_ns = 0;
  std::int64_t events_ns = 0;  // inner edges, the ledger, and the new state made visible
};

/// What the subscribers need; the rest is not computed.
struct StepOptions {
  bool contacts = true;    // points, normals, depths
  bool persisted = false;  // an event for each contact that continues and whose objects moved
};

/// A scene on its way into a world: a loading thread makes it, the world's thread adds it.
struct IndexedScene {
  Scene scene;  // without its triangles and saved indexes
  std::shared_ptr<StaticScene> geometry;
};

/// An attachment that is over since one of the two objects is no longer there.
struct EndedAttachment {
  std::string child;
  std::string parent;
  bool is_child_there = false;  // where the parent had it last
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
  /// indexes saved with the scene where they are valid, and leaves a warning where not.
  /// cost  slow: call it on a loading thread
  static IndexedScene index_scene(Scene scene, const BvhOptions& options);
  /// Why add_scene() would refuse this scene: a name that is taken, or a limit that would be exceeded.
  ///
  /// replaces  as if the loaded scene of its name, if there is one, had been removed
  std::optional<Refusal> refusal_of(const Scene& scene, bool replaces) const;
  /// Adds static triangles and the scene's objects; returns how many objects. All or nothing: a name that is taken or a
  /// limit that would be exceeded refuses the whole scene.
  std::variant<std::uint32_t, Refusal> add_scene(const IndexedScene& indexed);
  /// States that the geometry of a scene ("": of the world, whatever is loaded) is complete inside of these boxes. Once
  /// anything was stated, with or without boxes, what lies outside of all boxes is not covered, even after the scenes
  /// that stated them are gone: removing a scene must not make more of the world known. A shard covers what it holds.
  void state_covers(std::string_view scene, std::span<const Aabb> boxes);
  /// A shard whose part others hold now: from the next step on nothing is covered, past instants included.
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
  /// object takes one pose per step: where has_moved() is true, a step must come first. False: no such object.
  ///
  /// time_ns   world time of the pose
  /// teleport  the object was placed there; it did not touch what lies between
  bool move(ObjectId id, const Pose& pose, std::int64_t time_ns, bool teleport);
  /// The same for many objects of one publisher, prefetching rows ahead; moved[i] is what move() returns for ids[i].
  /// is_streamed: each object moves between its own poses, whichever other objects the publisher names.
  void move(std::span<const ObjectId> ids, std::span<const Pose> poses, std::int64_t time_ns, bool teleport,
            std::span<bool> moved, bool is_streamed = false);
  /// Declares the publisher's statements complete up to an instant: objects it has not named rested until then, and
  /// pairs with other publishers' objects are decided as far as both are known. True: the world has several sources, so
  /// other pairs may wait for this instant.
  ///
  /// is_only_alive  the publisher lives, and says nothing about its objects: each is known up to one gap before
  bool advance(std::uint64_t publisher, std::int64_t time_ns, bool is_only_alive = false);
  /// Sets up to how far apart two poses of one of the publisher's objects connect: between them it goes straight; beyond,
  /// it rested until one gap before the later pose. Call it before the publisher's first instant. Without it:
  /// kDefaultGapNs.
  void set_gap(std::uint64_t publisher, std::int64_t gap_ns);
  /// Until it sends nothing more, time waits for the publisher's instants though it has no objects here: some may come.
  void expect_objects(std::uint64_t publisher);
  /// The publisher sends nothing more: its objects rest from now on.
  void lose(std::uint64_t publisher);
  /// As many objects are there as may be; define() refuses one more.
  bool is_full() const;
  /// The object already has a change that the next step will take.
  bool has_moved(ObjectId id) const;
  /// Marks an object whose publisher is lost, or found again; queries then allow for how far it may have gone.
  void set_stale(ObjectId id, bool stale);

  /// Adds a fence; refuses a name that another fence has, and a shape that holds nothing. What is in it comes in at the
  /// next step.
  std::variant<ObjectId, Refusal> add_fence(const FenceDefinition& definition);
  /// Who is in it goes out at the next step. False: there is no such fence.
  bool remove_fence(std::string_view name);
  /// The fences, who is in them, and the last step's events of that; null: there never was one.
  const Fences* fences() const;

  /// The collision step (collision_step.cpp): all changes since the last one become events and a new snapshot. Does
  /// nothing and returns false while readers hold every free snapshot; the changes stay for the next call.
  ///
  /// batches  how many applied batches this step stands for: the version grows by it
  bool step(std::int64_t world_time_ns, std::uint64_t batches, const StepOptions& step_options);
  /// Of the last step; valid until the next call of step().
  const std::vector<Event>& events() const;
  const StepCost& cost() const;
  const std::vector<OpenContact>& contacts() const;  // those that hold and the pairs in doubt, in no order
  std::size_t doubt_count() const;
  std::uint64_t last_event_sequence() const;
  /// World time up to which all contacts are decided, where nothing has changed since the last step: by the publishers that
  /// have moving objects here and give instants; what else there is rests, up to now_ns.
  std::int64_t settled_ns(std::int64_t now_ns) const;

  /// The object with that name, or nothing.
  std::optional<ObjectId> find(std::string_view name) const;
  /// Replaces the rules of which pairs may touch, at most PairRules::kMost. The next step ends the contacts of pairs that
  /// are allowed now, and begins those of pairs that touch and are no longer.
  void set_pair_rules(std::vector<PairRule> rules);
  std::vector<PairRule> pair_rules() const;

  /// Has an object of no publisher move along with another one from now on, until one of the two is removed: where that
  /// one goes, it keeps its place relative to it. Refuses an object that is attached already, one with a publisher, one
  /// that stands still, and a circle.
  ///
  /// in_parent  that place, as a pose in the parent's frame; nothing: as it is now
  std::optional<Refusal> attach(ObjectId child, ObjectId parent, const std::optional<Pose>& in_parent = {});
  /// It stays where it is. False: it is not attached.
  bool detach(ObjectId child);
  const Attachments& attachments() const;
  /// Those that ended with a removed object, since the last call.
  std::vector<EndedAttachment> take_ended_attachments();
  /// Null: no such object.
  const ObjectInfo* info(ObjectId id) const;
  const ObjectTable& objects() const;

  /// The last published state. Any thread.
  SnapshotRing::Lease newest() const;
  /// Where objects were at an instant of the last seconds. Any thread.
  const PoseMemory& memory() const;

 private:
  std::unique_ptr<State> state_;
};

}  // namespace collided::engine
