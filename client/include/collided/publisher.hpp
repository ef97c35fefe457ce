#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <collided/codes.hpp>
#include <collided/result.hpp>
#include <collided/shapes.hpp>

/// Publishers: sources of moving objects, which live as long as their publisher.
#pragma GCC visibility push(default)

namespace collided {

namespace client {
class ShardedPublishing;
}

/// What happens to an object when its publisher is lost.
/// remove  it is stale, and leaves the world some seconds later (`collided --forget-after`)
/// freeze  it stays at its last pose but is stale, since it may have moved: answers that it could change are undecided
/// hold    it stays at its last pose, and counts as known to be there
using codes::LostPolicy;

/// An object to add, by Publisher::add or Client::add.
struct ObjectOptions {
  std::string name = {};  // unique in the world, at most 255 bytes
  Shape shape = {};       // one or more parts, in the object's frame; at most 1 MiB
  /// Factors for the shape along the object's axes, about its origin, above 0. Unequal factors are refused except for
  /// meshes, height fields, hulls, and boxes and ellipsoids that are not rotated in the object's frame.
  Vec3 scale = Vec3::Ones();
  Pose pose = {};                   // of the object's frame in the world
  std::uint32_t layers = 1;         // bits; a question or an object sees this one if its mask has one of them
  std::uint32_t mask = 0xffffffff;  // two objects may touch if each one's mask has one of the other's layers
  std::uint32_t group = 0;          // objects of one group other than 0 never touch each other
  bool moving = true;               // false: poses of the object are refused
  LostPolicy lost_policy = LostPolicy::remove;  // for a publisher's objects
  /// Its mesh bounds a solid; the object is refused if the mesh does not close. Other shapes are always solid. For a
  /// publisher's objects Publisher::wait_applied() reports the refusal.
  bool solid = false;
  /// With `solid`: a mesh that does not close is not refused. It is solid by its winding number for Client::inside and
  /// HitMode::signed_near, and a surface for all other questions and for events.
  bool solid_by_winding = false;
  /// The content of the shape is unknown: the object touches nothing, and a question that reaches into it is undecided
  /// with not_covered. Names and masks filter it like other objects.
  bool unknown = false;
};

/// Lease and timing of a publisher.
struct PublishOptions {
  /// Without a call for this long the publisher counts as lost. 100 ms to a day.
  std::chrono::nanoseconds lease{500'000'000};
  /// If two poses of an object are no farther apart in time than this, it moves straight between them. Otherwise it
  /// rests until one gap before the later pose. Choose it longer than the source's period; 1.5 s suits one pose a
  /// second. With a longer gap, an object that rests and then moves off seems to leave earlier. Contacts of an object
  /// without reports are decided a gap late. 1 ms to 8 s.
  std::chrono::nanoseconds gap{1'500'000'000};
};

/// The result of Publisher::flush.
struct FlushReport {
  std::uint64_t sequence = 0;  // of the last message that carries a pose or an object
  /// Empty unless the server had counted this publisher as lost since the last flush; then the cause and a remedy. This
  /// call has restored the publisher with all its objects.
  std::string lost = {};
  operator std::uint64_t() const { return sequence; }
};

/// Which objects of a publisher are missing from the world, and why.
struct PublisherReport {
  /// An object that is not in the world as defined, and why.
  struct MissingObject {
    std::string name;
    std::string why;
  };
  std::string refused;                  // why the server accepts nothing from this publisher; empty: it does
  std::vector<MissingObject> left_out;  // at most 20 of them
  std::uint64_t left_out_count = 0;     // of all missing objects
  /// Poses that newer ones of the same object replaced, since the server had more than it could apply. The object then
  /// moved straight from the pose before them to the one after; contacts on the published path may be missing.
  std::uint64_t merged_poses = 0;
};

/// A source of objects and their poses, made by Client::publish. Its objects live as long as it does unless removed
/// earlier; its destructor removes them. move() collects poses, and flush() sends them in batches of at most 4,096.
///
/// Only calls of its functions renew its lease (PublishOptions), so that a program that hangs is noticed. When the
/// lease runs out, the server counts the publisher as lost. Its objects are then stale, and answers that they could
/// change are undecided, until the server applies ObjectOptions::lost_policy, by default 5 s later (`collided
/// --forget-after`). The next call defines all objects again, at their newest poses, and flush() reports the loss. The
/// same happens with a new server.
///
/// errors   bad_input for an object that does not (or no longer) belong to this publisher, and for invalid numbers;
///          timeout if the server accepts no more messages: unsent poses stay collected for the next flush
/// threads  calls from any thread
class Publisher {
 public:
  ~Publisher();
  Publisher(Publisher&&) noexcept;
  Publisher& operator=(Publisher&&) noexcept;

  /// Handle of an object. The handle of a removed object refers to no other object until its number has been used 4,096
  /// times.
  using Object = std::uint32_t;
  /// Defines an object. Its name must be free in this publisher; up to 1,048,576 objects. If the name exists in the
  /// world, wait_applied() reports an error, and the object waits until the name is free.
  Result<Object> add(const ObjectOptions& options);
  /// Claims an existing moving object that has no living publisher, either added by Client::add or from a scene loaded
  /// with LoadOptions::moving. Its shape and filters stay. This publisher moves it from then on. remove() and the end
  /// of the publisher release it where it stands; with LostPolicy::remove the publisher's loss does too. The object's
  /// contacts end and begin again. If the object does not exist, is static or has a publisher, wait_applied() reports
  /// an error, and the object is claimed as soon as possible.
  ///
  /// pose  where it is placed
  Result<Object> claim(const std::string& name, const Pose& pose, LostPolicy lost_policy = LostPolicy::remove);
  /// Removes an object from the world; a claimed one is released where it stands.
  Result<void> remove(Object object);
  /// Replaces the shape of an object made by add(); its pose and scale stay. Its contacts end with geometry_changed and
  /// begin again.
  Result<void> reshape(Object object, const Shape& shape);
  /// Collects the newest pose of an object; flush() sends it. The object moves there from its last pose, and contacts
  /// on the path count, unless it is teleported. A pose is refused if it is not finite or the norm of its rotation is
  /// not 1 within 1e-6.
  Result<void> move(Object object, const Pose& pose, bool teleport = false);
  /// Sends the collected poses, valid at source_time. An object that was not moved since the last flush has been at
  /// rest. Contacts with other publishers' objects are decided only up to the last flush, so flush regularly even if
  /// nothing moves.
  ///
  /// source_time  time of the poses, since 1970; 0: now. A time before that of an earlier flush counts as the
  ///              nanosecond after it
  Result<FlushReport> flush(std::chrono::nanoseconds source_time = {});
  /// Switches to streaming: from now on a flush states nothing about objects that were not moved, and each object moves
  /// between its own poses. For sources that report their objects at separate instants. An object that is not moved for
  /// longer than PublishOptions::gap counts as at rest until one gap before its next pose.
  void stream();
  /// Renews the lease; move() and flush() do so too. Unlike flush(), it does not state that objects have been at rest.
  /// Up to PublishOptions::gap an object moves straight between its poses. Contacts with other publishers' objects are
  /// decided up to one gap before now.
  ///
  /// source_time  the publisher's current time, if it passes times to flush(); 0: the library's clock, if flush() was
  ///              given none
  Result<void> keep_alive(std::chrono::nanoseconds source_time = {});
  /// Waits until the server has applied every object and pose sent so far. It does not wait for a flush without poses,
  /// which only advances time; Answers::world_time shows when that has arrived. If the server is silent, it waits until
  /// the timeout.
  /// Error refused if an object is not in the world as defined, since its name is taken or the server refused it. The
  /// message gives the reason for the first such object; the other objects are in the world. Also refused if the server
  /// accepts nothing from this publisher, since it has too many publishers.
  Result<void> wait_applied(std::chrono::nanoseconds timeout);
  /// Asks the server, in one round trip, for objects and poses that it did not apply as published. After wait_applied()
  /// the report covers every object and pose sent before.
  Result<PublisherReport> report(std::chrono::nanoseconds timeout);

 private:
  friend class Client;
  friend class client::ShardedPublishing;
  struct State;
  explicit Publisher(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace collided

#pragma GCC visibility pop
