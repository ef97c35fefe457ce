#include <gtest/gtest.h>

#include "client/cli/io.hpp"
#include "tests/cli/fakes/fake_client.hpp"
#include "tests/cli/terminal.hpp"

namespace collided {
namespace {

class ClearanceVerb : public testing::Test {
 protected:
  void SetUp() override {
    fake::reset();
    last_from.clear();
    fake::server().clearance = [](const std::string& from, const ClearanceOptions& options) {
      last_from = from;
      last_options = options;
      return next;
    };
    next = {};
    next.version = 7;
    next.from_count = 2;
    next.to_count = 3;
    next.pairs.push_back({.a = "robot/hand",
                          .b = "cell/wall",
                          .clearance_m = 0.0124,
                          .error_m = 1e-13,
                          .on_a = {1, 0, 0},
                          .on_b = {1.0124, 0, 0},
                          .normal = {1, 0, 0}});
  }

  static inline std::string last_from;
  static inline ClearanceOptions last_options;
  static inline ClearanceAnswer next;
};

TEST_F(ClearanceVerb, TheNearestPairIsARowForPeopleAndALineForPrograms) {
  const Ran ran = at_terminal("clearance 'robot/*' --to 'cell/*'");
  EXPECT_EQ(ran.code, 0);
  EXPECT_EQ(ran.out,
            "A           B                 CLEARANCE  ON A   ON B\n"
            "robot/hand  cell/wall  apart  0.0124 m   1 0 0  1.0124 0 0\n");
  EXPECT_EQ(last_from, "robot/*");
  EXPECT_EQ(last_options.to, "cell/*");
  EXPECT_EQ(last_options.most, 1u);
  EXPECT_EQ(collide("clearance 'robot/*'").out, "robot/hand\tcell/wall\tapart\t0.0124\t1e-13\n");
  EXPECT_EQ(last_options.to, "");
  const Ran csv = collide("clearance 'robot/*' --csv --fields a,b,on_b,certificate");
  EXPECT_EQ(csv.out, "a,b,on_b_x,on_b_y,on_b_z,certificate\nrobot/hand,cell/wall,1.0124,0,0,\n");
}

TEST_F(ClearanceVerb, TheExitCodeSaysWhetherThereIsAPairAndWhetherThatIsCertain) {
  next.verdict = Verdict::hit;
  EXPECT_EQ(collide("clearance a").code, 0);
  next.late = true;
  EXPECT_EQ(collide("clearance a").code, 3);
  next.late = false;
  next.verdict = Verdict::undecided;
  EXPECT_EQ(collide("clearance a").code, 3);
  next.verdict = Verdict::miss;
  next.pairs.clear();
  const Ran none = at_terminal("clearance a --to b --nearer 5mm");
  EXPECT_EQ(none.code, 1);
  EXPECT_EQ(none.out, "no pair of a and b is nearer than 0.005 m\n");
  EXPECT_EQ(at_terminal("clash").out, "no pair of * and * touches\n");
  EXPECT_EQ(collide("clash").out, "");
}

// With a distance all pairs up to it are wanted, not only the nearest.
TEST_F(ClearanceVerb, OptionsBecomeWhatTheLibraryTakes) {
  EXPECT_EQ(collide("clearance a --nearer 5mm --skip 'b*' --with-filtered --as-of settled --deadline 2s").code, 0);
  EXPECT_EQ(last_options.nearer_m, 0.005);
  EXPECT_EQ(last_options.most, 10'000u);
  EXPECT_EQ(last_options.skip, "b*");
  EXPECT_TRUE(last_options.with_filtered);
  EXPECT_EQ(last_options.as_of.kind, Instant::Kind::settled);
  EXPECT_EQ(last_options.deadline, std::chrono::seconds(2));
  collide("clearance a --within 5mm -k 3");
  EXPECT_EQ(last_options.most, 3u);
  collide("clash plant");
  EXPECT_EQ(last_from, "plant");
  EXPECT_EQ(last_options.to, "plant");
  EXPECT_EQ(last_options.nearer_m, 0);
  EXPECT_EQ(last_options.most, 10'000u);
  collide("clash --certificate --nearer 1cm");
  EXPECT_EQ(last_from, "*");
  EXPECT_EQ(last_options.most, 1'000u);
  EXPECT_TRUE(last_options.certificate);
}

TEST_F(ClearanceVerb, WhatCannotBeMeantIsRefusedBeforeAnythingIsSent) {
  for (const char* words : {"clearance", "clearance a b", "clearance a --nearer -1", "clearance a -k 0",
                            "clearance a -k 10001", "clash --certificate -k 1001", "clearance a --nearer inf"}) {
    EXPECT_EQ(collide(words).code, 2) << words;
  }
  EXPECT_EQ(last_from, "");
}

// A certificate that does not prove its answer is worse than none.
TEST_F(ClearanceVerb, CertificatesAreCheckedHere) {
  const auto ball = [](double x) {
    return CertifiedPart{.summand = CertifiedPart::Summand::ball, .points = {{x, 0, 0}}, .radius_m = 1};
  };
  Certificate proof;
  proof.a = {ball(0)};
  proof.b = {ball(3)};
  proof.steps = {{.kind = Certificate::Step::Kind::plane, .normal = {1, 0, 0}, .point = {1.5, 0, 0}}};
  next.pairs[0].certificate = proof;
  const Ran proved = at_terminal("clearance a --certificate");
  EXPECT_EQ(proved.code, 0);
  EXPECT_NE(proved.out.find("proved"), std::string::npos) << proved.out;
  EXPECT_EQ(proved.err, "proved here: 1 of 1 pairs\n");
  next.pairs[0].certificate->steps[0].point = {0.5, 0, 0};
  const Ran lie = collide("clearance a --certificate");
  EXPECT_EQ(lie.code, 3);
  EXPECT_EQ(lie.out, "");
}

// The server tells how far it is, and whoever waits may end it there.
TEST_F(ClearanceVerb, CtrlCEndsALongOneAtTheNextSignOfProgress) {
  bool was_told = false;
  fake::server().clearance = [&](const std::string&, const ClearanceOptions& options) {
    options.progress(0.25);
    was_told = true;
    cli::stop_requested = true;
    options.progress(0.5);
    return next;
  };
  EXPECT_EQ(collide("clash").code, 130);
  EXPECT_TRUE(was_told);
}

TEST_F(ClearanceVerb, WhatIsNotCoveredLeavesItUndecided) {
  next.verdict = Verdict::undecided;
  next.reason = UndecidedReason::not_covered;
  next.uncovered = Vec3(3, 0, 0);
  const Ran ran = at_terminal("clearance robot");
  EXPECT_EQ(ran.code, 3);
  EXPECT_NE(ran.err.find("what is near 3 0 0 is not covered"), std::string::npos) << ran.err;
  EXPECT_EQ(collide("clash plant --unit mm").code, 2);
}

}  // namespace
}  // namespace collided
