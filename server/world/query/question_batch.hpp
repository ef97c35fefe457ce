#pragma once

#include <array>
#include <cstddef>

#include "server/world/query/question.hpp"

namespace collided::engine {

/// Answers the questions of one message one by one, or rays in groups. The answers are the same either way.
/// threads  one; the scratch holds the filter of these questions, and memory
class QuestionBatch {
 public:
  QuestionBatch(const Snapshot& snapshot, const Questions& asked, QueryScratch& scratch, Answers& answers);

  /// returns  the number answered before the pause, or before one was given up
  std::size_t answer_all(std::size_t count) const;
  /// Answers a plain ray that may meet a moving object.
  ///
  /// returns  false: it was given up, and has no answer
  bool answer_with_movers(std::size_t place, const PlainRay& ray) const;

 private:
  const double* numbers_of(std::size_t place) const { return asked_.numbers.data() + place * stride_; }
  const std::vector<std::uint8_t>& allowed() const { return scratch_.filter().allowed.by_slot(); }
  bool rays_gain_together(std::size_t count) const;

  // Each returns false if the question was given up, and has no answer.
  bool answer_one(std::size_t place) const;
  bool answer_in_general(std::size_t place) const;
  template <class Ask>
  bool answer_by(std::size_t place, const Ask& ask_question) const;
  bool answer_plain_ray(std::size_t place) const;
  bool finish_plain_ray(std::size_t place, PlainRay& ray) const;

  // Each walks up to kRaysAtOnce rays together and returns how many have an answer.
  std::size_t answer_plain_rays(std::size_t first, std::size_t count) const;
  std::size_t answer_rays(std::size_t first, std::size_t count) const;

  const Snapshot& snapshot_;
  const Questions& asked_;
  QueryScratch& scratch_;
  Answers& answers_;
  std::uint32_t stride_;
  bool is_plain_;
};

}  // namespace collided::engine
