#include "tests/drawing/methods/back_faces.hpp"
#include "tests/drawing/methods/edge_image.hpp"

#include <cmath>

#include "tests/drawing/drawing_fixture.hpp"

// The lecture's ways to draw silhouettes: each works where it is said to, and fails where it is said to.
namespace collided::drawing_test {
namespace {

class DrawingMethods : public DrawingTest {
 protected:
  struct Scene {
    draw::Drawing drawing;
    Polygons polygons;
    Buffers buffers;
  };
  /// 400 pixels wide, seen from a general eye.
  Scene scene(const MeshShape& mesh) {
    serve(Shape{mesh});
    draw::View view = general_eye();
    view.field_of_view_rad = 0.6;
    draw::Drawing d = drawing({.view = view});
    return {d, polygons_of(shown()), cast_buffers(d.camera, *rays_)};
  }
};

// A69: depth and normals cast by the service's rays show the edges, those of the cube's corners too.
TEST_F(DrawingMethods, EdgesOfBuffersAreTheEdges) {
  for (const MeshShape& mesh : {cube(1), torus(1, 0.4, 64, 32)}) {
    const Scene s = scene(mesh);
    const Agreement found = agreement(edge_image(s.buffers, s.drawing.camera, std::cos(0.6), 2), s.drawing);
    EXPECT_GE(found.recall(), 0.99);
    EXPECT_GE(found.precision(), 0.9);
    EXPECT_GT(found.line_pixels, 300U);
    std::printf("recall %.4f of %zu line pixels, precision %.3f of %zu\n", found.recall(), found.line_pixels,
                found.precision(), found.black_pixels);
    servers_.clear();
  }
}

// A66: lines of back faces are not of one width, whichever way they are pulled.
TEST_F(DrawingMethods, BiasedBackFacesHaveLinesOfAllWidths) {
  const Scene s = scene(torus(1, 0.4, 64, 32));
  const double depth_m = s.drawing.camera.project(Vec3::Zero()).depth_m;
  for (const auto& [bias, amount] :
       {std::pair(Bias::fixed, 0.35), std::pair(Bias::non_linear, 0.35 / (depth_m * depth_m)),
        std::pair(Bias::by_angle, 6.0)}) {
    const Mask mask = biased_back_faces(s.polygons, s.drawing.camera, s.buffers, bias, amount);
    const Widths widths = widths_across_silhouette(mask, s.drawing, 0, 15);
    ASSERT_GT(widths.px.size(), 300U);
    EXPECT_GT(widths.mean_px(), 0.5);
    EXPECT_GT(widths.spread(), 0.2);
    std::printf("bias %d: %.1f px wide, from %.1f to %.1f, spread %.0f %%\n", static_cast<int>(bias), widths.mean_px(),
                widths.least_px(), widths.most_px(), 100 * widths.spread());
  }
}

// A67: fat triangles give lines of the asked width, a needle's tip goes through the picture.
TEST_F(DrawingMethods, FattenedTrianglesAreRightWhereTheyAreFat) {
  constexpr double kWidth_px = 4;
  const Scene fat = scene(cube(1));
  const Mask mask = fattened_back_faces(fat.polygons, fat.drawing.camera, fat.buffers, kWidth_px);
  const Widths widths = widths_across_silhouette(mask, fat.drawing, 4 * kWidth_px, 3 * kWidth_px);
  ASSERT_GT(widths.px.size(), 300U);
  ASSERT_EQ(widths.line_means_px.size(), 6U);
  for (const double mean : widths.line_means_px) EXPECT_NEAR(mean, kWidth_px, 1);
  // Alone and turned away: how far black reaches beyond its tip.
  const draw::Camera camera = fat.drawing.camera;
  Buffers empty = fat.buffers;
  empty.depth_m.assign(empty.depth_m.size(), INFINITY);
  const auto growth_px = [&](const Vec3& tip, const Vec3& b, const Vec3& c) {
    Polygons one{{tip, b, c}, {{0, 1, 2}}};
    if (draw::faces_eye(tip, b, c, camera.eye())) std::swap(one.vertices[1], one.vertices[2]);
    const Mask grown = fattened_back_faces(one, camera, empty, kWidth_px);
    // The tip points to the right.
    double farthest = 0;
    for (int y = 0; y < grown.height; ++y) {
      for (int x = 0; x < grown.width; ++x)
        farthest = std::max(farthest, grown.at(x, y) ? x + 0.5 - camera.project(tip).x : 0);
    }
    return farthest;
  };
  const Vec3 tip = 0.3 * camera.right(), foot = -0.5 * camera.right();
  EXPECT_LT(growth_px(tip, foot + 0.4 * camera.above(), foot - 0.4 * camera.above()), 3 * kWidth_px);
  EXPECT_GT(growth_px(tip, foot + 0.02 * camera.above(), foot - 0.02 * camera.above()), 8 * kWidth_px)
      << "the failure on thin triangles";
}

// A68: a shell about a sphere is its outline; that of a cube with hard edges comes apart at its corners.
TEST_F(DrawingMethods, AnExpandedShellWorksOnASphereAndComesApartOnACube) {
  constexpr double kWidth_px = 5;
  const Scene ball = scene(sphere(1, 48, 96));
  const double distance_m = kWidth_px * ball.drawing.camera.pixel_m(Vec3::Zero());
  const Mask around =
      expanded_shell(ball.polygons, smooth_normals(ball.polygons), distance_m, ball.drawing.camera, ball.buffers);
  const Widths widths = widths_across_silhouette(around, ball.drawing, 0, 3 * kWidth_px);
  ASSERT_GT(widths.px.size(), 200U);
  EXPECT_NEAR(widths.mean_px(), kWidth_px, 1);
  EXPECT_LT(widest_gap_px(around, ball.buffers, ball.drawing, kWidth_px / 2), 2);
  servers_.clear();
  const Scene box = scene(cube(1));
  const Mask apart =
      expanded_shell(box.polygons, flat_normals(box.polygons), distance_m, box.drawing.camera, box.buffers);
  const double gap_px = widest_gap_px(apart, box.buffers, box.drawing, kWidth_px / 2);
  EXPECT_GT(gap_px, kWidth_px / 2);
  // Where the shell fails, the edges of the buffers do not: A69.
  EXPECT_GE(agreement(edge_image(box.buffers, box.drawing.camera, std::cos(0.6), 2), box.drawing).recall(), 0.99);
  std::printf("sphere %.1f px wide, cube's gap %.1f px\n", widths.mean_px(), gap_px);
}

// A72: with its bias no line pixel is lost at three zooms; without one many are, and the bias lets hidden ones through.
TEST_F(DrawingMethods, LinesOverPolygonsNeedABiasAndThenLoseNothing) {
  serve({{.name = "box", .shape = {cube(1)}}});
  for (const double width : {150.0, 400.0, 1000.0}) {
    draw::View view = general_eye();
    view.width_px = width;
    const draw::Drawing d = drawing({.view = view});
    const Buffers buffers = cast_buffers(d.camera, *rays_);
    const LinePixels without = biased_lines(buffers, d.camera, d, 0);
    EXPECT_GT(without.lost, 50U);
    const LinePixels with = biased_lines(buffers, d.camera, d, without.needed_m);
    EXPECT_EQ(with.lost, 0U);
    EXPECT_GT(with.drawn, without.drawn);
    EXPECT_LT(without.needed_m, 8 * d.camera.pixel_m(Vec3::Zero())) << "a few pixels' worth";
    std::printf("%4.0f px: bias %.3g m (%.2f pixels), without it %zu line pixels lost, with it 0 lost and %zu leaked\n",
                width, without.needed_m, without.needed_m / d.camera.pixel_m(Vec3::Zero()), without.lost, with.leaked);
  }
}

}  // namespace
}  // namespace collided::drawing_test
