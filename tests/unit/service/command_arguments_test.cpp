// What commands are told is checked where it is asked for: each refusal names the command, the argument, its value and what is allowed.
#include "server/service/commands/command_arguments.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <set>
#include <string_view>

namespace collided::engine::service {
namespace {

using wire_contract::QueryRight;
using wire_contract::command::ArgumentSpec;
using wire_contract::command::ArgumentType;
using wire_contract::command::Changes;
using wire_contract::command::CommandForm;
using wire_contract::command::CommandSpec;
using wire_contract::command::KeyedObjects;

constexpr ArgumentSpec kArguments[]{{"name", ArgumentType::text},
                                    {"limit", ArgumentType::whole, "", 3, 9},
                                    {"reach_m", ArgumentType::number, "m", 4},
                                    {"moving", ArgumentType::truth, "", true}};
constexpr ArgumentSpec kRemoval[]{{"remove", ArgumentType::truth}, {"glob", ArgumentType::text}};
constexpr CommandForm kForms[]{{"remove", kRemoval}};
constexpr CommandSpec kDo{"do", QueryRight::change, Changes::objects, KeyedObjects::all, kArguments, kForms};

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
  EXPECT_TRUE(said.truth("yes"));
  EXPECT_EQ(said.number("number"), -2.5);
  EXPECT_EQ(said.whole("whole", 7), 7U);
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
  EXPECT_EQ(refusal(odd, [](const Arguments& a) { a.truth("x"); }), said + "true or false");
  EXPECT_EQ(refusal(odd, [](const Arguments& a) { a.number("x"); }), said + "a number up to 1e290");
  EXPECT_EQ(refusal(odd, [](const Arguments& a) { a.whole("x", 9); }), said + "a whole number from 0 to 9");
  EXPECT_EQ(refusal(odd, [](const Arguments& a) { a.vector("x"); }), said + "three numbers up to 1e290");
  EXPECT_EQ(refusal(odd, [](const Arguments& a) { a.boxes("x"); }),
            said + "at most 10000 boxes of six numbers, the lower corner first");
  EXPECT_NE(refusal(odd, [](const Arguments& a) { a.pose("x"); }).find("; a pose is [x, y, z, qw, qx, qy, qz]"),
            std::string::npos);
  EXPECT_EQ(refusal(R"({"command": "do", "n": 10})", [](const Arguments& a) { a.whole("n", 9); }),
            "do: 'n' is 10; allowed: a whole number from 0 to 9");
  EXPECT_EQ(refusal(R"({"command": "do", "n": -1})", [](const Arguments& a) { a.whole("n", 9); }),
            "do: 'n' is -1; allowed: a whole number from 0 to 9");
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

TEST(CommandArguments, AnAbsentOneHasTheValueOfItsSpecification) {
  const Arguments silent(R"({"command": "do"})", kDo);
  EXPECT_TRUE(silent.truth("moving"));
  EXPECT_FALSE(silent.truth("x"));
  EXPECT_EQ(silent.truth_if_given("moving"), std::nullopt);
  EXPECT_EQ(silent.whole("limit"), 3U);
  EXPECT_EQ(silent.whole("limit", 2), 2U);
  EXPECT_EQ(silent.number("reach_m"), 4);
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

// A form is selected by an argument of its own, and then takes the arguments of that form alone.
TEST(CommandArguments, OnlyThoseOfTheCommandsFormAreTaken) {
  const auto checked = [](const std::string& arguments) {
    try {
      Arguments(R"({"command": "do")" + arguments + "}", kDo).refuse_unknown();
      return std::string("taken");
    } catch (const BadCommand& bad) { return std::string(bad.what()); }
  };
  EXPECT_EQ(checked(R"(, "name": "a", "limit": 10, "moving": null)"), "taken");
  EXPECT_EQ(checked(R"(, "durable": true)"), "taken");
  EXPECT_EQ(checked(R"(, "limt": 1)"), "do: unknown argument 'limt'; did you mean 'limit'?");
  EXPECT_EQ(checked(R"(, "glob": "a")"), "do: unknown argument 'glob'");
  EXPECT_EQ(checked(R"(, "remove": true, "glob": "a")"), "taken");
  EXPECT_EQ(checked(R"(, "remove": true, "durable": false)"), "taken");
  EXPECT_EQ(checked(R"(, "remove": true, "name": "a")"), "do: unknown argument 'name'");
  EXPECT_EQ(checked(R"(, "remove": false)"), "do: unknown argument 'remove'");
  EXPECT_EQ(refusal(R"({"command": "list", "limit": 1000001})", [](const Arguments& a) { a.whole("limit"); }),
            "list: 'limit' is 1000001; allowed: a whole number from 0 to 1000000");
}

TEST(CommandTable, NamesEachCommandAndArgumentOnce) {
  std::set<std::string_view> names;
  for (const CommandSpec& spec : wire_contract::command::kCommands) {
    EXPECT_TRUE(names.insert(spec.name).second) << spec.name;
    const auto check = [&](std::span<const ArgumentSpec> arguments) {
      std::set<std::string_view> known{"command", "durable"};
      for (const ArgumentSpec& argument : arguments)
        EXPECT_TRUE(known.insert(argument.name).second) << spec.name << ' ' << argument.name;
      return known;
    };
    check(spec.arguments);
    for (const CommandForm& form : spec.forms) EXPECT_TRUE(check(form.arguments).contains(form.given)) << form.given;
  }
}

// Keys and journals depend on it: what changes the world needs the right to change it.
TEST(CommandTable, ChangesNeedTheirRight) {
  using wire_contract::command::right_for;
  for (const CommandSpec& spec : wire_contract::command::kCommands)
    EXPECT_TRUE(!spec.changes_world() || spec.right == QueryRight::change) << spec.name;
  EXPECT_EQ(right_for("load", true), QueryRight::upload);
  EXPECT_EQ(right_for("recording", false), QueryRight::change);
  EXPECT_EQ(right_for("left_out", false), QueryRight::greet);
  EXPECT_EQ(right_for("of another version", false), QueryRight::ask);
}

}  // namespace
}  // namespace collided::engine::service
