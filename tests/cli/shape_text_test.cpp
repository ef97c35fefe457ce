// Shapes as they are typed: lengths along an axis are whole ones, and the middle is at the origin.
#include "client/cli/input/shape_text.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <string>

#include "client/cli/input/line_reader.hpp"

namespace collided::cli {
namespace {

template <class Shape>
Shape shape(std::string_view text) {
  return std::get<Shape>(parse_shape(text));
}

TEST(ShapeText, RoundShapesWithAnAxisStandOnItHalfAboveAndHalfBelow) {
  const auto capsule = shape<CapsuleShape>("capsule:5cm,30cm");
  EXPECT_EQ(capsule.radius_m, 0.05);
  EXPECT_EQ(capsule.a, Vec3(0, 0, -0.15));
  EXPECT_EQ(capsule.b, Vec3(0, 0, 0.15));
  const auto cylinder = shape<CylinderShape>("cylinder:2,6");
  EXPECT_EQ(cylinder.radius_m, 2);
  EXPECT_EQ(cylinder.a, Vec3(0, 0, -3));
  EXPECT_EQ(cylinder.b, Vec3(0, 0, 3));
  const auto cone = shape<ConeShape>("cone:2,6");
  EXPECT_EQ(cone.radius_m, 2);
  EXPECT_EQ(cone.apex, Vec3(0, 0, 3));
  EXPECT_EQ(cone.base, Vec3(0, 0, -3));
}

TEST(ShapeText, BoxesAreTypedByWholeLengthsAndSpheresByTheRadius) {
  EXPECT_EQ(shape<BoxShape>("box:2,4,6").half_m, Vec3(1, 2, 3));
  EXPECT_EQ(shape<SphereShape>("sphere:0.25").radius_m, 0.25);
}

TEST(LineReader, IsReadyForALineThatCameWithAnEarlierOneAndNotForHalfOfOne) {
  std::array<int, 2> ends{};
  ASSERT_EQ(pipe(ends.data()), 0);
  const auto write_text = [&](const std::string& text) {
    ASSERT_EQ(write(ends[1], text.data(), text.size()), static_cast<ssize_t>(text.size()));
  };
  LineReader reader(ends[0]);
  std::string line;
  EXPECT_FALSE(reader.ready());
  write_text("one\ntwo\nthr");
  ASSERT_TRUE(reader.next(line));
  EXPECT_EQ(line, "one");
  EXPECT_TRUE(reader.ready()) << "the second line came with the first";
  ASSERT_TRUE(reader.next(line));
  EXPECT_EQ(line, "two");
  EXPECT_FALSE(reader.ready()) << "its line end is still to come";
  close(ends[1]);
  EXPECT_TRUE(reader.ready()) << "there will be no more of it";
  ASSERT_TRUE(reader.next(line));
  EXPECT_EQ(line, "thr");
  EXPECT_TRUE(reader.ready());
  EXPECT_FALSE(reader.next(line));
  close(ends[0]);
}

}  // namespace
}  // namespace collided::cli
