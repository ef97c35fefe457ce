#pragma once

#include <new>
#include <pthread.h>
#include <thread>
#include <utility>

#include "server/service/runtime/out_of_memory.hpp"

namespace collided::engine::service {

/// Runs the body on this thread under that name, which top and gdb show. If the body runs out of memory without
/// handling it, the process ends by end_out_of_memory(): an exception out of a thread would end it without a message.
///
/// name  at most 15 characters; must outlive the thread
template <class Body>
void serve_here(const char* name, Body&& body) {
  pthread_setname_np(pthread_self(), name);
  try {
    body();
  } catch (const std::bad_alloc&) { end_out_of_memory(name); }
}

/// Starts a thread for the same.
template <class Body>
std::thread named_thread(const char* name, Body body) {
  return std::thread([name, body = std::move(body)]() mutable { serve_here(name, body); });
}

}  // namespace collided::engine::service
