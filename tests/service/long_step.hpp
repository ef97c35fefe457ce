#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "collided/client.hpp"

namespace collided::testing_support {

/// A publisher whose rough meshes are far apart until one flush puts all into one place: the step that follows decides
/// every pair of them, which takes a thread some seconds, more than one on a fast machine.
class LongStep {
 public:
  explicit LongStep(Client& client) : client_(client) {
    Result<Publisher> publisher = client.publish("crowd");
    EXPECT_TRUE(publisher) << publisher.error().message;
    publisher_ = std::make_unique<Publisher>(std::move(*publisher));
    for (int i = 0; i < kObjects; ++i) {
      const Result<Publisher::Object> added = publisher_->add(
          {.name = "rough " + std::to_string(i), .shape = {rough_mesh()}, .pose = {.position = {5. * i, 0, 50}}});
      EXPECT_TRUE(added) << added.error().message;
      objects_.push_back(*added);
    }
    const Result<void> applied = publisher_->wait_applied(std::chrono::seconds(60));
    EXPECT_TRUE(applied) << applied.error().message;
  }
  void begin() {
    for (const Publisher::Object object : objects_) {
      const Vec3 place(uniform(), uniform(), 50 + uniform());
      EXPECT_TRUE(publisher_->move(object, {.position = 0.3 * place + Vec3(0, 0, 35)}, true));
    }
    EXPECT_TRUE(publisher_->flush());
  }
  Publisher& publisher() { return *publisher_; }

 private:
  static constexpr int kObjects = 300;

  double uniform() { return std::uniform_real_distribution<double>(-1, 1)(random_); }
  MeshShape rough_mesh() {
    MeshShape mesh;
    for (std::uint32_t i = 0; i < 60; ++i) mesh.vertices.push_back(Vec3(uniform(), uniform(), uniform()).normalized());
    for (std::uint32_t i = 0; i + 2 < 60; ++i) mesh.triangles.push_back({i, i + 1, i + 2});
    return mesh;
  }

  Client& client_;
  std::mt19937_64 random_{5};
  std::unique_ptr<Publisher> publisher_;
  std::vector<Publisher::Object> objects_;
};

}  // namespace collided::testing_support
