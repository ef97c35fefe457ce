#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <collided/codes.hpp>
#include <collided/result.hpp>
#include <collided/shapes.hpp>

/// Objects that move, and live as long as the publisher that moves them.
#pragma GCC visibility push(default)

namespace collided {

namespace client {
class ShardedPublishing;
}

/// What becomes of an object when its publisher is lost.
/// remove  it leaves the world some seconds later (`collided --forget-after`), and is stale until then
/// freeze  it stays where it was said to be last, but stale, since it may have moved on: answers that it could change
///         are undecided
/// hold    it stays there as if known
using codes::LostPolicy;

/// An object to add, by Publisher::add or Client::add.
struct ObjectOptions {
  std::string name = {};  // unique in the world, at most 255 bytes
  Shape shape = {};       // at least one part, in the object's frame; 1 MiB at most
  /// Factors for the shape along the object's axes, about its origin, above 0. Unequal factors are refused except for
  /// meshes, height fields, hulls, and boxes and ellipsoids that are not rotated in the object's frame.
  Vec3 scale = Vec3::Ones();
  Pose pose = {};                   // of the object's frame in the world
  std::uint32_t layers = 1;         // bits; a question or an object sees this one by a mask with one of them
  std::uint32_t mask = 0xffffffff;  // two objects may touch where each one's mask has one of the other's layers
  std::uint32_t group = 0;          // objects of one group other than 0 never touch each other
  bool moving = true;               // false: poses of the object are refused
  LostPolicy lost_policy = LostPolicy::remove;  // for a publisher's objects
  /// Its mesh is the border of a solid; the object is refused where that does not close. Other shapes always are solid. Of a
  /// publisher's objects Publisher::wait_applied() tells the refusal.
  bool solid = false;
  /// With `solid`: a mesh that does not close is not refused but solid by its winding number, for Client::inside and signed
  /// near; to all other questions, and for events, it is a surface.
  bool solid_by_winding = false;
  /// What is in the shape is not known: it meets nothing, and a question that reaches into it is undecided with
  /// not_covered. It is left out by name or by mask as others are.
  bool unknown = false;
};

/// How a publisher is kept.
struct PublishOptions {
  /// Without a call for this long the server counts it as lost. 100 ms to a day.
  std::chrono::nanoseconds lease{500'000'000};
  /// Two poses of an object that are no farther apart connect: between them it goes straight. Beyond, it rested until one
  /// gap before the later pose. Choose it longer than the period of a source; a source that speaks once a second fits the
  /// 1.5 s. A longer gap has an object that rests and then moves off seem to leave earlier, and contacts of an object of
  /// which nothing is said are decided a gap late. 1 ms to 8 s.
  std::chrono::nanoseconds gap{1'500'000'000};
};

/// What Publisher::flush sent, and what it has to report.
struct FlushReport {
  std::uint64_t sequence = 0;  // number of the last message that carries a pose or an object
  /// Empty unless the server had counted this publisher as lost since the last flush: then how that came and what helps.
  /// This call has brought the publisher back, with all its objects.
  std::string lost = {};
  operator std::uint64_t() const { return sequence; }
};

/// Which objects of a publisher are missing from the world, and why.
struct PublisherReport {
  /// An object that is not in the world as it was defined, and why.
  struct MissingObject {
    std::string name;
    std::string why;
  };
  std::string refused;                  // why the server takes nothing of this publisher; empty: it does
  std::vector<MissingObject> left_out;  // at most 20 of them
  std::uint64_t left_out_count = 0;     // all of them
  /// Poses that a newer one of the same object replaced, since the server had more than it could apply. The object then
  /// moved straight from the pose before them to the one after, and contacts on the way that was published may be missing.
  std::uint64_t merged_poses = 0;
};

/// A source of objects and their poses, made by Client::publish. Its objects live as long as it does unless removed
/// earlier; its destructor removes them. move() collects poses, and flush() sends them in batches of at most 4,096.
///
/// Only calls of its functions show the server that it is alive, so that a program that hangs is noticed: after its lease
/// (PublishOptions) without one the server counts it as lost. Its objects are then stale, and answers that they could change
/// undecided, until the server applies ObjectOptions::lost_policy, 5 s later unless `collided --forget-after` says otherwise.
/// The next call defines all its objects again, at their newest poses, and flush() reports the loss; it does the same for a new
/// server.
///
/// errors   bad_input for an object that is not (any more) this publisher's, and for numbers that cannot be meant;
///          timeout where the server takes no more messages: what was not sent stays collected for the next flush
/// threads  calls from any thread
class Publisher {
 public:
  ~Publisher();
  Publisher(Publisher&&) noexcept;
  Publisher& operator=(Publisher&&) noexcept;

  /// Handle of an object. The handle of a removed object names no other one until its number was used 4,096 times.
  using Object = std::uint32_t;
  /// Defines an object. Its name must be free in this publisher; up to 1,048,576 objects. A name that the world has
  /// already is an error of wait_applied(), and the object waits until the name is free.
  Result<Object> add(const ObjectOptions& options);
  /// Takes over an object that is in the world without a living publisher and that moves: one that Client::add added,
  /// or of a scene loaded with LoadOptions::moving. Its shape and filters stay. This publisher moves it from then on;
  /// remove() and the end of the publisher give it back where it stands, and so does its loss with LostPolicy::remove.
  /// The object's contacts end and begin anew. One that is not there, stands still or has a publisher is an error of
  /// wait_applied(), and is claimed as soon as it can be.
  ///
  /// pose  where it is placed
  Result<Object> claim(const std::string& name, const Pose& pose, LostPolicy lost_policy = LostPolicy::remove);
  Result<void> remove(Object object);
  /// Gives an object of add() another shape, where it is; its scale stays. Its contacts end with geometry_changed and begin
  /// anew.
  Result<void> reshape(Object object, const Shape& shape);
  /// Collects the newest pose of an object; flush() sends it. The object moves there from its last pose, and contacts
  /// on the path count, unless it is teleported. A pose that is not finite, or whose rotation's norm is not 1 within
  /// 1e-6, is refused.
  Result<void> move(Object object, const Pose& pose, bool teleport = false);
  /// Sends what move() collected and says that this is where everything is at source_time: an object that was not moved
  /// since the last flush has rested. Contacts with other publishers' objects are decided only up to the last flush, so
  /// flush regularly even when nothing moves.
  ///
  /// source_time  when the objects were there, since 1970; 0: now. A time before that of an earlier flush counts as the
  ///              nanosecond after it
  Result<FlushReport> flush(std::chrono::nanoseconds source_time = {});
  /// From now on a flush says nothing about objects that were not moved: each one moves between its own poses. For
  /// sources whose objects have separate instants. An object that is not moved for longer than PublishOptions::gap counts as
  /// at rest until one gap before its next pose.
  void stream();
  /// Shows the server that this publisher is alive; move() and flush() do so too. It says nothing about where objects are:
  /// between its poses an object goes straight up to PublishOptions::gap, and contacts with other publishers' objects are
  /// decided up to one gap before now. flush() says that what was not moved has rested.
  ///
  /// source_time  the publisher's time now, for one that gives flush() its times; 0: the library's clock, if flush() had
  ///              none either
  Result<void> keep_alive(std::chrono::nanoseconds source_time = {});
  /// Waits until the server has applied every object and pose sent so far. It does not wait for a flush without poses,
  /// which only says how far the time has come: Answers::world_time shows when that has arrived. Error refused where an
  /// object is not in the world as it was defined, since its name is taken or the server refused it: the message says
  /// why, of the first one. The other objects are in the world. Error refused too where the server takes nothing of this
  /// publisher, since it has too many. A silent server is waited for until the timeout.
  Result<void> wait_applied(std::chrono::nanoseconds timeout);
  /// Asks the server what it has not taken as it was published; one round trip. After wait_applied() that counts every
  /// object and pose sent before.
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
