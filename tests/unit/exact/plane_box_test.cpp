// A38: a plane against a box, by all eight corners and by the box's projection on the normal. In whole numbers both are
// exact, so they must agree with each other and the engine with them, touching included.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <vector>

#include "server/exact_phase/distance/half_space.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::plane_box_test {
namespace {

/// normal . x = offset, and a box about its centre; small whole numbers in double.
struct Question {
  Vec3 normal;
  double offset;
  Vec3 center;
  Vec3 half_m;
};

/// Of the box from the plane, times the normal's length: both signs, or 0, and the plane meets it.
struct Heights {
  double lowest;
  double highest;
  bool meets() const { return lowest <= 0 && highest >= 0; }
};

Heights by_corners(const Question& q) {
  Heights heights{INFINITY, -INFINITY};
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 side(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
    const double height = q.normal.dot(q.center + side.cwiseProduct(q.half_m)) - q.offset;
    heights.lowest = std::min(heights.lowest, height);
    heights.highest = std::max(heights.highest, height);
  }
  return heights;
}

Heights by_projection(const Question& q) {
  const double middle = q.normal.dot(q.center) - q.offset;
  const double reach = q.normal.cwiseAbs().dot(q.half_m);
  return {middle - reach, middle + reach};
}

std::vector<Question> random_questions(std::size_t count, std::mt19937_64& random) {
  std::uniform_int_distribution<int> step(-9, 9), half(0, 5);
  std::vector<Question> questions;
  while (questions.size() < count) {
    Question q;
    for (int axis = 0; axis < 3; ++axis) {
      q.normal[axis] = step(random);
      q.center[axis] = step(random);
      q.half_m[axis] = half(random);
    }
    q.offset = 5 * step(random);
    if (!q.normal.isZero(0)) questions.push_back(q);
  }
  return questions;
}

/// A point of the plane, exact: its coordinate along an axis whose part of the normal is 1, 2, 4 or 8.
bool point_on(const Question& q, Vec3& point) {
  for (int axis = 0; axis < 3; ++axis) {
    const double part = std::abs(q.normal[axis]);
    if (part != 1 && part != 2 && part != 4 && part != 8) continue;
    point = Vec3::Zero();
    point[axis] = q.offset / q.normal[axis];
    return true;
  }
  return false;
}

TEST(ExactPlaneBox, CornersAndProjectionAgreeAndTheEngineWithThem) {
  std::mt19937_64 random = oracle::seeded(38);
  int met = 0;
  int touched = 0;
  int asked = 0;
  for (const Question& q : random_questions(1'000'000, random)) {
    const Heights corners = by_corners(q);
    const Heights projection = by_projection(q);
    ASSERT_EQ(corners.lowest, projection.lowest);
    ASSERT_EQ(corners.highest, projection.highest);
    met += corners.meets() ? 1 : 0;
    touched += corners.meets() && (corners.lowest == 0 || corners.highest == 0) ? 1 : 0;
    Vec3 point;
    if (!point_on(q, point)) continue;
    ++asked;
    const Box box{q.center, Mat3::Identity(), q.half_m};
    const bool reaches_down = overlaps(HalfSpace{point, q.normal}, box).yes();
    const bool reaches_up = overlaps(HalfSpace{point, -q.normal}, box).yes();
    ASSERT_EQ(reaches_down, projection.lowest <= 0);
    ASSERT_EQ(reaches_up, projection.highest >= 0);
  }
  EXPECT_GT(met, 100'000);
  EXPECT_GT(touched, 10'000);
  EXPECT_GT(asked, 100'000);
}

template <class Form>
double best_ns(const std::vector<Question>& questions, Form form) {
  double best = INFINITY;
  for (int repeat = 0; repeat < 15; ++repeat) {
    int met = 0;
    const auto start = std::chrono::steady_clock::now();
    for (const Question& q : questions) met += form(q).meets() ? 1 : 0;
    const std::chrono::duration<double, std::nano> taken = std::chrono::steady_clock::now() - start;
    EXPECT_GT(met, 0);
    best = std::min(best, taken.count() / static_cast<double>(questions.size()));
  }
  return best;
}

// Eight products against two: best of 15 rounds of each in one run, and only which one is faster is asked.
TEST(ExactPlaneBox, TheProjectionIsFasterThanTheCorners) {
  std::mt19937_64 random = oracle::seeded(39);
  const std::vector<Question> questions = random_questions(20'000, random);
  const double corners = best_ns(questions, by_corners);
  const double projection = best_ns(questions, by_projection);
  std::printf("corners %.2f ns, projection %.2f ns: ratio %.1f\n", corners, projection, corners / projection);
  EXPECT_LT(projection, corners);
}

}  // namespace
}  // namespace collided::engine::plane_box_test
