#pragma once

#include <string>

#include "client/cli/output/answer_output.hpp"
#include "client/cli/session.hpp"

namespace collided::cli {

/// What to read and how to answer it.
struct BatchOptions {
  std::string path;  // "-": stdin
  AskOptions ask;
  AnswerView view;
  bool stop_on_error = false;
};

/// Answers every question of a file or pipe, in order and with its id. Sends requests of growing size, several at a
/// time, each about one state of the world. When the pipe pauses it sends the available ones. Bad lines are refused one
/// by one.
Exit run_batch(Session& session, const Globals& globals, const BatchOptions& options);

}  // namespace collided::cli
