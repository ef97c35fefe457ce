#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include <collided/result.hpp>
#include <collided/shapes.hpp>

/// Objects that move, and live as long as who moves them.
#pragma GCC visibility push(default)

namespace collided {

/// What becomes of an object whose publisher is lost.
enum class LostPolicy { remove, freeze, hold };

struct ObjectOptions {
  std::string name = {};  // unique in the world, at most 255 bytes
  Shape shape = {};
  /// About the object's origin, above 0. Factors that differ suit meshes, height fields, hulls, and boxes and ellipsoids
  /// along the axes; for the other kinds they are refused.
  Vec3 scale = Vec3::Ones();
  Pose pose = {};
  std::uint32_t layers = 1;
  std::uint32_t mask = 0xffffffff;
  std::uint32_t group = 0;  // members of one group other than 0 never meet
  bool moving = true;
  LostPolicy lost_policy = LostPolicy::remove;
};

/// A source of objects and their poses. Objects live as long as the publisher unless removed earlier.
/// Poses are collected by move() and sent by flush() as batches of at most 4,096.
/// Only its calls say that it lives, so that a thread that hangs is noticed: after 500 ms without one the server takes it
/// for lost (ObjectOptions::when_lost). The next call then defines all its objects anew, at their newest poses.
class Publisher {
 public:
  ~Publisher();
  Publisher(Publisher&&) noexcept;
  Publisher& operator=(Publisher&&) noexcept;

  using Object = std::uint32_t;
  Result<Object> add(const ObjectOptions& options);
  Result<void> remove(Object object);
  /// Non-finite or non-unit (beyond 1e-6) poses are refused.
  Result<void> move(Object object, const Pose& pose, bool teleport = false);
  /// Sends what move() collected; returns the sequence of the last message (for AskOptions.fresh). It says where everything
  /// is at that time: what was not moved since the flush before has rested, also where nothing was. Pairs with other
  /// publishers' objects are decided up to there, so who has nothing to move flushes all the same.
  /// source_time: of the poses, since 1970; 0: now. One before an earlier flush's counts as the nanosecond after it. On a
  /// timeout what was not sent stays collected.
  Result<std::uint64_t> flush(std::chrono::nanoseconds source_time = {});
  /// From now on each object moves between its own poses, whichever others a flush names: for sources whose objects have
  /// instants of their own. Who is not moved for 250 ms has rested until 250 ms before its next pose.
  void stream();
  /// Says "still there" without moving anything; move/flush say so as well.
  Result<void> keep_alive();
  /// Waits until the server has applied every object and pose sent so far. A flush without news, which only says how far
  /// the time has come, is not waited for: Answers::world_time shows when it has arrived.
  Result<void> wait_applied(std::chrono::nanoseconds timeout);

 private:
  friend class Client;
  struct State;
  explicit Publisher(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace collided

#pragma GCC visibility pop
