#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "client/cli/global_options.hpp"
#include "tests/cli/fakes/fake_client.hpp"
#include "tests/cli/terminal.hpp"

namespace collided {
namespace {

using nlohmann::json;

class Completion : public testing::Test {
 protected:
  void SetUp() override {
    fake::reset();
    fake::server().command = [](const std::string& name, const json&, const Shape&) -> Result<std::string> {
      EXPECT_EQ(name, "list");
      return json{{"count", 2}, {"objects", {{{"name", "crate"}}, {{"name", "crane"}}}}}.dump();
    };
  }
};

TEST_F(Completion, VerbsOptionsAndObjects) {
  EXPECT_EQ(collide("complete -- ra").out, "ray\n");
  EXPECT_EQ(collide("complete -- co").out, "convert\ncompletion\n");
  EXPECT_EQ(collide("complete -- ray --on").out, "--only\n");
  EXPECT_EQ(collide("complete -- ray --only cra").out, "crate\ncrane\n");
  EXPECT_EQ(collide("complete -- get crat").out, "crate\n");
  EXPECT_EQ(collide("complete -- pair crate cran").out, "crane\n");
  EXPECT_EQ(collide("complete -- help wat").out, "watch\n");
  EXPECT_EQ(collide("complete -- load fil").out, "") << "a file may stand there";
  EXPECT_EQ(collide("complete -- completion z").out, "zsh\n");
}

TEST_F(Completion, WithoutAServerThereIsNothingAndNoMessage) {
  fake::server().command = [](const std::string&, const json&, const Shape&) -> Result<std::string> {
    return Error{ErrorCode::no_server, "no collided answered", ""};
  };
  const Ran ran = collide("complete -- get cr");
  EXPECT_EQ(ran.out, "");
  EXPECT_EQ(ran.err, "");
}

TEST_F(Completion, NoShellOfThatName) {
  EXPECT_EQ(collide("completion ksh").code, 2);
  EXPECT_NE(collide("completion bash").out.find("complete -o default -F _collide collide"), std::string::npos);
}

TEST_F(Completion, WhatAnOptionTakesIsOffered) {
  EXPECT_EQ(collide("complete -- ros --unknown u").out, "undecided\n");
  EXPECT_EQ(collide("complete -- fence wa").out, "watch\n");
  EXPECT_EQ(collide("complete -- fence add dock --to crat").out, "crate\n");
  EXPECT_EQ(collide("complete -- ray --to crat").out, "") << "a point";
  EXPECT_EQ(collide("complete -- move crate cran").out, "") << "a number";
}

// A new option gets a name for what it takes.
TEST_F(Completion, EveryOptionOfEveryVerbSaysWhatItTakes) {
  for (const cli::Verb& verb : cli::verbs()) {
    CLI::App app;
    const std::unique_ptr<cli::Command> command = make_command(verb, every_wing());
    cli::Globals globals;
    cli::declare_verb(app, *command, globals);
    for (const CLI::Option* option : app.get_options()) {
      if (option->get_items_expected_max() == 0 || option->get_positional()) continue;
      EXPECT_NE(option->get_type_name(), "") << verb.name << ' ' << option->get_name();
    }
  }
}

// One name, but not one kind of value: a point, or the file of a map.
TEST_F(Completion, AnOptionSaysWhatItTakesInEachVerb) {
  EXPECT_NE(collide("help ray").out.find("--to X Y Z"), std::string::npos);
  EXPECT_NE(collide("help fleet").out.find("--to MAP"), std::string::npos);
  EXPECT_NE(collide("help clearance").out.find("--to GLOB"), std::string::npos);
}

}  // namespace
}  // namespace collided
