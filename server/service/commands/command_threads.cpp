#include "server/service/commands/command_threads.hpp"

#include <fmt/format.h>

#include "server/service/commands/command_arguments.hpp"
#include "server/service/runtime/named_thread.hpp"

namespace collided::engine::service {

CommandThreads::CommandThreads() {
  const auto work = [](const char* name, auto& jobs) {
    return named_thread(name, [&jobs] {
      while (std::optional<Job> job = jobs.pop()) (*job)();
    });
  };
  slow_thread_ = work("loads", slow_jobs_);
  pair_thread_ = work("pairs", pair_jobs_);
  costly_thread_ = work("costly pairs", costly_jobs_);
}

void CommandThreads::stop() {
  slow_jobs_.close();
  if (slow_thread_.joinable()) slow_thread_.join();
  pair_jobs_.close();
  if (pair_thread_.joinable()) pair_thread_.join();
  // Closed only now: the thread for pairs may have passed one on until it ended.
  costly_jobs_.close();
  if (costly_thread_.joinable()) costly_thread_.join();
}

void CommandThreads::require_room(const char* what) const {
  if (!slow_jobs_.has_room())
    throw BadCommand(fmt::format("{}: too many such commands wait already", what), "ask again");
}

void CommandThreads::push(const char* what, FairQueue<Job>& jobs, const Share& share, Job job) {
  if (!jobs.push(share, job))
    throw BadCommand(fmt::format("{}: too many such commands wait already", what), "ask again");
}

}  // namespace collided::engine::service
