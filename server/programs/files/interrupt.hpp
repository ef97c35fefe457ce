#pragma once

#include <exception>

namespace collided::engine::files {

/// After this call Ctrl-C (SIGINT) only sets is_interrupted(), so that nothing is left half written.
void listen_for_interrupt();

/// Whether Ctrl-C was pressed since listen_for_interrupt().
///
/// threads  any
bool is_interrupted();

/// Thrown to end at the user's request; not an error.
struct Interrupted : std::exception {
  const char* what() const noexcept override { return "interrupted"; }
};

/// Throws Interrupted if is_interrupted().
void end_if_interrupted();

}  // namespace collided::engine::files
