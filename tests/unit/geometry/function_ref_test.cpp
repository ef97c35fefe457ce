#include "server/geometry/function_ref.hpp"

#include <gtest/gtest.h>

#include <array>

namespace collided::engine {
namespace {

int doubled(int number) { return 2 * number; }

int ask(FunctionRef<int(int)> function, int number) { return function(number); }

struct Adder {
  int more;
  int operator()(int number) const { return number + more; }
};

TEST(GeometryFunctionRef, CallsALambdaWithWhatItCaptured) {
  int sum = 0;
  const auto add = [&](int number) { return sum += number; };
  EXPECT_EQ(ask(add, 3), 3);
  EXPECT_EQ(ask(add, 4), 7);
  EXPECT_EQ(sum, 7);
  EXPECT_EQ(ask([&](int number) { return sum - number; }, 2), 5) << "written in the call";
}

TEST(GeometryFunctionRef, CallsAFunction) {
  EXPECT_EQ(ask(doubled, 21), 42);
  const FunctionRef<int(int)> kept = doubled;
  EXPECT_EQ(kept(4), 8);
}

TEST(GeometryFunctionRef, CallsAConstFunctor) {
  const Adder adder{5};
  EXPECT_EQ(ask(adder, 1), 6);
}

TEST(GeometryFunctionRef, CopiesReferToTheSameCallable) {
  auto count = [calls = 0](int) mutable { return ++calls; };
  FunctionRef<int(int)> first = count;
  FunctionRef<int(int)> second = first;
  EXPECT_EQ(first(0), 1);
  EXPECT_EQ(second(0), 2);
  EXPECT_EQ(count(0), 3) << "nothing is owned";
  first = doubled;
  EXPECT_EQ(second(0), 4) << "a copy refers to the callable, not to what it was copied from";
}

TEST(GeometryFunctionRef, HandsArgumentsAndResultsOnAsTheyAre) {
  std::array<int, 2> numbers{1, 2};
  const auto second = [](std::array<int, 2>& of) -> int& { return of[1]; };
  const FunctionRef<int&(std::array<int, 2>&)> place = second;
  place(numbers) = 7;
  EXPECT_EQ(numbers[1], 7);
  static_assert(sizeof(place) == 2 * sizeof(void*));
}

}  // namespace
}  // namespace collided::engine
