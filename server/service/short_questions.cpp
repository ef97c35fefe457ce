#include "server/service/short_questions.hpp"

#include "idl/topics.hpp"

namespace collided::service {

using wire_contract::QueryKind;

bool ShortQuestions::is_short(const wire::Query& query, std::int64_t now_ns) const {
  if (now_ns < not_before_ns_ || query.chunk_count != 1) return false;
  switch (static_cast<QueryKind>(query.kind)) {
    case QueryKind::ray:
      return query.numbers._length == wire_contract::kRayNumbers;
    case QueryKind::sphere:
      return query.numbers._length == wire_contract::kSphereNumbers;
    case QueryKind::box:
      return query.numbers._length == wire_contract::kBoxNumbers;
    case QueryKind::near:
      return query.numbers._length == wire_contract::kNearNumbers;
    default:
      return false;
  }
}

void ShortQuestions::took(std::int64_t started_ns, std::int64_t ended_ns) {
  long_in_a_row_ = ended_ns - started_ns > kLongNs ? long_in_a_row_ + 1 : 0;
  if (long_in_a_row_ < kMostLong) return;
  not_before_ns_ = ended_ns + kPauseNs;
  long_in_a_row_ = 0;
}

}  // namespace collided::service
