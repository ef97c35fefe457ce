#include "client/library/connection/workers.hpp"

#include <utility>

namespace collided::client {

Workers::~Workers() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  for (std::thread& thread : threads_) {
    thread.join();  // waiting tasks still run, since callers may wait for their futures
  }
}

bool Workers::run(std::function<void()> task) {
  const std::lock_guard lock(mutex_);
  if (tasks_.size() >= kMostWaiting) { return false; }
  tasks_.push_back(std::move(task));
  if (threads_.size() < kThreads) {
    threads_.emplace_back([this] { work(); });
  }
  changed_.notify_one();
  return true;
}

void Workers::work() {
  while (true) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return ending_ || !tasks_.empty(); });
    if (tasks_.empty()) { return; }
    const std::function<void()> task = std::move(tasks_.front());
    tasks_.pop_front();
    lock.unlock();
    task();
  }
}

}  // namespace collided::client
