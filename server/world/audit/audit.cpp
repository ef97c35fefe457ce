#include "server/world/audit/audit.hpp"

#include <fmt/format.h>

#include "server/world/audit/exact_answer.hpp"

namespace collided::engine {

namespace {

/// For near: nothing farther than the last answered one can contradict.
double far_of(const Questions& question, const Answers& given) {
  if (question.kind != QuestionKind::near || given.hits.size() < question.max_hits) return question.numbers.back();
  return given.hits.back().distance_m + given.hits.back().error_m;
}

}  // namespace

std::string audit(const Snapshot& snapshot, const Questions& question, const Answers& given) {
  const bool claims = given.answers[0] == Verdict::hit || given.answers[0] == Verdict::miss ||
                      given.reasons[0] == UndecidedReason::truncated;
  if (!claims) return {};
  const std::string difference = ExactAnswer(snapshot, question, far_of(question, given)).difference(given);
  if (difference.empty()) return {};
  return fmt::format("{} {:.17g}: {}", name_of(question.kind), fmt::join(question.numbers, " "), difference);
}

}  // namespace collided::engine
