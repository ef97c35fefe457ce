#include <gtest/gtest.h>

#include "idl/columns.hpp"
#include "idl/instant.hpp"
#include "server/service/questions/short_questions.hpp"

namespace collided::engine::service {
namespace {

using wire_contract::AskedInstant;
using wire_contract::QuestionKind;

class ShortQuestionsTest : public ::testing::Test {
 protected:
  ShortQuestionsTest() {
    query_.chunk_count = 1;
    set(QuestionKind::ray, wire_contract::kRayNumbers);
  }
  void set(QuestionKind kind, std::uint32_t numbers) {
    query_.kind = static_cast<std::uint8_t>(kind);
    rows_.assign(numbers, 0);
    wire::clear_questions(query_);
    wire::lend_columns(rows_, wire::question_columns(kind), columns_, query_);
  }

  wire::Query query_{};
  std::vector<double> rows_, columns_;
  ShortQuestions questions_;
};

TEST_F(ShortQuestionsTest, OneQuestionIsShortAndMoreAreNot) {
  EXPECT_TRUE(questions_.is_short(query_, 0));
  set(QuestionKind::ray, 2 * wire_contract::kRayNumbers);
  EXPECT_FALSE(questions_.is_short(query_, 0));
  set(QuestionKind::near, wire_contract::kNearNumbers);
  EXPECT_TRUE(questions_.is_short(query_, 0));
  query_.chunk_count = 2;
  EXPECT_FALSE(questions_.is_short(query_, 0));
}

// A past state has to be built first, which takes as long as thousands of rays.
TEST_F(ShortQuestionsTest, AQuestionAboutAnEarlierInstantIsNot) {
  for (const auto instant : {AskedInstant::Kind::settled, AskedInstant::Kind::at, AskedInstant::Kind::back}) {
    query_.instant = static_cast<std::uint8_t>(instant);
    EXPECT_FALSE(questions_.is_short(query_, 0)) << int{query_.instant};
  }
  query_.instant = static_cast<std::uint8_t>(AskedInstant::Kind::latest);
  EXPECT_TRUE(questions_.is_short(query_, 0));
}

TEST_F(ShortQuestionsTest, CommandsAndGreetingsAreNot) {
  for (const QuestionKind kind : {QuestionKind::command, QuestionKind::hello}) {
    set(kind, 0);
    EXPECT_FALSE(questions_.is_short(query_, 0));
  }
}

TEST_F(ShortQuestionsTest, TwoLongOnesInARowEndItForATenthOfASecond) {
  questions_.took(0, 60'000);
  EXPECT_TRUE(questions_.is_short(query_, 60'000));
  questions_.took(60'000, 61'000);
  questions_.took(61'000, 120'000);
  EXPECT_TRUE(questions_.is_short(query_, 120'000));
  questions_.took(120'000, 200'000);
  EXPECT_FALSE(questions_.is_short(query_, 200'000));
  EXPECT_TRUE(questions_.is_short(query_, 100'200'000));
}

}  // namespace
}  // namespace collided::engine::service
