#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>

#include "idl/clocks.hpp"
#include "idl/recording/recorded_topics.hpp"
#include "server/service/recording/flight_opening.hpp"
#include "server/service/recording/flight_ring.hpp"
#include "server/service/recording/flight_window.hpp"

namespace collided::engine::service {

/// A file that the flight recorder wrote.
struct FlightFile {
  std::string path;
  std::uint64_t bytes = 0;
  std::uint64_t messages = 0;
  std::uint64_t dropped = 0;             // samples since the start for which there was no room: the file may lack them
  std::uint64_t from_ns = 0, to_ns = 0;  // the span of the file, since 1970
};

/// Remembers what the server took and wrote in its last seconds, and the state that was there before them.
///
/// memory   8 MiB for samples under way; at most 64 MiB for the window (that of a busy server reaches less far back);
///          at most 96 MiB for definitions, commands and fences from before it, 16 MiB for contacts, 120 bytes for each pose
/// threads  note() from any, without lock, allocation or waiting; the rest from any
class FlightRecorder {
 public:
  /// name_space  of the recorded topics
  /// window_ns   how far back, above 0
  /// forget_after_ns  as of FlightOpening
  /// stem        "folder/name" that the files' names begin with; empty: no file can be written
  FlightRecorder(const std::string& name_space, std::int64_t window_ns, std::string stem,
                 std::int64_t forget_after_ns = 0);
  ~FlightRecorder();

  /// Records a sample.
  ///
  /// sent_ns  when it was sent, since 1970; 0: now
  template <class T>
  void note(recording::Recorded topic, const T& sample, std::int64_t sent_ns = 0) noexcept {
    if (topic >= recording::Recorded::fence_event) has_fences_.store(true, std::memory_order_relaxed);
    const std::uint64_t now = now_ns();
    ring_.put(static_cast<std::uint16_t>(topic), sample, now, sent_ns > 0 ? static_cast<std::uint64_t>(sent_ns) : now);
  }

  /// Writes the newest `last_ns`, or all that there is where that is less, as "<stem>_<word>.mcap". Throws
  /// std::runtime_error with the reason where it cannot.
  FlightFile write(const std::string& word, std::int64_t last_ns);
  const std::string& stem() const { return stem_; }

  /// From then on a signal that ends the process by its own fault leaves "<stem>_crash.mcap". The file lacks the state
  /// from before the window, which the signal could find half changed. Signals that have another handler are left to
  /// it.
  void write_at_fatal_signals();

 private:
  static std::uint64_t now_ns() { return static_cast<std::uint64_t>(wire_contract::since_1970_ns()); }
  void run();
  void take_over();
  static void on_fatal_signal(int signal);
  void write_crash_file() const;

  const std::string name_space_;
  const std::uint64_t window_ns_;
  const std::string stem_;
  const std::string crash_path_;
  mcap::Bytes prologue_;        // of a crash file
  mcap::Bytes fence_prologue_;  // follows it where anything was noted of fences
  std::atomic<bool> has_fences_{false};

  FlightRing ring_;
  std::mutex mutex_;  // guards window_ and opening_
  FlightOpening opening_;
  FlightWindow window_;
  std::atomic<bool> stopping_{false};
  std::atomic<bool> frozen_{false};  // a fatal signal is being handled: nothing moves from the ring to the window
  std::thread thread_;
};

}  // namespace collided::engine::service
