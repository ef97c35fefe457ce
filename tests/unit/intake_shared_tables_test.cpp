#include <gtest/gtest.h>

#include "idl/scene_generated.h"
#include "tests/unit/intake_loading.hpp"

namespace collided {
namespace {

/// A scene whose objects all point at one shape: sound FlatBuffers, which nobody who saves a scene writes.
std::string scene_of_shared_shapes(std::size_t object_count, std::size_t vertex_count) {
  flatbuffers::FlatBufferBuilder builder;
  const std::vector<double> numbers(3 * vertex_count, 1.0);
  const std::vector<std::uint32_t> corners = {0, 1, 2};
  const auto mesh = format::CreateMesh(builder, builder.CreateVector(numbers), builder.CreateVector(corners));
  const auto shape = format::CreateShape(builder, 0, 0, 0, mesh);
  std::vector<flatbuffers::Offset<format::Object>> objects;
  for (std::size_t i = 0; i < object_count; ++i) {
    const auto name = builder.CreateString(std::to_string(i));
    objects.push_back(format::CreateObject(builder, name, shape));
  }
  const auto name = builder.CreateString("shared");
  format::FinishSceneBuffer(builder, format::CreateScene(builder, 1, name, 0, 0, builder.CreateVector(objects)));
  return {reinterpret_cast<const char*>(builder.GetBufferPointer()), builder.GetSize()};
}

// One object alone is fine. Ten thousand would become 24 GB out of a file of 3 MB.
TEST(IntakeSceneFileTables, SharedTablesCannotGrowBeyondTheFile) {
  EXPECT_EQ(test::load("one.cscene", scene_of_shared_shapes(1, 100'000)).scene.objects.size(), 1u);
  EXPECT_EQ(
      test::complaint("many.cscene", scene_of_shared_shapes(10'000, 100'000)),
      "many.cscene: object '1': tables share their numbers, so that it would grow beyond its own size. Nothing was "
      "loaded.");
}

TEST(IntakeSceneFileTables, AnotherFormatNumberIsRefused) {
  flatbuffers::FlatBufferBuilder builder;
  format::FinishSceneBuffer(builder, format::CreateScene(builder, 2, builder.CreateString("later")));
  EXPECT_EQ(
      test::complaint("later.cscene", {reinterpret_cast<const char*>(builder.GetBufferPointer()), builder.GetSize()}),
      "later.cscene: scene format 2, this program reads 1. Nothing was loaded.");
}

}  // namespace
}  // namespace collided
