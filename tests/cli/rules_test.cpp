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

class AttachVerbs : public testing::Test {
 protected:
  void SetUp() override {
    fake::reset();
    fake::server().command = [](const std::string& name, const nlohmann::json& arguments, const Shape&) {
      sent = arguments;
      sent["command"] = name;
      if (name == "list")
        return Result<std::string>(std::string(
            R"({"objects":[{"name":"crate","id":1,"kind":"box","moving":true,"scene":"","publisher":"","position":[0,0,1],
                "triangles":0,"layers":1,"stale":false,"attached_to":"arm/hand"}],"count":1,"version":9})"));
      return Result<std::string>(std::string(R"({"child":"crate","parent":"arm/hand","version":9})"));
    };
  }
  static inline nlohmann::json sent;
};

TEST_F(AttachVerbs, AttachAndDetachSayWhatMovesWithWhat) {
  const Ran ran = at_terminal("attach crate arm/hand");
  EXPECT_EQ(ran.code, 0);
  EXPECT_EQ(ran.out, "crate moves along with arm/hand  (world 9)\n");
  EXPECT_EQ(ran.err, "undo: collide detach 'crate'\n");
  EXPECT_EQ(sent["command"], "attach");
  EXPECT_EQ(sent["child"], "crate");
  EXPECT_EQ(sent["parent"], "arm/hand");
  EXPECT_EQ(collide("attach crate arm/hand --json").out, "{\"child\":\"crate\",\"parent\":\"arm/hand\",\"world\":9}\n");
  EXPECT_EQ(at_terminal("detach crate").out, "crate no longer moves along with arm/hand  (world 9)\n");
  EXPECT_EQ(sent["command"], "detach");
  EXPECT_EQ(collide("attach crate").code, 2);
  EXPECT_EQ(collide("detach").code, 2);
  EXPECT_NE(at_terminal("ls").out.find("yes, with arm/hand"), std::string::npos);
  EXPECT_NE(collide("ls --json").out.find("\"attached_to\":\"arm/hand\""), std::string::npos);
}

}  // namespace
}  // namespace collided
