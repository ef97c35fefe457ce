// The questions of one message are spread over the threads that have nothing to do.
#include <algorithm>
#include <map>
#include <random>

#include "tests/oracle/seed.hpp"
#include "tests/service/eventually.hpp"
#include "tests/service/server_process.hpp"
#include "tests/service/server_wire_asker.hpp"

namespace collided::engine {
namespace {

using namespace std::chrono_literals;
using testing_support::WireAsker;
using wire_contract::QuestionKind;

class ServerWireSharing : public testing_support::ServerProcess {
 protected:
  static constexpr std::size_t kQuestions = 1'000;

  static WireAsker::Replies ask(WireAsker& asker, QuestionKind kind, const std::vector<double>& numbers) {
    dds::Sample<wire::Query> query;
    query->kind = static_cast<std::uint8_t>(kind);
    query->mask = 0xffffffff;
    query->max_hits = 8;
    test::put_questions(*query, numbers);
    return asker.ask_all(*query, kQuestions);
  }
  static WireAsker::Heard whole(const WireAsker::Replies& replies) {
    for (const auto& [first, part] : replies)
      EXPECT_EQ(part.version, replies.begin()->second.version) << "on one state";
    WireAsker::Heard all = WireAsker::whole(replies);
    EXPECT_EQ(all.answers.size(), kQuestions) << "each question is answered once";
    return all;
  }
  std::vector<double> questions(QuestionKind kind) {
    std::uniform_real_distribution<double> x(-9, 9), z(-0.5, 4.5);
    std::vector<double> numbers;
    for (std::size_t i = 0; i < kQuestions; ++i) {
      numbers.insert(numbers.end(), {x(random_), x(random_), z(random_)});
      if (kind == QuestionKind::near) numbers.push_back(3);
      if (kind == QuestionKind::ray) numbers.insert(numbers.end(), {x(random_), x(random_), z(random_), 30});
      if (kind == QuestionKind::box) numbers.insert(numbers.end(), {0.4, 0.5, 0.6, 1, 0, 0, 0});
    }
    return numbers;
  }
  std::mt19937_64 random_ = oracle::seeded(41);
};

TEST_F(ServerWireSharing, AnswersAreTheSameToTheBitFromAnyNumberOfThreads) {
  std::map<QuestionKind, std::vector<double>> asked;
  for (const QuestionKind kind : {QuestionKind::ray, QuestionKind::box, QuestionKind::near})
    asked[kind] = questions(kind);
  std::map<QuestionKind, WireAsker::Heard> expected;
  for (const char* threads : {"1", "4"}) {
    start({"--threads", threads});
    WireAsker asker(domain_);
    ASSERT_TRUE(asker.greet());
    for (const auto& [kind, numbers] : asked) {
      WireAsker::Replies replies = ask(asker, kind, numbers);
      if (threads[0] == '1') {
        expected[kind] = whole(replies);
        continue;
      }
      // Who has nothing to do shows a moment after the last answer.
      const bool is_spread = test::eventually([&] { return (replies = ask(asker, kind, numbers)).size() > 1; },
                                              kind == QuestionKind::near ? 20s : 1s);
      EXPECT_TRUE(is_spread || kind != QuestionKind::near) << "a thousand nearest points are worth four threads";
      const WireAsker::Heard all = whole(replies);
      EXPECT_EQ(all.answers, expected[kind].answers);
      EXPECT_EQ(all.reasons, expected[kind].reasons);
      EXPECT_EQ(all.hit_counts, expected[kind].hit_counts);
      EXPECT_EQ(all.triangles, expected[kind].triangles);
      EXPECT_EQ(all.objects, expected[kind].objects);
      EXPECT_EQ(all.numbers, expected[kind].numbers);
    }
    servers_.clear();
  }
}

}  // namespace
}  // namespace collided::engine
