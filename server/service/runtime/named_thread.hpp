#pragma once

#include <new>
#include <pthread.h>
#include <thread>
#include <utility>

#include "server/service/runtime/out_of_memory.hpp"

namespace collided::engine::service {

/// A thread of that name, which top and gdb show. Where its body finds no memory and takes no care of that itself, the
/// process ends as end_out_of_memory() says: an exception out of a thread would end it without a word.
///
/// name  at most 15 characters; must outlive the thread
template <class Body>
std::thread named_thread(const char* name, Body body) {
  return std::thread([name, body = std::move(body)]() mutable {
    pthread_setname_np(pthread_self(), name);
    try {
      body();
    } catch (const std::bad_alloc&) { end_out_of_memory(name); }
  });
}

}  // namespace collided::engine::service
