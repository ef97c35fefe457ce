#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "client/draw/drawing/drawing.hpp"
#include "client/draw/drawing/outlines.hpp"
#include "tests/studies/plot/plot.hpp"
#include "client/draw/svg.hpp"
#include "tests/cli/fakes/fake_client.hpp"

namespace collided::draw {
namespace {

// A quarter before an eye that is near to its things is in the picture; a hundredth of their radius before it nothing is.
TEST(DrawnCamera, WhatIsBesideTheEyeIsNotFittedAndWhatIsBeforeItIs) {
  const std::vector<Vec3> things{{0, 2, 1}, {0, 2, -1}, {0.02, 0.045, 0}, {0.02, 0.014, 0}};
  const Camera camera = Camera::fitted({.from = Vec3(0, 0, 0), .at = Vec3(0, 1, 0), .width_px = 400}, things);
  EXPECT_LT(camera.project(things[2]).x, 400);
  EXPECT_GT(camera.project(things[3]).x, 400);
}

// Whichever side it leaves by and whichever end is outside: a clipped line ends at the picture's border.
TEST(DrawnCamera, ALineThatLeavesThePictureEndsAtItsBorder) {
  const Vec3 inside(0.1, 4, 0.2);
  const std::vector<Vec3> corners{{-1, 3, -1}, {1, 5, 1}};
  for (const bool is_orthographic : {false, true}) {
    const Camera camera = Camera::fitted(
        {.from = Vec3(0, 0, 0), .at = Vec3(0, 1, 0), .is_orthographic = is_orthographic, .width_px = 400}, corners);
    for (const Vec3& outside : {Vec3(-40, 7, 0.5), Vec3(40, 7, 0.5), Vec3(0.3, 7, 40), Vec3(0.3, 7, -40)}) {
      for (const bool is_turned : {false, true}) {
        const Vec3 a = is_turned ? outside : inside;
        const Vec3 b = is_turned ? inside : outside;
        const auto shown = camera.clip(a, b);
        ASSERT_TRUE(shown) << outside.transpose();
        EXPECT_EQ(is_turned ? shown->second : shown->first, is_turned ? 1 : 0);
        const ImagePoint end = camera.project(a + (is_turned ? shown->first : shown->second) * (b - a));
        const double border = outside.x() < -1  ? end.x
                              : outside.x() > 1 ? camera.width_px() - end.x
                              : outside.z() > 1 ? end.y
                                                : camera.height_px() - end.y;
        EXPECT_NEAR(border, 0, 1e-9) << outside.transpose();
      }
    }
  }
}

// From its colour of nearness to nearly paper, in equal steps.
TEST(DrawnClearance, BandsGoFromTheAccentToPaper) {
  fake::reset();
  Result<Client> client = Client::connect({});
  ASSERT_TRUE(client);
  ShownObjects shown;
  shown.objects.push_back(
      {.id = 1, .name = "crate", .scene = {}, .pose = {}, .parts = {BoxShape{{1, 1, 1}}}, .runs = {}});
  Rays rays(*client, {.timeout = std::chrono::seconds(30)});
  const auto colors = [&](int bands) {
    return draw(shown, {.view = {.width_px = 40}, .clearance = ClearanceRamp{{1}, "crate", 1, bands}}, rays)
        .picture.pixels.value()
        .colors;
  };
  EXPECT_EQ(colors(3), (std::vector<std::string>{"#fbfaf6", "#c8450c", "#e29b74", "#fbf0dc"}));
  EXPECT_EQ(colors(1), (std::vector<std::string>{"#fbfaf6", "#c8450c"}));
}

// An eye before the cap sees no edge of the wall: the two rims are all the lines there are.
TEST(DrawnOutline, ACylinderSeenOnItsCapHasItsTwoRimsAlone) {
  const CylinderShape cylinder{.a = {0, 2, 0}, .b = {0, 4, 0}, .radius_m = 1};
  const std::vector<Vec3> corners{{-1, 2, -1}, {1, 4, 1}};
  for (const bool is_beside : {false, true}) {
    const View view{.from = is_beside ? Vec3(7, 3, 0) : Vec3(0.25, 0, 0), .at = Vec3(0, 3, 0)};
    std::vector<FeatureLine> lines;
    add_outline(cylinder, {}, Camera::fitted(view, corners), 5, lines);
    const auto silhouettes = std::count_if(lines.begin(), lines.end(),
                                           [](const FeatureLine& line) { return line.kind == LineKind::silhouette; });
    EXPECT_EQ(silhouettes, is_beside ? 2 : 0);
    EXPECT_EQ(lines.size() - static_cast<std::size_t>(silhouettes), 2U);
  }
}

TEST(DrawnPng, AStrokeAtEachBorderIsInThePicture) {
  const std::string empty = as_png({.width_px = 8, .height_px = 8});
  for (const double place : {0.5, 7.5}) {
    for (const Stroke& stroke : {Stroke{{{place, 2}, {place, 6}}, {"crease", "#000000", 1}},
                                 Stroke{{{2, place}, {6, place}}, {"crease", "#000000", 1}}}) {
      EXPECT_NE(as_png({.width_px = 8, .height_px = 8, .strokes = {stroke}}), empty)
          << stroke.points[0][0] << " " << stroke.points[0][1];
    }
  }
}

TEST(DrawnPlot, TicksAreTenToAPowerWhereTheyAreLargeOrSmall) {
  const std::vector<std::pair<double, const char*>> texts{{0, "0"},           {0.25, "0.25"}, {1e-3, "0.001"},
                                                          {9.5e-4, "9.5e-4"}, {1e-6, "1e-6"}, {-2.5e-12, "-2.5e-12"},
                                                          {99'999, "99999"},  {1e5, "1e5"},   {-3e7, "-3e7"}};
  for (const auto& [value, text] : texts) EXPECT_EQ(tick_text(value), text);
}

/// Every `<name ...>` of an SVG.
std::vector<std::string> elements(const std::string& svg, const std::string& name) {
  std::vector<std::string> found;
  for (std::size_t at = svg.find("<" + name + " "); at != std::string::npos; at = svg.find("<" + name + " ", at + 1)) {
    found.push_back(svg.substr(at, svg.find('>', at) + 1 - at));
  }
  return found;
}

double attribute(const std::string& element, const std::string& name) {
  const std::size_t at = element.find(" " + name + "=\"");
  EXPECT_NE(at, std::string::npos) << element << " has no " << name;
  return at == std::string::npos ? NAN : std::stod(element.substr(at + name.size() + 3));
}

// Six pixels from the corner and every nine along the upper and right sides, at 45 degrees from side to side.
TEST(DrawnHeatMap, ACellWithoutDataIsHatchedWithinItsBorders) {
  const HeatMap map{.title = "T",
                    .x_label = "x",
                    .y_label = "y",
                    .columns = {"x"},
                    .rows = {"a", "b"},
                    .cells = {{}, {.value = 1, .text = "one"}},
                    .width = 172};
  const std::string text = svg(map);
  const std::vector<std::string> rectangles = elements(text, "rect");
  const std::vector<std::string> lines = elements(text, "line");
  const auto cell = std::find_if(rectangles.begin(), rectangles.end(),
                                 [](const std::string& r) { return r.find(kFaint) != std::string::npos; });
  ASSERT_NE(cell, rectangles.end());
  const double x = attribute(*cell, "x");
  const double y = attribute(*cell, "y");
  const double width = attribute(*cell, "width");
  const double height = attribute(*cell, "height");
  EXPECT_EQ(height, 25);
  ASSERT_EQ(lines.size(), static_cast<std::size_t>(std::ceil((width + height - 6) / 9)));
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const double along = 6 + 9 * static_cast<double>(i);
    EXPECT_NEAR(attribute(lines[i], "x1"), x + std::min(along, width), 0.011);
    EXPECT_NEAR(attribute(lines[i], "y1"), y + (along < width ? 0 : along - width), 0.011);
    EXPECT_NEAR(attribute(lines[i], "x2"), x + (along < height ? 0 : along - height), 0.011);
    EXPECT_NEAR(attribute(lines[i], "y2"), y + std::min(along, height), 0.011);
  }
  EXPECT_NE(text.find(">one</text>"), std::string::npos);
}

/// The box of a text that stands in an SVG once.
Rectangle box_of(const std::string& svg, const std::string& words) {
  const std::size_t end = svg.find(">" + words + "</text>");
  EXPECT_NE(end, std::string::npos) << words;
  const std::size_t begin = svg.rfind("<text ", end);
  const std::string element = svg.substr(begin, end - begin);
  const Anchor anchor = element.find("\"start\"") != std::string::npos ? Anchor::start
                        : element.find("\"end\"") != std::string::npos ? Anchor::end
                                                                       : Anchor::middle;
  return text_box(attribute(element, "x"), attribute(element, "y"), words, attribute(element, "font-size"), anchor);
}

// Three pixels beside an upright line and two and a half above or below a level one, wherever the labelled point is.
TEST(DrawnPlot, ALabelKeepsClearOfTheLines) {
  for (const bool is_upright : {true, false}) {
    for (double place = 0.44; place < 0.56; place += 0.0005) {
      const Axis axis{.label = "m", .low = 0, .high = 1};
      Series line{.name = "line", .points = {{0, 0.5}, {1, 0.5}}, .marked = false};
      Point point{.x = 0.5, .y = place, .label = "label"};
      if (is_upright) {
        line.points = {{0.5, 0}, {0.5, 1}};
        std::swap(point.x, point.y);
      }
      const std::string text =
          svg(Plot{.title = "T",
                   .x = axis,
                   .y = axis,
                   .series = {line, {.name = "point", .points = {point}, .joined = false, .marked = false}}});
      const std::string path = elements(text, "polyline").at(0);
      double x = 0;
      double y = 0;
      ASSERT_EQ(std::sscanf(path.c_str() + path.find(" points=") + 9, "%lf%*[ ,]%lf", &x, &y), 2) << path;
      const Rectangle label = box_of(text, "label");
      const double clear = is_upright ? std::max(label.x - x, x - label.x - label.width)
                                      : std::max(label.y - y, y - label.y - label.height);
      EXPECT_GE(clear, is_upright ? 2.98 : 2.48) << place;
    }
  }
}

TEST(DrawnPlot, OursIsWrittenInOursColourAndTheOthersInInk) {
  const Plot plot{.title = "T",
                  .x = {.label = "x"},
                  .y = {.label = "y"},
                  .series = {{.name = "ours", .points = {{1, 1}, {2, 2}}, .paint = Paint::accent},
                             {.name = "theirs", .points = {{1, 2}, {2, 1}}},
                             {.name = "none"}}};
  const std::string text = svg(plot);
  const auto color_of = [&](const std::string& words) {
    const std::size_t end = text.find(">" + words + "</text>");
    EXPECT_NE(end, std::string::npos) << words;
    const std::string element = text.substr(text.rfind("<text ", end), end - text.rfind("<text ", end));
    const std::size_t at = element.find("fill=\"");
    return at == std::string::npos ? std::string() : element.substr(at + 6, 7);
  };
  EXPECT_EQ(color_of("ours"), kAccent);
  EXPECT_EQ(color_of("theirs"), kInk);
  EXPECT_EQ(color_of("none (no data)"), kInk);
}

// A quarter and three quarters of the 253 pixels between the names and the wholes; the legend in one line above.
TEST(DrawnStrips, EachPartIsAsLongAsItsShareAndNamedInTheLegend) {
  const Strips strips{.title = "Step",
                      .parts = {"take", "test"},
                      .rows = {{.name = "hall", .values = {1, 3}, .whole = "4 us"}},
                      .width = 400};
  EXPECT_EQ(
      svg(strips),
      R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 400.00 108.00" width="400.00" height="108.00" role="img" font-family="Helvetica, Arial, 'DejaVu Sans', sans-serif">
<title>Step</title>
<rect x="0.00" y="0.00" width="400.00" height="108.00" fill="#fbfaf6"/>
<text x="20.00" y="22.00" font-size="15.00" text-anchor="start" fill="#1d1d1b" font-weight="bold">Step</text>
<rect x="20.00" y="44.00" width="12.00" height="10.00" fill="#c8450c"/>
<text x="37.00" y="53.00" font-size="11.00" text-anchor="start" fill="#1d1d1b">take</text>
<rect x="81.52" y="44.00" width="12.00" height="10.00" fill="#0072b2"/>
<text x="98.52" y="53.00" font-size="11.00" text-anchor="start" fill="#1d1d1b">test</text>
<text x="80.00" y="82.00" font-size="12.00" text-anchor="end" fill="#1d1d1b">hall</text>
<rect x="90.00" y="68.00" width="63.25" height="20.00" fill="#c8450c"/>
<text x="121.63" y="82.00" font-size="10.50" text-anchor="middle" fill="#fbfaf6">25 %</text>
<rect x="153.25" y="68.00" width="189.75" height="20.00" fill="#0072b2"/>
<text x="248.13" y="82.00" font-size="10.50" text-anchor="middle" fill="#fbfaf6">75 %</text>
<text x="353.00" y="82.00" font-size="12.00" text-anchor="start" fill="#1d1d1b">4 us</text>
</svg>
)");
}

}  // namespace
}  // namespace collided::draw
