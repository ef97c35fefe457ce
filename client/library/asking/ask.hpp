#pragma once

#include <span>

#include "client/library/asking/question_encoding.hpp"
#include "client/library/connection/connection.hpp"

namespace collided::client {

/// Checks every question, sends them in chunks with a few in flight, and waits for all the answers.
/// Instantiated for the four question types.
///
/// earlier  answers whose memory is used again
template <class Question>
Result<Answers> ask(Connection& connection, std::span<const Question> questions, const AskOptions& options,
                    Answers&& earlier = {});

/// The same for motions of one shape, which is sent with each chunk.
Result<Answers> sweep(Connection& connection, const Shape& shape, std::span<const SweepQuestion> motions,
                      const AskOptions& options);

}  // namespace collided::client
