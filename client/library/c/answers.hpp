#pragma once

#include <memory>
#include <utility>
#include <vector>

#include <collided.h>
#include <collided/client.hpp>

/// What collided.h hands out: answers, with where the hits of each question begin.
struct collided_answers {
  collided::Answers answers;
  std::vector<std::size_t> first_hit;  // number of each question's first hit; one more at the end: of all hits

  void take(collided::Answers&& given) {
    answers = std::move(given);
    first_hit.assign(1, 0);
    first_hit.reserve(answers.answers.size() + 1);
    for (const collided::Answer& answer : answers.answers) first_hit.push_back(first_hit.back() + answer.hits.size());
  }
};

namespace collided::c {

/// Gives the caller new answers in place of earlier ones, which are freed; after an error there are none.
inline Result<void> hand_over(Result<Answers> said, collided_answers** answers) {
  auto kept = std::make_unique<collided_answers>();
  delete std::exchange(*answers, nullptr);
  if (!said) return said.error();
  kept->take(std::move(*said));
  *answers = kept.release();
  return {};
}

}  // namespace collided::c
