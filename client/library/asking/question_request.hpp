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

/// The questions of one call, whatever their type.
struct QuestionRequest {
  wire_contract::QuestionKind kind;
  const char* noun;
  std::uint32_t number_count;  // per question
  std::size_t question_count;
  std::function<void(std::size_t first, std::size_t count, double* numbers)> encode;  // writes some of the questions
  std::span<const std::uint8_t> blob = {};  // the shape of sweeps, the names of a what-if
  std::string text = {};                    // JSON, of a what-if
  std::size_t most_in_chunk = wire_contract::kMaxQuestionsPerChunk;
};

/// Sends the questions in chunks, a few in flight, and waits for all answers. A server that has no room says when it will
/// have some: the request waits as long as its timeout allows.
///
/// earlier  answers whose memory is used again
Result<Answers> run(Connection& connection, const QuestionRequest& request, const AskOptions& options,
                    Answers&& earlier);

}  // namespace collided::client
