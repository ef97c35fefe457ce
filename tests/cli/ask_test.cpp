#include <gtest/gtest.h>

#include <sstream>

#include "client/cli/output/wrapping.hpp"
#include "tests/cli/fakes/fake_client.hpp"
#include "tests/cli/terminal.hpp"

namespace collided {
namespace {

class Ask : public testing::Test {
 protected:
  void SetUp() override { fake::reset(); }

  static Answer answer(Verdict verdict, UndecidedReason reason = UndecidedReason::none) {
    Answer answer;
    answer.verdict = verdict;
    answer.reason = reason;
    return answer;
  }

  static void answer_rays(Answer answer) {
    fake::server().ray = [answer](const RayQuestion& ray, const AskOptions&) {
      last_ray = ray;
      return answer;
    };
  }

  static inline RayQuestion last_ray;
};

Answer shelf() {
  Hit hit = fake::hit("shelf_3/top", 3.8, {0, 0, 1.2});
  hit.triangle = 118;
  return fake::hit_answer({hit});
}

TEST_F(Ask, ARayOnATerminalReadsAsASentence) {
  answer_rays(shelf());
  const Ran ran = at_terminal("ray 0 0 5  0 0 -1");
  EXPECT_EQ(ran.code, 0);
  EXPECT_EQ(ran.out, "hit  shelf_3/top  distance 3.8 m  at 0 0 1.2  normal 0 0 1  triangle 118\n");
  EXPECT_EQ(ran.err, "     41 us: 7 nodes, 2 exact tests; world 18204, poses 2.1 ms old\n");
  EXPECT_EQ(last_ray.origin, Vec3(0, 0, 5));
  EXPECT_EQ(last_ray.direction, Vec3(0, 0, -1));
  EXPECT_EQ(last_ray.length_m, std::numeric_limits<double>::infinity());
}

TEST_F(Ask, OffATerminalARecordIsALineWithTabs) {
  answer_rays(shelf());
  const Ran ran = collide("ray 0 0 5 0 0 -1");
  EXPECT_EQ(ran.out, "hit\tshelf_3/top\t3.8\t4.4e-16\t0 0 1.2\t0 0 1\t118\t\t\t\t\t\t4.5e-16\t\t\n");
  EXPECT_EQ(ran.err, "");
}

TEST_F(Ask, JsonHoldsWhatIsKnown) {
  answer_rays(shelf());
  EXPECT_EQ(
      collide("ray 0 0 5 0 0 -1 --json").out,
      R"({"answer":"hit","object":"shelf_3/top","distance":3.8,"error":4.4e-16,"point":[0,0,1.2],"normal":[0,0,1],"triangle":118,"point_error":4.5e-16})"
      "\n");
  answer_rays(answer(Verdict::miss));
  EXPECT_EQ(collide("ray 0 0 5 0 0 1 --json").out, "{\"answer\":\"miss\"}\n");
}

TEST_F(Ask, InfinityInJsonIsAString) {
  Answer inside = fake::hit_answer({fake::hit("hall", 0, {0, 0, 5})});
  inside.hits[0].inside = true;
  inside.hits[0].exit_m = std::numeric_limits<double>::infinity();
  answer_rays(inside);
  EXPECT_EQ(collide("ray 0 0 5 0 0 1 --json --fields exit,distance,inside").out,
            "{\"exit\":\"inf\",\"distance\":0,\"inside\":true}\n");
}

TEST_F(Ask, CsvHasAHeaderAndVectorsTakeThreeColumns) {
  answer_rays(shelf());
  EXPECT_EQ(collide("ray 0 0 5 0 0 -1 --csv --fields object,distance,point").out,
            "object,distance,point_x,point_y,point_z\nshelf_3/top,3.8,0,0,1.2\n");
}

TEST_F(Ask, NamesThatHurtAFormatAreEscaped) {
  answer_rays(fake::hit_answer({fake::hit("a,\"b\"\t\x1b[2J", 1, {0, 0, 0})}));
  EXPECT_EQ(collide("ray 0 0 5 0 0 -1 --csv --fields object").out, "object\n\"a,\"\"b\"\"\t\x1b[2J\"\n");
  EXPECT_EQ(collide("ray 0 0 5 0 0 -1 --plain --fields object").out, "a,\"b\"\\t\\x1b[2J\n");
  EXPECT_EQ(collide("ray 0 0 5 0 0 -1 --json --fields object").out, "{\"object\":\"a,\\\"b\\\"\\t\\u001b[2J\"}\n");
  EXPECT_EQ(at_terminal("ray 0 0 5 0 0 -1").out, "hit  a,\"b\"??[2J  distance 1 m  at 0 0 0  normal 0 0 1\n");
}

TEST_F(Ask, TheThreeAnswersAreThreeExitCodes) {
  answer_rays(shelf());
  EXPECT_EQ(collide("ray 0 0 5 0 0 -1").code, 0);
  answer_rays(answer(Verdict::miss));
  EXPECT_EQ(collide("ray 0 0 5 0 0 -1").code, 1);
  EXPECT_EQ(collide("ray 0 0 5 0 0 -1 --exit-zero").code, 0);
  answer_rays(answer(Verdict::undecided, UndecidedReason::numeric));
  EXPECT_EQ(collide("ray 0 0 5 0 0 -1").code, 3);
  EXPECT_EQ(collide("--exit-zero ray 0 0 5 0 0 -1").code, 0);
}

TEST_F(Ask, UndecidedSaysWhy) {
  answer_rays(answer(Verdict::undecided, UndecidedReason::numeric));
  EXPECT_EQ(at_terminal("ray 0 0 5 0 0 -1").out, "undecided: numeric; both answers are consistent with the input\n");
  EXPECT_EQ(collide("ray 0 0 5 0 0 -1 --json").out, "{\"answer\":\"undecided\",\"reason\":\"numeric\"}\n");
}

TEST_F(Ask, WhatIsNotCoveredSaysWhere) {
  Answer uncovered = answer(Verdict::undecided, UndecidedReason::not_covered);
  uncovered.uncovered = Uncovered{.point = {0, 0, 8}, .covered_m = 3};
  answer_rays(uncovered);
  const Ran ran = at_terminal("ray 0 0 5 0 0 1");
  EXPECT_EQ(ran.code, 3);
  EXPECT_EQ(ran.out,
            "undecided: not_covered; it reaches out of what the server's geometry covers, at 0 0 8 (3 m on)\n");
  EXPECT_EQ(collide("ray 0 0 5 0 0 1 --json").out,
            "{\"answer\":\"undecided\",\"reason\":\"not_covered\",\"covered\":3,\"covered_to\":[0,0,8]}\n");
}

TEST_F(Ask, EverySpellingOfARayIsTheSameRay) {
  answer_rays(shelf());
  for (const char* words : {"ray 0,0,5 0,0,-1", "ray 0,0,5 0 0 -1", "ray 0 0 5 --to 0 0 4", "ray --to 0,0,4 0 0 5",
                            "ray 0 0 5000mm 0 0 -1", "ray -- 0 0 5 0 0 -1"}) {
    EXPECT_EQ(collide(words).code, 0) << words;
    EXPECT_EQ(last_ray.origin, Vec3(0, 0, 5)) << words;
    EXPECT_EQ(last_ray.direction, Vec3(0, 0, -1)) << words;
  }
  EXPECT_EQ(collide("ray -.5 -1e-3 +3 -0 -1 -.0 --length -1").code, 2);
  EXPECT_EQ(collide("ray -.5 -1e-3 +3 -0 -1 -.0 --length 2in").code, 0);
  EXPECT_EQ(last_ray.origin, Vec3(-0.5, -0.001, 3));
  EXPECT_EQ(last_ray.length_m, 0.0508);
}

TEST_F(Ask, OptionsReachTheServer) {
  answer_rays(shelf());
  collide(
      "ray 0 0 5 0 0 -1 --all --only 'pallet_*' --skip p9 --mask 0x6 --within 1um --deadline 200us --timeout 3s "
      "--max-hits 7 --fresh");
  const AskOptions& options = fake::server().last_options;
  EXPECT_EQ(options.mode, HitMode::all);
  EXPECT_EQ(options.only, "pallet_*");
  EXPECT_EQ(options.skip, "p9");
  EXPECT_EQ(options.mask, 6U);
  EXPECT_EQ(options.error_m, 1e-6);
  EXPECT_EQ(options.deadline, std::chrono::microseconds(200));
  EXPECT_EQ(options.timeout, std::chrono::seconds(3));
  EXPECT_EQ(options.max_hits, 7U);
  EXPECT_TRUE(options.fresh);
}

TEST_F(Ask, AllHitsComeInOrder) {
  answer_rays(fake::hit_answer({fake::hit("pallet_07", 1.91, {1, 1, 3}), fake::hit("pallet_11", 3.02, {2, 2, 2})}));
  EXPECT_EQ(collide("ray 0 0 5 --to 4 4 0 --all --json --fields object,order").out,
            "{\"object\":\"pallet_07\",\"order\":0}\n{\"object\":\"pallet_11\",\"order\":1}\n");
}

TEST_F(Ask, ASphereOnATerminalIsATable) {
  fake::server().sphere = [](const SphereQuestion& sphere, const AskOptions&) {
    EXPECT_EQ(sphere.center, Vec3(1, 2, 0.5));
    EXPECT_EQ(sphere.radius_m, 0.3);
    return fake::hit_answer({fake::hit("pallet_07", 0.0412, {0.93, 2, 0.5}), fake::hit("drone_2", 0, {1.3, 2, 0.5})});
  };
  EXPECT_EQ(at_terminal("sphere 1 2 0.5 300mm").out,
            "OBJECT     WHAT      DEPTH     CONTACT\n"
            "pallet_07  contact   0.0412 m  0.93 2 0.5\n"
            "drone_2    touching  0         1.3 2 0.5\n");
  EXPECT_EQ(at_terminal("sphere 1 2 0.5 0.3 --count").out, "2\n");
  EXPECT_EQ(collide("sphere 1 2 0.5 0.3 --count").out, "2\n");
  EXPECT_EQ(collide("sphere 1 2 0.5 0.3 --json --fields object,depth").out,
            "{\"object\":\"pallet_07\",\"depth\":0.0412}\n{\"object\":\"drone_2\",\"depth\":0}\n");
}

TEST_F(Ask, NothingIsWiderThanANarrowTerminal) {
  fake::server().sphere = [](const SphereQuestion&, const AskOptions&) {
    return fake::hit_answer({fake::hit("factory/hall_2/conveyor_17/roller_003", 0.0412, {0.93, 2, 0.5})});
  };
  for (const int columns : {80, 50}) {
    for (const char* words : {"ray 0 0 5 0 0 -1", "sphere 1 2 0.5 0.3", "near 0 0 0 -k 3", "status"}) {
      std::istringstream out(at_terminal(words, columns).out);
      for (std::string line; std::getline(out, line);)
        EXPECT_LE(cli::columns_of(line), static_cast<std::size_t>(columns)) << words << ": " << line;
    }
  }
  EXPECT_EQ(at_terminal("sphere 1 2 0.5 0.3", 50).out,
            "OBJECT               WHAT     DEPTH     CONTACT\n"
            "factory/h…oller_003  contact  0.0412 m  0.93 2 0.5\n");
}

TEST_F(Ask, VerboseSaysEveryDigitAndItsBound) {
  fake::server().ray = [](const RayQuestion&, const AskOptions&) {
    return fake::hit_answer({fake::hit("shelf_3/top", 3.8, {0, 0, 1.2000000000000002})});
  };
  const std::string sentence = "hit  shelf_3/top  distance 3.8 m ±4.4e-16  at 0 0 1.2000000000000002  normal 0 0 1";
  EXPECT_EQ(at_terminal("ray 0 0 5 0 0 -1 -v").out.substr(0, sentence.size()), sentence);
}

TEST_F(Ask, PlainOutputNamesItsColumnsWhenAskedTo) {
  fake::server().ray = [](const RayQuestion&, const AskOptions&) {
    return fake::hit_answer({fake::hit("shelf_3/top", 3.8, {0, 0, 1.2000000000000002})});
  };
  EXPECT_EQ(collide("ray 0 0 5 0 0 -1 --header --fields object,distance").out, "object\tdistance\nshelf_3/top\t3.8\n");
  const std::string fields = collide("ray 0 0 5 0 0 -1 --fields help").out;
  EXPECT_EQ(fields.substr(0, fields.find("point")), "answer\nobject\ndistance\nerror\n");
}

TEST_F(Ask, ABoxIsTwoCornersOrACentreAndASize) {
  BoxQuestion last;
  fake::server().box = [&](const BoxQuestion& box, const AskOptions&) {
    last = box;
    return fake::hit_answer({});
  };
  EXPECT_EQ(collide("box -1 -1 -1  1 1 1").code, 1);
  EXPECT_EQ(last.center, Vec3(0, 0, 0));
  EXPECT_EQ(last.half_m, Vec3(1, 1, 1));
  EXPECT_EQ(collide("box --center 1 2 3 --size 2 4 6 --rpy 0 0 90deg").code, 1);
  EXPECT_EQ(last.center, Vec3(1, 2, 3));
  EXPECT_EQ(last.half_m, Vec3(1, 2, 3));
  EXPECT_NEAR((last.rotation * Vec3(1, 0, 0) - Vec3(0, 1, 0)).norm(), 0, 1e-15);
  EXPECT_EQ(collide("box 1 1 1 0 0 0").err,
            "error: box: corners 1 1 1 and 0 0 0: the first must be the lower one on every axis\n");
}

TEST_F(Ask, NearAsksForAsManyAsK) {
  fake::server().near = [](const NearQuestion& near, const AskOptions& options) {
    EXPECT_EQ(options.max_hits, 3U);
    EXPECT_EQ(near.within_m, 5);
    return fake::hit_answer({fake::hit("drone_2", 0.412, {0.4, 0, 0})});
  };
  EXPECT_EQ(at_terminal("near 0 0 0 -k 3 --reach 5").out, "drone_2  distance 0.412 m  at 0.4 0 0\n");
}

TEST_F(Ask, RepeatAsksThatOften) {
  int asked = 0;
  fake::server().ray = [&](const RayQuestion&, const AskOptions&) {
    ++asked;
    return shelf();
  };
  EXPECT_EQ(collide("ray 0 0 5 0 0 -1 --repeat 3 --every 1ms").code, 0);
  EXPECT_EQ(asked, 3);
}

TEST_F(Ask, AStandingQuestionPrintsOnlyWhatChanges) {
  int asked = 0;
  fake::server().sphere = [&](const SphereQuestion&, const AskOptions&) {
    ++fake::server().version;
    ++asked;
    if (asked <= 3) return fake::hit_answer({fake::hit("wall", 0.01, {1, 0, 0})});
    if (asked <= 5) return fake::hit_answer({fake::hit("wall", 0.01, {1, 0, 0}), fake::hit("drone", 0.02, {0, 1, 0})});
    if (asked == 6) return answer(Verdict::undecided, UndecidedReason::deadline);
    return fake::hit_answer({fake::hit("drone", 0.02, {0, 1, 0})});
  };
  const Ran ran = collide("sphere 0 0 0 1 --watch --every 1ms -n 5 --fields change,object,depth,reason");
  EXPECT_EQ(ran.out,
            "enter\twall\t0.01\t\n"
            "enter\tdrone\t0.02\t\n"
            "undecided\t\t\tdeadline\n"
            "decided\t\t\t\n"
            "exit\twall\t\t\n");
  EXPECT_EQ(ran.code, 0);
}

}  // namespace
}  // namespace collided
