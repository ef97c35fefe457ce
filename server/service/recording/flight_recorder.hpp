#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <semaphore>
#include <span>
#include <string>
#include <string_view>
#include <thread>

#include "idl/clocks.hpp"
#include "idl/recording/recorded_topics.hpp"
#include "server/service/recording/flight_opening.hpp"
#include "server/service/recording/flight_ring.hpp"
#include "server/service/recording/flight_window.hpp"

namespace collided::engine::service {

/// A file written by the flight recorder.
struct FlightFile {
  std::string path;
  std::uint64_t bytes = 0;
  std::uint64_t messages = 0;
  std::uint64_t dropped = 0;             // samples since the start without room: the file may lack them
  std::uint64_t from_ns = 0, to_ns = 0;  // the span of the file, since 1970
};

/// Remembers what the server received and wrote in its last seconds, and the state before them.
///
/// memory   8 MiB for samples in flight; at most 64 MiB for the window (a busy server's reaches less far back); at most
///          96 MiB for definitions, commands and standing questions from before it, 16 MiB for contacts and standing
///          state, 120 bytes for each pose
/// threads  note() of a topic from any, without lock, allocation or waiting; note_own() and note_changes() from the
///          world's; the rest from any
class FlightRecorder {
 public:
  /// name_space       of the recorded topics
  /// window_ns        how far back, above 0
  /// forget_after_ns  see FlightOpening
  /// stem             "folder/name" at the beginning of the files' names; empty: no file can be written
  FlightRecorder(const std::string& name_space, std::int64_t window_ns, std::string stem,
                 std::int64_t forget_after_ns = 0);
  ~FlightRecorder();

  /// Records a sample.
  ///
  /// sent_ns  when it was sent, since 1970; 0: now
  template <class T>
  void note(recording::Recorded topic, const T& sample, std::int64_t sent_ns = 0) noexcept {
    if (topic >= recording::Recorded::standing_event) has_standing_.store(true, std::memory_order_relaxed);
    const std::uint64_t now = now_ns();
    put(static_cast<std::uint16_t>(topic), sample, now, sent_ns > 0 ? static_cast<std::uint64_t>(sent_ns) : now);
  }

  /// Records a command that the server repeats or copies from another server: clients' commands are recorded as they
  /// arrive.
  void note_own(std::string_view text, std::span<const std::byte> blob);
  /// Records the inventory's changes by commands.
  void note_changes(const Inventory::Changes& changes);

  /// Writes the newest `last_ns`, or all if there is less, as "<stem>_<word>.mcap". Throws std::runtime_error with the
  /// reason on failure.
  FlightFile write(const std::string& word, std::int64_t last_ns);
  const std::string& stem() const { return stem_; }

  /// After this call a fatal signal of the process itself leaves "<stem>_crash.mcap". The file lacks the state from
  /// before the window, which the signal could find half changed. Signals with another handler are left to it.
  void write_at_fatal_signals();

 private:
  template <class T>
  void put(std::uint16_t channel, const T& sample, std::uint64_t log_time, std::uint64_t publish_time) noexcept {
    ring_.put(channel, sample, log_time, publish_time);
    if (ring_.is_filling() && !is_woken_.exchange(true)) wake_.release();
  }
  static std::uint64_t now_ns() { return static_cast<std::uint64_t>(wire_contract::since_1970_ns()); }
  void run();
  void take_over(bool gives_back);
  static void on_fatal_signal(int signal);
  void write_crash_file() const;

  const std::string name_space_;
  const std::uint64_t window_ns_;
  const std::string stem_;
  const std::string crash_path_;
  mcap::Bytes prologue_;           // of a crash file
  mcap::Bytes standing_prologue_;  // follows it if there were events of standing questions
  std::atomic<bool> has_standing_{false};
  std::uint64_t own_commands_ = 0;        // since the start
  std::uint64_t own_commands_noted_ = 0;  // of these, at the last note_changes()

  FlightRing ring_;
  std::mutex mutex_;  // guards window_ and opening_
  FlightOpening opening_;
  FlightWindow window_;
  std::atomic<bool> stopping_{false};
  std::counting_semaphore<> wake_{0};
  std::atomic<bool> is_woken_{false};
  std::atomic<bool> frozen_{false};  // a fatal signal is being handled: nothing moves from the ring to the window
  std::thread thread_;
};

}  // namespace collided::engine::service
