#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/library/connection/names.hpp"
#include "collided/client.hpp"
#include "idl/dds.hpp"

namespace collided::client {

/// Puts a request's replies together, in whatever order they come.
class AnswerCollector {
 public:
  /// questions_per_chunk: of the request's chunks but the last.
  AnswerCollector(std::size_t question_count, std::size_t questions_per_chunk, Names& names, Answers&& earlier = {});

  /// The error when the reply is a refusal or makes no sense.
  std::optional<Error> add(const wire::Reply& reply);
  std::size_t chunks_answered() const { return chunks_answered_; }
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

/// A refusal's message and hint, from its text {"error": ..., "hint": ...}.
Error refusal(const std::string& text);

/// A reply's text.
std::string text_of(const wire::Reply& reply);

}  // namespace collided::client
