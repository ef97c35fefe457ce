#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <collided/client.hpp>

#include "client/cli/output/output.hpp"
#include "client/cli/session.hpp"

namespace collided::cli {

/// What every publisher of objects may be told.
struct ObjectTexts {
  std::uint32_t layers = 1;
  std::uint32_t mask = 0xffffffff;
  LostPolicy lost_policy = LostPolicy::remove;
};

/// Throws where the pose was refused. One that could not be sent is kept and goes with the next flush, where the loop counts
/// what a silent server misses.
inline void moved(const Result<void>& result) {
  if (!result && result.error().code == ErrorCode::bad_input) throw as_failure(result.error());
}

/// Something that moves objects, frame by frame. The loop calls begin(), then next_time() and move() in turn.
class Source {
 public:
  virtual ~Source() = default;
  /// Adds what is known from the start.
  virtual void begin(Client& client, Publisher& publisher) = 0;
  /// When the next frame is due, in seconds since the first at speed 1; nothing at the end.
  virtual std::optional<double> next_time() = 0;
  /// Moves what moves in that frame; returns how many poses it gave.
  virtual std::size_t move(Publisher& publisher) = 0;
  /// Which instant the frame of the last move() was sent as, since 1970: what the server's events count from.
  virtual void sent(std::chrono::nanoseconds /*instant*/) {}
  /// Its objects have instants of their own, so that a frame says nothing of those that it leaves out.
  virtual bool has_own_instants() const { return false; }
  /// Back to the first frame; false where a source cannot.
  virtual bool restart() = 0;
  /// What a run came to: fields for machines, lines for people.
  virtual void report(Record&, std::vector<std::string>&) const {}
  /// Lines of input that were refused.
  virtual std::uint64_t refused_count() const { return 0; }
};

}  // namespace collided::cli
