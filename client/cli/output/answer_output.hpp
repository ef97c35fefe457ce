#pragma once

#include <optional>
#include <string>

#include <collided/client.hpp>

#include "client/cli/failure.hpp"
#include "client/cli/input/question.hpp"
#include "client/cli/output/output.hpp"

namespace collided::cli {

/// How the answers of a verb are shown.
struct AnswerView {
  QuestionKind kind = QuestionKind::ray;
  bool several = false;  // all hits were asked for: each gets its order
  bool count_only = false;
  bool with_id = false;  // batches: every record starts with the caller's id
};

/// One answer as records, or as lines for people; hits in the order of the answer.
void print_answer(Printer& printer, const AnswerView& view, const RawJson& id, const Answer& answer);

/// A refused question of a batch: answer `invalid` with its line.
void print_refused(Printer& printer, const AnswerView& view, const RawJson& id, std::size_t line);

/// yes, no or undecided.
Exit exit_of(const Answer& answer);

/// "numeric: ..." as people read it.
std::string_view explain(UndecidedReason reason);
std::string_view name_of(UndecidedReason reason);

/// "41 us: 7 nodes, 2 exact tests; world 18204, poses 2.1 ms old"
std::string cost_line(const Answers& answers, const Answer& answer);

}  // namespace collided::cli
