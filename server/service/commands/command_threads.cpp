#include "server/service/commands/command_threads.hpp"

#include <fmt/format.h>

#include "server/service/commands/command_arguments.hpp"
#include "server/service/runtime/named_thread.hpp"

namespace collided::engine::service {

CommandThreads::CommandThreads() {
  slow_jobs_.serve("loads", [](const Job& job) { job(); });
  const auto staff = [](const char* name, FairQueue<Job>& jobs) {
    jobs.staff(1, [name, &jobs] {
      return [name, &jobs] {
        serve_here(name, [&] {
          while (std::optional<Job> job = jobs.pop()) (*job)();
        });
      };
    });
  };
  staff("pairs", pair_jobs_);
  staff("costly pairs", costly_jobs_);
}

void CommandThreads::stop() {
  slow_jobs_.finish();
  pair_jobs_.finish();
  costly_jobs_.finish();  // only now: until it ended, the thread for pairs may have passed one on
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
