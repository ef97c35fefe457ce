#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <collided/client.hpp>

#include "client/cli/output/output.hpp"
#include "client/cli/publish/world_publisher.hpp"
#include "client/cli/session.hpp"

namespace collided::cli {

/// Options that every source has for its objects.
struct ObjectTexts {
  std::uint32_t layers = 1;
  std::uint32_t mask = 0xffffffff;
  LostPolicy lost_policy = LostPolicy::remove;
  bool solid = false;             // their meshes are boundaries of solids
  bool solid_by_winding = false;  // those that are not closed, by winding number
};

/// Time limit for the server to accept or refuse an object.
inline constexpr std::chrono::seconds kPatience{5};

/// Throws Failure if the library refused a pose. A pose that could not be sent is kept and goes with the next flush,
/// where the loop counts what a silent server misses.
inline void moved(const Result<void>& result) {
  if (!result && result.error().code == ErrorCode::bad_input) throw as_failure(result.error());
}

/// Something that moves objects frame by frame. The loop owns none of it; it calls begin(), then next_time() and move()
/// in turn, all on one thread.
class MotionSource {
 public:
  virtual ~MotionSource() = default;
  /// Sets a function called about ten times a second while next_time() waits for input.
  void when_waiting(std::function<void()> call) { while_waiting_ = std::move(call); }
  /// Adds the objects known from the start. Watches and questions use the session of the publisher.
  virtual void begin(Session& session, const Globals& globals, WorldPublisher& publisher) = 0;
  /// When the next frame is due, in seconds after the first at speed 1; nothing after the last.
  virtual std::optional<double> next_time() = 0;
  /// Moves the objects of that frame, and returns the number of poses.
  virtual std::size_t move(WorldPublisher& publisher) = 0;
  /// Called with the time at which the frame of the last move() was sent, since 1970; the server's events refer to it.
  virtual void sent(std::chrono::nanoseconds /*instant*/) {}
  /// Whether the objects have separate instants, so that a frame does not concern the objects that it leaves out.
  virtual bool has_own_instants() const { return false; }
  /// Returns to the first frame; false if the source cannot.
  virtual bool restart() = 0;
  /// Adds the results of the run: fields for machines, lines for people.
  virtual void report(Record&, std::vector<std::string>&) const {}
  /// Number of input lines that were refused.
  virtual std::uint64_t refused_count() const { return 0; }

 protected:
  void wait_a_moment() const {
    if (while_waiting_) while_waiting_();
  }

 private:
  std::function<void()> while_waiting_;
};

}  // namespace collided::cli
