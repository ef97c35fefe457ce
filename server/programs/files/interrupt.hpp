#pragma once

#include <exception>

namespace collided::engine::files {

/// From now on Ctrl-C (SIGINT) only sets is_interrupted(), so that nothing half written stays behind.
void listen_for_interrupt();

/// threads  any
bool is_interrupted();

/// Thrown by what ends because the user said so: no error.
struct Interrupted : std::exception {
  const char* what() const noexcept override { return "interrupted"; }
};

/// Throws Interrupted.
void end_if_interrupted();

}  // namespace collided::engine::files
