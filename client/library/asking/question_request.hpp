#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "client/library/connection/connection.hpp"
#include "collided/client.hpp"
#include "idl/topics.hpp"

namespace collided::client {

/// The questions of one call, independent of their type.
struct QuestionRequest {
  wire_contract::QuestionKind kind;
  const char* noun;
  std::uint32_t number_count;  // per question
  std::size_t question_count;
  std::function<void(std::size_t first, std::size_t count, double* numbers)> encode;  // writes some of the questions
  std::span<const std::uint8_t> blob = {};  // the shape of sweeps, the names of a what-if
  std::string text = {};                    // JSON, for a what-if
  std::size_t most_in_chunk = wire_contract::kMaxQuestionsPerChunk;
};

/// Sends the questions in chunks, a few in flight, and waits for all answers. An overloaded server announces when it
/// will have capacity; the request waits for that within its timeout.
///
/// earlier  answers whose memory is reused
Result<Answers> run(Connection& connection, const QuestionRequest& request, const AskOptions& options,
                    Answers&& earlier);

}  // namespace collided::client
