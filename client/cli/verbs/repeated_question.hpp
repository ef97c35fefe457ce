#pragma once

#include <chrono>

#include "client/cli/output/answer_output.hpp"
#include "client/cli/session.hpp"

namespace collided::cli {

/// How often and how long to ask.
struct RepeatedQuestionOptions {
  AskOptions ask;
  QuestionKind kind = QuestionKind::ray;
  std::uint64_t most_changes = 0;  // 0: any number
  std::chrono::nanoseconds most_time = std::chrono::nanoseconds::max();
  std::chrono::nanoseconds every = std::chrono::milliseconds(10);
};

/// Asks one question repeatedly and prints changes: an object that enters or leaves the answer, a distance that changes
/// (rays and near), an answer that becomes undecided or decided. Answers about one version of the world are not
/// compared. Ends with a summary after `most_changes`, after `most_time`, or on Ctrl-C.
Exit run_repeated(Session& session, const Globals& globals, const Questions& question,
                  const RepeatedQuestionOptions& options);

}  // namespace collided::cli
