#include "server/service/self_test.hpp"

#include "server/world/audit/audit.hpp"
#include "server/world/audit/random_questions.hpp"

namespace collided::engine::service {

SelfTestResult self_test(const Snapshot& snapshot, std::uint32_t question_count, std::uint64_t seed) {
  constexpr std::size_t kMostReported = 5;
  RandomQuestions random(snapshot, seed);
  SelfTestResult result;
  Answers answers;
  QueryScratch scratch;
  for (std::uint32_t i = 0; i < question_count; ++i) {
    for (const QuestionKind kind : kPlainQuestions) {
      const std::vector<double> numbers = random.question(kind);
      const Questions question{
          .kind = kind, .max_hits = kind == QuestionKind::near ? 3U : 0xffffffffU, .numbers = numbers};
      answer(snapshot, question, answers, scratch);
      const std::string difference = audit(snapshot, question, answers);
      ++result.asked;
      if (difference.empty()) ++result.equal;
      else if (result.differences.size() < kMostReported) result.differences.push_back(difference);
    }
  }
  return result;
}

}  // namespace collided::engine::service
