// A shape from outside with one bad number among a million would poison every bound that holds it; a shape that is only
// odd must come in bit for bit.
#include <gtest/gtest.h>

#include "server/intake/scene_file/scene_file.hpp"
#include "tests/extreme/worlds.hpp"

namespace collided::engine::validation_shapes_test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kTiniest = std::numeric_limits<double>::denorm_min();
constexpr double kGreatest = 0.5e290;  // what reaches farther than twice this is refused

std::string refusal_of(const Primitive& primitive) {
  return decode_shape(encode_shape({.primitives = {primitive}, .mesh = nullptr})).refusal;
}

TEST(ExtremeBorderShapes, RefusedWithPlaceValueAndWhatIsAllowed) {
  EXPECT_EQ(refusal_of(Sphere{{0, kNaN, 0}, 1}), "sphere 0: center is (0, nan, 0) m, allowed are numbers up to 1e290");
  EXPECT_EQ(refusal_of(Sphere{{0, 0, kInfinite}, 1}),
            "sphere 0: center is (0, 0, inf) m, allowed are numbers up to 1e290");
  EXPECT_EQ(refusal_of(Sphere{{0, 0, 0}, -1}), "sphere 0: radius -1 m, allowed are finite sizes of 0 and more");
  EXPECT_EQ(refusal_of(Sphere{{0, 0, 0}, kInfinite}), "sphere 0: radius inf m, allowed are finite sizes of 0 and more");
  EXPECT_EQ(refusal_of(Sphere{{0, 0, 0}, kNaN}), "sphere 0: radius nan m, allowed are finite sizes of 0 and more");
  EXPECT_EQ(refusal_of(Box{.center = {0, 0, 0}, .half_m = {1, -kTiniest, 1}}),
            "box 0: half size -5e-324 m, allowed are finite sizes of 0 and more");
  EXPECT_EQ(refusal_of(Box{.center = {0, 0, 0}, .half_m = {1, 1, kNaN}}),
            "box 0: half size is (1, 1, nan) m, allowed are numbers up to 1e290");
  EXPECT_EQ(refusal_of(Capsule{{kNaN, 0, 0}, {0, 0, 0}, 1}),
            "capsule 0: end a is (nan, 0, 0) m, allowed are numbers up to 1e290");
  EXPECT_EQ(refusal_of(Capsule{{0, 0, 0}, {0, -kInfinite, 0}, 1}),
            "capsule 0: end b is (0, -inf, 0) m, allowed are numbers up to 1e290");
  EXPECT_EQ(refusal_of(Capsule{{0, 0, 0}, {0, 0, 0}, -2}),
            "capsule 0: radius -2 m, allowed are finite sizes of 0 and more");
  EXPECT_EQ(decode_shape(encode_shape(Shape{})).refusal, "shape of nothing");
}

// Distances between two such shapes would overflow, and an answer without a number is none.
TEST(ExtremeBorderShapes, NoShapeReachesBeyondTheLimit) {
  const std::string allowed = " m, allowed are numbers up to 1e290";
  EXPECT_EQ(refusal_of(Sphere{{0, -1.1e290, 0}, 1}), "sphere 0: center is (0, -1.1e+290, 0)" + allowed);
  EXPECT_EQ(refusal_of(Sphere{{0, 0, 0}, 1e290}), "");
  EXPECT_EQ(refusal_of(Sphere{{0.6e290, 0, 0}, 0.6e290}).substr(0, 24), "primitive 0 reaches to (");
  EXPECT_EQ(refusal_of(Box{.center = {0, 0, 0}, .half_m = {1, 2e290, 1}}),
            "box 0: half size is (1, 2e+290, 1)" + allowed);
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 2e290, 0}};
  mesh.triangles = {{0, 1, 2}};
  EXPECT_EQ(decode_shape(encode_shape(extreme::mesh_shape(mesh))).refusal, "vertex 2 is (0, 2e+290, 0)" + allowed);
}

TEST(ExtremeBorderShapes, MeshesThatPointNowhere) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, kNaN, 0}};
  mesh.triangles = {{0, 1, 2}};
  EXPECT_EQ(decode_shape(encode_shape(extreme::mesh_shape(mesh))).refusal,
            "vertex 2 is (0, nan, 0) m, allowed are numbers up to 1e290");
  mesh.vertices[2] = {0, 1, 0};
  mesh.triangles = {{0, 1, 2}, {0, 1, 3}};
  EXPECT_EQ(decode_shape(encode_shape(extreme::mesh_shape(mesh))).refusal, "triangle 1: corner 2 is vertex 3 of 3");
  EXPECT_NE(decode_shape(encode_shape(extreme::mesh_shape(mesh)), {.max_triangles = 1}).refusal, "");
}

TEST(ExtremeBorderShapes, TheOddComesInBitForBit) {
  const Primitive odd[] = {Sphere{{-0.0, kTiniest, -kGreatest}, 0},
                           Sphere{{0, 0, 0}, kGreatest},
                           Sphere{{0, 0, 0}, kTiniest},
                           Box{.center = {kGreatest, -kGreatest, -0.0}, .half_m = {0, kTiniest, kGreatest}},
                           Capsule{{1, 1, 1}, {1, 1, 1}, 0},
                           Capsule{{-kGreatest, 0, 0}, {kGreatest, 0, 0}, kTiniest}};
  for (const Primitive& primitive : odd) {
    const Shape shape{.primitives = {primitive}, .mesh = nullptr};
    const DecodedShape decoded = decode_shape(encode_shape(shape));
    ASSERT_TRUE(decoded.shape) << decoded.refusal;
    EXPECT_EQ(encode_shape(*decoded.shape), encode_shape(shape));
  }
  TriangleMesh mesh;
  mesh.vertices = {{kGreatest, -kTiniest, -0.0}, {0, 0, 0}};
  mesh.triangles = {{0, 0, 0}, {0, 1, 0}, {1, 1, 1}};
  const Shape degenerate = extreme::mesh_shape(mesh);
  const DecodedShape decoded = decode_shape(encode_shape(degenerate));
  ASSERT_TRUE(decoded.shape) << decoded.refusal;
  EXPECT_EQ(encode_shape(*decoded.shape), encode_shape(degenerate));
}

}  // namespace
}  // namespace collided::engine::validation_shapes_test
