#include <cmath>

#include "tests/drawing/drawing_fixture.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::drawing_test {
namespace {

using draw::Style;
using ExactNumber = boost::multiprecision::cpp_rational;

struct Corners {
  Vec3 a, b, c;
};

template <class N>
struct Vector {
  N x, y, z;
};
template <class N>
Vector<N> exactly(const Vec3& v) {
  return {N(v.x()), N(v.y()), N(v.z())};
}
template <class N>
Vector<N> minus(const Vector<N>& a, const Vector<N>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class N>
Vector<N> cross(const Vector<N>& a, const Vector<N>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class N>
N dot(const Vector<N>& a, const Vector<N>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// The numerators of a ray's meeting with a triangle's plane over one denominator, in any arithmetic.
template <class N>
struct Meeting {
  N denominator, u, v, t;
};
template <class N>
Meeting<N> meeting(const RayQuestion& ray, const Corners& corners) {
  const Vector<N> e1 = minus(exactly<N>(corners.b), exactly<N>(corners.a));
  const Vector<N> e2 = minus(exactly<N>(corners.c), exactly<N>(corners.a));
  const Vector<N> from = minus(exactly<N>(ray.origin), exactly<N>(corners.a));
  const Vector<N> d = exactly<N>(ray.direction);
  const Vector<N> p = cross(d, e2);
  const Vector<N> q = cross(from, e1);
  return {dot(e1, p), dot(from, p), dot(d, q), dot(e2, q)};
}

/// Whether a ray without end meets a triangle, touching included: double where it is far from doubt, else rationals.
/// source  Moeller, Trumbore, "Fast, Minimum Storage Ray-Triangle Intersection", 1997
bool meets(const RayQuestion& ray, const Corners& corners) {
  constexpr double kDoubt = 1e-9;
  const Meeting<double> m = meeting<double>(ray, corners);
  if (std::abs(m.denominator) > kDoubt) {
    const double u = m.u / m.denominator, v = m.v / m.denominator, t = m.t / m.denominator;
    const double least = std::min({u, v, 1 - u - v, t});
    if (std::abs(least) > kDoubt) return least > 0;
  }
  const Meeting<ExactNumber> x = meeting<ExactNumber>(ray, corners);
  if (x.denominator == 0) return false;  // in the plane: general eyes are in none
  const ExactNumber u = x.u / x.denominator, v = x.v / x.denominator;
  return u >= 0 && v >= 0 && u + v <= 1 && x.t / x.denominator >= 0;
}

std::vector<Corners> triangles_of(const ShownObjects& shown) {
  std::vector<Corners> all;
  for (const ShownObject& object : shown.objects) {
    for (const SurfaceRun& run : object.runs) {
      for (const auto& [a, b, c] : run.surface->triangles) {
        const auto& v = run.surface->vertices;
        all.push_back({v[a] + object.pose.position, v[b] + object.pose.position, v[c] + object.pose.position});
      }
    }
  }
  return all;
}

class DrawingSight : public DrawingTest {
 protected:
  /// 10,000 places on the lines, in no order, all asked of the server and worked out here.
  void expect_brute_force(const draw::View& view) {
    const draw::Drawing d = drawing({.view = view, .style = Style::wireframe});
    const std::vector<Corners> triangles = triangles_of(shown());
    std::mt19937_64 random = oracle::seeded(73);
    std::uniform_int_distribution<std::size_t> which(0, d.segments.size() - 1);
    std::uniform_real_distribution<double> where(0.001, 0.999);
    std::vector<RayQuestion> questions;
    for (int i = 0; i < 10'000; ++i)
      questions.push_back(draw::sight_of(d.segments[which(random)].at(d.camera, where(random)), d.camera, 0.01));
    const std::vector<std::uint8_t> seen = rays_->are_free(questions);
    std::size_t equal = 0;
    std::size_t seen_count = 0;
    for (std::size_t i = 0; i < questions.size(); ++i) {
      const bool hidden =
          std::any_of(triangles.begin(), triangles.end(), [&](const Corners& t) { return meets(questions[i], t); });
      equal += hidden == (seen[i] == 0) ? 1 : 0;
      seen_count += hidden ? 0 : 1;
    }
    EXPECT_EQ(equal, 10'000U);
    EXPECT_GT(seen_count, 1'000U);
    EXPECT_LT(seen_count, 9'000U);
    std::printf("%zu triangles, %zu lines: %zu of 10000 samples equal, %zu seen\n", triangles.size(), d.segments.size(),
                equal, seen_count);
  }
};

// A73
TEST_F(DrawingSight, TenThousandSamplesOfARoomEqualBruteForce) {
  std::vector<ObjectOptions> objects{{.name = "room", .shape = {open_box(3)}}};
  for (int i = 0; i < 12; ++i) {
    objects.push_back({.name = "crate_" + std::to_string(i),
                       .shape = {cube(0.3 + 0.03 * i)},
                       .pose = {.position = {-2 + 1.1 * (i % 4), -2 + 1.7 * (i / 4), -2 + 0.31 * i}}});
  }
  serve(objects);
  expect_brute_force({.from = Vec3(7.1, -9.3, 8.2), .at = Vec3(0, 0, 0), .width_px = 800});
}

TEST_F(DrawingSight, TenThousandSamplesOfRoundMeshesEqualBruteForce) {
  serve({{.name = "ring", .shape = {torus(2, 0.5, 40, 20)}},
         {.name = "ball", .shape = {sphere(1, 16, 32)}, .pose = {.position = {0.5, -1.5, 1.5}}},
         {.name = "crate", .shape = {cube(0.7)}, .pose = {.position = {-1, 2, 1}}}});
  expect_brute_force({.from = Vec3(5.1, -9.3, 4.2), .at = Vec3(0, 0, 0), .width_px = 800});
  expect_brute_force({.from = Vec3(5.1, -9.3, 4.2), .at = Vec3(0, 0, 0), .is_orthographic = true, .width_px = 800});
}

// A plate before a bar: the bar's edges change where the plate's edge is in the picture, to a tenth of a pixel. Seen
// level, so that what is upright is upright in the picture.
TEST_F(DrawingSight, ChangesAreWhereTheyAreToATenthOfAPixel) {
  serve({{.name = "bar", .shape = {BoxShape{{3, 0.1, 0.1}}}},
         {.name = "plate", .shape = {BoxShape{{0.5, 0.01, 1}}}, .pose = {.position = {0.3, -2, 0}}}});
  const draw::Drawing d = drawing({.view = {.from = Vec3(0, -8, 0.05), .at = Vec3(0, 0, 0.05), .width_px = 900}});
  const double left = d.camera.project({-0.2, -2.01, 0}).x;
  const double right = d.camera.project({0.8, -2.01, 0}).x;
  std::size_t changes = 0;
  for (std::size_t i = 1; i < d.pieces.size(); ++i) {
    if (d.pieces[i].segment != d.pieces[i - 1].segment) continue;
    const draw::LineSegment& s = d.segments[d.pieces[i].segment];
    const double x = s.image_a.x + d.pieces[i].from * (s.image_b.x - s.image_a.x);
    // The plate's far side is narrower in the picture than its near side, which decides.
    EXPECT_LE(std::min(std::abs(x - left), std::abs(x - right)), 0.1) << x;
    ++changes;
  }
  EXPECT_GE(changes, 4U) << "at least both visible long edges go behind the plate and come out again";
}

// A72: lines over their own surfaces: nothing of them is lost, near or far.
TEST_F(DrawingSight, NoPartOfAVisibleLineIsLostAtThreeZooms) {
  serve(Shape{cube(1)}, {.position = {1e5, 2e5, 3e4}});
  for (const double width : {200.0, 1000.0, 5000.0}) {
    draw::View view{.from = Vec3(1e5 + 3.1, 2e5 - 5.3, 3e4 + 4.2), .width_px = width};
    const draw::Drawing d = drawing({.view = view});
    EXPECT_EQ(lines_with(d, true).size(), 9U) << width;
    EXPECT_EQ(d.pieces.size(), 12U) << "each line is seen or hidden whole";
    EXPECT_GT(d.bias_m, 0);
    std::printf("%5.0f px: bias %.3g m, %llu rays\n", width, d.bias_m, static_cast<unsigned long long>(rays_->asked()));
  }
}

// Curved silhouettes in closed form: half a pixel to the inside the solid is met, half a pixel outside it is missed.
TEST_F(DrawingSight, OutlinesOfCurvedSolidsAreWhereTheirSolidsEnd) {
  const Quat turn(Eigen::AngleAxisd(0.8, Vec3(1, 2, 3).normalized()));
  const std::vector<std::pair<std::string, ShapePart>> solids{
      {"sphere", SphereShape{0.8}},
      {"capsule", CapsuleShape{{-0.5, 0, 0}, {0.6, 0.3, 0}, 0.5}},
      {"cylinder", CylinderShape{{0, 0, -0.7}, {0, 0, 0.7}, 0.6}},
      {"cone", ConeShape{{0, 0, 1}, {0, 0, -0.5}, 0.7}},
      {"ellipsoid", EllipsoidShape{{0.9, 0.5, 0.3}}}};
  std::vector<ObjectOptions> objects;
  for (std::size_t i = 0; i < solids.size(); ++i) {
    objects.push_back(
        {.name = solids[i].first,
         .shape = {solids[i].second},
         .pose = {.position = {2.5 * static_cast<double>(i), 0.4 * static_cast<double>(i), 0}, .rotation = turn}});
  }
  serve(objects);
  const ShownObjects all = shown();
  for (const bool is_parallel : {false, true}) {
    const draw::Camera camera = draw::Camera::fitted(
        {.from = Vec3(3, -11, 6), .is_orthographic = is_parallel, .width_px = 1200}, draw::extreme_points(all));
    const auto lines = draw::feature_lines(all, camera);
    for (std::uint32_t object = 0; object < all.objects.size(); ++object) {
      draw::Rays rays(*client_, AskOptions{.only = all.objects[object].name, .timeout = std::chrono::seconds(30)});
      const draw::ImagePoint middle = camera.project(all.objects[object].pose.position);
      std::vector<RayQuestion> inside, outside;
      for (const draw::FeatureLine& line : lines) {
        if (line.object != object || line.kind != draw::LineKind::silhouette) continue;
        for (std::size_t k = 1; k < line.points.size(); ++k) {
          const draw::ImagePoint a = camera.project(line.points[k - 1]), b = camera.project(line.points[k]);
          const double x = (a.x + b.x) / 2, y = (a.y + b.y) / 2;
          double nx = b.y - a.y, ny = a.x - b.x;
          const double length = std::hypot(nx, ny);
          if (nx * (x - middle.x) + ny * (y - middle.y) < 0) nx = -nx, ny = -ny;
          inside.push_back(camera.through(x - 0.5 * nx / length, y - 0.5 * ny / length));
          outside.push_back(camera.through(x + 0.5 * nx / length, y + 0.5 * ny / length));
        }
      }
      ASSERT_GE(inside.size(), 2U) << all.objects[object].name;
      const auto inside_free = rays.are_free(inside), outside_free = rays.are_free(outside);
      EXPECT_EQ(std::count(inside_free.begin(), inside_free.end(), 1), 0) << all.objects[object].name;
      EXPECT_EQ(std::count(outside_free.begin(), outside_free.end(), 0), 0) << all.objects[object].name;
    }
  }
}

// What is behind a solid is hidden, and the front of its rim is not.
TEST_F(DrawingSight, ACylinderSeenFromAboveShowsOneRimAndHalfOfTheOther) {
  serve(Shape{CylinderShape{{0, 0, -1}, {0, 0, 1}, 1}});
  const draw::Drawing d = drawing({.view = {.from = Vec3(0, -8, 5), .at = Vec3(0, 0, 0), .width_px = 600}});
  double seen_px[2] = {}, whole_px[2] = {};
  for (const draw::Piece& piece : d.pieces) {
    const draw::LineSegment& s = d.segments[piece.segment];
    if (s.kind != draw::LineKind::crease) continue;
    const std::size_t rim = s.a.z() > 0 ? 1 : 0;
    whole_px[rim] += (piece.to - piece.from) * s.length_px();
    seen_px[rim] += piece.is_seen ? (piece.to - piece.from) * s.length_px() : 0;
  }
  EXPECT_NEAR(seen_px[1], whole_px[1], 1e-6);
  EXPECT_GT(seen_px[0], 0.4 * whole_px[0]);
  EXPECT_LT(seen_px[0], 0.6 * whole_px[0]);
}

}  // namespace
}  // namespace collided::drawing_test
