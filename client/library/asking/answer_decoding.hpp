#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/library/connection/names.hpp"
#include "collided/client.hpp"
#include "idl/dds.hpp"

namespace collided::client {

/// Assembles the answers to one request from its replies, which may come in any order and repeatedly.
/// threads  one at a time
class AnswerCollector {
 public:
  /// questions_per_chunk  in each of the request's chunks except the last
  /// names                receives the names of objects in the replies
  /// earlier              answers whose memory is reused
  AnswerCollector(std::size_t question_count, std::size_t questions_per_chunk, Names& names, Answers&& earlier = {});

  /// Adds a reply. Returns the error if it is a refusal or inconsistent.
  std::optional<Error> add(const wire::Reply& reply);
  std::size_t chunks_answered() const { return chunks_answered_; }
  /// True when every question has its answer.
  bool complete() const { return answered_ == result_.answers.size(); }
  Answers take() { return std::move(result_); }

 private:
  std::optional<Error> check(const wire::Reply& reply) const;
  void note_state(const wire::Reply& reply);
  void note_answered(std::size_t first, std::size_t count);

  Names& names_;
  Answers result_;
  std::size_t questions_per_chunk_;
  std::vector<std::uint8_t> seen_;
  std::vector<std::uint32_t> open_in_chunk_;
  std::size_t chunks_answered_ = 0;
  std::size_t answered_ = 0;
};

/// The error for a refusal, with the message and hint of its text {"error": ..., "hint": ...}.
Error refusal(const std::string& text);

/// The text of a reply.
std::string text_of(const wire::Reply& reply);

}  // namespace collided::client
