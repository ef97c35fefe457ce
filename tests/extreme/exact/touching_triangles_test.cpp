#include <gtest/gtest.h>

#include "server/exact_phase/overlap/overlap.hpp"
#include "tests/extreme/transformed.hpp"

namespace collided::engine::touching_triangles_test {
namespace {

using extreme::down;
using extreme::up;

const Triangle kFloor{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};

void expect_both_orders(const Triangle& a, const Triangle& b, bool truth) {
  for (const Triangle& x : {a, Triangle{a.b, a.c, a.a}, Triangle{a.c, a.a, a.b}, Triangle{a.b, a.a, a.c}}) {
    EXPECT_EQ(overlaps(x, b).yes(), truth);
    EXPECT_EQ(overlaps(b, x).yes(), truth);
  }
}

TEST(ExtremeTouchingTriangles, SharedCornerAndSharedEdge) {
  expect_both_orders(kFloor, {{0, 0, 0}, {-1, -1, 1}, {-1, -2, 3}}, true);
  expect_both_orders(kFloor, {{0, 0, 0}, {4, 0, 0}, {1, -1, 3}}, true);
  expect_both_orders(kFloor, {{0, 0, 0}, {4, 0, 0}, {1, -1, 0}}, true);
}

TEST(ExtremeTouchingTriangles, CornerOnAFaceAndOneStepAbove) {
  expect_both_orders(kFloor, {{1, 1, 0}, {1, 0, 2}, {0, 1, 2}}, true);
  expect_both_orders(kFloor, {{1, 1, up(0.0)}, {1, 0, 2}, {0, 1, 2}}, false);
  expect_both_orders(kFloor, {{1, 1, down(0.0)}, {1, 0, 2}, {0, 1, 2}}, true);
  expect_both_orders(kFloor, {{2, 2, 0}, {3, 3, 2}, {3, 3, 3}}, true);
  expect_both_orders(kFloor, {{2, up(2.0), 0}, {3, 3, 2}, {3, 3, 3}}, false);
}

TEST(ExtremeTouchingTriangles, CrossedEdges) {
  expect_both_orders(kFloor, {{2, 0, 1}, {2, 0, -1}, {2, -3, 0}}, true);
  expect_both_orders(kFloor, {{2, down(0.0), 1}, {2, down(0.0), -1}, {2, -3, 0}}, false);
}

TEST(ExtremeTouchingTriangles, OneInsideTheOtherInOnePlane) {
  expect_both_orders(kFloor, {{0.5, 0.5, 0}, {1, 0.5, 0}, {0.5, 1, 0}}, true);
  expect_both_orders(kFloor, {{5, 5, 0}, {6, 5, 0}, {5, 6, 0}}, false);
  expect_both_orders(kFloor, {{4, 0, 0}, {6, 5, 0}, {5, 6, 0}}, true);
  expect_both_orders(kFloor, {{up(4.0), 0, 0}, {6, 5, 0}, {5, 6, 0}}, false);
}

TEST(ExtremeTouchingTriangles, WithoutAreaTheyAreSegmentsAndPoints) {
  const Triangle pole{{1, 1, -1}, {1, 1, 0}, {1, 1, 5}};
  expect_both_orders(kFloor, pole, true);
  expect_both_orders(kFloor, {{3, 3, -1}, {3, 3, 0}, {3, 3, 5}}, false);
  expect_both_orders(pole, {{0, 1, 2}, {3, 1, 2}, {2, 1, 2}}, true);
  expect_both_orders(pole, {{0, 1, 6}, {3, 1, 6}, {2, 1, 6}}, false);
  expect_both_orders(pole, {{1, 1, 3}, {1, 1, 3}, {1, 1, 3}}, true);
  expect_both_orders(pole, {{1, 1, up(5.0)}, {1, 1, up(5.0)}, {1, 1, up(5.0)}}, false);
  expect_both_orders(kFloor, {{1, 1, 0}, {1, 1, 0}, {1, 1, 0}}, true);
}

}  // namespace
}  // namespace collided::engine::touching_triangles_test
