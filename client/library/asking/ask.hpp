#pragma once

#include <span>

#include "client/library/asking/question_encoding.hpp"
#include "client/library/connection/connection.hpp"

namespace collided::client {

/// Checks every question, sends them in chunks with a few in flight, and waits for all answers. Instantiated for the
/// question types of Client::ask.
///
/// earlier  answers whose memory is reused
template <class Question>
Result<Answers> ask(Connection& connection, std::span<const Question> questions, const AskOptions& options,
                    Answers&& earlier = {});

/// Asks about motions of one shape, which is sent with each chunk.
Result<Answers> sweep(Connection& connection, const Shape& shape, std::span<const SweepQuestion> motions,
                      const AskOptions& options);

}  // namespace collided::client
