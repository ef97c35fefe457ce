#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "server/world/world.hpp"
#include "tests/oracle/exact_data.hpp"

namespace collided::recorded {
using namespace engine;

/// A test of what really happened: the folder named by COLLIDED_DATA, or a skip that says so.
class RecordedReality : public testing::Test {
 protected:
  void SetUp() override {
    const std::filesystem::path exact = oracle::exact_data();
    if (exact.empty()) GTEST_SKIP() << "no recorded data; COLLIDED_DATA may name the folder";
    data_ = exact.parent_path();
  }
  std::filesystem::path data_;
};

/// A table whose columns are asked for by name; a file that is not there has no rows and fails the test.
class Rows {
 public:
  explicit Rows(const std::filesystem::path& file);
  std::size_t size() const { return table_.rows.size(); }
  const std::string& text(std::size_t row, const char* column) const;
  double number(std::size_t row, const char* column) const;
  int integer(std::size_t row, const char* column) const { return static_cast<int>(number(row, column)); }
  Vec3 point(std::size_t row) const { return {number(row, "x"), number(row, "y"), number(row, "z")}; }
  /// Columns x y z qw qx qy qz; recordings round their quaternions, which are made unit again.
  Pose pose(std::size_t row) const;
  /// Runs of rows that agree in a column: [first, end).
  std::vector<std::pair<std::size_t, std::size_t>> groups(const char* column) const { return groups(column, column); }
  std::vector<std::pair<std::size_t, std::size_t>> groups(const char* column, const char* other) const;

 private:
  std::size_t column(const char* name) const;
  oracle::Table table_;
  mutable std::vector<std::pair<const char*, std::size_t>> known_;
};

/// A world that is told poses and says which objects touch.
class Stage {
 public:
  ObjectId add(const std::string& name, Shape shape, const Pose& pose, bool moving, std::uint32_t group = 0);
  void move(ObjectId object, const Pose& pose, bool teleport = false);
  /// One step; its events are in world().
  void step();
  /// Names of the pairs that touch now, as "first:second" where `moving` comes first.
  std::vector<std::string> touching() const;
  World& world() { return world_; }

 private:
  World world_{WorldOptions{}};
  std::int64_t time_ns_ = 0;
};

/// The triangles of a mesh file in its own frame, metres.
std::shared_ptr<const TriangleMesh> mesh_file(const std::filesystem::path& file);

}  // namespace collided::recorded
