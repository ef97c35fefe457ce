#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <thread>

#include "idl/dds.hpp"

namespace collided::engine::service {

/// Listens to the primary's status. A primary whose process lives, but whose world has been at one step for longer than
/// kWorldHangsNs, is silent too.
///
/// threads  one of its own, on which it calls what it was given
class PrimaryPulse {
 public:
  struct Collaborators {
    std::function<std::uint64_t()> primary;  // which server is listened to; 0: none yet
    /// It has said nothing for so long; called again and again while that lasts. True: no more.
    std::function<bool(std::int64_t silent_ns)> is_silent;
    /// Whether its place has been given to this server: then it counts as silent, whatever it says.
    std::function<bool()> is_replaced;
  };
  /// silent_after_ns  without a status for so long the primary counts as silent
  PrimaryPulse(const dds::Participant& participant, const std::string& name_space, std::int64_t silent_after_ns,
               Collaborators with);
  ~PrimaryPulse();
  PrimaryPulse(const PrimaryPulse&) = delete;
  PrimaryPulse& operator=(const PrimaryPulse&) = delete;

  /// Whether it counts as silent. Any thread.
  bool is_silent() const { return is_silent_.load(); }
  /// When its world was heard last, steady clock; 0: never. While that is busy no event is written. Any thread.
  std::int64_t heard_ns() const { return heard_ns_.load(); }

 private:
  void run();
  void take();

  const std::int64_t silent_after_ns_;
  const Collaborators with_;
  dds::Topic<wire::Status> topic_;
  dds::Reader<wire::Status> reader_;
  dds::WaitSet waitset_;
  dds::Sample<wire::Status> status_;  // this and the next three are of the thread
  std::uint64_t listened_to_ = 0;     // 0: nobody yet
  std::int64_t blamed_ns_ = 0;        // since when its silence counts, steady clock; 0: it does not yet
  std::int64_t looked_ns_ = 0;
  std::atomic<bool> is_silent_{false};
  std::atomic<std::int64_t> heard_ns_{0};  // see heard_ns()
  std::atomic<bool> is_over_{false};
  std::thread thread_;
};

}  // namespace collided::engine::service
