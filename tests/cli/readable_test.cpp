#include "client/cli/output/readable.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <sstream>

#include "client/cli/input/number.hpp"
#include "client/cli/output/output.hpp"
#include "client/cli/output/wrapping.hpp"

namespace collided::cli {
namespace {

using Eigen::Vector3d;

TEST(Readable, LengthsAreRoundedToWhatTheEyeNeeds) {
  EXPECT_EQ(readable_length(1.7999999999999998, 2.2e-16, Digits::rounded), "1.8 m");
  EXPECT_EQ(readable_length(0, 0, Digits::rounded), "0");
  EXPECT_EQ(readable_length(-0.0, 1e-17, Digits::rounded), "0");
  EXPECT_EQ(readable_length(0.0123456789, 0, Digits::rounded), "0.012346 m");
  EXPECT_EQ(readable_length(0.00123456789, 0, Digits::rounded), "0.001235 m");
  EXPECT_EQ(readable_length(1234567.89012345, 0, Digits::rounded), "1234567.890123 m");
  EXPECT_EQ(readable_length(3.14159e-7, 0, Digits::rounded), "3.142e-07 m");
  EXPECT_EQ(readable_length(-1e-6, 0, Digits::rounded), "-1e-06 m");
  EXPECT_EQ(readable_length(5e-324, 0, Digits::rounded), "5e-324 m");
  EXPECT_EQ(readable_length(std::numeric_limits<double>::infinity(), 0, Digits::rounded), "inf m");
  EXPECT_EQ(readable_length(1e300, 0, Digits::rounded), "1e+300 m");
}

TEST(Readable, NumbersThatPeopleCopyHaveNoExponentUnlessTheyMust) {
  EXPECT_EQ(format_number(500000), "500000");
  EXPECT_EQ(format_number(-4649022.125), "-4649022.125");
  EXPECT_EQ(format_number(1e-4), "0.0001");
  EXPECT_EQ(format_number(1e-5), "1e-05");
  EXPECT_EQ(format_number(1e15), "1e+15");
  EXPECT_EQ(format_bound(523456), "520000");
  EXPECT_EQ(format_bound(8.9e-16), "8.9e-16");
}

TEST(Readable, ABoundIsShownWhereItHidesDigits) {
  EXPECT_EQ(readable_length(1.23456789, 0.01, Digits::rounded), "1.23 m ±0.01");
  EXPECT_EQ(readable_length(1.23456789, 1e-9, Digits::rounded), "1.234568 m");
  EXPECT_EQ(readable_length(1e-12, 1e-9, Digits::rounded), "0 ±1e-09");
  EXPECT_EQ(readable_number(0.0036638432793211126, std::numeric_limits<double>::infinity()), "0.003664");
  EXPECT_EQ(readable_length(1.7999999999999998, 2.2e-16, Digits::all), "1.7999999999999998 m ±2.2e-16");
  EXPECT_EQ(readable_length(0.2, 0, Digits::all), "0.2 m exact");
}

TEST(Readable, PointsAndDirectionsShareOneResolution) {
  EXPECT_EQ(readable_point(Vector3d(0, 1e-17, 1.2000000000000002), 0, Digits::rounded), "0 0 1.2");
  EXPECT_EQ(readable_point(Vector3d(-1e-17, 2, 3), 0, Digits::rounded), "0 2 3");
  EXPECT_EQ(readable_point(Vector3d(3e-9, 4e-9, 0), 0, Digits::rounded), "3e-09 4e-09 0");
  EXPECT_EQ(readable_point(Vector3d(0, 0, 1.2000000000000002), 0, Digits::all), "0 0 1.2000000000000002");
  EXPECT_EQ(readable_direction(Vector3d(0, -1e-9, 0.70710678), Digits::rounded), "0 0 0.7071");
}

// What is shown is never farther from the value than half of a micrometre, of its fourth digit, or of its bound's digit.
TEST(Readable, RoundingStaysWithinItsPromise) {
  std::mt19937_64 random(21);
  std::uniform_real_distribution<double> exponent(-12, 9);
  std::uniform_real_distribution<double> mantissa(-10, 10);
  for (int i = 0; i < 20'000; ++i) {
    const double value = mantissa(random) * std::pow(10.0, std::floor(exponent(random)));
    const double shown = std::stod(readable_number(value));
    const double promise = std::max(0.51e-6, 0.51e-3 * std::abs(value));
    EXPECT_LE(std::abs(shown - value), std::min(promise, 0.51e-6 + 1e-9 * std::abs(value))) << format_number(value);
    EXPECT_LE(std::abs(shown - value), 0.51e-3 * std::abs(value)) << format_number(value);
  }
}

TEST(Wrapping, LinesBreakWhereTwoBlanksAre) {
  const std::string line = "hit  warehouse/shelf_3/top  distance 3.8 m  at 0 0 1.2  normal 0 0 1  triangle 2";
  EXPECT_EQ(wrapped(line, 0), line);
  EXPECT_EQ(wrapped(line, 200), line);
  EXPECT_EQ(wrapped(line, 50), "hit  warehouse/shelf_3/top  distance 3.8 m\n     at 0 0 1.2  normal 0 0 1  triangle 2");
  EXPECT_EQ(wrapped("a_word_that_is_longer_than_the_terminal_is_wide", 20),
            "a_word_that_is_longer_than_the_terminal_is_wide");
  EXPECT_EQ(columns_of("\x1b[32mhit\x1b[0m ±"), 5u);
}

TEST(Wrapping, NothingIsWiderThanTheTerminalAndNoWordIsLost) {
  std::mt19937_64 random(22);
  for (int i = 0; i < 2'000; ++i) {
    std::string line(random() % 8, ' ');
    for (std::size_t word = 1 + random() % 20; word > 0; --word)
      line += std::string(1 + random() % 12, 'x') + std::string(1 + random() % 2, ' ');
    const std::size_t width = 24 + random() % 60;
    std::string left, right;
    std::string text = wrapped(line, width);
    for (const char c : line)
      if (c != ' ') left += c;
    for (const char c : text)
      if (c != ' ' && c != '\n') right += c;
    EXPECT_EQ(left, right);
    for (std::size_t begin = 0; begin <= text.size();) {
      const std::size_t end = std::min(text.find('\n', begin), text.size());
      EXPECT_LE(columns_of(std::string_view(text).substr(begin, end - begin)), width + 1) << text;
      begin = end + 1;
    }
  }
}

TEST(Wrapping, ATableFitsByItsWidestColumns) {
  std::vector<ColumnWidth> widths{{40}, {8}, {30}};
  EXPECT_TRUE(fit(widths, 50));
  EXPECT_LE(widths[0].columns + widths[1].columns + widths[2].columns + 4, 50u);
  EXPECT_EQ(widths[1].columns, 8u);
  widths = {{40}, {30, false}};
  EXPECT_TRUE(fit(widths, 50));
  EXPECT_EQ(widths[0].columns, 18u);
  EXPECT_EQ(widths[1].columns, 30u);
  EXPECT_FALSE(fit(widths, 30));
  EXPECT_EQ(cut_to("warehouse/shelf_3/top", 10), "ware…3/top");
  EXPECT_EQ(cut_to("äöüßäöüß", 5), "äö…üß");
  EXPECT_EQ(cut_to("short", 10), "short");
}

// A role cut to "…imary", or a heading to "…RSION", cannot be read.
TEST(Wrapping, HeadingsAndShortWordsOfATableStayWhole) {
  std::ostringstream out;
  const std::string name = "AC14-FZK-Haus/IfcWallStandardCase/2XPyKWY018sA1ygZKgQPtU";
  for (const std::size_t width : {100u, 80u, 60u, 40u}) {
    out.str("");
    Printer printer(out, Format::table, {}, {.width = width});
    printer.row({"SERVER", "ROLE", "VERSION", "OF"}, {name, "primary", "0.2.0", name});
    printer.finish();
    EXPECT_NE(out.str().find("primary"), std::string::npos) << out.str();
    EXPECT_NE(out.str().find("AC14-FZ"), std::string::npos) << out.str();
    EXPECT_NE(out.str().find("gQPtU"), std::string::npos) << out.str();
    if (width > 60) { EXPECT_NE(out.str().find("VERSION"), std::string::npos) << out.str(); }
  }
}

TEST(Wrapping, WhatHoldsANumberIsKnown) {
  for (const char* const text : {"1.8 m", "-0.003 m", "+12 m", "at most -3 m", "4649035.5 500006 5", ".5", "±1e-9"})
    EXPECT_TRUE(holds_number(text)) << text;
  for (const char* const text : {"", "pallet_07", "warehouse/shelf_3/top", "none", "contact inside", "-", "arm-2"})
    EXPECT_FALSE(holds_number(text)) << text;
}

// "1234567.5 m" cut to "12…5 m" would be another length.
TEST(Wrapping, NumbersOfATableStayWhole) {
  std::ostringstream out;
  const auto print = [&](std::size_t width) {
    out.str("");
    Printer printer(out, Format::table, {}, {.width = width});
    printer.row({"OBJECT", "DEPTH", "CONTACT"}, {"street.city/the_long_church", "1234567.5 m", "4649035.25 500006 5"});
    printer.finish();
    return out.str();
  };
  EXPECT_EQ(print(50),
            "OBJECT            DEPTH        CONTACT\n"
            "street.…g_church  1234567.5 m  4649035.25 500006 5\n");
  EXPECT_EQ(print(36),
            "street.city/the_long_church\n"
            "     depth 1234567.5 m\n"
            "     contact 4649035.25 500006 5\n");
}

TEST(Wrapping, ALabelIsNotLeftAlone) {
  EXPECT_EQ(wrapped("  placed   a unit of the file is 1 m, since CSV does not say", 40),
            "  placed   a unit of the file is 1 m,\n     since CSV does not say");
  EXPECT_EQ(wrapped("poses 0 applied, 0 dropped  ·  questions 8 answered", 36),
            "poses 0 applied, 0 dropped\n     ·  questions 8 answered");
}

TEST(Wrapping, ANumberStaysWithItsUnit) {
  EXPECT_EQ(wrapped("undecided: the answer is known to 13.25 m and to no more", 38),
            "undecided: the answer is known to\n     13.25 m and to no more");
}

}  // namespace
}  // namespace collided::cli
