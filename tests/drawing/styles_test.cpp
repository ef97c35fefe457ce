#include <png.h>

#include <cmath>
#include <numbers>

#include "client/draw/svg.hpp"
#include "tests/drawing/drawing_fixture.hpp"

namespace collided::drawing_test {
namespace {

using draw::Pixels;
using draw::Style;

std::size_t count_of(const std::string& text, const std::string& word) {
  std::size_t count = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
  return count;
}

class DrawingStyles : public DrawingTest {};

// A58, A59: a lit sphere has as many tones as asked for, and each ends where n . l says, to the pixel.
TEST_F(DrawingStyles, ToonTonesAreAsManyAsAskedForAndEndAtTheAnalyticCircles) {
  serve(Shape{SphereShape{1}});
  const Vec3 light = Vec3(0.6, -0.5, 0.7).normalized();
  for (const int tones : {2, 3, 5}) {
    const draw::Drawing d =
        drawing({.view = {.from = Vec3(0, -20, 0), .at = Vec3(0, 0, 0), .is_orthographic = true, .width_px = 500},
                 .style = Style::toon,
                 .tones = tones,
                 .toward_light = light});
    const Pixels& pixels = *d.picture.pixels;
    std::set<std::uint8_t> found(pixels.numbers.begin(), pixels.numbers.end());
    EXPECT_TRUE(found.contains(Pixels::kPaperPixel));
    EXPECT_EQ(found.size(), static_cast<std::size_t>(tones) + 1);
    EXPECT_EQ(pixels.colors.size(), static_cast<std::size_t>(tones));
    std::size_t looked_at = 0;
    const double pixel_m = d.camera.pixel_m(Vec3::Zero());
    const draw::ImagePoint middle = d.camera.project(Vec3::Zero());
    const auto tone_at = [&](double px, double py) {
      const double x = (px - middle.x) * pixel_m, z = (middle.y - py) * pixel_m;
      const double squared = x * x + z * z;
      return squared < 1 ? draw::tone_of(std::max(0.0, light.dot(Vec3(x, -std::sqrt(1 - squared), z))), tones) : -1;
    };
    for (int y = 0; y < pixels.height; ++y) {
      for (int x = 0; x < pixels.width; ++x) {
        // Somewhere within a pixel's distance the sphere has the tone that is drawn.
        const std::uint8_t number = pixels.numbers[static_cast<std::size_t>(y) * pixels.width + x];
        const int drawn = number == Pixels::kPaperPixel ? -1 : number;
        bool near = false;
        for (const auto& [dx, dy] :
             {std::pair(0, 0), std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1)}) {
          near = near || tone_at(x + 0.5 + dx, y + 0.5 + dy) == drawn;
        }
        EXPECT_TRUE(near) << x << ' ' << y;
        looked_at += drawn >= 0 ? 1 : 0;
      }
    }
    EXPECT_GT(looked_at, 100'000U);
    EXPECT_LT(rays_->asked(), looked_at / 2) << "flat tone is not cast pixel by pixel";
  }
}

// A line that runs out of the picture has no pixels there, neither on the other side nor on the next row.
TEST_F(DrawingStyles, LinesBesideThePictureAskForNoRays) {
  serve(Shape{SphereShape{1}});
  const draw::Drawing d =
      drawing({.view = {.from = Vec3(0, -20, 0), .at = Vec3(0, 0, 0), .is_orthographic = true, .width_px = 200}});
  const double width = d.camera.width_px(), height = d.camera.height_px();
  const auto rays_for = [&](const std::vector<draw::LineSegment>& lines, draw::ToneMap& map) {
    draw::Rays rays(*client_, AskOptions{.timeout = std::chrono::seconds(30)});
    map = draw::cast_tones(shown(), d.camera, lines, {}, rays);
    return rays.asked();
  };
  const auto line = [](double ax, double ay, double bx, double by) {
    draw::LineSegment segment;
    segment.image_a = {ax, ay};
    segment.image_b = {bx, by};
    return segment;
  };
  draw::ToneMap plain, summand, across;
  const std::uint64_t none = rays_for({}, plain);
  EXPECT_EQ(
      rays_for({line(width, 5, width + 60, 5), line(width + 3, 9, width + 3, height - 1), line(-9, 5, -2, height - 1),
                line(5, -30, width - 5, -2), line(5, height, width - 5, height), line(5, height + 3, 40, height + 60)},
               summand),
      none);
  EXPECT_EQ(summand.numbers, plain.numbers);
  EXPECT_EQ(summand.light, plain.light);
  EXPECT_GT(rays_for({line(0, 5.5, width - 1, 5.5)}, across), none) << "a line in the picture is looked through";
}

// Coarse rays pass beside a rod of two pixels; its lines have every pixel of it looked through.
TEST_F(DrawingStyles, WhatIsThinnerThanTheCoarseRaysIsNotLost) {
  serve({{.name = "rod", .shape = {BoxShape{{0.01, 0.01, 1}}}},
         {.name = "foot", .shape = {BoxShape{{1, 0.1, 0.1}}}, .pose = {.position = {0, 0, -1.1}}}});
  const draw::Drawing d =
      drawing({.view = {.from = Vec3(0.003, -20, 0), .at = Vec3(0.003, 0, 0), .is_orthographic = true, .width_px = 220},
               .style = Style::toon});
  const Pixels& pixels = *d.picture.pixels;
  const int column = static_cast<int>(d.camera.project(Vec3::Zero()).x);
  for (int y = static_cast<int>(d.camera.project({0, 0, 0.98}).y);
       y < static_cast<int>(d.camera.project({0, 0, -0.98}).y); ++y) {
    EXPECT_NE(pixels.numbers[static_cast<std::size_t>(y) * pixels.width + column], Pixels::kPaperPixel) << y;
  }
}

// A58: what is drawn is those tones, paper and ink, to the last byte of the SVG.
TEST_F(DrawingStyles, AToonPictureHasItsTonesPaperAndInkAlone) {
  serve(Shape{torus(2, 0.6, 48, 24)});
  const draw::Drawing d = drawing({.view = {.width_px = 400}, .style = Style::toon, .tones = 4});
  const std::string svg = draw::as_svg(d.picture);
  std::set<std::string> colors;
  for (std::size_t at = svg.find('#'); at != std::string::npos; at = svg.find('#', at + 1))
    colors.insert(svg.substr(at, 7));
  EXPECT_EQ(colors.size(), 4U + 2U);
  EXPECT_TRUE(colors.contains(draw::kPaper));
  EXPECT_TRUE(colors.contains(draw::kInk));
}

// A60: a ball over a plate, coloured by its distance from it: bands as wide as the ramp says.
TEST_F(DrawingStyles, ClearanceBandsAreAsWideAsTheRampSays) {
  serve({{.name = "ball", .shape = {SphereShape{0.5}}, .pose = {.position = {0, 0, 0.6}}},
         {.name = "plate", .shape = {BoxShape{{5, 5, 0.5}}}, .pose = {.position = {0, 0, -0.5}}}});
  constexpr int kBands = 5;
  draw::ClearanceRamp ramp{.is_measured = {}, .name_glob = "ball", .reach_m = 1.25, .bands = kBands};
  for (const ShownObject& object : shown().objects) ramp.is_measured.push_back(object.name == "ball" ? 1 : 0);
  const draw::Drawing d =
      drawing({.view = {.from = Vec3(0, -20, 0.6), .at = Vec3(0, 0, 0.6), .is_orthographic = true, .width_px = 2000},
               .clearance = ramp});
  const Pixels& pixels = *d.picture.pixels;
  const int column = static_cast<int>(d.camera.project({0, 0, 0.6}).x);
  int looked_at = 0;
  for (int y = 0; y < pixels.height; ++y) {
    const double z = 0.6 + (d.camera.project({0, 0, 0.6}).y - (y + 0.5)) * d.camera.pixel_m({0, 0, 0});
    if (std::abs(z - 0.6) > 0.49) continue;
    const int expected = static_cast<int>(z / ramp.reach_m * kBands);
    const double off_m = std::abs(z - std::round(z / (ramp.reach_m / kBands)) * ramp.reach_m / kBands);
    if (off_m < 1.5 * d.camera.pixel_m({0, 0, 0})) continue;
    EXPECT_EQ(pixels.numbers[static_cast<std::size_t>(y) * pixels.width + column], 1 + expected) << z;
    ++looked_at;
  }
  EXPECT_GT(looked_at, 100);
}

// A71: the darker, the more ink; black and white alone.
TEST(DrawingHatching, DensityGrowsWithDarknessAndLighterLinesStay) {
  constexpr int kSide = 240;
  double before = -1;
  std::set<std::array<double, 2>> begun_before;
  std::set<long> densities;
  for (double light = 1; light >= 0; light -= 0.0625) {
    draw::ToneMap map{kSide, kSide, std::vector<float>(kSide * kSide, static_cast<float>(light)),
                      std::vector<std::uint8_t>(kSide * kSide, 0)};
    double length_px = 0;
    std::set<std::array<double, 2>> begun;
    for (const auto& stroke : draw::hatching(map, 3)) {
      length_px += std::hypot(stroke[1][0] - stroke[0][0], stroke[1][1] - stroke[0][1]);
      begun.insert(stroke[0]);
    }
    EXPECT_GE(length_px, before) << "at " << light;
    densities.insert(std::lround(length_px));
    EXPECT_TRUE(std::includes(begun.begin(), begun.end(), begun_before.begin(), begun_before.end()))
        << "a line of a lighter tone went";
    before = length_px;
    begun_before = begun;
  }
  EXPECT_GE(densities.size(), 12U) << "tones that can be told apart";
  EXPECT_GT(before, 1.8 * kSide * kSide / 3) << "both families at black";
  draw::ToneMap lit{kSide, kSide, std::vector<float>(kSide * kSide, 1), {}};
  EXPECT_TRUE(draw::hatching(lit, 3).empty());
}

TEST_F(DrawingStyles, AHatchedPictureIsBlackAndWhite) {
  serve(Shape{sphere(1, 16, 32)});
  const draw::Drawing d =
      drawing({.view = {.width_px = 300}, .style = Style::hatched, .contacts = {{{0, 0, 1}, {0, 0, 1}, 0.1}}});
  const std::string png = draw::as_png(d.picture);
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  ASSERT_NE(png_image_begin_read_from_memory(&image, png.data(), png.size()), 0);
  image.format = PNG_FORMAT_RGB;
  std::vector<png_byte> bytes(PNG_IMAGE_SIZE(image));
  ASSERT_NE(png_image_finish_read(&image, nullptr, bytes.data(), 0, nullptr), 0);
  EXPECT_EQ(image.width, 300U);
  std::size_t black = 0;
  for (const png_byte byte : bytes) {
    ASSERT_TRUE(byte == 0 || byte == 255);
    black += byte == 0 ? 1 : 0;
  }
  EXPECT_GT(black, bytes.size() / 50);
}

// A70: a contact's ring is the wider the deeper the contact.
TEST(DrawingContacts, StrokeWidthGrowsWithDepth) {
  double before = 0;
  for (double depth = 0; depth < 20; depth = depth * 1.05 + 1e-4) {
    const double width = draw::contact_width_px(depth, 10);
    EXPECT_GT(width, before) << depth;
    before = width;
  }
  EXPECT_LT(before, 6);
  EXPECT_EQ(draw::contact_width_px(0, 10), 1);
}

// A57: contacts are rings in red with their normals, rays end where they meet something.
TEST_F(DrawingStyles, ContactsAndRaysAreMarked) {
  serve(Shape{cube(1)});
  const draw::Drawing d = drawing({.view = general_eye(),
                                   .contacts = {{{1, 0, 0}, {1, 0, 0}, 0.01}, {{0, 0, 1}, {0, 0, 1}, 0.2}},
                                   .ray_marks = {{{0, 0, 4}, {0, 0, 1}, true}, {{4, 0, 2}, {4, 9, 2}, false}}});
  const std::string svg = draw::as_svg(d.picture);
  EXPECT_EQ(count_of(svg, "class=\"contact\""), 2U);
  EXPECT_EQ(count_of(svg, "class=\"ray-hit\""), 1U);
  EXPECT_EQ(count_of(svg, "class=\"normal\""), 1U) << "one path";
  EXPECT_EQ(count_of(svg.substr(svg.find("class=\"normal\""),
                                svg.find('>', svg.find("class=\"normal\"")) - svg.find("class=\"normal\"")),
                     "M"),
            2U);
  EXPECT_LT(d.picture.rings[1].ink.width_px, d.picture.rings[2].ink.width_px);
}

TEST(DrawingPicture, BrailleDotsAreWhereTheStrokesAre) {
  draw::Picture picture{.width_px = 4,
                        .height_px = 8,
                        .strokes = {{{{0.5, 0.5}, {0.5, 7.5}}, {"crease", "#000000", 1}},
                                    {{{3.5, 4.5}, {3.5, 4.5}}, {"crease", "#000000", 1}}}};
  EXPECT_EQ(draw::as_braille(picture), "⡇\n⡇⠈\n");
}

TEST(DrawingPicture, PixelsBecomeRectanglesThatCoverThemOnce) {
  Pixels pixels{5,
                4,
                {0, 0, 1, 1,   255,  //
                 0, 0, 1, 255, 255, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1},
                {"#111111", "#222222"}};
  const std::string svg = draw::as_svg({.width_px = 5, .height_px = 4, .pixels = pixels});
  // Width times height of all "MX YhWvHh-Wz".
  double covered = 0;
  for (std::size_t at = svg.find("h"); at != std::string::npos; at = svg.find("h", at + 1)) {
    int width = 0, height = 0;
    if (std::sscanf(svg.c_str() + at, "h%dv%dh", &width, &height) == 2 && width > 0) covered += width * height;
  }
  EXPECT_EQ(covered, 17);
}

}  // namespace
}  // namespace collided::drawing_test
