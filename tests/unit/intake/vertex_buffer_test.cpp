#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "server/intake/mesh/mesh_health.hpp"
#include "server/intake/mesh/sphere_mesh.hpp"
#include "server/intake/readers/strips.hpp"
#include "server/intake/readers/vertex_buffer.hpp"
#include "server/world/query/query.hpp"
#include "server/world/world.hpp"
#include "tests/oracle/brute_force.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"

// Vertex buffers of six kinds, and the way back.  // A7 A8 A9 A10 A11 A12
namespace collided::engine {
namespace {

/// Bytes that own what a VertexBuffer refers to, with junk between the positions, from an odd address on.
struct Bytes {
  std::vector<std::byte> vertices{std::byte{0}};
  std::vector<std::byte> indices{std::byte{0}};
  VertexBuffer buffer;

  template <class Number>
  static void append(std::vector<std::byte>& bytes, Number number) {
    const auto* raw = reinterpret_cast<const std::byte*>(&number);
    bytes.insert(bytes.end(), raw, raw + sizeof(Number));
  }

  Bytes(BufferKind kind, const std::vector<Vec3>& points, const std::vector<std::uint32_t>& sequence,
        std::size_t index_bytes, std::size_t stride, std::size_t offset, bool is_double) {
    for (const Vec3& p : points) {
      const std::size_t begin = vertices.size();
      vertices.resize(begin + offset, std::byte{0xff});
      for (int axis = 0; axis < 3; ++axis) {
        if (is_double) append(vertices, p[axis]);
        else append(vertices, static_cast<float>(p[axis]));
      }
      vertices.resize(begin + stride, std::byte{0xff});
    }
    for (const std::uint32_t i : sequence) {
      if (index_bytes == 2) append(indices, static_cast<std::uint16_t>(i));
      if (index_bytes == 4) append(indices, i);
    }
    buffer = {
        kind, is_double, stride, offset, std::span(vertices).subspan(1), index_bytes, std::span(indices).subspan(1)};
  }
};

DecodedBuffer decoded(const VertexBuffer& buffer) {
  auto result = decode_buffer(buffer);
  if (const auto* flaw = std::get_if<std::string>(&result)) throw std::runtime_error(*flaw);
  return std::get<DecodedBuffer>(std::move(result));
}

std::string refusal(const VertexBuffer& buffer) {
  auto result = decode_buffer(buffer);
  return std::holds_alternative<std::string>(result) ? std::get<std::string>(result) : "taken";
}

/// Each triangle from its least corner on: the set of oriented triangles.
std::vector<TriangleCorners> oriented(std::vector<TriangleCorners> triangles) {
  for (TriangleCorners& t : triangles) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

const std::vector<Vec3> kSix{{0, 0, 0}, {1, 0, 0.5}, {0, 1, 0.25}, {1, 1, 0}, {0, 2, -0.5}, {1, 2, 1}};

TEST(IntakeVertexBuffer, SixKindsAreJoinedAsTheirNamesSay) {
  const auto of = [&](BufferKind kind) { return decoded(Bytes(kind, kSix, {}, 0, 12, 0, false).buffer); };
  using Pairs = std::vector<std::array<std::uint32_t, 2>>;
  using Triangles = std::vector<TriangleCorners>;
  EXPECT_EQ(of(BufferKind::points).points, (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(of(BufferKind::segments).segments, (Pairs{{0, 1}, {2, 3}, {4, 5}}));
  EXPECT_EQ(of(BufferKind::polyline).segments, (Pairs{{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 5}}));
  EXPECT_EQ(of(BufferKind::triangles).mesh.triangles, (Triangles{{0, 1, 2}, {3, 4, 5}}));
  EXPECT_EQ(of(BufferKind::fan).mesh.triangles, (Triangles{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}}));
  EXPECT_EQ(of(BufferKind::strip).mesh.triangles, (Triangles{{0, 1, 2}, {2, 1, 3}, {2, 3, 4}, {4, 3, 5}}));
}

// A11: strides of 12 to 64 bytes, positions anywhere in the vertex, odd addresses, floats and doubles: one mesh.
TEST(IntakeVertexBuffer, StridesOffsetsAndWidthsGiveTheSameMesh) {
  const DecodedBuffer plain = decoded(Bytes(BufferKind::strip, kSix, {}, 0, 12, 0, false).buffer);
  for (const bool is_double : {false, true}) {
    const std::size_t position = is_double ? 24 : 12;
    for (std::size_t stride = position; stride <= 64; ++stride) {
      for (const std::size_t offset : {std::size_t{0}, (stride - position) / 2, stride - position}) {
        for (const std::size_t index_bytes : {0, 2, 4}) {
          const Bytes bytes(BufferKind::strip, kSix, {0, 1, 2, 3, 4, 5}, index_bytes, stride, offset, is_double);
          VertexBuffer buffer = bytes.buffer;
          if (index_bytes == 0) buffer.indices = {};
          for (const std::size_t cut :
               {std::size_t{0}, stride - position - offset}) {  // the tail of the last vertex may be missing
            buffer.vertices = bytes.buffer.vertices.first(bytes.buffer.vertices.size() - cut);
            const DecodedBuffer same = decoded(buffer);
            ASSERT_EQ(same.mesh.vertices, plain.mesh.vertices) << stride;
            ASSERT_EQ(same.mesh.triangles, plain.mesh.triangles) << stride;
          }
        }
      }
    }
  }
}

TEST(IntakeVertexBuffer, WhatDoesNotFitIsRefusedByName) {
  const Bytes list(BufferKind::triangles, kSix, {0, 1, 2, 3, 4, 9}, 2, 16, 4, false);
  EXPECT_EQ(refusal(list.buffer), "triangle 1: index 5 is vertex 9 of 6");
  EXPECT_EQ(refusal(Bytes(BufferKind::fan, kSix, {0, 1, 2, 65535}, 4, 16, 4, false).buffer),
            "triangle 1: index 3 is vertex 65535 of 6");
  EXPECT_EQ(refusal(Bytes(BufferKind::strip, kSix, {7, 1, 2, 3}, 4, 16, 4, false).buffer),
            "triangle 0: index 0 is vertex 7 of 6");
  EXPECT_EQ(refusal(Bytes(BufferKind::segments, kSix, {0, 1, 2, 6}, 2, 16, 4, false).buffer),
            "segment 1: index 3 is vertex 6 of 6");
  const auto changed = [&](auto change) {
    VertexBuffer buffer = list.buffer;
    buffer.indices = buffer.indices.first(6);
    change(buffer);
    return refusal(buffer);
  };
  EXPECT_EQ(changed([](VertexBuffer&) {}), "taken");
  EXPECT_NE(changed([](VertexBuffer& b) { b.stride_bytes = 11; }).find("stride 11"), std::string::npos);
  EXPECT_NE(changed([](VertexBuffer& b) { b.stride_bytes = 0; }).find("stride 0"), std::string::npos);
  EXPECT_NE(changed([](VertexBuffer& b) { b.offset_bytes = 5; }).find("offset 5"), std::string::npos);
  EXPECT_NE(changed([](VertexBuffer& b) { b.offset_bytes = SIZE_MAX; }).find("does not fit"), std::string::npos);
  EXPECT_NE(changed([](VertexBuffer& b) { b.vertices = b.vertices.first(6 * 16 - 1); }), "taken");
  EXPECT_NE(changed([](VertexBuffer& b) { b.vertices = b.vertices.first(5 * 16 + 3); }).find("breaks off"),
            std::string::npos);
  EXPECT_NE(changed([](VertexBuffer& b) { b.index_bytes = 3; }).find("indices of 3 bytes"), std::string::npos);
  EXPECT_NE(changed([](VertexBuffer& b) { b.indices = b.indices.first(5); }).find("5 bytes of indices"),
            std::string::npos);
  EXPECT_NE(changed([](VertexBuffer& b) { b.indices = b.indices.first(4); }).find("2 corners"), std::string::npos);
  EXPECT_NE(changed([](VertexBuffer& b) { b.kind = static_cast<BufferKind>(6); }).find("kind 6"), std::string::npos);
  EXPECT_NE(changed([](VertexBuffer& b) { b.kind = static_cast<BufferKind>(6), b.is_double = true; }), "taken");
  EXPECT_NE(changed([](VertexBuffer& b) { b.offset_bytes = 0; }).find("vertex 0 is"), std::string::npos)
      << "0xff.. is no number";
}

// A12: what a buffer takes in memory is the formula, so that a server can say so ahead.
TEST(IntakeVertexBuffer, TooFewCornersForOnePieceAreRefusedAndJustEnoughAreTaken) {
  struct Fewest {
    BufferKind kind;
    std::size_t count;
    std::string piece;
  };
  for (const Fewest& fewest : {Fewest{BufferKind::points, 1, "point"},
                               {BufferKind::segments, 2, "segment"},
                               {BufferKind::polyline, 2, "segment"},
                               {BufferKind::triangles, 3, "triangle"},
                               {BufferKind::fan, 3, "triangle"},
                               {BufferKind::strip, 3, "triangle"}}) {
    std::vector<std::uint32_t> sequence(fewest.count);
    for (std::uint32_t i = 0; i < sequence.size(); ++i) sequence[i] = i;
    for (;; sequence.pop_back()) {
      const std::string told = refusal(Bytes(fewest.kind, kSix, sequence, 2, 12, 0, false).buffer);
      if (sequence.size() == fewest.count) {
        EXPECT_EQ(told, "taken");
      } else {
        EXPECT_EQ(told.find(std::to_string(sequence.size()) + " corners, a " + fewest.piece + " takes " +
                            std::to_string(fewest.count)),
                  0u)
            << told;
      }
      if (sequence.empty()) break;
    }
  }
}

TEST(IntakeVertexBuffer, MemoryIsTheFormula) {
  const DecodedBuffer d = decoded(Bytes(BufferKind::fan, kSix, {0, 1, 2, 3}, 2, 12, 0, false).buffer);
  EXPECT_EQ(d.mesh.vertices.size() * sizeof(Vec3) + d.mesh.triangles.size() * sizeof(TriangleCorners),
            6u * 24 + 2u * 12);
}

void expect_same_triangles(const TriangleMesh& mesh) {
  for (const BufferKind kind : {BufferKind::fan, BufferKind::strip}) {
    std::vector<TriangleCorners> back;
    for (const auto& run : kind == BufferKind::fan ? fans_of(mesh) : strips_of(mesh)) {
      const DecodedBuffer d = decoded(Bytes(kind, mesh.vertices, run, 4, 24, 0, true).buffer);
      ASSERT_EQ(d.mesh.triangles.size(), run.size() - 2);
      back.insert(back.end(), d.mesh.triangles.begin(), d.mesh.triangles.end());
    }
    EXPECT_EQ(oriented(back), oriented(mesh.triangles));
  }
}

TEST(IntakeVertexBuffer, FansAndStripsCarryTheSameOrientedTriangles) {
  expect_same_triangles(latitude_longitude_sphere(1, 12, 7));
  expect_same_triangles(scenes::icosphere(3, 1));
  expect_same_triangles(scenes::terrain(9, 1, 2));
  expect_same_triangles(
      {kSix, {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}, {1, 0, 5}, {0, 1, 2}}});  // edges of five, doubled triangles
  expect_same_triangles({kSix, {{0, 1, 2}}});
}

// A8: every other triangle of a strip turns the other way; all normals of a closed one point out all the same.
TEST(IntakeVertexBuffer, NormalsOfStripsOfAClosedSurfacePointOut) {
  const TriangleMesh mesh = latitude_longitude_sphere(1, 16, 9);
  for (const auto& run : strips_of(mesh)) {
    const DecodedBuffer d = decoded(Bytes(BufferKind::strip, mesh.vertices, run, 2, 24, 0, true).buffer);
    for (std::uint32_t i = 0; i < d.mesh.triangles.size(); ++i) {
      const Triangle t = d.mesh.triangle(i);
      EXPECT_GT((t.b - t.a).cross(t.c - t.a).dot(t.a + t.b + t.c), 0);
    }
  }
}

// A9: the table.
TEST(IntakeVertexBuffer, TheMeshIsTheSmallestEncodingOfASphere) {
  const TriangleMesh mesh = latitude_longitude_sphere(1, 64, 33);
  const std::vector<EncodingSize> sizes = encoding_sizes(mesh);
  for (const EncodingSize& size : sizes)
    std::printf("%-7s %8zu bytes, %5.1f a triangle\n", size.name.c_str(), size.bytes, size.bytes_a_triangle);
  ASSERT_EQ(sizes.back().name, "mesh");
  for (std::size_t i = 0; i + 1 < sizes.size(); ++i) EXPECT_LT(sizes.back().bytes, sizes[i].bytes) << sizes[i].name;
  EXPECT_LT(sizes[2].bytes, sizes[0].bytes / 2) << "strips carry each vertex about once a triangle";
}

// A10: all six kinds are met by questions as brute force over their parts says.
TEST(IntakeVertexBuffer, AllSixKindsAreCollidable) {
  std::mt19937_64 random = oracle::seeded(110);
  std::uniform_real_distribution<double> coordinate(-1, 1);
  for (int kind = 0; kind < 6; ++kind) {
    std::vector<Vec3> points;
    for (int i = 0; i < 60; ++i) points.emplace_back(coordinate(random), coordinate(random), coordinate(random));
    const Bytes bytes(static_cast<BufferKind>(kind), points, {}, 0, 32, 8, true);
    auto shape = shape_of_buffer(bytes.buffer, 0.05);
    ASSERT_TRUE(std::holds_alternative<Shape>(shape));
    World world(WorldOptions{});
    ObjectDefinition object;
    object.name = "buffer";
    object.shape = std::get<Shape>(shape);
    world.define(object);
    world.step(0, 1, {});
    int hits = 0;
    for (const QuestionKind query : {QuestionKind::ray, QuestionKind::sphere, QuestionKind::near}) {
      std::vector<double> numbers;
      for (int i = 0; i < 200; ++i) {
        for (int k = 0; k < 3; ++k) numbers.push_back(2 * coordinate(random));
        if (query == QuestionKind::ray) {
          for (int k = 0; k < 3; ++k) numbers.push_back(-numbers[numbers.size() - 3] + 0.5 * coordinate(random));
        }
        numbers.push_back(query == QuestionKind::sphere ? 0.2 : 100);
      }
      const Questions questions{.kind = query, .numbers = numbers};
      Answers fast;
      Answers slow;
      QueryScratch scratch;
      answer(*world.newest(), questions, fast, scratch);
      oracle::answer(*world.newest(), questions, slow);
      ASSERT_EQ(fast.answers, slow.answers) << kind;
      ASSERT_EQ(fast.hits.size(), slow.hits.size()) << kind;
      for (std::size_t i = 0; i < fast.hits.size(); ++i)
        EXPECT_EQ(fast.hits[i].distance_m, slow.hits[i].distance_m) << kind;
      hits += static_cast<int>(fast.hits.size());
    }
    EXPECT_GT(hits, 200) << kind;
  }
}

}  // namespace
}  // namespace collided::engine
