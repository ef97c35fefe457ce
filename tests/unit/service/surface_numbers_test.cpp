#include "server/service/commands/surface_numbers.hpp"

#include <gtest/gtest.h>

namespace collided::engine::service {
namespace {

// A mesh that went may leave its address to the next one; viewers must not take the two for one.
TEST(ServiceSurfaceNumbers, AnAddressThatIsUsedAgainHasAnotherNumber) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "the sanitizer hands out no address again so soon";
#endif
  SurfaceNumbers numbers;
  std::uint64_t before = 0;
  std::size_t used_again = 0;
  const TriangleMesh* address = nullptr;
  for (int i = 0; i < 100; ++i) {
    const std::shared_ptr<const TriangleMesh> mesh(new TriangleMesh);
    const std::uint64_t number = numbers.number_of(mesh);
    EXPECT_GT(number, before);
    EXPECT_EQ(numbers.number_of(mesh), number);
    EXPECT_EQ(numbers.find(number).mesh, mesh);
    EXPECT_EQ(numbers.find(before).mesh, nullptr);
    used_again += mesh.get() == address ? 1 : 0;
    address = mesh.get();
    before = number;
  }
  EXPECT_GT(used_again, 0U) << "else nothing was tried";
}

// Numbers of what has gone are forgotten, those of what is there are kept, through thousands of meshes.
TEST(ServiceSurfaceNumbers, WhatIsThereKeepsItsNumber) {
  SurfaceNumbers numbers;
  const auto scene = std::make_shared<const StaticScene>();
  const std::uint64_t of_scene = numbers.number_of(scene);
  for (int i = 0; i < 5'000; ++i) (void)numbers.number_of(std::make_shared<const TriangleMesh>());
  EXPECT_EQ(numbers.number_of(scene), of_scene);
  EXPECT_EQ(numbers.find(of_scene).scene, scene);
  EXPECT_EQ(numbers.find(of_scene).mesh.get(), &scene->mesh);
}

}  // namespace
}  // namespace collided::engine::service
