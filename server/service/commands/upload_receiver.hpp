#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "server/service/commands/command_arguments.hpp"
#include "server/service/questions/answering.hpp"
#include "server/service/runtime/work_queue.hpp"

namespace collided::engine::service {

/// Takes files of clients in pieces, in any order and any number of times, each with its checksum, into a folder of its
/// own; a file that is there to its last byte is handed on to be loaded. On a thread of its own. What is begun and not gone
/// on with for a minute is thrown away; all that lies there is at most a gibibyte.
class UploadReceiver {
 public:
  using Send = std::function<void(const CommandAsk&, wire_contract::ReplyStatus, std::string)>;
  /// The `load` that a client asked for, and the file it meant; throws BadCommand.
  using Load = std::function<void(CommandAsk ask, const std::string& path)>;

  /// folder  empty: every upload is refused. Made when it is needed.
  /// keep    of an earlier server's files, those in whose folder's name one of these texts speaks stay; the others go
  UploadReceiver(std::string folder, const std::vector<CommandAsk>& keep, Send send, Load load);
  ~UploadReceiver() { stop(); }
  UploadReceiver(const UploadReceiver&) = delete;
  UploadReceiver& operator=(const UploadReceiver&) = delete;

  /// Any thread; the answer comes later. An `upload`, a `piece`, or a `load` of an upload.
  void take(CommandAsk ask);
  /// Whether the path is that of a file that was taken here. Any thread.
  bool has_taken(const std::string& path) const;
  /// The file is needed no longer. Any thread.
  void forget(const std::string& path);
  void stop();

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::size_t kMostJobs = 64;
  static constexpr std::size_t kMostUnderWay = 8;
  static constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 30;
  static constexpr std::chrono::seconds kPatience{60};
  struct Forget {
    std::string path;
  };
  using Job = std::variant<CommandAsk, Forget>;

  /// A file on its way.
  struct Upload {
    std::uint64_t client = 0;
    std::string path;
    int file = -1;
    std::uint64_t bytes = 0;
    std::uint32_t checksum = 0;
    std::vector<std::int64_t> pieces;  // checksum of each, -1 where it has yet to come
    std::uint64_t missing = 0;
    Clock::time_point asked_at;
  };

  void work(const CommandAsk& ask);
  std::string begin(const CommandAsk& ask, const Arguments& arguments);
  std::string piece(const CommandAsk& ask, const Arguments& arguments);
  void commit(const CommandAsk& ask, const Arguments& arguments);
  Upload& find(const CommandAsk& ask, const Arguments& arguments);
  void drop(std::map<std::uint64_t, Upload>::iterator upload);
  void remove_file(const std::string& path);
  void drop_forgotten();

  std::string folder_;
  Send send_;
  Load load_;
  std::map<std::uint64_t, Upload> uploads_;
  std::map<std::string, std::uint64_t> bytes_;  // of every file in the folder, by path
  WorkQueue<Job> jobs_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace collided::engine::service
