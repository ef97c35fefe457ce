#include "server/world/objects/shared_primitives.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "tests/scenes/meshes.hpp"

namespace collided::engine {
namespace {

const Box kUnitBox{.center = {0, 0, 0}, .half_m = {1, 1, 1}};

TEST(SharedPrimitives, EqualListsAreOne) {
  RecentPrimitives recent;
  const std::vector<Primitive> list{Sphere{{0, 0, 0}, 1}, kUnitBox};
  const SharedPrimitives first = recent.shared(list);
  EXPECT_TRUE(recent.shared(std::vector<Primitive>(list)).shares(first));
  EXPECT_EQ(first.size(), 2u);
  EXPECT_EQ(std::get<Box>(first[1]).half_m, kUnitBox.half_m);
}

// A bit of difference is one, of the sign of a zero too.
TEST(SharedPrimitives, WhatDiffersAtAllIsKeptApart) {
  RecentPrimitives recent;
  const auto of = [&](const Primitive& one) { return recent.shared(std::vector<Primitive>{one}); };
  const SharedPrimitives sphere = of(Sphere{{0, 0, 0}, 1});
  const Primitive others[] = {Sphere{{0, 0, 0}, std::nextafter(1, 2)}, Sphere{{0, -0.0, 0}, 1}, kUnitBox,
                              Ellipsoid{.center = {0, 0, 0}, .half_m = {1, 1, 1}}};
  for (const Primitive& other : others) {
    const SharedPrimitives own = of(other);
    EXPECT_FALSE(own.shares(sphere));
    EXPECT_EQ(own.front().index(), other.index());
  }
  EXPECT_EQ(std::get<Sphere>(of(Sphere{{0, 0, 0}, 2}).front()).radius_m, 2);
}

TEST(SharedPrimitives, HullsOfOneMeshAreOne) {
  RecentPrimitives recent;
  const auto mesh = std::make_shared<const TriangleMesh>(scenes::box({1, 1, 1}));
  const auto same = std::make_shared<const TriangleMesh>(*mesh);
  const auto of = [&](const std::shared_ptr<const TriangleMesh>& mesh_of_it, double x) {
    return recent.shared(std::vector<Primitive>{Hull{.mesh = mesh_of_it, .position = {x, 0, 0}}});
  };
  const SharedPrimitives hull = of(mesh, 0);
  EXPECT_TRUE(of(mesh, 0).shares(hull));
  EXPECT_FALSE(of(mesh, 1).shares(hull));
  EXPECT_FALSE(of(same, 0).shares(hull)) << "vertices are not compared";
}

// Whoever has its list keeps it, however many others come; none of them is mistaken for another.
TEST(SharedPrimitives, ForgottenOnesStayWithTheirOwners) {
  RecentPrimitives recent;
  std::vector<SharedPrimitives> owners;
  constexpr std::size_t kCount = 10 * RecentPrimitives::kRemembered;
  for (std::size_t i = 0; i < kCount; ++i)
    owners.push_back(recent.shared(std::vector<Primitive>{Sphere{{0, 0, 0}, static_cast<double>(i)}}));
  for (std::size_t i = 0; i < kCount; ++i)
    ASSERT_EQ(std::get<Sphere>(owners[i].front()).radius_m, static_cast<double>(i));
  EXPECT_TRUE(recent.shared(std::vector<Primitive>{}).empty());
}

}  // namespace
}  // namespace collided::engine
