// What commands are told is checked where it is asked for: each refusal names the command, the argument, its value and what is allowed.
#include "server/service/command_arguments.hpp"

#include <gtest/gtest.h>

#include <functional>

namespace collided::service {
namespace {

std::string refusal(const std::string& text, const std::function<void(const Arguments&)>& read) {
  try {
    read(Arguments(text));
    return "taken";
  } catch (const BadCommand& bad) {
    return bad.what() + (bad.hint.empty() ? "" : "; " + bad.hint);
  }
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
  EXPECT_EQ(refusal(odd, [](const Arguments& a) { a.number("x", 0); }), said + "a finite number");
  EXPECT_EQ(refusal(odd, [](const Arguments& a) { a.whole("x", 0, 9); }), said + "a whole number from 0 to 9");
  EXPECT_EQ(refusal(odd, [](const Arguments& a) { a.vector("x"); }), said + "three numbers");
  EXPECT_EQ(refusal(odd, [](const Arguments& a) { a.boxes("x"); }), said + "at most 10000 boxes of six numbers, the lower corner first");
  EXPECT_NE(refusal(odd, [](const Arguments& a) { a.pose("x"); }).find("; a pose is [x, y, z, qw, qx, qy, qz]"), std::string::npos);
  EXPECT_EQ(refusal(R"({"command": "do", "n": 10})", [](const Arguments& a) { a.whole("n", 0, 9); }),
            "do: 'n' is 10; allowed: a whole number from 0 to 9");
  EXPECT_EQ(refusal(R"({"command": "do", "n": -1})", [](const Arguments& a) { a.whole("n", 0, 9); }),
            "do: 'n' is -1; allowed: a whole number from 0 to 9");
  EXPECT_EQ(refusal(R"({"command": "do", "limt": 1})", [](const Arguments& a) { a.allow_only({"name", "limit"}); }),
            "do: unknown argument 'limt'; did you mean 'limit'?");
  EXPECT_EQ(refusal("no json", [](const Arguments&) {}), "a command's text is not a JSON object");
  EXPECT_EQ(refusal("[]", [](const Arguments&) {}), "a command's text is not a JSON object");
  EXPECT_EQ(refusal(R"({"command": 7})", [](const Arguments&) {}), "a command without its name");
}

}  // namespace
}  // namespace collided::service
