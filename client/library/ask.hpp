#pragma once

#include <span>

#include "client/library/connection.hpp"
#include "client/library/question_encoding.hpp"

namespace collided::client {

/// Checks every question, sends them in chunks with a few in flight, and waits for all the answers.
/// Instantiated for the four kinds of question.
/// earlier  answers whose memory serves again
template <class Question>
Result<Answers> ask(Connection& connection, std::span<const Question> questions, const AskOptions& options,
                    Answers&& earlier = {});

/// The same for ways of one shape, which travels with each chunk.
Result<Answers> sweep(Connection& connection, const Shape& shape, std::span<const SweepQuestion> motions,
                      const AskOptions& options);

}  // namespace collided::client
