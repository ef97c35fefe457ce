#pragma once

#include <string>

#include "client/cli/output/answer_output.hpp"
#include "client/cli/session.hpp"

namespace collided::cli {

struct BatchOptions {
  std::string path;  // "-": stdin
  AskOptions ask;
  AnswerView view;
  bool stop_on_error = false;
};

/// Answers every question of a file or pipe, in its order and with the caller's id: requests of growing size, several in
/// flight, each on one state of the world. A pause of the pipe sends what has come so far. Bad lines are refused one by one.
Exit run_batch(Session& session, const Globals& globals, const BatchOptions& options);

}  // namespace collided::cli
