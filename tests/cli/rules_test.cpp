#include <gtest/gtest.h>

#include "tests/cli/fakes/fake_client.hpp"
#include "tests/cli/terminal.hpp"

namespace collided {
namespace {

class RuleVerbs : public testing::Test {
 protected:
  void SetUp() override {
    fake::reset();
    fake::server().command = [](const std::string& name, const nlohmann::json& arguments, const Shape&) {
      sent = arguments;
      sent["command"] = name;
      if (name == "allowed") return Result<std::string>(rules);
      return Result<std::string>(std::string(R"({"rules":1,"a_count":1,"b_count":0,"ended":1,"began":2,"version":9})"));
    };
    rules = R"({"rules":[{"a":"arm/upper","b":"arm/fore","because":"a joint","allows":true},
                         {"a":"human_*","b":"*","because":"","allows":false}],"version":9})";
  }
  static inline nlohmann::json sent;
  static inline std::string rules;
};

TEST_F(RuleVerbs, AllowSaysWhatEndedAndHowToTakeItBack) {
  const Ran ran = at_terminal("allow arm/upper arm/fore --because 'they share a joint'");
  EXPECT_EQ(ran.code, 0);
  EXPECT_EQ(ran.out, "allowed  1 object with 0 objects  ended 1 contact (world 9)\n");
  EXPECT_EQ(ran.err, "no object's name matches 'arm/fore' now\nundo: collide deny 'arm/upper' 'arm/fore'\n");
  EXPECT_EQ(sent["command"], "allow");
  EXPECT_EQ(sent["a"], "arm/upper");
  EXPECT_EQ(sent["b"], "arm/fore");
  EXPECT_EQ(sent["because"], "they share a joint");
  EXPECT_EQ(collide("allow a").code, 2);
  EXPECT_EQ(collide("allow a b c").code, 2);
}

TEST_F(RuleVerbs, AllowAloneListsTheRulesInTheirOrder) {
  EXPECT_EQ(at_terminal("allow").out,
            "RULE     A          B         BECAUSE\n"
            "allowed  arm/upper  arm/fore  a joint\n"
            "denied   human_*    *\n");
  EXPECT_EQ(collide("allow --json").out,
            "{\"rule\":\"allowed\",\"a\":\"arm/upper\",\"b\":\"arm/fore\",\"because\":\"a joint\"}\n"
            "{\"rule\":\"denied\",\"a\":\"human_*\",\"b\":\"*\",\"because\":\"\"}\n");
  rules = R"({"rules":[],"version":9})";
  EXPECT_EQ(collide("allow").code, 1);
}

TEST_F(RuleVerbs, DenyTakesItBack) {
  EXPECT_EQ(at_terminal("deny 'human_*' '*'").out, "denied  1 object with 0 objects  began 2 contacts (world 9)\n");
  EXPECT_EQ(sent["command"], "deny");
  EXPECT_EQ(collide("deny a").code, 2);
}

}  // namespace
}  // namespace collided
