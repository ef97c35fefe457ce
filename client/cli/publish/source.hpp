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
  bool solid = false;             // their meshes are borders of solids
  bool solid_by_winding = false;  // of those that do not close, by winding number
};

/// How long the server may take to say whether it has taken an object.
inline constexpr std::chrono::seconds kPatience{5};

/// Throws Failure where the library refused a pose. A pose that could not be sent is kept and goes with the next flush,
/// where the loop counts what a silent server misses.
inline void moved(const Result<void>& result) {
  if (!result && result.error().code == ErrorCode::bad_input) throw as_failure(result.error());
}

/// Something that moves objects frame by frame. The loop owns none of it; it calls begin(), then next_time() and move()
/// in turn, all on one thread.
class MotionSource {
 public:
  virtual ~MotionSource() = default;
  /// Sets what to call about ten times a second while next_time() waits for input.
  void when_waiting(std::function<void()> call) { while_waiting_ = std::move(call); }
  /// Adds the objects that are known from the start. What it watches or asks, it does by the session of the publisher.
  virtual void begin(Session& session, const Globals& globals, WorldPublisher& publisher) = 0;
  /// When the next frame is due, in seconds after the first at speed 1; nothing after the last.
  virtual std::optional<double> next_time() = 0;
  /// Moves what moves in that frame, and returns the number of poses.
  virtual std::size_t move(WorldPublisher& publisher) = 0;
  /// The frame of the last move() was sent with this time, since 1970, to which the server's events refer.
  virtual void sent(std::chrono::nanoseconds /*instant*/) {}
  /// Whether the objects have separate instants, so that a frame says nothing about those that it leaves out.
  virtual bool has_own_instants() const { return false; }
  /// Goes back to the first frame; false where the source cannot.
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
