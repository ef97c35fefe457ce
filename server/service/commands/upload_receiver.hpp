#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "server/service/commands/bound_command.hpp"
#include "server/service/commands/command_answers.hpp"
#include "server/service/questions/answering.hpp"
#include "server/service/runtime/work_queue.hpp"

namespace collided::engine::service {

/// Receives files from clients on a thread of its own: in pieces, in any order and any number of times, each with its
/// checksum, into a folder of its own. A complete file is passed on for loading. An upload without a piece for a minute
/// is dropped; all files together take at most a gibibyte.
class UploadReceiver {
 public:
  /// Loads the file at `path` of that CRC-32, which the client's `load` refers to; throws BadCommand.
  using Load = std::function<void(CommandAsk ask, const std::string& path, std::uint32_t checksum)>;

  /// folder  empty: every upload is refused; made on first use
  /// keep    commands to be repeated: files of an earlier server that none of these texts names are removed
  UploadReceiver(std::string folder, const std::vector<KeptCommand>& keep, CommandAnswers& answers, Load load);
  ~UploadReceiver() { stop(); }
  UploadReceiver(const UploadReceiver&) = delete;
  UploadReceiver& operator=(const UploadReceiver&) = delete;

  /// The commands `upload` and `piece`, which its own thread answers through `answers`. They must not outlive this.
  std::vector<BoundCommand> commands();
  /// Queues a `load` of an upload, answered the same way. Throws BadCommand if too many commands wait. Any thread.
  void take_load(CommandAsk ask) { take(std::move(ask), &UploadReceiver::commit); }
  /// Whether the path is that of a file received here. Any thread.
  bool has_taken(const std::string& path) const;
  /// Removes a received file that is no longer needed; other paths are ignored. Any thread.
  void forget(const std::string& path);
  /// Refuses waiting commands, ends the thread, and drops incomplete uploads.
  void stop();

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::size_t kMostJobs = 64;                         // waiting
  static constexpr std::size_t kMostUnderWay = 8;                      // uploads
  static constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 30;  // of all files in the folder
  static constexpr std::chrono::seconds kPatience{60};
  using Handler = void (UploadReceiver::*)(const CommandAsk&, const Arguments&);
  struct Asked {
    CommandAsk ask;
    Handler handler;
  };
  struct Forget {
    std::string path;
  };
  using Job = std::variant<Asked, Forget>;

  /// A file with missing pieces.
  struct Upload {
    std::uint64_t client = 0;
    std::string path;
    int file = -1;
    std::uint64_t bytes = 0;
    std::uint32_t checksum = 0;        // CRC-32 of the whole file
    std::vector<std::int64_t> pieces;  // CRC-32 of each; -1: still missing
    std::uint64_t missing = 0;         // pieces
    Clock::time_point asked_at;
  };

  void take(CommandAsk ask, Handler handler);
  void work(const Asked& asked);
  void begin(const CommandAsk& ask, const Arguments& arguments);
  void piece(const CommandAsk& ask, const Arguments& arguments);
  void commit(const CommandAsk& ask, const Arguments& arguments);
  Upload& find(const CommandAsk& ask, const Arguments& arguments);
  void drop(std::map<std::uint64_t, Upload>::iterator upload);
  void remove_file(const std::string& path);
  void drop_forgotten();

  std::string folder_;
  CommandAnswers& answers_;
  Load load_;
  std::map<std::uint64_t, Upload> uploads_;     // by number
  std::map<std::string, std::uint64_t> bytes_;  // of every file in the folder, by path
  WorkQueue<Job> jobs_;
  std::atomic<bool> stopping_{false};
};

}  // namespace collided::engine::service
