#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>

#include "server/exact_phase/distance/box_contact.hpp"
#include "server/exact_phase/distance/box_middle.hpp"
#include "server/exact_phase/distance/box_push.hpp"
#include "server/exact_phase/distance/convex.hpp"
#include "server/exact_phase/distance/facet_filter.hpp"
#include "server/exact_phase/overlap/box_lanes.hpp"
#include "server/exact_phase/overlap/separation_filter.hpp"
#include "tests/oracle/box_twins.hpp"
#include "tests/oracle/random_shapes.hpp"
#include "tests/oracle/seed.hpp"

namespace collided {
namespace {
using namespace engine;
using kernel::Core;

constexpr int kPairs = 20'000;

/// Pairs of every family of coordinates, at sizes from beyond the range of squares in double to denormal ones.
template <class Check>
void for_boxes(std::uint64_t seed, Check&& check) {
  std::mt19937_64 random = oracle::seeded(seed);
  constexpr double kScales[] = {1, 0x1p-30, 0x1p40, 0x1p-110, 0x1p110, 0x1p-300, 0x1p300, 0x1p-1060};
  for (const oracle::Family family : oracle::kFamilies) {
    oracle::RandomShapes shapes(random, family);
    for (int i = 0; i < kPairs; ++i) {
      Box a = shapes.box();
      Box b = shapes.box();
      if (i % 4 == 0) b.axes = a.axes;
      if (i % 8 == 0) b.center = a.center + a.axes * (a.half_m + b.half_m);  // touching corners
      const double scale = i % 2 == 0 ? 1 : kScales[static_cast<std::size_t>(i / 2) % std::size(kScales)];
      for (Box* box : {&a, &b}) {
        box->center *= scale;
        box->half_m *= scale;
      }
      check(a, b, i);
      if (::testing::Test::HasFailure()) return;
    }
  }
}

// Four axes at a time decide what one after the other does, parallel and barely turned edges included.
TEST(BoxLanes, DecideAsOneAxisAfterTheOther) {
  int yes = 0;
  int no = 0;
  for_boxes(20261201, [&](const Box& a, const Box& b, int i) {
    const double off_m = i % 3 == 0 ? 0 : 1e-9 * std::abs(a.half_m[0]);
    const Decision decided = kernel::quickly_overlaps(a, b, off_m);
    EXPECT_EQ(decided, oracle::plain_overlap(a, b, off_m)) << i;
    yes += decided == Decision::yes ? 1 : 0;
    no += decided == Decision::no ? 1 : 0;
  });
  EXPECT_GT(yes, kPairs / 4);
  EXPECT_GT(no, kPairs / 4);
}

TEST(BoxLanes, KeepTheAxesThatOneAfterTheOtherKeeps) {
  for_boxes(20261202, [&](const Box& a, const Box& b, int i) {
    EXPECT_EQ(kernel::axes_of_least_push({}, Core(a), Core(b)), oracle::plain_least_pushes(a, b)) << i;
  });
}

TEST(BoxLanes, DecideAndKeepAxesAtOnceAsEachAlone) {
  int met = 0;
  for_boxes(20261212, [&](const Box& a, const Box& b, int i) {
    const double off_m = i % 3 == 0 ? 0 : 1e-9 * std::abs(a.half_m[0]);
    const kernel::BoxOverlap both =
        kernel::overlap_and_pushes_in_lanes(a, b, kernel::gap_bounds(off_m), kernel::kDepthError);
    EXPECT_EQ(both.decision, oracle::plain_overlap(a, b, off_m)) << i;
    if (both.decision != Decision::yes) return;
    ++met;
    EXPECT_EQ(both.least_pushes, oracle::plain_least_pushes(a, b)) << i;
  });
  EXPECT_GT(met, kPairs / 4);
}

// To the last bit, since contacts are part of recorded events.
TEST(BoxLanes, TheQuickContactIsTheContact) {
  int met = 0;
  for_boxes(20261213, [&](const Box& a, const Box& b, int i) {
    const double off_m = i % 3 == 0 ? 0 : 1e-9 * std::abs(a.half_m[0]);
    Contact quick;
    const Decision decision = quick_contact(a, b, off_m, quick);
    EXPECT_EQ(decision, oracle::plain_overlap(a, b, off_m)) << i;
    if (decision != Decision::yes) return;
    ++met;
    const Contact whole = contact(a, b);
    EXPECT_EQ(quick.point, whole.point) << i;
    EXPECT_EQ(quick.normal, whole.normal) << i;
    EXPECT_EQ(quick.depth_m, whole.depth_m) << i;
    EXPECT_EQ(quick.depth_error_m, whole.depth_error_m) << i;
  });
  EXPECT_GT(met, kPairs / 4);
}

TEST(BoxLanes, PartOnTheWayAsOneAxisAfterTheOther) {
  std::mt19937_64 random = oracle::seeded(20261206);
  std::uniform_real_distribution<double> part(-1, 1);
  int parted = 0;
  for_boxes(20261207, [&](const Box& a, const Box& b, int i) {
    const double size_m = std::max(kernel::extent(Core(a)), kernel::extent(Core(b)));
    const auto moving = [&](const Box& box) {
      const auto frame = [&] {
        const double turn = i % 3 == 0 ? 0 : 0.1;
        const Vec3 moved(part(random), part(random), part(random));
        return frame_of({.position = 0.1 * size_m * moved,
                         .rotation = Quat(1, turn * part(random), turn * part(random), 0).normalized()});
      };
      const Frame before = frame();
      const Frame now = i % 5 == 0 ? before : frame();
      return kernel::MovingBox(box, before, now, size_m);
    };
    const kernel::MovingBox first = moving(a);
    const kernel::MovingBox second = moving(b);
    const bool is_parted = kernel::surely_apart(first, second);
    EXPECT_EQ(is_parted, oracle::plain_parted(first, second)) << i;
    parted += is_parted ? 1 : 0;
  });
  EXPECT_GT(parted, kPairs / 4);
}

TEST(BoxLanes, TheAxesOfBoxesHaveTheirPlaceInTheList) {
  std::mt19937_64 random = oracle::seeded(20261203);
  oracle::RandomShapes shapes(random, oracle::Family::random);
  const Core a(shapes.box());
  const Core b(shapes.box());
  const kernel::FacetAxes axes = kernel::facet_axes(a, b);
  ASSERT_EQ(axes.count, 15);
  for (int i = 0; i < axes.count; ++i) {
    EXPECT_EQ(kernel::facet_axis_of_boxes(a, b, i).u.to, axes.axis[i].u.to) << i;
    EXPECT_EQ(kernel::facet_axis_of_boxes(a, b, i).v.to, axes.axis[i].v.to) << i;
  }
}

// To the last bit, since contact points are part of recorded events.
TEST(BoxLanes, TheMiddleIsThatOfOneEdgeAfterTheOther) {
  int found = 0;
  for_boxes(20261204, [&](const Box& a, const Box& b, int i) {
    const double size_m = kernel::extent(Core(a)) + kernel::extent(Core(b));
    const std::optional<Vec3> fast = kernel::middle_of_boxes(Core(a), Core(b), size_m);
    const std::optional<Vec3> slow = oracle::plain_middle(a, b, size_m);
    ASSERT_EQ(fast.has_value(), slow.has_value()) << i;
    if (!fast) return;
    ++found;
    EXPECT_EQ(*fast, *slow) << i;
  });
  EXPECT_GT(found, kPairs);
}

// A box of which one axis vanishes in squares has no slabs of its own; it is left to the plain form.
TEST(BoxLanes, AxesWithoutSquaresAreLeftToThePlainForm) {
  Box flat{.center = Vec3::Zero(), .axes = Mat3::Identity(), .half_m = Vec3::Ones()};
  flat.axes.col(0) *= 0x1p-300;
  EXPECT_FALSE(kernel::middle_of_boxes(Core(flat), Core(flat), 4).has_value());
}

// To the last bit of value and bound, since both stand in recorded events; out of range both are no number.
TEST(BoxLanes, PushesAreThoseOfOneOperationAfterTheOther) {
  const auto is_same = [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); };
  int finite = 0;
  for_boxes(20261208, [&](const Box& a, const Box& b, int i) {
    const Core core_a(a);
    const Core core_b(b);
    const auto n = kernel::direction<Bounded>(kernel::facet_axis_of_boxes(core_a, core_b, i % 15));
    const kernel::Pushes<Bounded> fast = kernel::pushes_of_boxes(n, core_a, core_b);
    const kernel::Pushes<Bounded> slow = kernel::pushes_along(n, core_a, core_b);
    EXPECT_TRUE(is_same(fast.forward.value, slow.forward.value)) << i;
    EXPECT_TRUE(is_same(fast.forward.error, slow.forward.error)) << i;
    EXPECT_TRUE(is_same(fast.backward.value, slow.backward.value)) << i;
    EXPECT_TRUE(is_same(fast.backward.error, slow.backward.error)) << i;
    finite += std::isfinite(slow.forward.value) && slow.forward.error > 0 ? 1 : 0;
  });
  EXPECT_GT(finite, kPairs);
}

// To the last bit of value and bound, on edges that vanish and at both ends of the range too.
TEST(BoxLanes, NormalsOfFacetsAreThoseOfOneOperationAfterTheOther) {
  std::mt19937_64 random = oracle::seeded(20261214);
  std::uniform_real_distribution<double> part(-1, 1);
  constexpr int kPowers[] = {0, -30, 40, -300, 300, -530, 510, -1060};
  const auto same = [](const Bounded& x, const Bounded& y) {
    const auto is_same = [](double p, double q) { return p == q || (std::isnan(p) && std::isnan(q)); };
    return is_same(x.value, y.value) && is_same(x.error, y.error);
  };
  int finite = 0;
  for (int i = 0; i < kPairs; ++i) {
    const auto any = [&](int kind) {
      Vec3 edge(part(random), part(random), part(random));
      if (kind % 3 == 0) edge[kind / 3 % 3] = 0;
      for (double& x : edge) x = std::ldexp(x, kPowers[static_cast<std::size_t>(kind) % std::size(kPowers)]);
      return kernel::EdgeDirection{edge, Vec3::Zero()};
    };
    const kernel::FacetAxis axis{any(i), any(i / 8)};
    const kernel::Vector<Bounded> fast = kernel::direction_of_boxes(axis);
    const kernel::Vector<Bounded> slow = kernel::direction<Bounded>(axis);
    EXPECT_TRUE(same(fast.x, slow.x) && same(fast.y, slow.y) && same(fast.z, slow.z)) << i;
    EXPECT_TRUE(same(kernel::product_sum(fast, fast), square(slow))) << i;
    finite += std::isfinite(slow.x.bound()) && slow.x.error > 0 ? 1 : 0;
  }
  EXPECT_GT(finite, kPairs / 2);
}

TEST(BoxLanes, TheReachOfABoxIsThatOfAnyConvexSet) {
  std::mt19937_64 random = oracle::seeded(20261210);
  std::uniform_real_distribution<double> part(-1, 1);
  int finite = 0;
  for_boxes(20261211, [&](const Box& a, const Box& b, int i) {
    const kernel::Convex box(a);
    const Vec3 n = i % 3 == 0 ? Vec3(b.axes.col(i / 3 % 3)) : Vec3(part(random), part(random), part(random));
    const int side = i % 2 == 0 ? 1 : -1;
    const Bounded fast = kernel::reach_value(box, n, side, b.center);
    const Bounded slow = kernel::reach_along<Bounded>(box, n, side, b.center).part[0].rational;
    if (!std::isfinite(slow.bound())) {
      EXPECT_FALSE(std::isfinite(fast.bound())) << i;
      return;
    }
    EXPECT_EQ(fast.value, slow.value) << i;
    EXPECT_EQ(fast.error, slow.error) << i;
    ++finite;
  });
  EXPECT_GT(finite, kPairs);
}

// A factor that is exact leaves out operations of the running bound, and no bit of the result.
TEST(BoxLanes, ProductsWithExactNumbersKeepEveryBit) {
  std::mt19937_64 random = oracle::seeded(20261205);
  std::uniform_real_distribution<double> part(-1, 1);
  for (int i = 0; i < kPairs; ++i) {
    const double scale = std::ldexp(1, static_cast<int>(400 * part(random)));
    const Bounded x =
        i % 5 == 0 ? Bounded(i % 2 == 0 ? 0 : part(random)) : Bounded(part(random) * scale, scale * 1e-16);
    const double exact = i % 7 == 0 ? 0 : part(random) * std::ldexp(1, static_cast<int>(400 * part(random)));
    const Bounded plain = Bounded(exact) * x;
    const Bounded quick = kernel::times(x, exact);
    EXPECT_EQ(quick.value, plain.value);
    EXPECT_EQ(quick.error, plain.error);
  }
}

}  // namespace
}  // namespace collided
