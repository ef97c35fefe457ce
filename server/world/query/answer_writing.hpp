#pragma once

#include <cstddef>
#include <optional>

#include "server/world/query/question.hpp"

namespace collided::engine {

/// The answer if none needs a search: the numbers are invalid, or the deadline has passed.
std::optional<Verdict> answer_at_once(const Questions& asked, const double* numbers);
void write_at_once(Answers& answers, std::size_t place, Verdict answer);

/// True if the search ended at its deadline, and its findings alone do not give the answer.
bool is_cut_short(const Question& question);

/// Writes the findings as the answer at that place, as a doubt if it depends on unknown space; then forgets them.
///
/// filter   the questions', whose memory for unknown space is used
/// numbers  of the question
void write_answer(Question& question, const double* numbers, const AnswerFilter& filter, std::size_t place,
                  Answers& answers);

}  // namespace collided::engine
