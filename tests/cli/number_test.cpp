#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

#include "client/cli/failure.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/input/tokens.hpp"

namespace collided::cli {
namespace {

using namespace std::chrono_literals;

std::string number_refusal(std::string_view text, Measure measure = Measure::none) {
  try {
    parse_number(text, measure);
    return "accepted";
  } catch (const Failure& failure) { return failure.what(); }
}

TEST(Number, EverySpellingOfADoubleIsRead) {
  EXPECT_EQ(parse_number("-1"), -1);
  EXPECT_EQ(parse_number("-.5"), -0.5);
  EXPECT_EQ(parse_number("+3"), 3);
  EXPECT_EQ(parse_number("1e-300"), 1e-300);
  EXPECT_EQ(parse_number("-inf"), -INFINITY);
  EXPECT_TRUE(std::signbit(parse_number("-0")));
}

TEST(Number, WhatIsNoNumberIsRefusedByName) {
  EXPECT_EQ(number_refusal("nan"), "'nan' has no place in a question or a pose");
  EXPECT_EQ(number_refusal("-NaN"), "'-NaN' has no place in a question or a pose");
  EXPECT_EQ(number_refusal("crate"), "'crate' is not a number");
  EXPECT_EQ(number_refusal("1x"), "'1x' is not a number");
  EXPECT_EQ(number_refusal(""), "'' is not a number");
  EXPECT_EQ(number_refusal("+-1"), "'+-1' is not a number");
  EXPECT_EQ(number_refusal("1e400"), "'1e400' is out of the range of a double (about 4.9e-324 to 1.8e308)");
  EXPECT_EQ(number_refusal("3kg", Measure::length), "'3kg': 'kg' is not a unit here; known: nm um µm mm cm m km in ft");
  EXPECT_EQ(number_refusal("3s", Measure::length), "'3s': 's' is not a unit here; known: nm um µm mm cm m km in ft");
}

// 3.5mm is the double nearest to 0.0035, not 3.5 times a rounded 0.001.
TEST(Number, UnitsRoundOnce) {
  EXPECT_EQ(parse_number("3.5mm", Measure::length), 0.0035);
  EXPECT_EQ(parse_number("2in", Measure::length), 0.0508);
  EXPECT_EQ(parse_number("1um", Measure::length), 1e-6);
  EXPECT_EQ(parse_number("0.3", Measure::length), 0.3);
  EXPECT_EQ(parse_number("180deg", Measure::angle), std::acos(-1.0));
  EXPECT_EQ(parse_number("0.5rad", Measure::angle), 0.5);
  EXPECT_EQ(parse_duration("200us"), 200us);
  EXPECT_EQ(parse_duration("1.5s"), 1500ms);
  EXPECT_EQ(parse_duration("2"), 2s);
  EXPECT_EQ(parse_duration("inf"), std::chrono::nanoseconds::max());
}

// Each unit with the double nearest to what it is, and none of another measure.
TEST(Number, EveryUnitIsWhatItSays) {
  struct Known {
    const char* text;
    Measure measure;
    double value;
  };
  const double pi = std::acos(-1.0);
  const Known known[] = {
      {"7nm", Measure::length, 7e-9},     {"7um", Measure::length, 7e-6},    {"7µm", Measure::length, 7e-6},
      {"7mm", Measure::length, 7e-3},     {"7cm", Measure::length, 0.07},    {"7m", Measure::length, 7},
      {"7km", Measure::length, 7000},     {"10in", Measure::length, 0.254},  {"10ft", Measure::length, 3.048},
      {"7rad", Measure::angle, 7},        {"90deg", Measure::angle, pi / 2}, {"-60°", Measure::angle, -pi / 3},
      {"7ns", Measure::duration, 7e-9},   {"7us", Measure::duration, 7e-6},  {"7µs", Measure::duration, 7e-6},
      {"7ms", Measure::duration, 7e-3},   {"7s", Measure::duration, 7},      {"7min", Measure::duration, 420},
      {"7h", Measure::duration, 25200},   {"7Hz", Measure::rate, 7},         {"7kHz", Measure::rate, 7000},
      {"7mm/s", Measure::speed, 7e-3},    {"7m/s", Measure::speed, 7},       {"36km/h", Measure::speed, 10},
      {"1km/h", Measure::speed, 1 / 3.6},
  };
  for (const Known& one : known) {
    EXPECT_EQ(parse_number(one.text, one.measure), one.value) << one.text;
    for (const Measure other :
         {Measure::none, Measure::length, Measure::angle, Measure::duration, Measure::rate, Measure::speed}) {
      if (other != one.measure) { EXPECT_NE(number_refusal(one.text, other), "accepted") << one.text; }
    }
  }
  EXPECT_EQ(parse_vector("1m:20cm:300mm", Measure::length), Eigen::Vector3d(1, 0.2, 0.3));
  EXPECT_EQ(parse_duration("2min"), 120s);
  EXPECT_EQ(parse_duration("7ns"), 7ns);
  EXPECT_THROW(parse_duration("-1s"), Failure);
}

// On either side of where the unit that is shown changes.
TEST(Number, TimesAreShownInTheUnitThatFits) {
  EXPECT_EQ(format_duration(999ns), "999 ns");
  EXPECT_EQ(format_duration(1us), "1 us");
  EXPECT_EQ(format_duration(1500us), "1.5 ms");
  EXPECT_EQ(format_duration(999ms), "999 ms");
  EXPECT_EQ(format_duration(119s), "119 s");
  EXPECT_EQ(format_duration(125s), "2 m 5 s");
  EXPECT_EQ(format_duration(2h + 3min), "2 h 3 m");
}

TEST(Number, TheShortestTextReadsBackToTheSameBits) {
  std::mt19937_64 random(17);
  for (int trial = 0; trial < 100'000; ++trial) {
    const std::uint64_t bits = random();
    double value = 0;
    std::memcpy(&value, &bits, sizeof value);
    if (std::isnan(value)) continue;
    const double back = parse_number(format_number(value));
    ASSERT_EQ(std::memcmp(&back, &value, sizeof value), 0) << format_number(value);
  }
}

TEST(Number, CountsShowTheirThousands) {
  EXPECT_EQ(format_count(0), "0");
  EXPECT_EQ(format_count(999), "999");
  EXPECT_EQ(format_count(18'204), "18 204");
  EXPECT_EQ(format_count(1'000'007), "1 000 007");
}

TEST(Number, BitsAreDecimalHexadecimalOrBinary) {
  EXPECT_EQ(parse_bits("5"), 5U);
  EXPECT_EQ(parse_bits("0xffffffff"), 0xffffffffU);
  EXPECT_EQ(parse_bits("0b101"), 5U);
  EXPECT_THROW(parse_bits("0x1ffffffff"), Failure);
  EXPECT_THROW(parse_bits("-1"), Failure);
}

TEST(Tokens, ANumberIsNeverAnOption) {
  for (const char* text : {"-1", "-.5", "+3", "1e-300", "-inf", "-3.5mm", "-1,0,5", "-nan"})
    EXPECT_TRUE(is_number_text(text)) << text;
  for (const char* text : {"-n", "--to", "-", "", "rays.csv", "-1x", "1,,2", "-in"})
    EXPECT_FALSE(is_number_text(text)) << text;
}

TEST(Tokens, AVectorOptionTakesItsNumbersAndNoMore) {
  const auto joined = [](std::vector<std::string> words) {
    std::vector<std::string> tokens = prepare_tokens(words);
    for (std::string& token : tokens) token = unmarked(token);
    return tokens;
  };
  EXPECT_EQ(joined({"--to", "4", "-4", "0", "7"}), (std::vector<std::string>{"--to", "4,-4,0", "7"}));
  EXPECT_EQ(joined({"--to", "4,-4,0", "7"}), (std::vector<std::string>{"--to", "4,-4,0", "7"}));
  EXPECT_EQ(joined({"--size", "0.2", "--seed", "7"}), (std::vector<std::string>{"--size", "0.2", "--seed", "7"}));
}

TEST(Number, AUnitMayStandByItself) {
  EXPECT_EQ(parse_numbers({"20", "cm", "3", "m"}, Measure::length), (std::vector<double>{0.2, 3}));
  EXPECT_EQ(parse_numbers({"20cm", "3"}, Measure::length), (std::vector<double>{0.2, 3}));
  EXPECT_THROW(parse_numbers({"20cm", "cm"}, Measure::length), Failure);
  EXPECT_THROW(parse_numbers({"cm", "20"}, Measure::length), Failure);
  EXPECT_THROW(parse_numbers({"20", "deg"}, Measure::length), Failure);
}

TEST(Tokens, WordsAreSplitAsAShellDoes) {
  EXPECT_EQ(split_words("add 'a b' \"c d\" e\\ f # g"), (std::vector<std::string>{"add", "a b", "c d", "e f"}));
  EXPECT_EQ(split_words("rm a#b"), (std::vector<std::string>{"rm", "a#b"}));
  EXPECT_TRUE(split_words("   # nothing").empty());
  EXPECT_THROW(split_words("add 'open"), Failure);
}

}  // namespace
}  // namespace collided::cli
