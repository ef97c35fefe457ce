// What commands are told is checked where it is asked for: each refusal names the command, the argument, its value and what is allowed.
#include "server/service/commands/command_arguments.hpp"

#include <gtest/gtest.h>

#include <functional>

namespace collided::engine::service {
namespace {

std::string refusal(const std::string& text, const std::function<void(const Arguments&)>& read) {
  try {
    read(Arguments(text));
    return "taken";
  } catch (const BadCommand& bad) { return bad.what() + (bad.hint.empty() ? "" : "; " + bad.hint); }
}

TEST(CommandArguments, AreReadAsTheyWereSaid) {
  const Arguments said(R"({"command": "do", "text": "é", "yes": true, "number": -2.5, "whole": 7, "three": [1, 2, 3],
                           "boxes": [[0, 1, 2, 3, 4, 5], ["-inf", 0, 0, "inf", 1, 1]], "pose": [1, 2, 3, 1, 0, 0, 0], "none": null})");
  EXPECT_EQ(said.command(), "do");
  EXPECT_EQ(said.text("text"), "é");
  EXPECT_EQ(said.text("other", "otherwise"), "otherwise");
  EXPECT_TRUE(said.truth("yes", false));
  EXPECT_EQ(said.number("number", 0), -2.5);
  EXPECT_EQ(said.number("other", 4), 4);
  EXPECT_EQ(said.whole("whole", 0, 7), 7U);
  EXPECT_EQ(said.vector("three"), Vec3(1, 2, 3));
  EXPECT_EQ(said.pose("pose")->position, Vec3(1, 2, 3));
  EXPECT_FALSE(said.has("none"));
  const std::vector<Aabb> boxes = said.boxes("boxes");
  ASSERT_EQ(boxes.size(), 2U);
  EXPECT_EQ(boxes[0].low, Vec3(0, 1, 2));
  EXPECT_EQ(boxes[0].high, Vec3(3, 4, 5));
  EXPECT_EQ(boxes[1].low[0], -HUGE_VAL);
  EXPECT_EQ(boxes[1].high[0], HUGE_VAL);
}

TEST(CommandArguments, ARefusalSaysWhatWasSaidAndWhatIsAllowed) {
  const std::string odd = R"({"command": "do", "x": ["é", {"deep": [1, 2]}]})";
  const std::string said = R"(do: 'x' is ["é",{"deep":[1,2]}]; allowed: )";
  EXPECT_EQ(refusal(odd, [](const Arguments& a) { a.text("x"); }), said + "text");
  EXPECT_EQ(refusal(odd, [](const Arguments& a) { a.truth("x", false); }), said + "true or false");
  EXPECT_EQ(refusal(odd, [](const Arguments& a) { a.number("x", 0); }), said + "a number up to 1e290");
  EXPECT_EQ(refusal(odd, [](const Arguments& a) { a.whole("x", 0, 9); }), said + "a whole number from 0 to 9");
  EXPECT_EQ(refusal(odd, [](const Arguments& a) { a.vector("x"); }), said + "three numbers up to 1e290");
  EXPECT_EQ(refusal(odd, [](const Arguments& a) { a.boxes("x"); }),
            said + "at most 10000 boxes of six numbers, the lower corner first");
  EXPECT_NE(refusal(odd, [](const Arguments& a) { a.pose("x"); }).find("; a pose is [x, y, z, qw, qx, qy, qz]"),
            std::string::npos);
  EXPECT_EQ(refusal(R"({"command": "do", "n": 10})", [](const Arguments& a) { a.whole("n", 0, 9); }),
            "do: 'n' is 10; allowed: a whole number from 0 to 9");
  EXPECT_EQ(refusal(R"({"command": "do", "n": -1})", [](const Arguments& a) { a.whole("n", 0, 9); }),
            "do: 'n' is -1; allowed: a whole number from 0 to 9");
  EXPECT_EQ(refusal(R"({"command": "do", "limt": 1})",
                    [](const Arguments& a) {
                      a.allow_only({"name", "limit"});
                    }),
            "do: unknown argument 'limt'; did you mean 'limit'?");
  EXPECT_EQ(refusal("no json", [](const Arguments&) {}), "a command's text is not a JSON object");
  EXPECT_EQ(refusal("[]", [](const Arguments&) {}), "a command's text is not a JSON object");
  EXPECT_EQ(refusal(R"({"command": 7})", [](const Arguments&) {}), "a command without its name");
}

// Of words only the two that JSON has no number for; nothing, a word, a truth or a corner below the other is no box.
TEST(CommandArguments, OnlyNumbersAndTheTwoInfinitiesMakeABox) {
  for (const char* const wrong : {R"("nan")", R"("far")", R"("")", "null", "true", "[0]", "4"}) {
    for (const char* const box :
         {"[%, 0, 0, 3, 1, 1]", "[0, %, 0, 1, 3, 1]", "[0, 0, %, 1, 1, 3]", "[0, 0, 0, 1, 1, %, 1]"}) {
      std::string text = box;
      text.replace(text.find('%'), 1, wrong);
      EXPECT_NE(refusal(R"({"command": "do", "x": [)" + text + "]}", [](const Arguments& a) { a.boxes("x"); }), "taken")
          << text;
    }
  }
  EXPECT_EQ(
      refusal(R"({"command": "do", "x": [["inf", 0, 0, "-inf", 1, 1]]})", [](const Arguments& a) { a.boxes("x"); }),
      "do: 'x' is [[\"inf\",0,0,\"-inf\",1,1]]; allowed: at most 10000 boxes of six numbers, the lower corner first");
  EXPECT_EQ(Arguments(R"({"command": "do", "x": [["-inf", "-inf", "-inf", "inf", "inf", "inf"], [2, 2, 2, 2, 2, 2]]})")
                .boxes("x")
                .size(),
            2U);
  EXPECT_TRUE(Arguments(R"({"command": "do"})").boxes("x").empty());
}

TEST(CommandArguments, WhatWasNotSaidIsWhatIsTakenOtherwise) {
  const Arguments silent(R"({"command": "do"})");
  EXPECT_TRUE(silent.truth("x", true));
  EXPECT_FALSE(silent.truth("x", false));
  EXPECT_EQ(silent.whole("x", 3, 9), 3U);
  EXPECT_EQ(silent.vector("x"), std::nullopt);
  EXPECT_FALSE(silent.pose("x").has_value());
  const auto read = [](const char* value, const auto& how) {
    return refusal(std::string(R"({"command": "do", "x": )") + value + "}", how);
  };
  const auto three = [](const Arguments& a) { a.vector("x"); };
  EXPECT_EQ(read("[1, 2]", three), "do: 'x' is [1,2]; allowed: three numbers up to 1e290");
  EXPECT_EQ(read(R"([1, 2, "3"])", three), "do: 'x' is [1,2,\"3\"]; allowed: three numbers up to 1e290");
  const auto pose = [](const Arguments& a) { a.pose("x"); };
  EXPECT_EQ(read("[1, 2, 3]", pose), "do: 'x': a pose of 3 numbers; 7 are needed; a pose is [x, y, z, qw, qx, qy, qz]");
  EXPECT_EQ(read(R"([1, 2, "3", 1, 0, 0, 0])", pose), "do: 'x': a pose with nan; a pose is [x, y, z, qw, qx, qy, qz]");
  EXPECT_EQ(read("[1, 2, 3, 2, 0, 0, 0]", pose),
            "do: 'x': quaternion norm 2, allowed 1 +- 1e-06; a pose is [x, y, z, qw, qx, qy, qz]");
}

}  // namespace
}  // namespace collided::engine::service
