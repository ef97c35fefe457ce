#include <cstring>

#include "idl/scene_generated.h"
#include "server/intake/mesh/sphere_mesh.hpp"
#include "server/intake/scene_file/scene_file.hpp"
#include "tests/fuzz/fuzz_target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace collided;
  using namespace collided::engine;
  const ShapeLimits limits{.max_triangles = 10'000, .max_primitives = 100};
  const DecodedShape decoded = decode_shape({reinterpret_cast<const std::byte*>(data), size}, limits);
  fuzz::require(decoded.shape.has_value() == decoded.refusal.empty(), "a shape or a reason");
  if (decoded.shape) {
    fuzz::require(!decoded.shape->empty() && decoded.shape->primitives.size() <= 100, "limits are kept");
    const DecodedShape again = decode_shape(encode_shape(*decoded.shape), limits);
    fuzz::require(again.shape.has_value(), "what was taken once is taken again");
  }
  return 0;
}

/// A scaled height field with a cloud and a line.
static std::string with_forms() {
  using namespace collided;
  using namespace collided::engine;
  flatbuffers::FlatBufferBuilder builder;
  const std::vector<double> points{0, 0, 0, 1, 0, 0, 1, 1, 1};
  const std::vector<double> heights{0, 1, 2, 3, 4, 5};
  const auto cloud = builder.CreateVector(std::vector{format::CreatePointsDirect(builder, &points, 0.5)});
  const auto line = builder.CreateVector(std::vector{format::CreatePointsDirect(builder, &points, 0.25)});
  const auto field = format::CreateHeightFieldDirect(builder, 3, 1, 2, &heights);
  const format::Vec3 scale(2, 2, 2);
  format::ShapeBuilder shape(builder);
  shape.add_height_field(field);
  shape.add_clouds(cloud);
  shape.add_polylines(line);
  shape.add_scale(&scale);
  builder.Finish(shape.Finish());
  return {reinterpret_cast<const char*>(builder.GetBufferPointer()), builder.GetSize()};
}

/// A strip with indices beside a line of points, as vertex buffers.
static std::string with_buffers() {
  using namespace collided;
  using namespace collided::engine;
  flatbuffers::FlatBufferBuilder builder;
  std::vector<std::uint8_t> vertices(5 * 16, 0);
  for (std::size_t i = 0; i < 5; ++i) {
    const float position[3] = {static_cast<float>(i / 2), static_cast<float>(i % 2), 0.5F};
    std::memcpy(vertices.data() + 16 * i + 4, position, sizeof position);
  }
  const std::vector<std::uint8_t> indices{0, 0, 1, 0, 2, 0, 3, 0, 4, 0};
  const auto strip =
      format::CreateVertexBufferDirect(builder, format::BufferKind::strip, false, 16, 4, &vertices, 2, &indices);
  const auto line =
      format::CreateVertexBufferDirect(builder, format::BufferKind::polyline, false, 16, 4, &vertices, 0, nullptr, 0.1);
  const auto buffers = builder.CreateVector(std::vector{strip, line});
  format::ShapeBuilder shape(builder);
  shape.add_buffers(buffers);
  builder.Finish(shape.Finish());
  return {reinterpret_cast<const char*>(builder.GetBufferPointer()), builder.GetSize()};
}

/// Cells beside cells of unknown space.
static std::string with_voxels(bool is_unknown) {
  using namespace collided;
  flatbuffers::FlatBufferBuilder builder;
  const std::vector<std::uint8_t> bits{0xa5, 0x0f, 0x03};
  const auto cells =
      builder.CreateVector(std::vector{format::CreateVoxelsDirect(builder, 0.25, -1, 2, 3, 3, 3, 2, &bits)});
  format::ShapeBuilder shape(builder);
  shape.add_voxels(cells);
  shape.add_is_unknown(is_unknown);
  builder.Finish(shape.Finish());
  return {reinterpret_cast<const char*>(builder.GetBufferPointer()), builder.GetSize()};
}

std::vector<std::string> fuzz_seeds() {
  using namespace collided;
  using namespace collided::engine;
  const Eigen::AngleAxisd turn(0.3, Vec3(1, 2, 3).normalized());
  const Shape compound{{Sphere{{0, 0, 0}, 1}, Box{.center = {1, 0, 0}, .half_m = {1, 1, 1}},
                        Box{.center = {1, 0, 0}, .axes = turn.toRotationMatrix(), .half_m = {1, 1, 1}},
                        Capsule{{0, 0, 0}, {1, 0, 0}, 1}},
                       std::make_shared<const TriangleMesh>(latitude_longitude_sphere(1, 4, 3))};
  std::vector<std::string> seeds;
  for (const Shape& shape :
       {compound, Shape{{Sphere{{1, 2, 3}, 0.5}}, nullptr}, Shape{{HalfSpace{{1, 2, 3}, {0, 0, 2}}}, nullptr}}) {
    const std::vector<std::byte> bytes = encode_shape(shape);
    seeds.emplace_back(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }
  seeds.push_back(with_forms());
  seeds.push_back(with_buffers());
  seeds.push_back(with_voxels(false));
  seeds.push_back(with_voxels(true));
  return seeds;
}
