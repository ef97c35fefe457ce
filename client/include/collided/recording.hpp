#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <collided/client.hpp>

/// Recordings of all messages on a namespace: write them, fetch them from the server, read them, replay them, and
/// repeat their questions. A recording is an MCAP file (https://mcap.dev) of CDR messages, with the IDL as their
/// schema.
#pragma GCC visibility push(default)

namespace collided {

// ---- recording -----------------------------------------------------------------------------------------------------

/// The samples of one topic in a recording.
struct RecordedChannel {
  std::string topic;          // its name without the namespace
  std::uint64_t samples = 0;  // in the file
  std::uint64_t lost = 0;     // known to have been sent, but missing from the file
};

/// What a recording has written so far.
struct RecordingCounts {
  std::vector<RecordedChannel> channels;
  std::uint64_t samples = 0;     // of all channels
  std::uint64_t lost = 0;        // of all channels
  std::uint64_t unanswered = 0;  // questions without an answer in the file: lost or never sent
  std::uint64_t bytes = 0;       // of the file
  std::string no_opening;        // why the file does not begin with the existing world; empty: it does
  std::string problem;           // why writing has stopped; empty: it has not
  /// Grows whenever the standing questions or their answers may have changed.
  std::uint64_t standing_changes = 0;
};

/// An additional channel of a recording, for data that a program derives from the namespace's topics, such as a scene
/// for a viewer. Encodings are names from MCAP's registry.
struct OwnChannel {
  std::string topic;     // its name in the file, different from the namespace's topics
  std::string encoding;  // of its messages, such as "json"
  std::string schema_name;
  std::string schema_encoding;  // such as "jsonschema"
  std::string schema;
};

/// Writes all messages on a namespace to a file, from record() until finish() or destruction. If the process is killed,
/// the file is readable up to its last chunk; at most a second is missing.
///
/// memory   at most 64 MiB wait for the disk; further messages count as lost
/// effect   while a recording runs, the server publishes its steps and computes contact points. The process takes one
///          of the domain's participant indexes that other programs probe, so it must not have joined the domain as a
///          client before
/// threads  calls from any thread; it has one of its own
class Recording {
 public:
  ~Recording();
  Recording(Recording&&) noexcept;
  Recording& operator=(Recording&&) noexcept;

  /// Counts of what has been written so far.
  RecordingCounts counts() const;
  /// Writes the remaining messages and the index, and ends the recording. An error means that the file has no proper
  /// end; the part written before is still readable.
  Result<RecordingCounts> finish();
  /// Returns a client on the same connection; its questions are not recorded.
  Client client() const;
  /// Writes a message, dated now, on an additional channel, which its first message creates. Error bad_input for more
  /// than 8 channels, or after finish().
  Result<void> write(const OwnChannel& channel, std::string_view message);

 private:
  friend Result<Recording> record(const ConnectOptions&, const std::string&);
  struct State;
  explicit Recording(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Starts to record. The file is created, or emptied if it exists. Waits a second or two until all publishers and
/// clients are discovered.
Result<Recording> record(const ConnectOptions& options, const std::string& path);

/// Fetches the last seconds from the server's flight recorder, as a recording, into a file on this machine.
///
/// last     how far back; 0: only the current world of publishers' and commands' objects
/// returns  the size of the file in bytes
Result<std::uint64_t> fetch_recording(const ConnectOptions& options, std::chrono::nanoseconds last,
                                      const std::string& path);

// ---- events of a recording -----------------------------------------------------------------------------------------

/// A time in a recording: since 1970, or relative to its begin or end, which are the times of the first and last sample
/// by the recorder's clock.
struct RunTime {
  enum class Since { year_1970, begin, end };
  Since since = Since::year_1970;
  std::chrono::nanoseconds offset{0};  // negative: before it
};

/// Which events of a recording to return.
struct RecordedEventsOptions {
  std::string only = {};  // as in WatchOptions
  std::string skip = {};
  std::optional<RunTime> from = {};  // inclusive; not set: the recording's begin
  std::optional<RunTime> to = {};    // inclusive; not set: its end
};

/// The events of a recording.
struct RecordedEvents {
  std::vector<Event> events;
  std::chrono::nanoseconds begin{0};  // of the recording
  std::chrono::nanoseconds end{0};
  std::vector<std::string> scenes;    // names of those loaded, by the server's last status
  std::uint64_t lost = 0;             // known to have been sent, but missing from the file
  std::vector<std::string> warnings;  // damage to the file, lost events, contacts of unknown age
};

/// Reads the events of a recording; no server is needed. Contacts open before `from` come first, as `open`, then all
/// events ordered by happened(). Error bad_input if the file cannot be read.
Result<RecordedEvents> recorded_events(const std::string& path, const RecordedEventsOptions& options = {});

/// The events of a recording's standing questions.
struct RecordedStandingEvents {
  std::vector<StandingEvent> events;
  std::chrono::nanoseconds begin{0};  // of the recording
  std::chrono::nanoseconds end{0};
  std::uint64_t lost = 0;             // known to have been sent, but missing from the file
  std::vector<std::string> warnings;  // damage to the file, lost events, stays of unknown age
};

/// Reads the events of a recording's standing questions; no server is needed. They are those a StandingWatch would have
/// reported: first the state before `from`, as `inside`, `within` and `is`, then all events by sequence. `only` and
/// `skip` are as in StandingWatchOptions. Error bad_input if the file cannot be read.
Result<RecordedStandingEvents> recorded_standing_events(const std::string& path,
                                                        const RecordedEventsOptions& options = {});

// ---- the picture of a recording ------------------------------------------------------------------------------------

/// A message of an OwnChannel.
struct OwnMessage {
  std::string schema_name;
  std::string data;
};

/// A change in the picture of a recording.
struct PictureChange {
  std::chrono::nanoseconds at{0};  // since the recording's begin
  /// All objects, the poses of all moving objects, events, a status, or a message of an additional channel.
  std::variant<std::shared_ptr<const ShownObjects>, Poses, std::vector<Event>, ServerStatus, OwnMessage> what;
};

/// Content and resolution of a recording's picture.
struct PictureOptions {
  /// Static objects that recordings do not contain, such as the parts of scenes. Recorded commands may remove them.
  std::shared_ptr<const ShownObjects> surroundings = {};
  std::chrono::nanoseconds frame{33'000'000};       // minimum interval between poses
  std::chrono::nanoseconds table{100'000'000};      // minimum interval between tables of all objects
  std::size_t most_poses = std::size_t{8'000'000};  // over all frames; to stay below, frames get farther apart
  std::function<bool()> go_on = {};                 // called many times a second; false stops reading
};

/// A recording whose picture was read.
struct RecordedPicture {
  std::chrono::nanoseconds length{0};
  std::vector<std::string> warnings;  // damage to the file, unreadable messages
};

/// Reads a recording as a viewer of its server would have seen it; no server is needed. It yields objects with their
/// shapes, poses, initial contacts as `open`, events and statuses. Objects get new numbers, equal for equal names, also
/// in events. A command takes effect with its answer; a refused one has no effect. Error bad_input if the file cannot
/// be read.
///
/// take  called with each change in order of time, on the calling thread
Result<RecordedPicture> recorded_picture(const std::string& path, const PictureOptions& options,
                                         const std::function<void(const PictureChange&)>& take);

// ---- replay --------------------------------------------------------------------------------------------------------

/// How to replay a recording.
struct ReplayOptions {
  std::string path;                  // of the recording
  double rate = 1;                   // 2 is twice as fast as recorded; above 0 up to 1e6
  bool ask = false;                  // repeat the recorded questions, state by state; ignores the rate
  std::function<bool()> go_on = {};  // called many times a second, on the calling thread; false ends the replay
  std::optional<RunTime> from = {};  // earlier messages are published at once; not set: the recording's begin
  std::optional<RunTime> to = {};    // later messages are left out; not set: the recording's end
  /// Called on a separate thread when all has been published and before it is removed. With `rate` 1, times of the
  /// replayed world are `shift` after those of the recording.
  std::function<void(std::chrono::nanoseconds shift)> at_end = {};
};

/// What was published, and how answers compare with the recorded ones. A question is compared only if its state could
/// be reproduced.
struct ReplayReport {
  std::uint64_t samples = 0;                  // definitions and pose batches that were published
  std::uint64_t commands = 0;                 // repeated commands that add, move, remove, attach or allow something
  std::uint64_t questions = 0;                // repeated
  std::uint64_t equal = 0;                    // answered bit for bit as recorded
  std::uint64_t not_compared = 0;             // questions that were left out
  std::vector<std::string> why_not_compared;  // "12 answered before the recording knew what was in the world"
  std::vector<std::string> differences;       // one sentence each, the first 20
  std::vector<std::string> warnings;          // damage to the file, commands left out, missing scenes
  bool stopped = false;                       // by ReplayOptions::go_on
  std::uint64_t standing = 0;                 // standing questions that were added again
};

/// Replays a recording's objects and poses with its own publishers, whose objects are removed at the end. Objects and
/// kept standing questions made by commands stay. Other standing questions are removed when the recorded client that
/// added them disconnected, or at the end. Scenes that the server had loaded from files must be loaded first. Returns
/// when the replay has ended.
Result<ReplayReport> replay(const ConnectOptions& connect, const ReplayOptions& options);

}  // namespace collided

#pragma GCC visibility pop
