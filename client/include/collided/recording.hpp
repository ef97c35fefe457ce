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

/// Recordings of everything that is sent on a namespace: written, fetched from the server, read, published again, and
/// with their questions asked again. A recording is an MCAP file (https://mcap.dev) of CDR messages, with the IDL as
/// their schema.
#pragma GCC visibility push(default)

namespace collided {

// ---- recording -----------------------------------------------------------------------------------------------------

/// What a recording has of one topic.
struct RecordedChannel {
  std::string topic;          // its name without the namespace
  std::uint64_t samples = 0;  // in the file
  std::uint64_t lost = 0;     // known to have been sent, but not in the file
};

/// What a recording has written so far.
struct RecordingCounts {
  std::vector<RecordedChannel> channels;
  std::uint64_t samples = 0;     // of all channels
  std::uint64_t lost = 0;        // of all channels
  std::uint64_t unanswered = 0;  // questions without an answer in the file: it was lost, or never sent
  std::uint64_t bytes = 0;       // of the file
  std::string no_opening;        // why the file does not begin with what was in the world already; empty: it does
  std::string problem;           // why nothing more is written; empty: all is well
  /// Grows whenever there may be other standing questions, or they may hold other objects.
  std::uint64_t standing_changes = 0;
};

/// A channel of a recording beside those of the namespace's topics, for what a program makes of them, such as a scene that
/// another one shows. Encodings are names of MCAP's registry.
struct OwnChannel {
  std::string topic;     // its name in the file, other than those of the namespace's topics
  std::string encoding;  // of its messages, such as "json"
  std::string schema_name;
  std::string schema_encoding;  // such as "jsonschema"
  std::string schema;
};

/// Writes everything that is sent on a namespace to a file, from record() until it is finished or destroyed. If the
/// process is killed, the file can be read up to its last chunk: at most a second is missing.
///
/// memory   at most 64 MiB wait for the disk; what comes beyond that counts as lost
/// effect   while anyone records, the server writes its steps and computes contact points. The process takes one of the
///          domain's places that other programs look at, so it must not have joined the domain as a client before
/// threads  calls from any thread; it has one of its own
class Recording {
 public:
  ~Recording();
  Recording(Recording&&) noexcept;
  Recording& operator=(Recording&&) noexcept;

  /// What was written up to now.
  RecordingCounts counts() const;
  /// Writes the rest and the index, and ends the recording. An error means that the file has no proper end; what was
  /// written before can still be read.
  Result<RecordingCounts> finish();
  /// A client of the same connection, whose questions are not recorded.
  Client client() const;
  /// Writes a message of a channel of the caller's own, dated now. The channel is in the file from its first message on; up
  /// to 8. Error bad_input where there would be more, or after finish().
  Result<void> write(const OwnChannel& channel, std::string_view message);

 private:
  friend Result<Recording> record(const ConnectOptions&, const std::string&);
  struct State;
  explicit Recording(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Starts to record. The file is created, or emptied if it exists. Waits a second or two until all publishers and
/// clients are heard.
Result<Recording> record(const ConnectOptions& options, const std::string& path);

/// Fetches what the server's flight recorder holds of its last seconds, as a recording, into a file on this machine.
///
/// last     how far back; 0: only what publishers and commands have brought into the world up to now
/// returns  the size of the file in bytes
Result<std::uint64_t> fetch_recording(const ConnectOptions& options, std::chrono::nanoseconds last,
                                      const std::string& path);

// ---- events of a recording -----------------------------------------------------------------------------------------

/// A time in a recording: since 1970, or relative to the recording's begin or end, which are the times of its first and
/// last sample by the recorder's clock.
struct RunTime {
  enum class Since { year_1970, begin, end };
  Since since = Since::year_1970;
  std::chrono::nanoseconds offset{0};  // negative: before it
};

/// Which events of a recording to return.
struct RecordedEventsOptions {
  std::string only = {};  // as in WatchOptions
  std::string skip = {};
  std::optional<RunTime> from = {};  // included; not set: from the recording's begin
  std::optional<RunTime> to = {};    // included; not set: to its end
};

/// The events of a recording.
struct RecordedEvents {
  std::vector<Event> events;
  std::chrono::nanoseconds begin{0};  // of the recording
  std::chrono::nanoseconds end{0};
  std::vector<std::string> scenes;    // names of those that the server had loaded, by its last status
  std::uint64_t lost = 0;             // known to have been sent, but not in the file
  std::vector<std::string> warnings;  // damage of the file, events that are lost, contacts of unknown age
};

/// Reads the events of a recording; no server is needed. What held before `from` comes first, as `open`, then each
/// event in the order of happened(). Error bad_input where the file cannot be read.
Result<RecordedEvents> recorded_events(const std::string& path, const RecordedEventsOptions& options = {});

/// The events of a recording's standing questions.
struct RecordedStandingEvents {
  std::vector<StandingEvent> events;
  std::chrono::nanoseconds begin{0};  // of the recording
  std::chrono::nanoseconds end{0};
  std::uint64_t lost = 0;             // known to have been sent, but not in the file
  std::vector<std::string> warnings;  // damage of the file, events that are lost, stays of unknown age
};

/// Reads them; no server is needed. They are what a StandingWatch would have reported: what held before `from` first, as
/// `inside`, `within` and `is`, then each event in the order of its number. `only` and `skip` are as in
/// StandingWatchOptions. Error bad_input where the file cannot be read.
Result<RecordedStandingEvents> recorded_standing_events(const std::string& path,
                                                        const RecordedEventsOptions& options = {});

// ---- the picture of a recording ------------------------------------------------------------------------------------

/// A message of an OwnChannel.
struct OwnMessage {
  std::string schema_name;
  std::string data;
};

/// A change of what a recording shows.
struct PictureChange {
  std::chrono::nanoseconds at{0};  // since the recording's begin
  /// All objects, where everything that moves is, events, a status, or a message of a channel of the recorder's own.
  std::variant<std::shared_ptr<const ShownObjects>, Poses, std::vector<Event>, ServerStatus, OwnMessage> what;
};

/// The choice of what a recording shows, and how finely.
struct PictureOptions {
  /// Objects that stand still and are in no recording, such as the parts of scenes. Recorded commands may remove them.
  std::shared_ptr<const ShownObjects> surroundings = {};
  std::chrono::nanoseconds frame{33'000'000};       // from poses to poses, at least
  std::chrono::nanoseconds table{100'000'000};      // from one table of all objects to the next, at least
  std::size_t most_poses = std::size_t{8'000'000};  // of all frames together; with more, frames are farther apart
  std::function<bool()> go_on = {};                 // called many times a second; false ends the reading
};

/// A recording whose picture was read.
struct RecordedPicture {
  std::chrono::nanoseconds length{0};
  std::vector<std::string> warnings;  // damage of the file, messages that could not be read
};

/// Reads what a recording shows, as a viewer of its server would have seen it: objects with their shapes, poses, contacts
/// that held at the begin as `open`, events, statuses; no server is needed. Objects have numbers of their own, equal for
/// equal names, also in events. Commands count from their answers on; refused ones do nothing. Error bad_input where the
/// file cannot be read.
///
/// take  called with each change in the order of time, on the calling thread
Result<RecordedPicture> recorded_picture(const std::string& path, const PictureOptions& options,
                                         const std::function<void(const PictureChange&)>& take);

// ---- replay --------------------------------------------------------------------------------------------------------

/// How to replay a recording.
struct ReplayOptions {
  std::string path;                  // of the recording
  double rate = 1;                   // 2 is twice as fast as recorded; above 0 up to 1e6
  bool ask = false;                  // ask the recorded questions again, state by state; the rate does not matter
  std::function<bool()> go_on = {};  // called many times a second on the calling thread; false ends the replay
  std::optional<RunTime> from = {};  // what came before is published at once; not set: the recording's begin
  std::optional<RunTime> to = {};    // what came after is left out; not set: the recording's end
  /// Called once all is in the world and before it is taken out again, on a thread of its own. Where `rate` is 1, times
  /// of the replayed world are `shift` after those of the recording.
  std::function<void(std::chrono::nanoseconds shift)> at_end = {};
};

/// What was published, and how the answers compare with the recorded ones, where the state that a question was about
/// could be made again.
struct ReplayReport {
  std::uint64_t samples = 0;                  // definitions and pose batches that were published
  std::uint64_t commands = 0;                 // that add, move, remove, attach or allow something, sent again
  std::uint64_t questions = 0;                // asked again
  std::uint64_t equal = 0;                    // answered with the same bits
  std::uint64_t not_compared = 0;             // questions that were left out
  std::vector<std::string> why_not_compared;  // "12 answered before the recording knew what was in the world"
  std::vector<std::string> differences;       // one sentence each, the first 20
  std::vector<std::string> warnings;          // damage of the file, commands left out, scenes that are missing
  bool stopped = false;                       // by ReplayOptions::go_on
  std::uint64_t standing = 0;                 // standing questions that were made again
};

/// Publishes a recording's objects and poses again, by publishers of its own; their objects are removed at the end. What
/// commands made stays: objects, and standing questions that were kept; others go when the recorded client that had added them
/// does, or with the replay. Scenes that the server had loaded from files must be loaded first. It returns when the replay has
/// ended.
Result<ReplayReport> replay(const ConnectOptions& connect, const ReplayOptions& options);

}  // namespace collided

#pragma GCC visibility pop
