#pragma once

#include <cstddef>
#include <optional>

#include "server/world/query/question.hpp"

namespace collided::engine {

/// The answer that needs no search: the numbers are invalid, or the deadline has passed.
std::optional<Verdict> answer_at_once(const Questions& asked, const double* numbers);
void write_at_once(Answers& answers, std::size_t place, Verdict answer);

/// The search ended at its deadline, and what it found does not answer alone.
bool is_cut_short(const Question& question);

/// Writes what a search found as the answer of that place, doubted where it claims something about space of which nothing
/// is known; forgets what was found.
///
/// filter   the questions', whose memory for unknown space is used
/// numbers  of the question
void write_answer(Question& question, const double* numbers, const AnswerFilter& filter, std::size_t place,
                  Answers& answers);

}  // namespace collided::engine
