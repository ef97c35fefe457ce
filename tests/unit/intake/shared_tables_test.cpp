#include <gtest/gtest.h>

#include "idl/scene_generated.h"
#include "tests/unit/intake/loading.hpp"

namespace collided::engine {
namespace {

/// A scene whose objects all point at one shape.
template <class Make>
std::string scene_of_one_shape(std::size_t object_count, Make&& make) {
  flatbuffers::FlatBufferBuilder builder;
  const flatbuffers::Offset<format::Shape> shape = make(builder);
  std::vector<flatbuffers::Offset<format::Object>> objects;
  for (std::size_t i = 0; i < object_count; ++i) {
    const auto name = builder.CreateString(std::to_string(i));
    objects.push_back(format::CreateObject(builder, name, shape));
  }
  const auto name = builder.CreateString("shared");
  format::FinishSceneBuffer(builder, format::CreateScene(builder, 1, name, 0, 0, builder.CreateVector(objects)));
  return {reinterpret_cast<const char*>(builder.GetBufferPointer()), builder.GetSize()};
}

std::string scene_of_one_mesh(std::size_t object_count, std::size_t vertex_count) {
  return scene_of_one_shape(object_count, [&](flatbuffers::FlatBufferBuilder& builder) {
    const std::vector<double> numbers(3 * vertex_count, 1.0);
    const std::vector<std::uint32_t> corners = {0, 1, 2};
    const auto mesh = format::CreateMesh(builder, builder.CreateVector(numbers), builder.CreateVector(corners));
    return format::CreateShape(builder, 0, 0, 0, mesh);
  });
}

std::string scene_of_one_heap_of_balls(std::size_t object_count, std::size_t ball_count) {
  return scene_of_one_shape(object_count, [&](flatbuffers::FlatBufferBuilder& builder) {
    const std::vector<format::Sphere> balls(ball_count, format::Sphere(format::Vec3(1, 2, 3), 1));
    return format::CreateShape(builder, builder.CreateVectorOfStructs(balls));
  });
}

// Ten thousand of 2.4 MB each, and one in memory.
TEST(IntakeSceneFileTables, ASharedMeshIsHeldOnce) {
  const Scene scene = test::load("many.cscene", scene_of_one_mesh(10'000, 100'000)).scene;
  ASSERT_EQ(scene.objects.size(), 10'000u);
  EXPECT_EQ(scene.objects.front().shape.mesh->vertices.size(), 100'000u);
  EXPECT_EQ(scene.objects.front().shape.mesh, scene.objects.back().shape.mesh);
}

// Sound FlatBuffers, which nobody who saves a scene writes: what is not shared in memory would become many times the
// file.
TEST(IntakeSceneFileTables, SharedTablesCannotGrowBeyondTheFile) {
  EXPECT_EQ(test::load("one.cscene", scene_of_one_heap_of_balls(1, 10'000)).scene.objects.size(), 1u);
  EXPECT_EQ(
      test::complaint("many.cscene", scene_of_one_heap_of_balls(10'000, 10'000)),
      "many.cscene: object '1': tables share their numbers, so that it would grow beyond its own size. Nothing was "
      "loaded.");
}

/// Buffers that are one, of so many vertices and indices, all of them the vertex 0.
std::string scene_of_one_buffer(std::size_t times, std::size_t vertex_count, std::size_t index_count) {
  return scene_of_one_shape(1, [&](flatbuffers::FlatBufferBuilder& builder) {
    const std::vector<std::uint8_t> vertices(12 * vertex_count, 0);
    const std::vector<std::uint8_t> indices(4 * index_count, 0);
    const auto buffer =
        format::CreateVertexBuffer(builder, format::BufferKind::points, false, 12, 0, builder.CreateVector(vertices),
                                   index_count == 0 ? 0 : 4, builder.CreateVector(indices), 0.5);
    const std::vector<flatbuffers::Offset<format::VertexBuffer>> buffers(times, buffer);
    const auto all = builder.CreateVector(buffers);
    format::ShapeBuilder shape(builder);
    shape.add_buffers(all);
    return shape.Finish();
  });
}

// The larger of its two tables is what a buffer grows by, each time that it is named.
TEST(IntakeSceneFileTables, ABufferThatIsNamedAgainAndAgainCannotGrowBeyondTheFile) {
  const std::string refusal =
      "buffers.cscene: object '0': tables share their numbers, so that it would grow beyond its own size. Nothing was "
      "loaded.";
  EXPECT_EQ(test::load("buffers.cscene", scene_of_one_buffer(1, 1, 10'000)).scene.objects[0].shape.primitives.size(),
            10'000u);
  EXPECT_EQ(test::load("buffers.cscene", scene_of_one_buffer(1, 10'000, 0)).scene.objects[0].shape.primitives.size(),
            10'000u);
  EXPECT_EQ(test::complaint("buffers.cscene", scene_of_one_buffer(3, 1, 10'000)), refusal);
  EXPECT_EQ(test::complaint("buffers.cscene", scene_of_one_buffer(3, 10'000, 0)), refusal);
  EXPECT_EQ(test::complaint("buffers.cscene", scene_of_one_buffer(3, 10'000, 1)), refusal);
}

TEST(IntakeSceneFileTables, AnotherFormatNumberIsRefused) {
  flatbuffers::FlatBufferBuilder builder;
  format::FinishSceneBuffer(builder, format::CreateScene(builder, 5, builder.CreateString("later")));
  EXPECT_EQ(
      test::complaint("later.cscene", {reinterpret_cast<const char*>(builder.GetBufferPointer()), builder.GetSize()}),
      "later.cscene: scene format 5, this program reads up to 4. Nothing was loaded.");
}

}  // namespace
}  // namespace collided::engine
