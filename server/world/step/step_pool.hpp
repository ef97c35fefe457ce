#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "server/world/step/decisions.hpp"

namespace collided::engine {

/// Helper threads that decide blocks of a step. They sleep while there is none.
///
/// threads  all but the constructor and destructor: the world's
class StepPool {
 public:
  /// Decides a block; `lists` are the thread's own, with this step's boxes.
  using Decide = std::function<void(StepBlock& block, DecisionLists& lists)>;

  /// The threads start with the first shared step.
  explicit StepPool(unsigned helpers) : helpers_(helpers) {}
  ~StepPool();
  StepPool(const StepPool&) = delete;
  StepPool& operator=(const StepPool&) = delete;

  /// Call before the first block of a step.
  void begin_step(Decide decide, std::size_t slot_count);
  /// Queues a block. The block and the data that it reads must not change until finish().
  void push(StepBlock& block);
  /// Takes part in deciding until all blocks are done. Rethrows an exception thrown while deciding.
  void finish(DecisionLists& own_lists);

 private:
  void run();
  void decide_or_fail(StepBlock& block, DecisionLists& lists);

  const unsigned helpers_;
  std::mutex mutex_;  // guards all but threads_
  std::condition_variable came_;
  std::condition_variable done_;
  std::deque<StepBlock*> waiting_;
  std::size_t under_way_ = 0;
  std::uint64_t step_ = 0;
  std::size_t slot_count_ = 0;
  Decide decide_;
  std::exception_ptr failure_;
  bool is_over_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace collided::engine
