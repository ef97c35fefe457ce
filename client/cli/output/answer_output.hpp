#pragma once

#include <optional>
#include <string>

#include <collided/client.hpp>

#include "client/cli/failure.hpp"
#include "client/cli/input/question.hpp"
#include "client/cli/output/output.hpp"

namespace collided::cli {

/// How a verb's answers are printed.
struct AnswerView {
  QuestionKind kind = QuestionKind::ray;
  bool several = false;  // all hits were requested, so each is printed with its number
  bool count_only = false;
  bool with_id = false;  // for batches: every record begins with the question's id
};

/// Prints an answer as records, or as lines for people; hits are in the order of the answer.
void print_answer(Printer& printer, const AnswerView& view, const RawJson& id, const Answer& answer);

/// Prints a refused question of a batch: the answer `invalid` with its line.
void print_refused(Printer& printer, const AnswerView& view, const RawJson& id, std::size_t line);

/// The exit code for an answer: yes, no or undecided.
Exit exit_of(const Answer& answer);

/// A reason for people, as a sentence.
std::string_view explain(UndecidedReason reason);
/// A reason for machines, as a word.

/// The cost of an answer: "41 us: 7 nodes, 2 exact tests; world 18204, poses 2.1 ms old".
std::string cost_line(const Answers& answers, const Answer& answer);

}  // namespace collided::cli
