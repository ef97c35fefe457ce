#include <gtest/gtest.h>

#include "tests/cli/fakes/fake_client.hpp"
#include "tests/cli/terminal.hpp"

namespace collided {
namespace {

CertifiedPart ball(double x, double radius_m) {
  return {.summand = CertifiedPart::Summand::ball, .points = {{x, 0, 0}}, .radius_m = radius_m};
}

class PairVerb : public testing::Test {
 protected:
  void SetUp() override {
    fake::reset();
    fake::server().pair = [](const std::string& a, const std::string& b, const PairOptions& options) {
      names = a + " " + b;
      last_options = options;
      return next;
    };
    next = {};
    next.version = 7;
    next.normal = {1, 0, 0};
    next.distance_m = 0.0124;
    next.error_m = 1e-13;
    next.on_a = {1, 0, 0};
    next.on_b = {1.0124, 0, 0};
  }

  static inline std::string names;
  static inline PairOptions last_options;
  static inline PairAnswer next;
};

TEST_F(PairVerb, ApartReadsAsASentence) {
  const Ran ran = at_terminal("pair crate shelf");
  EXPECT_EQ(ran.code, 1);
  EXPECT_EQ(ran.out, "apart  0.0124 m  nearest 1 0 0 | 1.0124 0 0\n");
  EXPECT_EQ(names, "crate shelf");
  EXPECT_FALSE(last_options.certificate);
}

// A script must not take a mistyped name for "apart", which is 1, whichever verb meets it.
TEST_F(PairVerb, AnUnknownNameIsRefusedAsByEveryVerb) {
  const Error unknown{ErrorCode::refused, "server refused: no object", ""};
  fake::server().pair = [&](const std::string&, const std::string&, const PairOptions&) -> Result<PairAnswer> {
    return unknown;
  };
  fake::server().command = [&](const std::string& name, const nlohmann::json&, const Shape&) -> Result<std::string> {
    if (name == "list") return std::string(R"({"objects":[{"name":"crate"}],"count":1,"version":5})");
    return unknown;
  };
  const std::string said = "error: object 'crte' is not in the world (1 object); nearest names: crate\n";
  for (const char* const words : {"pair crate crte", "pair crte crate", "get crte", "move crte 0 0 0", "rm crte -q"}) {
    const Ran ran = collide(words);
    EXPECT_EQ(ran.code, 5) << words;
    EXPECT_EQ(ran.err, said) << words;
  }
}

TEST_F(PairVerb, ZeroHasNoSignInAPipe) {
  next.normal = {-0.0, 1, -0.0};
  EXPECT_EQ(collide("pair crate shelf --fields normal").out, "0 1 0\n");
  EXPECT_EQ(collide("pair crate shelf --json --fields normal").out, "{\"normal\":[0,1,0]}\n");
}

TEST_F(PairVerb, TouchingTellsWhereTheyBear) {
  next.verdict = Verdict::hit;
  next.normal = {0, 0, 1};
  next.depth_m = 0.01;
  next.error_m = 1e-16;
  next.point = {1, 2, 0};
  next.manifold = {{.point = {1, 2, 0}, .depth_m = 0.01, .error_m = 1e-15}};
  const Ran ran = at_terminal("pair crate shelf");
  EXPECT_EQ(ran.code, 0);
  EXPECT_EQ(ran.out, "touching  depth 0.01 m  at 1 2 0  apart by 0 0 0.01\n  bears at 1 2 0  0.01 m deep\n");
  next.verdict = Verdict::undecided;
  EXPECT_EQ(collide("pair crate shelf").code, 3);
}

TEST_F(PairVerb, AnotherOpinionStandsBesideOurs) {
  next.verdict = Verdict::miss;
  collide("pair crate shelf");
  EXPECT_EQ(last_options.opinion, "");
  const auto line = [](const SecondOpinion& opinion) {
    next.opinion = opinion;
    const std::string out = at_terminal("pair crate shelf --opinion fcl").out;
    return out.substr(out.find('\n') + 1);
  };
  EXPECT_EQ(line({.verdict = OpinionVerdict::agree, .touches = false, .distance_m = 0.0124}),
            "  FCL: agree  apart 0.0124 m\n");
  EXPECT_EQ(last_options.opinion, "fcl");
  EXPECT_EQ(line({.verdict = OpinionVerdict::differ, .touches = false, .distance_m = 0.0125}),
            "  FCL: differ  apart 0.0125 m, ours: apart 0.0124 m\n");
  EXPECT_EQ(line({.verdict = OpinionVerdict::differ, .touches = true}),
            "  FCL: differ  touching, ours: apart 0.0124 m\n");
  EXPECT_EQ(line({.verdict = OpinionVerdict::failed, .why = "FCL was ended by signal 6"}),
            "  FCL: failed  FCL was ended by signal 6\n");
  EXPECT_EQ(line({.verdict = OpinionVerdict::unsupported, .why = "two half-spaces"}),
            "  FCL: unsupported  two half-spaces\n");
  next.opinion = {.verdict = OpinionVerdict::differ, .touches = false, .distance_m = 0.5};
  EXPECT_EQ(
      collide("pair crate shelf --opinion fcl --json --fields opinion,opinion_answer,opinion_distance,opinion_why").out,
      "{\"opinion\":\"differ\",\"opinion_answer\":\"apart\",\"opinion_distance\":0.5}\n");
  const Ran refused = collide("pair crate shelf --opinion bullet");
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find("--opinion bullet: allowed is fcl"), std::string::npos) << refused.err;
}

TEST_F(PairVerb, BothAreAskedForAtOneInstant) {
  collide("pair crate shelf");
  EXPECT_EQ(last_options.as_of.kind, Instant::Kind::latest);
  collide("pair crate shelf --as-of settled");
  EXPECT_EQ(last_options.as_of.kind, Instant::Kind::settled);
  collide("pair crate shelf --as-of -2s");
  EXPECT_EQ(last_options.as_of.kind, Instant::Kind::back);
  EXPECT_EQ(last_options.as_of.time, std::chrono::seconds(2));
  const Ran noon = collide("pair crate shelf --as-of noon");
  EXPECT_EQ(noon.code, 2);
  EXPECT_EQ(noon.err,
            "error: pair: --as-of 'noon' is no time\n       latest, settled, -2s, 2026-11-22T12:03:10.5Z or seconds "
            "since 1970\n");
}

TEST_F(PairVerb, WhatIsNotKnownOfALostObjectShows) {
  next.stale = true;
  EXPECT_EQ(at_terminal("pair crate shelf").out,
            "apart  0.0124 m  nearest 1 0 0 | 1.0124 0 0\n  stale: one of them is where it was heard of last, "
            "and moved then\n");
  next.verdict = Verdict::undecided;
  next.reason = UndecidedReason::stale_object;
  EXPECT_EQ(at_terminal("pair crate shelf").out,
            "undecided: stale_object; an object that decides has not been heard of lately\n");
  EXPECT_EQ(collide("pair crate shelf --fields answer,reason,stale").out, "undecided\tstale_object\ttrue\n");
  next.reason = UndecidedReason::numeric;
  next.stale = false;
  EXPECT_EQ(at_terminal("pair crate shelf").out, "undecided: numeric; both answers are consistent with the input\n");
}

TEST_F(PairVerb, ACertificateIsCheckedHere) {
  next.certificate =
      Certificate{.a = {ball(0, 1)}, .b = {ball(3, 1)}, .steps = {{.normal = {1, 0, 0}, .point = {1.5, 0, 0}}}};
  const Ran ran = collide("pair crate shelf --certificate --fields answer,certificate");
  EXPECT_EQ(ran.code, 1);
  EXPECT_EQ(ran.out, "apart\tproved\n");
  EXPECT_EQ(ran.err, "proved here: 1 plane between 1 and 1 parts\n");
  EXPECT_TRUE(last_options.certificate);
}

// A server that is wrong, or lies, does not get its answer printed.
TEST_F(PairVerb, AWrongCertificateIsRefused) {
  next.certificate =
      Certificate{.a = {ball(0, 1)}, .b = {ball(1.5, 1)}, .steps = {{.normal = {1, 0, 0}, .point = {1, 0, 0}}}};
  const Ran ran = collide("pair crate shelf --certificate");
  EXPECT_EQ(ran.code, 3);
  EXPECT_EQ(ran.out, "");
  EXPECT_EQ(ran.err.find("error: the server's certificate does not prove its answer"), 0u) << ran.err;
  next.certificate->touches = true;
  EXPECT_EQ(collide("pair crate shelf --certificate").code, 3);
  // One that proves the other answer is not believed either.
  next.certificate = Certificate{.touches = true,
                                 .a = {ball(0, 1)},
                                 .b = {ball(2, 1)},
                                 .point = {Certificate::Sum{1}, {}, {}},
                                 .divisor = {1},
                                 .mix_a = {{0, {1}}},
                                 .mix_b = {{0, {1}}}};
  EXPECT_EQ(collide("pair crate shelf --certificate").code, 3);
}

TEST_F(PairVerb, TrianglesAreRowsAndACutIsSaid) {
  next.verdict = Verdict::hit;
  next.triangle_pairs = {{.a_triangle = 3, .b_triangle = 5, .from = {0, 0, 0}, .to = {1, 0, 0}, .error_m = 1e-16}};
  next.triangle_pair_count = 12'000;
  next.cut = true;
  const Ran ran = collide("pair a b --triangles --most 1");
  EXPECT_EQ(ran.out, "3\t5\t0 0 0\t1 0 0\t1e-16\n");
  EXPECT_EQ(ran.err, "cut: 1 of 12 000 pairs of triangles; --most tells more, up to 100 000\n");
  EXPECT_TRUE(last_options.triangles);
  EXPECT_EQ(last_options.most_triangle_pairs, 1u);
}

TEST_F(PairVerb, TwoNamesAreNeeded) {
  EXPECT_EQ(collide("pair crate").code, 2);
  EXPECT_EQ(collide("pair a b c").code, 2);
}

class ProbeVerb : public testing::Test {
 protected:
  void SetUp() override {
    fake::reset();
    fake::server().readings = {{.probe = "front",
                                .object = "car",
                                .state = Clearance::gap,
                                .clearance_m = 0.12,
                                .error_m = 1e-15,
                                .met = "road"},
                               {.probe = "rear",
                                .object = "car",
                                .state = Clearance::collision,
                                .clearance_m = -0.003,
                                .error_m = 1e-15,
                                .met = "road"},
                               {.probe = "lost", .object = "", .state = Clearance::absent, .met = ""}};
  }
};

TEST_F(ProbeVerb, IsFixedToAnObjectAndRemoved) {
  EXPECT_EQ(collide("probe front --on car 1.2 70cm -.5 0 0 -1 --reach inf --back 20cm").code, 0);
  ASSERT_EQ(fake::server().probes.size(), 1u);
  const Probe& probe = fake::server().probes[0];
  EXPECT_EQ(probe.name + " " + probe.object, "front car");
  EXPECT_EQ(probe.origin, Vec3(1.2, 0.7, -0.5));
  EXPECT_EQ(probe.direction, Vec3(0, 0, -1));
  EXPECT_EQ(probe.back_m, 0.2);
  EXPECT_TRUE(std::isinf(probe.reach_m));
  EXPECT_EQ(collide("probe --rm front").code, 0);
  EXPECT_EQ(collide("probe --rm front").code, 1);
  EXPECT_EQ(collide("probe front 0 0 0 0 0 -1").code, 2) << "on what?";
  EXPECT_EQ(collide("probe front --on car 0 0 0").code, 2);
  EXPECT_EQ(collide("probe front --on car 0 0 0 0 0 0").code, 2);
  EXPECT_EQ(collide("probe front --on car 0 0 0 0 0 nan").code, 2);
}

TEST_F(ProbeVerb, ANameThatNothingHasIsSaid) {
  fake::server().command = [](const std::string&, const nlohmann::json&, const Shape&) -> Result<std::string> {
    return std::string(R"({"objects":[{"name":"car"},{"name":"road"}],"count":2,"version":5})");
  };
  EXPECT_EQ(collide("probe front --on car 0 0 0 0 0 -1").err, "");
  const Ran ran = collide("probe front --on cra 0 0 0 0 0 -1");
  EXPECT_EQ(ran.code, 0) << "it waits for its object";
  EXPECT_EQ(ran.err,
            "object 'cra' is not in the world (2 objects); nearest names: car. The probe reads 'absent' until it is\n");
}

TEST_F(ProbeVerb, ReadingsAreRecords) {
  EXPECT_EQ(collide("probe --fields probe,state,clearance,met").out,
            "front\tgap\t0.12\troad\nrear\tcollision\t-0.003\troad\nlost\tabsent\t\t\n");
  const Ran ran = collide("probe --watch -n 2 --fields probe,clearance");
  EXPECT_EQ(ran.code, 0);
  EXPECT_EQ(ran.out, "front\t0.12\nrear\t-0.003\n");
}

TEST_F(ProbeVerb, AFollowedOneReadsAsALine) {
  const Ran ran = at_terminal("probe --watch -n 2");
  EXPECT_NE(ran.out.find("front  gap  +0.12 m  to road\n"), std::string::npos) << ran.out;
  EXPECT_NE(ran.out.find("rear  collision  -0.003 m  in road\n"), std::string::npos) << ran.out;
}

}  // namespace
}  // namespace collided
