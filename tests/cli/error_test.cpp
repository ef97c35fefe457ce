#include <gtest/gtest.h>

#include "client/cli/command.hpp"
#include "client/cli/output/wrapping.hpp"
#include "tests/cli/fakes/fake_client.hpp"
#include "tests/cli/scratch_file.hpp"
#include "tests/cli/terminal.hpp"

namespace collided {
namespace {

class Errors : public testing::Test {
 protected:
  void SetUp() override { fake::reset(); }
};

TEST_F(Errors, AnUnknownVerbNamesTheNearest) {
  const Ran ran = collide("rya 0 0 5 0 0 -1");
  EXPECT_EQ(ran.code, 2);
  EXPECT_EQ(ran.err, "error: unknown verb 'rya'; did you mean 'ray'?\n");
  EXPECT_EQ(fake::server().connect_count, 0);
}

// By its letters "remove" is nearest to "move".
TEST_F(Errors, AnotherProgramsWordNamesTheVerbThatDoesIt) {
  for (const auto& [word, verb] : std::vector<std::pair<std::string, std::string>>{
           {"remove", "rm"}, {"delete", "rm"}, {"list", "ls"}, {"ping", "status"}})
    EXPECT_EQ(collide(word + " crate").err, "error: unknown verb '" + word + "'; did you mean '" + verb + "'?\n");
}

TEST_F(Errors, ADirectionOfZeroHasNoDirection) {
  const Ran ran = collide("ray 0 0 5  0 0 0");
  EXPECT_EQ(ran.code, 2);
  EXPECT_EQ(ran.err, "error: ray: direction 0 0 0 has no direction\n       use --to X Y Z to aim at a point\n");
  EXPECT_EQ(fake::server().connect_count, 0);
}

TEST_F(Errors, ABadLineOfABatchIsNamedAndTheRestIsAnswered) {
  std::string csv = "fx,fy,fz,dx,dy,dz\n";
  for (int ray = 0; ray < 4810; ++ray) csv += "0,0,5,0,0,-1\n";
  csv += "0,0,5,0,0,NaN\n0,0,5,0,0,-1\n";
  const Ran ran = collide("ray - -q", {.in = csv});
  EXPECT_EQ(ran.code, 6);
  EXPECT_EQ(
      ran.err,
      "error: stdin line 4812: 'NaN' in column dz; 4 810 rays answered, this one refused (--stop-on-error to stop)\n");
}

// Each line of a pipe would say it again.
TEST_F(Errors, ASecondServerIsWarnedOfOnce) {
  EXPECT_EQ(collide("ls").err.find("second server"), std::string::npos);
  fake::server().strangers = {.samples = 5, .speak_now = true};
  const std::string said = collide("-", {.in = "status\nstatus\n"}).err;
  const std::size_t at =
      said.find("warning: a second server speaks on this namespace, or somebody who plays one: 5 of ");
  ASSERT_NE(at, std::string::npos) << said;
  EXPECT_EQ(said.find("a second server", at + 20), std::string::npos) << said;
}

TEST_F(Errors, NoServerSaysWhatWasSeen) {
  fake::server().connect_error =
      Error{ErrorCode::no_server, "no collided answered in 2 s on domain 0, namespace 'collided'",
            "seen on this domain: 3 participants, none of ours"};
  const Ran ran = collide("status");
  EXPECT_EQ(ran.code, 4);
  EXPECT_EQ(ran.err,
            "error: no collided answered in 2 s on domain 0, namespace 'collided'\n"
            "       seen on this domain: 3 participants, none of ours\n");
}

// "--any" and "--only" are both one letter away; what begins the same longer was meant.
TEST_F(Errors, OfTwoNearOptionsTheOneThatBeginsTheSameIsNamed) {
  EXPECT_EQ(collide("ray 0 0 5 0 0 -1 --ony ball").err, "error: ray: unknown option '--ony'; did you mean '--only'?\n");
}

TEST_F(Errors, WhatIsMissingIsAskedFor) {
  EXPECT_EQ(collide("events").err, "error: events: which file?\n");
  EXPECT_EQ(collide("record").err, "error: record: which file?\n");
  EXPECT_EQ(collide("view --save").err, "error: view: --save takes a value\n");
}

TEST_F(Errors, ANameOfSeveralObjectsSaysWhich) {
  fake::server().command = [](const std::string& name, const nlohmann::json&, const Shape&) -> Result<std::string> {
    if (name == "get") return Error{ErrorCode::refused, "no object", ""};
    return std::string(R"({"objects":[{"name":"arm/base"},{"name":"arm/hand"},{"name":"army"}],"count":3})");
  };
  const Ran ran = collide("get arm");
  EXPECT_EQ(ran.code, 5);
  EXPECT_EQ(ran.err,
            "error: 'arm' is not one object but 2 objects: arm/base, arm/hand\n       collide ls 'arm/*' lists them\n");
}

TEST_F(Errors, AnUnknownObjectNamesTheNearest) {
  fake::server().command = [](const std::string& name, const nlohmann::json&, const Shape&) -> Result<std::string> {
    if (name == "get") return Error{ErrorCode::refused, "no object", ""};
    return std::string(
        R"({"objects":[{"name":"wall"},{"name":"pallet_70"},{"name":"pallet_07"}],"count":3,"version":18204})");
  };
  const Ran ran = collide("get pallet7");
  EXPECT_EQ(ran.code, 5);
  EXPECT_EQ(ran.err, "error: object 'pallet7' is not in the world (3 objects); nearest names: pallet_07, pallet_70\n");
}

TEST_F(Errors, ARefusalOfTheServerIsPassedOn) {
  fake::server().ask_error =
      Error{ErrorCode::refused,
            "server refused: 'box' against 'octree' is not supported; supported pairs: collide plan --pairs", ""};
  const Ran ran = collide("box 0 0 0 1 1 1");
  EXPECT_EQ(ran.code, 5);
  EXPECT_EQ(ran.err,
            "error: server refused: 'box' against 'octree' is not supported; supported pairs: collide plan --pairs\n");
}

TEST_F(Errors, BadUseIsRefusedBeforeAnythingIsSent) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"ray 0 0 5 0 0 nan", "error: ray: 'nan' has no place in a question or a pose\n"},
      {"ray 0 0 5 0 0",
       "error: ray: 5 numbers; a ray takes 6, start and direction, or 3 and --to X Y Z\n       collide help ray\n"},
      {"ray 0 0 5 0 0 -1 --tp 1 2 3", "error: ray: unknown option '--tp'; did you mean '--to'?\n"},
      {"ray 0 0 5 --to 0 0 5", "error: ray: start and target are the same point, 0 0 5\n"},
      {"ray 0 0 5 0 0 inf", "error: ray: direction 0 0 inf must be finite\n"},
      {"sphere 0 0 inf 1", "error: sphere: centre 0 0 inf must be finite\n"},
      {"sphere 0 0 0 -1", "error: sphere: radius -1 must be finite and not below 0\n"},
      {"ray 0 0 5 0 0 -1 --json --csv", "error: ray: --json, --csv, --plain and --table exclude each other\n"},
      {"ray 0 0 5 0 0 -1 --mask cargo", "error: ray: 'cargo' is not a set of 32 bits (decimal, 0x1f or 0b101)\n"},
      {"ray 0 0 5 0 0 -1 --domain 231", "error: ray: domain '231': allowed 0 to 230\n"},
      {"ray 0 0 5 0 0 -1 --domain -1", "error: ray: domain '-1': allowed 0 to 230\n"},
      {"ray 0 0 5 0 0 -1 --domain lab", "error: ray: domain 'lab': allowed 0 to 230\n"},
      {"ray missing.csv", "error: ray: missing.csv: No such file or directory\n"},
      {"add crate bx 1 1 1",
       "error: add: no shape 'bx'; did you mean 'box'?\n       shapes: sphere R, box X Y Z, capsule R L, cylinder R L, "
       "cone R H, ellipsoid X Y Z, plane [NX NY NZ],\n       points FILE R, polyline FILE R, heights FILE DX [DY], "
       "mesh FILE, hull FILE\n"},
      {"add crate box 1 1", "error: add: a box takes 3: full lengths along x, y, z; 2 given\n"},
      {"--jsn status", "error: status: unknown option '--jsn'; did you mean '--json'?\n"},
      {"get \xff", "error: get: a name or path is not UTF-8 text\n"},
      {"help rya", "error: help: no verb 'rya'; did you mean 'ray'?\n"},
  };
  for (const auto& [words, expected] : cases) {
    const Ran ran = collide(words);
    EXPECT_EQ(ran.code, 2) << words;
    EXPECT_EQ(ran.err, expected) << words;
    EXPECT_EQ(ran.out, "") << words;
  }
  EXPECT_TRUE(fake::server().request_sizes.empty());
}

TEST_F(Errors, AFieldThatDoesNotExistNamesThoseThatDo) {
  const Ran ran = collide("ray 0 0 5 0 0 -1 --fields distanze");
  EXPECT_EQ(ran.code, 2);
  EXPECT_EQ(ran.err,
            "error: ray: no field 'distanze'; did you mean 'distance'?\n"
            "       fields: "
            "answer,object,distance,error,point,normal,triangle,order,exit,inside,stale,reason,point_error,covered,"
            "covered_to\n");
}

TEST_F(Errors, QuietLeavesOutTheHint) {
  EXPECT_EQ(collide("ray 0 0 5  0 0 0 -q").err, "error: ray: direction 0 0 0 has no direction\n");
}

TEST_F(Errors, TheHelpIsFourteenLinesAndListsWhatWorks) {
  const Ran ran = collide("");
  EXPECT_EQ(ran.code, 0);
  EXPECT_LE(std::count(ran.out.begin(), ran.out.end(), '\n'), 14);
  EXPECT_NE(ran.out.find("Ask      ray  sphere  box  near  inside  sweep  pair  clearance  clash  what-if\n"
                         "Follow   watch  probe  fence  margin  nearest  explain  metrics  fleet  handover\n"),
            std::string::npos)
      << ran.out;
  EXPECT_EQ(collide("--help").out, ran.out);
  EXPECT_EQ(collide("help").out, ran.out);
}

TEST_F(Errors, EveryVerbExplainsItself) {
  const Ran ran = collide("ray -h");
  EXPECT_EQ(ran.code, 0);
  EXPECT_NE(ran.out.find("collide ray X Y Z --to X Y Z"), std::string::npos) << ran.out;
  EXPECT_NE(ran.out.find("--length"), std::string::npos);
  EXPECT_EQ(collide("ray 0 0 5 0 0 -1 --all -h").out, ran.out);
  EXPECT_EQ(collide("help ray").out, ran.out);
}

TEST_F(Errors, NoLineOfAHelpIsWiderThanATerminal) {
  for (const cli::Verb& verb : cli::verbs()) {
    if (verb.group.empty() || verb.passes_words_on) continue;
    std::istringstream lines(collide("help " + std::string(verb.name)).out);
    for (std::string line; std::getline(lines, line);)
      EXPECT_LE(cli::columns_of(line), 80U) << verb.name << ": " << line;
  }
}

TEST_F(Errors, ArgumentsComeFromAFileToo) {
  const ScratchFile file("arguments", "# from above\nray 0 0 5\n  0 0 -1 --only 'a b'\n");
  EXPECT_EQ(collide("@" + file.path()).code, 1);
  EXPECT_EQ(fake::server().last_options.only, "a b");
  EXPECT_EQ(collide("ray @/nowhere/at/all").err, "error: @/nowhere/at/all: cannot open that file\n");
}

TEST_F(Errors, StdinHoldsVerbsOrQuestionsNotBoth) {
  const Ran ran = collide("-", {.in = "ray -\n"});
  EXPECT_EQ(ran.code, 6);
  EXPECT_EQ(ran.err, "error: line 1: ray: '-' has no meaning here: the verbs are read from stdin\n");
}

}  // namespace
}  // namespace collided
