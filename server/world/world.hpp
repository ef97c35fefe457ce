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
#include "server/world/objects/object.hpp"
#include "server/world/objects/snapshot.hpp"
#include "server/world/query/pose_memory.hpp"

namespace collided::engine {

struct WorldOptions {
  std::uint64_t epoch = 1;
  std::uint32_t max_objects = 100'000;  // static parts and moving objects together
  std::uint32_t max_contacts = 10'000'000;  // that one step may find
  double sweep_width = 1e-9;            // of the bracket of a lone sphere's first contact, as a fraction of the step
  std::int64_t clock_error_ns = 0;      // of two publishers' clocks against each other: widens brackets and nothing else
  PoseMemoryOptions memory = {};        // for questions about an instant
  double sweep_width_s = 1e-6;          // of the bracket of any other mover's, seconds of world time
};

struct ObjectDefinition {
  std::string name;
  std::string scene;
  Shape shape;
  Pose pose;
  Filter filter;
  bool moving = true;
  LostPolicy lost_policy = LostPolicy::remove;
  std::uint64_t publisher = 0;
  std::shared_ptr<const IndexedMesh> indexed{};  // the shape's mesh, where it has its index already
  CutTriangles cut{};                            // of the shape's mesh
};

/// Why something was refused, as a sentence for the user.
struct Refusal {
  std::string reason;
};

/// How long the stages of a step took and what they met.
struct StepCost {
  std::uint32_t moved = 0;
  std::uint32_t candidate_pairs = 0;
  std::uint32_t exact_tests = 0;
  std::uint32_t undecided = 0;
  std::uint32_t swept = 0;
  std::uint32_t filtered = 0;  // pairs of movers near each other that layers, masks or groups keep from meeting
  std::uint32_t kept_apart = 0;  // pairs of meshes not tested, since they were too far apart for how far they have gone
  /// Pairs with a mover whose way could not be searched to its end: a contact between two poses may be missing.
  std::uint32_t sweeps_skipped = 0;
  std::uint32_t contacts = 0;  // found, those that held before included
  /// There are more than max_contacts, or too many candidates for it: what came after is not told, and all pairs are
  /// looked at again once anything moves. Contacts that are told are right all the same, and so are their ends.
  bool truncated = false;
  std::int64_t update_ns = 0;
  std::int64_t broad_ns = 0;
  std::int64_t exact_ns = 0;
};

/// What the subscribers want; what nobody wants is not computed.
struct StepOptions {
  bool contacts = true;    // points, normals, depths
  bool persisted = false;  // an event for each contact that goes on and whose objects moved
};

/// The state of the world and the one way to change it. One thread writes (everything but newest()); any thread reads
/// snapshots. Changes collect until step(), which finds what began and ended and publishes the next snapshot.
class World {
 public:
  struct State;  // world_state.hpp: the writer's own memory

  explicit World(const WorldOptions& options);
  ~World();
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  /// Takes the triangles out of a loaded scene and indexes them and the meshes of its objects, with the scene's saved
  /// indexes where they are fit (slow: call it on a loading thread); add_scene makes them part of the world.
  static std::shared_ptr<StaticScene> index_scene(Scene& scene, const BvhOptions& options);
  /// Static triangles and the scene's objects. All or nothing: a clash of names refuses the scene.
  std::variant<std::uint32_t, Refusal> add_scene(const Scene& scene, std::shared_ptr<StaticScene> indexed);
  /// The geometry of a scene ("": of the world, whatever is loaded) is complete inside of these boxes. Once anything was
  /// stated, with or without boxes, what lies outside of all of them is not covered, even when the scenes that stated it are
  /// gone: what was taken away must not make more of the world known.
  void state_covers(std::string_view scene, std::span<const Aabb> boxes);
  /// Number of objects removed; their contacts end with geometry_changed.
  std::uint32_t remove_scene(std::string_view name);

  std::variant<ObjectId, Refusal> define(const ObjectDefinition& definition);
  /// The object's contacts end with the reason at the next step. False: no such object.
  bool remove(ObjectId id, EndReason reason);
  /// The pose must be finite with a unit quaternion (the border has checked and normalised). One pose an object and
  /// step: has_moved() tells that a step must come first. False: no such object.
  bool move(ObjectId id, const Pose& pose, std::int64_t time_ns, bool teleport);
  /// The same for many objects of one publisher, whose memory is fetched while the ones before are at work. moved[i]: as
  /// move() returns. is_streamed: its objects move between their own poses, whichever others it names.
  void move(std::span<const ObjectId> ids, std::span<const Pose> poses, std::int64_t time_ns, bool teleport,
            std::span<bool> moved, bool is_streamed = false);
  /// All that the publisher has to say of the time up to there is said: whoever it has not named has rested, and pairs with
  /// other publishers' objects are decided as far as both are known. True: somebody may wait for it.
  bool advance(std::uint64_t publisher, std::int64_t time_ns);
  /// The publisher says no more: its objects rest from now on.
  void lose(std::uint64_t publisher);
  bool has_moved(ObjectId id) const;
  void set_stale(ObjectId id, bool stale);

  /// The collision step (collision_step.cpp): all changes since the last become events and a new snapshot. batches:
  /// how many applied batches this step stands for (the version grows by it). Events are valid until the next call.
  /// Does nothing and returns false while readers hold every free snapshot; the changes stay for the next call.
  bool step(std::int64_t world_time_ns, std::uint64_t batches, const StepOptions& step_options);
  const std::vector<Event>& events() const;
  const StepCost& cost() const;
  const std::vector<OpenContact>& contacts() const;  // those that hold and pairs in doubt, in no order
  std::size_t doubt_count() const;
  std::uint64_t last_event_sequence() const;

  std::optional<ObjectId> find(std::string_view name) const;
  const ObjectInfo* info(ObjectId id) const;
  const ObjectTable& objects() const;

  /// Any thread.
  SnapshotRing::Lease newest() const;
  /// What was at an instant of the last seconds. Any thread.
  const PoseMemory& memory() const;

 private:
  std::unique_ptr<State> state_;
};

}  // namespace collided::engine
