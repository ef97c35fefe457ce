#include "server/service/questions/short_questions.hpp"

#include "idl/instant.hpp"
#include "server/service/questions/ask.hpp"

namespace collided::engine::service {

bool ShortQuestions::is_short(const wire::Query& query, std::int64_t now_ns) const {
  return now_ns >= not_before_ns_ && is_single(query) && query.text[0] == 0 &&
         query.instant == static_cast<std::uint8_t>(wire_contract::AskedInstant::Kind::latest) &&
         query.kind != static_cast<std::uint8_t>(wire_contract::QuestionKind::sweep) &&
         query.kind != static_cast<std::uint8_t>(wire_contract::QuestionKind::what_if);
}

void ShortQuestions::took(std::int64_t started_ns, std::int64_t ended_ns) {
  long_in_a_row_ = ended_ns - started_ns > kLongNs ? long_in_a_row_ + 1 : 0;
  if (long_in_a_row_ < kMostLong) return;
  not_before_ns_ = ended_ns + kPauseNs;
  long_in_a_row_ = 0;
}

}  // namespace collided::engine::service
