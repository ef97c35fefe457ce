// The list of everything that the border refuses, each with its reason: what is not on it must be answered, and a check
// that NaN slips through lets it into every comparison behind.
#include <gtest/gtest.h>

#include "idl/columns.hpp"
#include "server/service/questions/ask.hpp"
#include "server/service/questions/validation.hpp"
#include "tests/extreme/worlds.hpp"

namespace collided::engine::validation_refusals_test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kTiniest = std::numeric_limits<double>::denorm_min();

struct Malformed {
  const char* why;
  QuestionKind kind;
  std::vector<double> numbers;
};

const Malformed kMalformed[] = {
    {"a direction of zero", QuestionKind::ray, {0, 0, 0, 0, 0, 0, 1}},
    {"a direction of minus zero", QuestionKind::ray, {0, 0, 0, -0.0, 0, -0.0, 1}},
    {"NaN in the origin", QuestionKind::ray, {kNaN, 0, 0, 1, 0, 0, 1}},
    {"infinity in the origin", QuestionKind::ray, {0, -kInfinite, 0, 1, 0, 0, 1}},
    {"NaN in the direction", QuestionKind::ray, {0, 0, 0, 0, kNaN, 1, 1}},
    {"infinity in the direction", QuestionKind::ray, {0, 0, 0, kInfinite, 0, 0, 1}},
    {"a length of NaN", QuestionKind::ray, {0, 0, 0, 1, 0, 0, kNaN}},
    {"a length below zero", QuestionKind::ray, {0, 0, 0, 1, 0, 0, -kTiniest}},
    {"a length of minus infinity", QuestionKind::ray, {0, 0, 0, 1, 0, 0, -kInfinite}},
    {"NaN in the centre", QuestionKind::sphere, {0, 0, kNaN, 1}},
    {"infinity in the centre", QuestionKind::sphere, {kInfinite, 0, 0, 1}},
    {"a radius below zero", QuestionKind::sphere, {0, 0, 0, -kTiniest}},
    {"a radius of NaN", QuestionKind::sphere, {0, 0, 0, kNaN}},
    {"a radius without end", QuestionKind::sphere, {0, 0, 0, kInfinite}},
    {"a half size below zero", QuestionKind::box, {0, 0, 0, 1, -1, 1, 1, 0, 0, 0}},
    {"a half size of NaN", QuestionKind::box, {0, 0, 0, 1, 1, kNaN, 1, 0, 0, 0}},
    {"a half size without end", QuestionKind::box, {0, 0, 0, kInfinite, 1, 1, 1, 0, 0, 0}},
    {"a quaternion of zeros", QuestionKind::box, {0, 0, 0, 1, 1, 1, 0, 0, 0, 0}},
    {"a quaternion of length 2", QuestionKind::box, {0, 0, 0, 1, 1, 1, 2, 0, 0, 0}},
    {"a quaternion of NaN", QuestionKind::box, {0, 0, 0, 1, 1, 1, kNaN, 0, 0, 0}},
    {"a quaternion that overflows", QuestionKind::box, {0, 0, 0, 1, 1, 1, 1e200, 0, 0, 0}},
    {"NaN in the box's centre", QuestionKind::box, {kNaN, 0, 0, 1, 1, 1, 1, 0, 0, 0}},
    {"an origin beyond the limit", QuestionKind::ray, {0, 0, 1.1e290, 1, 0, 0, 1}},
    {"a direction beyond the limit", QuestionKind::ray, {0, 0, 0, -1.1e290, 0, 0, kInfinite}},
    {"a radius beyond the limit", QuestionKind::sphere, {0, 0, 0, 1.1e290}},
    {"a half size beyond the limit", QuestionKind::box, {0, 0, 0, 1, 1, 1e300, 1, 0, 0, 0}},
    {"a point beyond the limit", QuestionKind::near, {-1e308, 0, 0, kInfinite}},
    {"NaN in the asked point", QuestionKind::near, {0, kNaN, 0, 1}},
    {"a reach below zero", QuestionKind::near, {0, 0, 0, -1}},
    {"a reach of NaN", QuestionKind::near, {0, 0, 0, kNaN}},
};

// A19: a direction that is zero or not finite is none.
TEST(ExtremeBorderRefusals, EachMalformedQuestionIsInvalidForItself) {
  extreme::Stage stage;
  stage.ball("ball", {0, 0, 0}, 1);
  stage.step();
  for (const Malformed& bad : kMalformed) {
    // A good question on either side is answered all the same.
    std::vector<double> good = bad.kind == QuestionKind::ray   ? std::vector<double>{-3, 0, 0, 1, 0, 0, kInfinite}
                               : bad.kind == QuestionKind::box ? std::vector<double>{0, 0, 0, 1, 1, 1, 1, 0, 0, 0}
                                                               : std::vector<double>{0, 0, 0, 1};
    std::vector<double> numbers = good;
    numbers.insert(numbers.end(), bad.numbers.begin(), bad.numbers.end());
    numbers.insert(numbers.end(), good.begin(), good.end());
    const Answers answers = stage.ask(bad.kind, numbers);
    EXPECT_EQ(answers.answers, (std::vector{Verdict::hit, Verdict::invalid, Verdict::hit})) << bad.why;
    EXPECT_EQ(answers.hit_counts.at(1), 0u) << bad.why;
  }
}

void expect_pose_refused(std::vector<double> numbers, const std::string& reason) {
  const auto checked = service::checked_pose(numbers);
  ASSERT_TRUE(std::holds_alternative<Refusal>(checked)) << reason;
  EXPECT_EQ(std::get<Refusal>(checked).reason, reason);
}

TEST(ExtremeBorderRefusals, PosesWithTheirReasons) {
  expect_pose_refused({0, 0, 0, 1, 0, 0}, "a pose of 6 numbers; 7 are needed");
  expect_pose_refused({}, "a pose of 0 numbers; 7 are needed");
  expect_pose_refused({0, kNaN, 0, 1, 0, 0, 0}, "a pose with nan");
  expect_pose_refused({kInfinite, 0, 0, 1, 0, 0, 0}, "a pose with inf");
  expect_pose_refused({0, 0, 0, 1, 0, 0, -kInfinite}, "a pose with -inf");
  expect_pose_refused({0, -2e290, 0, 1, 0, 0, 0}, "a pose with -2e+290, allowed are numbers up to 1e290");
  expect_pose_refused({0, 0, 0, 0, 0, 0, 0}, "quaternion norm 0, allowed 1 +- 1e-06");
  expect_pose_refused({0, 0, 0, 0.87, 0, 0, 0}, "quaternion norm 0.87, allowed 1 +- 1e-06");
  expect_pose_refused({0, 0, 0, 1.000002, 0, 0, 0}, "quaternion norm 1.000002, allowed 1 +- 1e-06");
  expect_pose_refused({0, 0, 0, 1e200, 1e200, 0, 0}, "quaternion norm inf, allowed 1 +- 1e-06");
  expect_pose_refused({0, 0, 0, kTiniest, 0, 0, 0}, "quaternion norm 0, allowed 1 +- 1e-06");
}

TEST(ExtremeBorderRefusals, NamesThatAreNotText) {
  EXPECT_FALSE(service::is_good_name(""));
  EXPECT_FALSE(service::is_good_name(std::string(256, 'a')));
  EXPECT_FALSE(service::is_good_name("a\nb"));
  EXPECT_FALSE(service::is_good_name(std::string_view("a\0b", 3)));
  EXPECT_FALSE(service::is_good_name("\x1b[31m")) << "terminals obey it";
  EXPECT_FALSE(service::is_good_name("\xc0\xaf")) << "overlong";
  EXPECT_FALSE(service::is_good_name("\xed\xa0\x80")) << "half a surrogate pair";
  EXPECT_FALSE(service::is_good_name("\xff"));
  EXPECT_TRUE(service::is_good_name(std::string(255, 'a')));
  EXPECT_TRUE(service::is_good_name("Kran \xc3\xbc/7"));
}

/// A chunk of one good ray; each case spoils one thing.
class ExtremeBorderChunk : public testing::Test {
 protected:
  ExtremeBorderChunk() {
    query.kind = static_cast<std::uint8_t>(QuestionKind::ray);
    query.chunk_count = 1;
    query.max_hits = 1;
    fill(1);
  }
  void expect_refused(const std::string& reason) {
    EXPECT_EQ(service::why_refused(query).value_or("(accepted)"), reason);
  }
  void fill(std::size_t rays) {
    rays_.assign(7 * rays, 1.0);
    wire::lend_columns<wire::Query>(rays_, wire::kRayColumns, columns_, query);
  }
  wire::Query query{};

 private:
  std::vector<double> rays_, columns_;
};

TEST_F(ExtremeBorderChunk, TheGoodOneIsTaken) { EXPECT_FALSE(service::why_refused(query)); }

TEST_F(ExtremeBorderChunk, Counts) {
  for (auto* column : {&query.points, &query.directions, &query.lengths}) {
    --column->_length;
    expect_refused("the columns of ray questions are not of one length, or others are filled too");
    ++column->_length;
  }
  const std::vector<double> radius{1};
  dds::borrow(query.radii, radius);
  expect_refused("the columns of ray questions are not of one length, or others are filled too");
  query.radii = {};
  fill(0);
  expect_refused("the columns of ray questions are empty");
  fill(1'001);
  expect_refused("a chunk of 1001 questions; allowed 1000");
  fill(1);
  query.first_question = 100'000;
  expect_refused("question 100000 and 1 more; a request has at most 100000");
  query.first_question = 0xffffffff;
  expect_refused("question 4294967295 and 1 more; a request has at most 100000");
}

TEST_F(ExtremeBorderChunk, Chunks) {
  query.chunk_count = 0;
  expect_refused("a request of 0 chunks; allowed 1 to 100000");
  query.chunk_count = 2;
  query.chunk_index = 2;
  expect_refused("chunk number 2 of 2 chunks; they count from 0");
}

TEST_F(ExtremeBorderChunk, Codes) {
  query.kind = 9;
  expect_refused("question kind 9 is not known; allowed 0 to 8");
  query.kind = 7;
  expect_refused("the columns of inside questions are not of one length, or others are filled too");
  query.kind = 1;
  query.mode = 3;
  expect_refused("ray questions do not have hit mode 3");
  query.mode = 5;
  expect_refused("hit mode 5 is not known; allowed 0 to 4");
  query.mode = 2;
  query.importance = 3;
  expect_refused("importance 3 is not known; allowed 0 to 2");
  query.importance = 2;
  query.instant = 4;
  expect_refused("instant 4 is not known; allowed 0 to 3");
  query.instant = 3;
  query.instant_ns = -1;
  expect_refused("the instant -1 ns; allowed 0 and more");
}

TEST_F(ExtremeBorderChunk, Limits) {
  query.max_hits = 0;
  expect_refused("max_hits 0; allowed 1 to 8192");
  query.max_hits = 8'193;
  expect_refused("max_hits 8193; allowed 1 to 8192");
  query.max_hits = 1;
  query.deadline_ns = -1;
  expect_refused("deadline -1 ns; allowed 0 (none) and more");
  query.deadline_ns = 0;
  query.error_asked = -1;
  expect_refused("error asked -1 m; allowed 0 and more");
  query.error_asked = kNaN;
  expect_refused("error asked nan m; allowed 0 and more");
  query.error_asked = 0;
  query.only[0] = '\n';
  expect_refused("the name pattern '?' is not text");
}

TEST(ExtremeBorderRefusals, TheWorldsOwn) {
  World world{WorldOptions{.max_objects = 2}};
  const auto define = [&](const std::string& name) {
    ObjectDefinition body;
    body.name = name;
    body.shape = extreme::ball_shape(1);
    const auto defined = world.define(body);
    return std::holds_alternative<Refusal>(defined) ? std::get<Refusal>(defined).reason : "";
  };
  EXPECT_EQ(define("a"), "");
  EXPECT_EQ(define("a"), "the name 'a' is taken; names are unique in a world. Nothing was added");
  EXPECT_EQ(define("b"), "");
  EXPECT_EQ(define("c"), "object 'c' is one more than the limit of 2 objects (max_objects). Nothing was added");
  EXPECT_FALSE(world.move(0xdeadbeef, {}, 1, false)) << "no such object";
  EXPECT_FALSE(world.remove(0xdeadbeef, EndReason::removed));
}

}  // namespace
}  // namespace collided::engine::validation_refusals_test
