#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace collided::cli {

/// Exit codes of the process. Scripts rely on the numbers: do not change them.
enum class Exit : int {
  yes = 0,             // a hit, or done
  no = 1,              // a miss, nothing found, or a server that is not ready
  bad_use = 2,         // nothing was sent
  undecided = 3,       // neither hit nor miss is certain
  no_server = 4,       // none answers
  refused = 5,         // by the server
  partly_refused = 6,  // some lines of a batch were refused
  interrupted = 130,   // by Ctrl-C
};

/// Thrown to end the verb. `message` is printed after "error: ", and each line of `hint` indented below it.
struct Failure : std::runtime_error {
  Failure(Exit exit_code, const std::string& message, std::string next_step = {})
      : std::runtime_error(message), code(exit_code), hint(std::move(next_step)) {}
  Exit code;
  std::string hint;
  bool is_printed = false;  // by another program already
};

/// The Failure for bad use or bad input: nothing was sent.
inline Failure bad_use(const std::string& message, std::string hint = {}) {
  return {Exit::bad_use, message, std::move(hint)};
}

}  // namespace collided::cli
