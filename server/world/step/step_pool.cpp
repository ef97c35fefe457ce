#include "server/world/step/step_pool.hpp"

#include <pthread.h>

#include <exception>
#include <utility>

namespace collided::engine {

StepPool::~StepPool() {
  {
    const std::lock_guard lock(mutex_);
    is_over_ = true;
  }
  came_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void StepPool::begin_step(Decide decide, std::size_t slot_count) {
  try {
    while (threads_.size() < helpers_) threads_.emplace_back([this] { run(); });
  } catch (const std::exception&) {
    // Without resources for more threads, the world's thread and the running ones decide all blocks.
  }
  const std::lock_guard lock(mutex_);
  ++step_;
  slot_count_ = slot_count;
  decide_ = std::move(decide);
}

void StepPool::push(StepBlock& block) {
  {
    const std::lock_guard lock(mutex_);
    waiting_.push_back(&block);
  }
  came_.notify_one();
}

void StepPool::finish(DecisionLists& own_lists) {
  std::unique_lock lock(mutex_);
  while (!waiting_.empty()) {
    StepBlock* const block = waiting_.front();
    waiting_.pop_front();
    lock.unlock();
    decide_or_fail(*block, own_lists);
    lock.lock();
  }
  done_.wait(lock, [this] { return under_way_ == 0; });
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

/// An exception of one thread leaves finish(), once the others are done with their blocks.
void StepPool::decide_or_fail(StepBlock& block, DecisionLists& lists) {
  try {
    decide_(block, lists);
  } catch (...) {
    const std::lock_guard lock(mutex_);
    failure_ = std::current_exception();
  }
}

void StepPool::run() {
  pthread_setname_np(pthread_self(), "step");
  DecisionLists lists;
  std::uint64_t step_of_lists = 0;
  std::unique_lock lock(mutex_);
  while (true) {
    came_.wait(lock, [this] { return is_over_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    StepBlock* const block = waiting_.front();
    waiting_.pop_front();
    ++under_way_;
    if (std::exchange(step_of_lists, step_) != step_) lists.boxes.begin_step(slot_count_);
    lock.unlock();
    decide_or_fail(*block, lists);
    lock.lock();
    if (--under_way_ == 0 && waiting_.empty()) done_.notify_one();
  }
}

}  // namespace collided::engine
