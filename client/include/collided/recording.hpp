#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <collided/client.hpp>

/// Recordings of everything that goes over a namespace, as MCAP files (https://mcap.dev) with CDR messages and the IDL as
/// their schema: written, fetched from the server, read, published and asked again.
#pragma GCC visibility push(default)

namespace collided {

// ---- recording -----------------------------------------------------------------------------------------------------

struct RecordedChannel {
  std::string topic;
  std::uint64_t samples = 0;  // in the file
  std::uint64_t lost = 0;     // known to have been sent; not in the file
};

struct RecordingCounts {
  std::vector<RecordedChannel> channels;
  std::uint64_t samples = 0;
  std::uint64_t lost = 0;
  std::uint64_t unanswered = 0;  // questions whose answer did not come: lost, or nobody answered
  std::uint64_t bytes = 0;       // of the file
  std::string no_opening;        // why it does not begin with what was in the world before, or empty
  std::string problem;           // why nothing more is written, or empty
};

/// Writes what comes over the namespace of a connection to a file until it is finished or destroyed. A recording that is
/// killed can be read up to its last chunk: at most a second is missing.
///
/// memory   64 MiB wait for the disk at most; what comes beyond that counts as lost
/// effect   the server writes its steps and finds contact points while anybody records; the process takes one of the
///          domain's places that others look at, and must not have joined it as a client before
/// threads  one of its own; calls from any
class Recording {
 public:
  ~Recording();
  Recording(Recording&&) noexcept;
  Recording& operator=(Recording&&) noexcept;

  /// Up to now.
  RecordingCounts counts() const;
  /// Writes the rest and the index. The error where the file has no good end; what was written before stays readable.
  Result<RecordingCounts> finish();

 private:
  friend Result<Recording> record(const ConnectOptions&, const std::string&);
  struct State;
  explicit Recording(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Starts to record; the file is made or emptied.
Result<Recording> record(const ConnectOptions& options, const std::string& path);

/// The server's flight recorder: what it took and wrote in its last seconds, as a file here.
/// last     0: only what its publishers and commands have brought into the world up to now
/// returns  the bytes of the file
Result<std::uint64_t> fetch_recording(const ConnectOptions& options, std::chrono::nanoseconds last,
                                      const std::string& path);

// ---- events of a recording -----------------------------------------------------------------------------------------

/// A world time, or one in a recording: its begin and end are the times of its first and last sample by the recorder's clock.
struct RunTime {
  enum class Since { year_1970, begin, end };
  Since since = Since::year_1970;
  std::chrono::nanoseconds offset{0};  // before the end: below 0
};

/// only, skip  as in WatchOptions
/// from, to    both included; without: the whole recording
struct RecordedEventsOptions {
  std::string only = {};
  std::string skip = {};
  std::optional<RunTime> from = {};
  std::optional<RunTime> to = {};
};

struct RecordedEvents {
  std::vector<Event> events;
  std::chrono::nanoseconds begin{0}, end{0};  // of the recording
  std::uint64_t lost = 0;                     // known to have been told; not in the file
  std::vector<std::string> warnings;          // damage of the file, events that are lost, contacts of unknown age
};

/// The events in a recording, without a server: what held before `from` as `open`, then each by when it had happened().
Result<RecordedEvents> recorded_events(const std::string& path, const RecordedEventsOptions& options = {});

// ---- replay --------------------------------------------------------------------------------------------------------

/// go_on  asked every few milliseconds; false ends the replay
struct ReplayOptions {
  std::string path;
  double rate = 1;   // above 0; of the recorded time
  bool ask = false;  // step by step with the questions: the rate does not matter
  std::function<bool()> go_on = {};
};

/// What became of a recording's questions, as far as their worlds could be made again.
struct ReplayReport {
  std::uint64_t samples = 0;    // definitions and batches of poses that were published
  std::uint64_t commands = 0;   // add, move, remove and probe, given again
  std::uint64_t questions = 0;  // asked again
  std::uint64_t equal = 0;      // answered with the same bits
  std::uint64_t not_compared = 0;
  std::vector<std::string> why_not_compared;  // "12 answered before the recording knew what was in the world"
  std::vector<std::string> differences;       // the first 20
  std::vector<std::string> warnings;          // damage of the file, commands left out, other scenes than then
  bool stopped = false;                       // by go_on
};

/// Publishes what was recorded as publishers of its own, whose objects go at the end. What the server loaded from files
/// it must have loaded here too.
Result<ReplayReport> replay(const ConnectOptions& connect, const ReplayOptions& options);

}  // namespace collided

#pragma GCC visibility pop
