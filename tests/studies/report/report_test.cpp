#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <regex>
#include <unistd.h>

#include "tests/studies/plot/plot.hpp"
#include "client/draw/svg.hpp"
#include "tests/oracle/random_shapes.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/studies/report/measured/pairs.hpp"
#include "tests/studies/report/measured/time_truth.hpp"
#include "tests/studies/report/methods/plain.hpp"
#include "tests/studies/report/page/page_check.hpp"
#include "tests/studies/report/page/rows.hpp"

namespace collided::report {
using namespace engine;
namespace {

draw::Plot crowded(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> part(0, 1);
  draw::Plot plot{.title = "Crowded & <quoted>",
                  .x = {.label = "x", .scale = draw::Scale::logarithmic},
                  .y = {.label = "y", .scale = draw::Scale::logarithmic}};
  for (int s = 0; s < 9; ++s) {
    draw::Series series{.name = "series number " + std::to_string(s)};
    for (int i = 0; i < 12; ++i) {
      series.points.push_back({std::pow(10, 3 * part(random)), i == 0 ? 0 : std::pow(10, -15 * part(random)),
                               "a label " + std::to_string(i)});
    }
    plot.series.push_back(series);
  }
  return plot;
}

std::vector<draw::Rectangle> text_boxes(const std::string& svg) {
  static const std::regex kText(
      R"re(<text x="([-0-9.]+)" y="([-0-9.]+)" font-size="([0-9.]+)" text-anchor="(\w+)"[^>]*>([^<]*)</text>)re");
  std::vector<draw::Rectangle> boxes;
  for (std::sregex_iterator match(svg.begin(), svg.end(), kText), end; match != end; ++match) {
    const std::string anchor = (*match)[4];
    boxes.push_back(draw::text_box(std::stod((*match)[1]), std::stod((*match)[2]), (*match)[5].str(),
                                   std::stod((*match)[3]),
                                   anchor == "start"    ? draw::Anchor::start
                                   : anchor == "middle" ? draw::Anchor::middle
                                                        : draw::Anchor::end));
  }
  return boxes;
}

TEST(DrawPlot, NoTwoTextsOverlapInACrowd) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const std::vector<draw::Rectangle> boxes = text_boxes(draw::svg(crowded(seed)));
    ASSERT_GT(boxes.size(), 40u);
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j)
        ASSERT_FALSE(boxes[i].overlaps(boxes[j])) << "seed " << seed << " " << i << " " << j;
    }
  }
}

TEST(DrawPlot, TheSameDataGiveTheSameBytes) { EXPECT_EQ(draw::svg(crowded(1)), draw::svg(crowded(1))); }

TEST(DrawPlot, IsWellFormedWithNoDataOneDatumAndZeros) {
  draw::Plot plot{.title = "t", .x = {.label = "x"}, .y = {.label = "y", .scale = draw::Scale::logarithmic}};
  EXPECT_EQ(xml_fault(draw::svg(plot)), "");
  plot.series.push_back({.name = "one", .points = {{1, 0, "zero"}}});
  const std::string svg = draw::svg(plot);
  EXPECT_EQ(xml_fault(svg), "");
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(xml_fault(draw::svg(crowded(2))), "");
}

TEST(DrawBars, AMissingValueSaysNoData) {
  const draw::Bars bars{
      .title = "b", .value = {.label = "v"}, .series = {"ours", "peer"}, .groups = {{"g", {3.0, std::nullopt}}}};
  const std::string svg = draw::svg(bars);
  EXPECT_EQ(xml_fault(svg), "");
  EXPECT_NE(svg.find("no data"), std::string::npos);
}

TEST(ReportPage, FaultsOfXmlAreFound) {
  EXPECT_EQ(xml_fault("<a b=\"1\"><c/>&lt;</a>"), "");
  for (const char* broken :
       {"<a><b></a></b>", "<a>", "</a>", "<a b=1/>", "<a b=\"1\" b=\"2\"/>", "<a>&</a>", "<a b=\"<\"/>"}) {
    EXPECT_NE(xml_fault(broken), "") << broken;
  }
}

TEST(ReportPairs, ComplaintsComeForWrongHighLooseAndMissingCells) {
  const PairCell good{.query = "q", .pair = "p", .n = 5, .worst_error = 2e-16, .worst_ratio = 0.5};
  const std::vector<PinnedCell> pins = pinned({good});
  EXPECT_EQ(pins[0].ceiling, 2e-16);
  EXPECT_TRUE(complaints({good}, pins).empty());
  PairCell cell = good;
  cell.worst_error = 2.1e-16;
  EXPECT_EQ(complaints({cell}, pins).size(), 1u);
  cell = good;
  cell.worst_error = 1e-17;
  EXPECT_EQ(complaints({cell}, pins).size(), 1u);
  cell = good;
  cell.worst_ratio = 1.001;
  EXPECT_EQ(complaints({cell}, pins).size(), 1u);
  cell = good;
  cell.wrong = 1;
  EXPECT_EQ(complaints({cell}, pins).size(), 1u);
  EXPECT_EQ(complaints({good}, {}).size(), 2u);
}

// The truth of the box tables against another formulation: the planes of the Minkowski difference, all of them.
TEST(ReportTruth, DepthAgreesWithTheHullOfTheMinkowskiDifference) {
  std::mt19937_64 random = oracle::seeded(71);
  oracle::RandomShapes shapes(random, oracle::Family::random);
  for (int i = 0, met = 0; i < 100 && met < 4; ++i) {
    const Box box = shapes.box();
    const Triangle triangle = shapes.triangle();
    const double depth = static_cast<double>(plain_depth(Body<oracle::Wide>(box), Body<oracle::Wide>(triangle)));
    if (depth <= 0) continue;
    ++met;
    EXPECT_NEAR(depth, oracle::part_length(oracle::figure(box), oracle::figure(triangle)), 1e-8);
  }
}

TEST(ReportTruth, TimeOfAHeadOnContactIsKnownByHand) {
  const Triangle floor{{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}};
  const Truth truth = time_truth({{0, 0, 3}, {0, 0, -1}, 1}, floor);
  ASSERT_TRUE(truth.yes);
  EXPECT_NEAR(static_cast<double>(truth.value), 0.5, 1e-17);
  EXPECT_TRUE(time_truth({{0, 0, 3}, {1, 0, 3}, 3}, floor).yes) << "it touches at the start";
  EXPECT_FALSE(time_truth({{0, 0, 3}, {1, 0, 3}, 2.999}, floor).yes);
}

TEST(ReportRows, NumbersAreShortAndAlwaysWritten) {
  EXPECT_EQ(short_number(1.23e-7), "1.2e-7");
  EXPECT_EQ(short_number(1e-7), "1e-7");
  EXPECT_EQ(short_number(123456), "1.2e5");
  EXPECT_EQ(short_number(1234), "1234");
  EXPECT_EQ(short_number(INFINITY), "infinite");
  EXPECT_EQ(short_number(kUnknown), "-");
}

TEST(ReportRows, ACsvFieldKeepsCommasAndQuotes) {
  const auto file =
      std::filesystem::temp_directory_path() / ("collided_report_rows_" + std::to_string(::getpid()) + ".csv");
  write_rows(file, {Row{.study = "s", .scene = "a, \"b\"", .n = 7}},
             {.machine = "m, n", .commit = "c", .command = "x", .seed = 3});
  const Csv csv = read_csv(file);
  std::filesystem::remove(file);
  ASSERT_EQ(csv.rows.size(), 1u);
  EXPECT_EQ(csv.text(0, "scene"), "a, \"b\"");
  EXPECT_EQ(csv.text(0, "machine"), "m, n");
  EXPECT_EQ(csv.number(0, "n"), 7);
  EXPECT_TRUE(std::isnan(csv.number(0, "ns")));
}

}  // namespace
}  // namespace collided::report
