#include <cmath>

#include "client/draw/drawing/features.hpp"
#include "tests/drawing/drawing_fixture.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::drawing_test {
namespace {

using draw::LineKind;
using draw::Style;
using Exact = boost::multiprecision::cpp_rational;

struct Kinds {
  std::size_t count[draw::kLineKindCount] = {};
  std::size_t of(LineKind kind) const { return count[static_cast<std::size_t>(kind)]; }
};

Kinds kinds_of(const std::vector<draw::FeatureLine>& lines) {
  Kinds kinds;
  for (const draw::FeatureLine& line : lines) ++kinds.count[static_cast<std::size_t>(line.kind)];
  return kinds;
}

/// How many silhouette edges end at each point.
std::map<std::array<double, 3>, int> silhouette_ends(const std::vector<draw::FeatureLine>& lines) {
  std::map<std::array<double, 3>, int> ends;
  for (const draw::FeatureLine& line : lines) {
    if (line.kind != LineKind::silhouette) continue;
    for (const Vec3& p : line.points) ++ends[{p.x(), p.y(), p.z()}];
  }
  return ends;
}

class DrawingLines : public DrawingTest {};

// A73: of a box from a general eye, twelve lines; three of them behind it.
TEST_F(DrawingLines, ABoxHasTwelveNineAndNineWithThreeLighter) {
  serve({{.name = "box", .shape = {BoxShape{{1, 1, 1}}}}});
  for (const bool is_parallel : {false, true}) {
    const draw::View view = general_eye(is_parallel);
    const draw::Drawing wire = drawing({.view = view, .style = Style::wireframe});
    EXPECT_EQ(wire.picture.strokes.size(), 12U);
    EXPECT_EQ(rays_->asked(), 0U) << "nothing is hidden in a wireframe";
    const draw::Drawing hidden = drawing({.view = view, .style = Style::hidden_line});
    EXPECT_EQ(hidden.picture.strokes.size(), 9U);
    const draw::Drawing obscured = drawing({.view = view, .style = Style::obscured_line});
    ASSERT_EQ(obscured.picture.strokes.size(), 12U);
    std::size_t lighter = 0;
    for (const draw::Stroke& stroke : obscured.picture.strokes) lighter += stroke.ink.name == "hidden" ? 1 : 0;
    EXPECT_EQ(lighter, 3U);
    EXPECT_EQ(lines_with(obscured, false).size(), 3U);
    EXPECT_GT(rays_->asked(), 1'000U);
    EXPECT_EQ(rays_->undecided(), 0U);
  }
}

// A62, A64: as a mesh it has the same, and its silhouette is one loop of six edges.
TEST_F(DrawingLines, ACubeOfTrianglesHasTwelveCreasesSixOfThemOneSilhouetteLoop) {
  serve(Shape{cube(1)},
        {.position = {10, 20, 30}, .rotation = Quat(Eigen::AngleAxisd(0.3, Vec3(1, 2, 3).normalized()))});
  const draw::View view{.from = Vec3(13.1, 14.7, 34.2), .width_px = 400};
  const draw::Drawing hidden = drawing({.view = view});
  EXPECT_EQ(hidden.segments.size(), 12U) << "the diagonals of its sides are no lines";
  EXPECT_EQ(hidden.picture.strokes.size(), 9U);
  const Kinds kinds = kinds_of(draw::feature_lines(shown(), hidden.camera));
  EXPECT_EQ(kinds.of(LineKind::silhouette), 6U);
  EXPECT_EQ(kinds.of(LineKind::crease), 6U);
  const auto ends = silhouette_ends(draw::feature_lines(shown(), hidden.camera));
  EXPECT_EQ(ends.size(), 6U);
  for (const auto& [point, count] : ends) EXPECT_EQ(count, 2);
}

// A62: a sphere of triangles has no crease at 60 degrees. A64: silhouettes are loops on every closed mesh.
TEST_F(DrawingLines, RoundMeshesHaveNoCreasesAndTheirSilhouettesAreLoops) {
  serve({{.name = "ball", .shape = {sphere(1, 24, 48)}},
         {.name = "ring",
          .shape = {torus(2, 0.5, 48, 24)},
          .pose = {.position = {4, 1, 0}, .rotation = Quat(Eigen::AngleAxisd(1, Vec3::UnitX()))}}});
  for (const Vec3& eye : {Vec3(9, -7, 5), Vec3(-3, -8, 1), Vec3(4, 0.1, 20)}) {
    const draw::Camera camera = draw::Camera::fitted({.from = eye, .at = Vec3(2, 0, 0)}, {});
    const auto lines = draw::feature_lines(shown(), camera);
    EXPECT_EQ(kinds_of(lines).of(LineKind::crease), 0U);
    EXPECT_EQ(kinds_of(lines).of(LineKind::boundary), 0U);
    EXPECT_GT(kinds_of(lines).of(LineKind::silhouette), 40U);
    for (const auto& [point, count] : silhouette_ends(lines)) EXPECT_EQ(count % 2, 0) << "from " << eye.transpose();
  }
}

// A61
TEST_F(DrawingLines, AnOpenBoxHasFourBoundaryLines) {
  serve(Shape{open_box(1)});
  const auto lines = draw::feature_lines(shown(), drawing({.view = general_eye(), .style = Style::wireframe}).camera);
  EXPECT_EQ(kinds_of(lines).of(LineKind::boundary), 4U);
  EXPECT_EQ(lines.size(), 12U);
}

// A63: steel from x = 0 on, wood before it, over flat sides: their border is lines by the material alone.
TEST_F(DrawingLines, TheBorderOfTwoMaterialsIsDrawnAndNothingElseOfIt) {
  start({folder_.write(
      "bar.obj",
      "v -1 0 0\nv 0 0 0\nv 1 0 0\nv -1 1 0\nv 0 1 0\nv 1 1 0\nv -1 0 1\nv 0 0 1\nv 1 0 1\nv -1 1 1\nv 0 1 1\nv 1 1 1\n"
      "usemtl wood\nf 1 4 5 2\nf 7 8 11 10\nf 1 2 8 7\nf 5 4 10 11\nf 4 1 7 10\n"
      "usemtl steel\nf 2 5 6 3\nf 8 9 12 11\nf 2 3 9 8\nf 6 5 11 12\nf 3 6 12 9\n")});
  client_.emplace(connect());
  const auto lines =
      draw::feature_lines(shown(), draw::Camera::fitted({.from = Vec3(3, -5, 4), .at = Vec3(0, 0.5, 0.5)}, {}));
  std::size_t material = 0;
  for (const draw::FeatureLine& line : lines) {
    const bool is_border = line.points[0].x() == 0 && line.points[1].x() == 0;
    EXPECT_EQ(line.kind == LineKind::material, is_border);
    material += is_border ? 1 : 0;
  }
  EXPECT_EQ(material, 4U);
  EXPECT_EQ(lines.size(), 4U + 12U + 4U) << "a border, and the long edges in two halves each";
}

// A65: the sign of n . (eye - p), also where double does not know it.
TEST(DrawingFacing, IsTheSignOfTheExactVolume) {
  std::mt19937_64 random = oracle::seeded(65);
  std::uniform_real_distribution<double> coordinate(-1, 1);
  const auto point = [&] { return Vec3(coordinate(random), coordinate(random), coordinate(random)); };
  const auto exact = [](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& eye) {
    Exact m[3][3];
    for (int k = 0; k < 3; ++k) {
      m[0][k] = Exact(b[k]) - Exact(a[k]);
      m[1][k] = Exact(c[k]) - Exact(a[k]);
      m[2][k] = Exact(eye[k]) - Exact(a[k]);
    }
    const Exact volume = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                         m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
    return volume > 0;
  };
  std::size_t facing = 0;
  std::size_t edge_on = 0;
  for (int i = 0; i < 10'000; ++i) {
    // Every second eye is in the triangle's plane, but for rounding; a quarter of them exactly: all on a lattice.
    const auto cut = [&](const Vec3& p) { return i % 4 == 3 ? Vec3((p * 64).array().round() / 64) : p; };
    const Vec3 a = cut(point()), b = cut(point()), c = cut(point());
    const double u = i % 4 == 3 ? 2 : coordinate(random), v = i % 4 == 3 ? -1 : coordinate(random);
    const Vec3 eye = i % 2 == 0 ? Vec3(3 * point()) : Vec3(a + u * (b - a) + v * (c - a));
    ASSERT_EQ(draw::faces_eye(a, b, c, eye), exact(a, b, c, eye)) << i;
    ASSERT_EQ(draw::faces_eye(a, c, b, eye), exact(a, c, b, eye)) << i;
    facing += exact(a, b, c, eye) ? 1 : 0;
    edge_on += !exact(a, b, c, eye) && !exact(a, c, b, eye) ? 1 : 0;
  }
  EXPECT_GT(facing, 3'000U);
  EXPECT_EQ(edge_on, 2'500U);
  std::printf("%zu of 10000 face the eye, %zu are exactly edge-on\n", facing, edge_on);
}

// A73: each crossing of two lines is a gap in the one behind; "trouble when lines are close" is what gaps overlap for.
TEST_F(DrawingLines, HaloedLinesHaveAGapAtEachCrossing) {
  serve({{.name = "box", .shape = {BoxShape{{1, 1, 1}}}}});
  for (const bool is_parallel : {false, true}) {
    const draw::Drawing haloed = drawing({.view = general_eye(is_parallel), .style = Style::haloed, .halo_px = 4});
    EXPECT_EQ(rays_->asked(), 0U);
    ASSERT_EQ(haloed.segments.size(), 12U);
    // All pairs, by the areas of triangles in the picture.
    const auto side = [](const draw::ImagePoint& a, const draw::ImagePoint& b, const draw::ImagePoint& p) {
      return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x) > 0;
    };
    std::size_t crossing_count = 0;
    for (std::size_t i = 0; i < 12; ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const draw::LineSegment& s = haloed.segments[i];
        const draw::LineSegment& t = haloed.segments[j];
        if ((s.a - t.a).norm() < 1e-9 || (s.a - t.b).norm() < 1e-9 || (s.b - t.a).norm() < 1e-9 ||
            (s.b - t.b).norm() < 1e-9)
          continue;
        crossing_count += side(s.image_a, s.image_b, t.image_a) != side(s.image_a, s.image_b, t.image_b) &&
                                  side(t.image_a, t.image_b, s.image_a) != side(t.image_a, t.image_b, s.image_b)
                              ? 1
                              : 0;
      }
    }
    EXPECT_GT(crossing_count, 0U);
    EXPECT_EQ(haloed.crossings.size(), crossing_count);
    EXPECT_EQ(haloed.picture.strokes.size(), 12 + crossing_count);
    for (const draw::LineCrossing& crossing : haloed.crossings) {
      const draw::ImagePoint behind =
          haloed.camera.project(haloed.segments[crossing.farther].at(haloed.camera, crossing.at));
      double before_m = 0;
      double off_px = 1e9;
      for (double t = 0; t <= 1; t += 1e-4) {
        const draw::ImagePoint p = haloed.camera.project(haloed.segments[crossing.nearer].at(haloed.camera, t));
        if (std::hypot(p.x - behind.x, p.y - behind.y) > off_px) continue;
        off_px = std::hypot(p.x - behind.x, p.y - behind.y);
        before_m = p.depth_m;
      }
      EXPECT_LT(off_px, 0.1);
      EXPECT_LT(before_m, behind.depth_m - 0.1) << "the line before is the one without a gap";
      double gap_px = 1e9;
      for (const draw::Piece& piece : haloed.pieces) {
        if (piece.segment != crossing.farther) continue;
        for (const double end : {piece.from, piece.to})
          gap_px = std::min(gap_px, std::abs(end - crossing.at) * haloed.segments[crossing.farther].length_px());
      }
      EXPECT_GE(gap_px, 4 - 1e-6) << "nothing of the line behind is within the halo";
    }
  }
}

TEST_F(DrawingLines, WhatCannotBeDrawnIsSaidAndWhatIsOddIsDrawn) {
  serve({{.name = "far", .shape = {BoxShape{{1e200, 1e200, 1e200}}}}});
  EXPECT_THROW((void)drawing({}), Error);
  servers_.clear();
  serve({{.name = "point", .shape = {SphereShape{0}}},
         {.name = "flat", .shape = {BoxShape{{1, 0, 0}}}},
         {.name = "ground", .shape = {HalfSpaceShape{}}}});
  EXPECT_EQ(drawing({}).segments.size(), 12U) << "edges of a box, however flat";
  // From the middle of it, upward along what is up, and with everything behind the eye.
  EXPECT_GT(drawing({.view = {.from = Vec3(0, 0.1, 0)}}).picture.width_px, 0);
  EXPECT_GT(drawing({.view = {.from = Vec3(0, 0, -3), .at = Vec3(0, 0, 0)}}).segments.size(), 0U);
  EXPECT_EQ(drawing({.view = {.from = Vec3(0, 5, 0), .at = Vec3(0, 9, 0)}}).segments.size(), 0U);
}

TEST_F(DrawingLines, ThePictureHoldsEverythingAndRaysGoWhereItWasDrawn) {
  serve({{.name = "ring", .shape = {torus(2, 0.5, 24, 12)}, .pose = {.position = {4e6, -5e5, 10}}}});
  for (const bool is_parallel : {false, true}) {
    const draw::Drawing d =
        drawing({.view = {.is_orthographic = is_parallel, .width_px = 700}, .style = Style::wireframe});
    double left = 1e9, right = 0;
    for (const draw::Stroke& stroke : d.picture.strokes) {
      for (const draw::Spot& p : stroke.points) {
        left = std::min(left, p[0]);
        right = std::max(right, p[0]);
        EXPECT_TRUE(p[0] >= 0 && p[1] >= 0 && p[0] <= 700 && p[1] <= d.picture.height_px);
      }
    }
    EXPECT_LT(left, 60);
    EXPECT_GT(right, 640);
    for (const draw::LineSegment& s : d.segments) {
      for (const double t : {0.0, 0.3, 1.0}) {
        const draw::ImagePoint p = d.camera.project(s.at(d.camera, t));
        EXPECT_LT(std::hypot(p.x - s.image_a.x - t * (s.image_b.x - s.image_a.x),
                             p.y - s.image_a.y - t * (s.image_b.y - s.image_a.y)),
                  1e-5);
      }
    }
    for (const Vec3& p : {Vec3(4e6 + 2, -5e5, 10), Vec3(4e6, -5e5 + 2.5, 10.25)}) {
      const draw::ImagePoint image = d.camera.project(p);
      const RayQuestion ray = d.camera.through(image.x, image.y);
      const Vec3 displacement = p - ray.origin;
      EXPECT_LT(displacement.cross(ray.direction).norm() / ray.direction.norm(), 1e-8);
    }
  }
}

}  // namespace
}  // namespace collided::drawing_test
