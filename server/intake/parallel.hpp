#pragma once

#include <cstddef>
#include <functional>

namespace collided::engine {

/// Runs task(0) ... task(task_count - 1) on as many threads as there are cores, the calling one among them.
///
/// between   called on the calling thread after each of its own tasks, with the number of tasks done. It may throw,
///           which ends the run
/// promise   all other threads have ended when this returns or throws
/// throws    the exception of the task with the smallest number, so that the outcome does not depend on the threads
void run_in_parallel(std::size_t task_count, const std::function<void(std::size_t)>& task,
                     const std::function<void(std::size_t)>& between);

}  // namespace collided::engine
