#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <list>
#include <string>
#include <thread>
#include <vector>

#include "server/service/commands/bound_command.hpp"
#include "server/service/commands/command_answers.hpp"
#include "server/service/commands/geometry_encoding.hpp"
#include "server/service/questions/answering.hpp"
#include "server/service/runtime/work_queue.hpp"
#include "server/world/world.hpp"

namespace collided::engine::service {

/// Sends geometry and poses to viewers, in pages, on a thread of its own: the commands shapes, surface, snapshot and more. Every
/// buffer is of one state. A buffer is kept until its last page was sent, for half a minute without a request, or until
/// too many wait.
class GeometryService {
 public:
  /// world, answers  must outlive this
  GeometryService(const World& world, CommandAnswers& answers);
  ~GeometryService() { stop(); }
  GeometryService(const GeometryService&) = delete;
  GeometryService& operator=(const GeometryService&) = delete;

  /// The commands `shapes`, `surface`, `snapshot` and `more`, which its own thread answers through `answers`, and `poses`, which
  /// the asking thread answers. They must not outlive this.
  std::vector<BoundCommand> commands();
  /// Refuses waiting commands, then ends the thread.
  void stop();

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::size_t kMostJobs = 64;       // commands waiting
  static constexpr std::size_t kMostTransfers = 64;  // buffers kept
  static constexpr std::size_t kPageBytes = std::size_t{8} << 20;
  static constexpr std::uint64_t kMostKeptBytes = std::uint64_t{1} << 30;  // of all buffers kept
  static constexpr std::chrono::seconds kPatience{30};

  /// A buffer with pages left to send.
  struct Transfer {
    std::uint64_t number = 0;
    std::string bytes;
    Clock::time_point asked_at;
  };

  using Handler = std::string (GeometryService::*)(const Arguments&);
  /// A waiting command, and its handler.
  struct Job {
    CommandAsk ask;
    Handler handler;
  };

  void answer(const CommandAsk& ask, Handler handler);
  std::string poses(const Arguments& arguments);
  std::string shapes(const Arguments& arguments);
  std::string snapshot(const Arguments& arguments);
  std::string surface(const Arguments& arguments);
  std::string more(const Arguments& arguments);
  std::string first_page(std::string bytes);
  void make_room(std::size_t byte_count);

  const World& world_;
  CommandAnswers& answers_;
  SurfaceNumbers numbers_;
  std::list<Transfer> transfers_;  // ordered by last request, oldest first
  std::uint64_t newest_transfer_ = 0;
  WorkQueue<Job> jobs_;
  std::atomic<bool> stopping_{false};
};

}  // namespace collided::engine::service
