// Shapes as they travel: every kind's every field in its place, read by the table's own names.
#include <gtest/gtest.h>

#include <limits>

#include "client/library/publishing/shape_encoding.hpp"
#include "idl/scene_generated.h"

namespace collided::client {
namespace {

using ShapeNumbers = std::vector<double>;

class ShapeEncoding : public testing::Test {
 protected:
  const format::Shape& encoded(const Shape& shape, const Vec3& scale = Vec3::Ones()) {
    const Result<std::vector<std::uint8_t>> bytes = encode_shape(shape, scale, "here");
    EXPECT_TRUE(bytes) << bytes.error().message;
    bytes_ = bytes ? *bytes : std::vector<std::uint8_t>();
    flatbuffers::Verifier verifier(bytes_.data(), bytes_.size());
    EXPECT_TRUE(verifier.VerifyBuffer<format::Shape>());
    return *flatbuffers::GetRoot<format::Shape>(bytes_.data());
  }
  static std::string refusal(const Shape& shape, const Vec3& scale = Vec3::Ones()) {
    const Result<std::vector<std::uint8_t>> bytes = encode_shape(shape, scale, "here");
    return bytes ? "taken" : bytes.error().message;
  }
  static void put(ShapeNumbers& numbers, const format::Vec3& v) {
    numbers.insert(numbers.end(), {v.x(), v.y(), v.z()});
  }
  static void put(ShapeNumbers& numbers, const format::Quat& q) {
    numbers.insert(numbers.end(), {q.w(), q.x(), q.y(), q.z()});
  }
  static void put(ShapeNumbers& numbers, const format::Mat3& m) {
    for (const format::Vec3* column : {&m.column_0(), &m.column_1(), &m.column_2()}) put(numbers, *column);
  }
  static void put(ShapeNumbers& numbers, double number) { numbers.push_back(number); }
  template <class... Fields>
  static ShapeNumbers all(const Fields&... fields) {
    ShapeNumbers numbers;
    (put(numbers, fields), ...);
    return numbers;
  }
  template <class Vector>
  static ShapeNumbers list(const Vector* vector) {
    return vector == nullptr ? ShapeNumbers() : ShapeNumbers(vector->begin(), vector->end());
  }
  std::vector<std::uint8_t> bytes_;
};

const Quat kThird(0.5, 0.5, 0.5, 0.5);  // a third of a turn: x to y, y to z, z to x

TEST_F(ShapeEncoding, EveryPrimitiveTravelsWithEveryFieldInItsPlace) {
  const format::Shape& shape =
      encoded({SphereShape{.radius_m = 1, .center = {2, 3, 4}},
               BoxShape{.half_m = {5, 6, 7}, .center = {8, 9, 10}, .rotation = kThird},
               CapsuleShape{.a = {1, 2, 3}, .b = {4, 5, 6}, .radius_m = 7},
               CylinderShape{.a = {11, 12, 13}, .b = {14, 15, 16}, .radius_m = 17},
               ConeShape{.apex = {21, 22, 23}, .base = {24, 25, 26}, .radius_m = 27},
               EllipsoidShape{.half_m = {31, 32, 33}, .center = {34, 35, 36}, .rotation = kThird},
               SphereShape{.radius_m = 5, .center = {6, 7, 8}}});
  ASSERT_EQ(shape.spheres()->size(), 2U);
  const auto& sphere = *shape.spheres()->Get(0);
  const auto& other = *shape.spheres()->Get(1);
  EXPECT_EQ(all(sphere.center(), sphere.radius(), other.center(), other.radius()),
            (ShapeNumbers{2, 3, 4, 1, 6, 7, 8, 5}));
  const auto& box = *shape.boxes()->Get(0);
  EXPECT_EQ(all(box.center(), box.rotation(), box.half()), (ShapeNumbers{8, 9, 10, 0.5, 0.5, 0.5, 0.5, 5, 6, 7}));
  const auto& capsule = *shape.capsules()->Get(0);
  EXPECT_EQ(all(capsule.a(), capsule.b(), capsule.radius()), (ShapeNumbers{1, 2, 3, 4, 5, 6, 7}));
  const auto& cylinder = *shape.cylinders()->Get(0);
  EXPECT_EQ(all(cylinder.a(), cylinder.b(), cylinder.radius()), (ShapeNumbers{11, 12, 13, 14, 15, 16, 17}));
  const auto& cone = *shape.cones()->Get(0);
  EXPECT_EQ(all(cone.apex(), cone.base(), cone.radius()), (ShapeNumbers{21, 22, 23, 24, 25, 26, 27}));
  const auto& ellipsoid = *shape.ellipsoids()->Get(0);
  EXPECT_EQ(all(ellipsoid.center(), ellipsoid.axes(), ellipsoid.half()),
            (ShapeNumbers{34, 35, 36, 0, 1, 0, 0, 0, 1, 1, 0, 0, 31, 32, 33}));
  EXPECT_EQ(shape.mesh(), nullptr);
  EXPECT_EQ(shape.height_field(), nullptr);
  EXPECT_EQ(shape.half_spaces(), nullptr);
  EXPECT_EQ(shape.hulls(), nullptr);
  EXPECT_EQ(shape.clouds(), nullptr);
  EXPECT_EQ(shape.polylines(), nullptr);
  EXPECT_EQ(shape.box_axes(), nullptr);
  EXPECT_EQ(shape.scale(), nullptr) << "1 is left out";
}

TEST_F(ShapeEncoding, PointsAndSurfacesTravelInTheirOrder) {
  const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}};
  const ShapeNumbers flat{0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3};
  const format::Shape& shape = encoded({HullShape{.points = points}, CloudShape{.points = points, .radius_m = 5},
                                        PolylineShape{.points = points, .radius_m = 6},
                                        MeshShape{.vertices = points, .triangles = {{0, 1, 2}, {3, 2, 1}}}},
                                       {2, 3, 4});
  ASSERT_EQ(shape.hulls()->size(), 1U);
  EXPECT_EQ(list(shape.hulls()->Get(0)->vertices()), flat);
  EXPECT_EQ(list(shape.hulls()->Get(0)->corners()), ShapeNumbers());
  ASSERT_EQ(shape.clouds()->size(), 1U);
  EXPECT_EQ(list(shape.clouds()->Get(0)->points()), flat);
  EXPECT_EQ(shape.clouds()->Get(0)->radius(), 5);
  ASSERT_EQ(shape.polylines()->size(), 1U);
  EXPECT_EQ(list(shape.polylines()->Get(0)->points()), flat);
  EXPECT_EQ(shape.polylines()->Get(0)->radius(), 6);
  EXPECT_EQ(list(shape.mesh()->vertices()), flat);
  EXPECT_EQ(list(shape.mesh()->corners()), (ShapeNumbers{0, 1, 2, 3, 2, 1}));
  ASSERT_NE(shape.scale(), nullptr);
  EXPECT_EQ(all(*shape.scale()), (ShapeNumbers{2, 3, 4}));
}

TEST_F(ShapeEncoding, AHalfSpaceAndAHeightFieldTravelWithEveryField) {
  const auto& half_space = *encoded({HalfSpaceShape{.normal = {1, 2, 3}, .point = {4, 5, 6}}}).half_spaces()->Get(0);
  EXPECT_EQ(all(half_space.point(), half_space.normal()), (ShapeNumbers{4, 5, 6, 1, 2, 3}));
  const format::HeightField& field =
      *encoded(
           {HeightFieldShape{.columns = 3, .spacing_x_m = 0.5, .spacing_y_m = 0.25, .heights_m = {1, 2, 3, 4, 5, 6}}})
           .height_field();
  EXPECT_EQ(field.columns(), 3U);
  EXPECT_EQ(field.spacing_x(), 0.5);
  EXPECT_EQ(field.spacing_y(), 0.25);
  EXPECT_EQ(list(field.heights()), (ShapeNumbers{1, 2, 3, 4, 5, 6}));
}

TEST_F(ShapeEncoding, AScaleIsFiniteAndAboveZeroInEachDirection) {
  const Shape ball{SphereShape{.radius_m = 1}};
  for (const double wrong :
       {0., -1., std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    for (int axis = 0; axis < 3; ++axis) {
      Vec3 scale = Vec3::Ones();
      scale[axis] = wrong;
      EXPECT_EQ(refusal(ball, scale), "here: its scale must be finite and above 0") << wrong << " along " << axis;
    }
  }
  EXPECT_EQ(refusal(ball, {1e-9, 1, 1e9}), "taken");
  EXPECT_EQ(refusal({}), "here: its shape has no part");
}

TEST_F(ShapeEncoding, WhatIsNoPartIsNamedWithItsNumber) {
  const double inf = std::numeric_limits<double>::infinity();
  const auto second = [&](const ShapePart& part) {
    const std::string said = refusal({SphereShape{.radius_m = 1}, part});
    EXPECT_EQ(said.substr(0, said.find(": ", 6)), "here: part 1") << said;
    return said.size() > 14 ? said.substr(14) : said;
  };
  EXPECT_EQ(second(HalfSpaceShape{.normal = {0, 0, 0}}), "its normal is zero");
  EXPECT_NE(second(HalfSpaceShape{.normal = {0, inf, 0}}).find("normal"), std::string::npos);
  EXPECT_NE(second(HalfSpaceShape{.point = {0, inf, 0}}).find("point"), std::string::npos);
  const std::string sizes = "; whole rows are needed, at least 2 of 2";
  EXPECT_EQ(second(HeightFieldShape{.columns = 1, .heights_m = {1, 2, 3, 4}}),
            "a height field of 4 heights in 1 columns" + sizes);
  EXPECT_EQ(second(HeightFieldShape{.columns = 2, .heights_m = {1, 2}}),
            "a height field of 2 heights in 2 columns" + sizes);
  EXPECT_EQ(second(HeightFieldShape{.columns = 2, .heights_m = {1, 2, 3, 4, 5}}),
            "a height field of 5 heights in 2 columns" + sizes);
  const std::string spacings = "the spacings of a height field must be finite and above 0";
  EXPECT_EQ(second(HeightFieldShape{.columns = 2, .spacing_x_m = 0, .heights_m = {1, 2, 3, 4}}), spacings);
  EXPECT_EQ(second(HeightFieldShape{.columns = 2, .spacing_y_m = -1, .heights_m = {1, 2, 3, 4}}), spacings);
  EXPECT_EQ(second(HeightFieldShape{.columns = 2, .spacing_y_m = inf, .heights_m = {1, 2, 3, 4}}), spacings);
  EXPECT_EQ(second(HeightFieldShape{.columns = 2, .heights_m = {1, 2, 3, inf}}), "height 3 is not finite");
  EXPECT_EQ(second(CloudShape{.points = {}, .radius_m = 1}), "0 points; at least 1 are needed");
  EXPECT_EQ(second(PolylineShape{.points = {{0, 0, 0}}, .radius_m = 1}), "1 points; at least 2 are needed");
  EXPECT_NE(second(CloudShape{.points = {{0, 0, 0}, {0, inf, 0}}, .radius_m = 1}).find("(point 1)"), std::string::npos);
  EXPECT_NE(second(PolylineShape{.points = {{0, 0, 0}, {0, 1, 0}}, .radius_m = -1}).find("radius -1"),
            std::string::npos);
  EXPECT_EQ(refusal({CloudShape{.points = {{0, 0, 0}}, .radius_m = 0}}), "taken");
  EXPECT_EQ(refusal({PolylineShape{.points = {{0, 0, 0}, {0, 1, 0}}, .radius_m = 0}}), "taken");
  EXPECT_EQ(refusal({HeightFieldShape{.columns = 2, .heights_m = {1, 2, 3, 4}}}), "taken");
}

}  // namespace
}  // namespace collided::client
