// Where values stand along an axis, and what the ticks beside them say.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/studies/plot/axis_map.hpp"

namespace collided::draw {
namespace {

std::vector<std::string> texts(const AxisMap& map, double room_px) {
  std::vector<std::string> found;
  for (const auto& [value, text] : map.ticks(room_px)) found.push_back(text);
  return found;
}

const Axis kLogarithmic{.label = "e", .scale = Scale::logarithmic};

// Zero has no logarithm: it stands at the low end, a decade below the least number, where the tick says so.
TEST(PlotAxis, ZerosGetADecadeOfTheirOwn) {
  const AxisMap map(kLogarithmic, {0, 1.5e-3, 0.2, 0}, 100, 500);
  EXPECT_TRUE(map.has_zero());
  EXPECT_NEAR(map.low(), 1e-4, 1e-18);
  EXPECT_NEAR(map.high(), 1, 1e-15);
  EXPECT_EQ(map.pixel(0), 100);
  EXPECT_NEAR(map.pixel(1e-3), 200, 1e-9);
  EXPECT_GT(map.pixel(1.5e-3) - map.pixel(0), 100) << "the least number is a decade away";
  EXPECT_EQ(texts(map, 60), (std::vector<std::string>{"0", "1e-3", "1e-2", "1e-1", "1e0"}));
  EXPECT_NEAR(map.ticks(60).front().first, map.low(), 1e-18);
}

TEST(PlotAxis, WithoutZerosTheLeastNumbersDecadeIsTheFirst) {
  const AxisMap map(kLogarithmic, {1.5e-3, 0.2, INFINITY, NAN}, 100, 500);
  EXPECT_FALSE(map.has_zero());
  EXPECT_NEAR(map.low(), 1e-3, 1e-18);
  EXPECT_NEAR(map.high(), 1, 1e-15);
  EXPECT_NEAR(map.pixel(0.1), 100 + 400 * 2 / 3., 1e-9);
  EXPECT_EQ(map.pixel(0), 100) << "drawn at the low end all the same";
  EXPECT_EQ(map.pixel(1e9), 500);
  EXPECT_EQ(texts(map, 60), (std::vector<std::string>{"1e-3", "1e-2", "1e-1", "1e0"}));
  EXPECT_NEAR(map.value_at(0.5), std::pow(10, -1.5), 1e-12);
}

TEST(PlotAxis, TicksAreAsFewAsTheirTextsNeed) {
  const AxisMap wide(kLogarithmic, {2e-9, 0.2}, 0, 900);
  EXPECT_EQ(texts(wide, 100).size(), 9U + 1U);
  EXPECT_EQ(texts(wide, 200), (std::vector<std::string>{"1e-9", "1e-7", "1e-5", "1e-3", "1e-1"}));
}

TEST(PlotAxis, ALinearAxisHoldsItsDataAndBeginsAtZeroWhereThatIsNear) {
  const AxisMap near_zero(Axis{.label = "x"}, {1, 10, INFINITY}, 0, 100);
  EXPECT_EQ(near_zero.low(), 0);
  EXPECT_NEAR(near_zero.high(), 10.45, 1e-12);
  EXPECT_NEAR(near_zero.pixel(5.225), 50, 1e-9);
  EXPECT_EQ(texts(near_zero, 25), (std::vector<std::string>{"0", "5", "10"}));
  const AxisMap away(Axis{.label = "x"}, {-4, 6}, 200, 100);
  EXPECT_NEAR(away.low(), -4.5, 1e-12);
  EXPECT_NEAR(away.high(), 6.5, 1e-12);
  EXPECT_NEAR(away.pixel(1), 150, 1e-9) << "upward";
  EXPECT_NEAR(away.pixel(-4.5), 200, 1e-9);
  EXPECT_NEAR(away.value_at(0.25), -1.75, 1e-12);
  EXPECT_EQ(texts(away, 20), (std::vector<std::string>{"0", "5"}));
  EXPECT_EQ(texts(away, 10), (std::vector<std::string>{"-4", "-2", "0", "2", "4", "6"}));
  const AxisMap one(Axis{.label = "x"}, {7}, 0, 100);
  EXPECT_EQ(one.low(), 3.5);
  EXPECT_EQ(one.high(), 10.5);
}

TEST(PlotAxis, EndsThatAreGivenAreTaken) {
  const AxisMap map(Axis{.label = "x", .low = -2, .high = 8}, {0, 100}, 0, 1000);
  EXPECT_EQ(map.pixel(-2), 0);
  EXPECT_EQ(map.pixel(3), 500);
  EXPECT_EQ(map.pixel(100), 1000);
  EXPECT_EQ(map.pixel(-9), 0);
}

}  // namespace
}  // namespace collided::draw
