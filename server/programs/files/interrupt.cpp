#include "server/programs/files/interrupt.hpp"

#include <atomic>
#include <csignal>

namespace collided::engine::files {
namespace {

std::atomic<bool> interrupted = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler sets it");

}  // namespace

void listen_for_interrupt() {
  struct sigaction action {};
  action.sa_handler = [](int) { interrupted.store(true); };
  action.sa_flags = SA_RESTART;
  ::sigaction(SIGINT, &action, nullptr);
}

bool is_interrupted() { return interrupted.load(); }

void end_if_interrupted() {
  if (is_interrupted()) throw Interrupted();
}

}  // namespace collided::engine::files
