#include <gtest/gtest.h>

#include "tests/cli/fakes/fake_client.hpp"
#include "tests/cli/scratch_file.hpp"
#include "tests/cli/terminal.hpp"

namespace collided {
namespace {

/// Whatever is at x above 1 touches.
class WhatIfVerb : public testing::Test {
 protected:
  void SetUp() override {
    fake::reset();
    requests = 0;
    fake::server().what_if = [](const WhatIfConfigurations& given, const WhatIfOptions& options) {
      ++requests;
      last = given;
      last_options = options;
      WhatIfAnswers answers;
      answers.version = 7;
      for (std::size_t i = 0; i < given.poses.size(); i += given.objects.size()) {
        ConfigurationAnswer& answer = answers.configurations.emplace_back();
        const double x = given.poses[i].position.x();
        if (x > 1) answer.verdict = Verdict::hit;
        if (x > 1 || options.with_clearance)
          answer.nearest = ClearancePair{.a = given.objects[0], .b = "wall", .clearance_m = 1 - x, .error_m = 1e-15};
      }
      return answers;
    };
  }
  static Ran with_input(const std::string& words, const std::string& in) {
    return collide(words, {.out_is_terminal = false, .err_is_terminal = false, .in = in, .environment = {}});
  }

  static inline int requests;
  static inline WhatIfConfigurations last;
  static inline WhatIfOptions last_options;
};

constexpr const char* kPlan =
    "config,name,x,y,z\nhome,hand,0,0,1\nhome,elbow,0,0,0.5\nreach,elbow,0,0,0.7\nreach,hand,2,0,1\n";

TEST_F(WhatIfVerb, RowsOfOneConfigurationBelongTogetherInAnyOrder) {
  const Ran ran = with_input("what-if -", kPlan);
  EXPECT_EQ(ran.code, 1);
  EXPECT_EQ(ran.out, "home\tfree\t\t\t\nreach\ttouching\thand\twall\t\n");
  EXPECT_EQ(ran.err, "2 configurations  free 1  touching 1  undecided 0  refused 0\n");
  EXPECT_EQ(requests, 1);
  EXPECT_EQ(last.objects, (std::vector<std::string>{"hand", "elbow"}));
  ASSERT_EQ(last.poses.size(), 4u);
  EXPECT_EQ(last.poses[2].position, Vec3(2, 0, 1));
  EXPECT_EQ(last.poses[3].position, Vec3(0, 0, 0.7));
}

TEST_F(WhatIfVerb, ConfigurationsComeAsJsonToo) {
  const Ran ran = with_input("what-if - --clearance --json --fields config,answer,a,b,clearance",
                             "{\"config\":\"p\",\"poses\":{\"hand\":[0.5,0,0,1,0,0,0]}}\n\n"
                             "{\"poses\":{\"hand\":[0.25,0,0]}}\n");
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(ran.out,
            "{\"config\":\"p\",\"answer\":\"free\",\"a\":\"hand\",\"b\":\"wall\",\"clearance\":0.5}\n"
            "{\"config\":\"3\",\"answer\":\"free\",\"a\":\"hand\",\"b\":\"wall\",\"clearance\":0.75}\n");
  EXPECT_TRUE(last_options.with_clearance);
}

TEST_F(WhatIfVerb, WhatIsWrongIsRefusedForItselfAndTheRestIsAsked) {
  const Ran ran = with_input("what-if - -q",
                             "config,name,x,y,z,qw,qx,qy,qz\n1,hand,0,0,0,1,0,0,0\n2,hand,nan,0,0,1,0,0,0\n"
                             "3,hand,0,0,0,2,0,0,0\n4,foot,0,0,0,1,0,0,0\n5,hand,0,0,0,1,0,0,0\n"
                             "5,hand,0,0,0,1,0,0,0\n6,hand,0.5,0,0,1,0,0,0\n");
  EXPECT_EQ(ran.code, 6);
  EXPECT_NE(ran.err.find("stdin line 3: 'nan' in column x"), std::string::npos) << ran.err;
  EXPECT_NE(ran.err.find("object 'foot' is not in the first configuration"), std::string::npos) << ran.err;
  EXPECT_NE(ran.err.find("object 'hand' has two poses"), std::string::npos) << ran.err;
  EXPECT_NE(ran.out.find("6\tfree"), std::string::npos) << ran.out;
  EXPECT_EQ(with_input("what-if -", "config,nam,x,y,z\n").code, 2);
  const Ran bad_json = with_input("what-if - -q", "{\"poses\":{\"hand\":[1,2]}}\n{\"poses\":\n");
  EXPECT_EQ(bad_json.code, 6);
  EXPECT_NE(bad_json.err.find("stdin line 1: 'hand' must hold 3 or 7 numbers"), std::string::npos) << bad_json.err;
  EXPECT_NE(bad_json.err.find("stdin line 2: column"), std::string::npos) << bad_json.err;
  EXPECT_EQ(requests, 1);
}

TEST_F(WhatIfVerb, OptionsBecomeWhatTheLibraryTakes) {
  const Ran ran = with_input(
      "what-if - --against 'cell/*' --skip 'x*' --mask 0x3 --clearance --nearer 5mm --attach crate=hand --attach a=b "
      "--deadline 2s --importance low --as-of settled --with-filtered --fresh",
      kPlan);
  EXPECT_EQ(ran.code, 1) << ran.err;
  EXPECT_EQ(last_options.against, "cell/*");
  EXPECT_EQ(last_options.skip, "x*");
  EXPECT_EQ(last_options.mask, 3u);
  EXPECT_EQ(last_options.nearer_m, 0.005);
  EXPECT_EQ(last_options.attached, (std::vector<std::pair<std::string, std::string>>{{"crate", "hand"}, {"a", "b"}}));
  EXPECT_EQ(last_options.deadline, std::chrono::seconds(2));
  EXPECT_EQ(last_options.importance, Importance::low);
  EXPECT_TRUE(last_options.with_filtered && last_options.fresh);
  for (const char* words : {"what-if", "what-if a b", "what-if - --nearer 5mm", "what-if - --attach crate",
                            "what-if - --attach =hand", "what-if /no/such/file"}) {
    EXPECT_EQ(with_input(words, kPlan).code, 2) << words;
  }
}

// A robot of one joint that slides along x, so that its position is where the link is.
TEST_F(WhatIfVerb, ARobotsJointsBecomePosesOfItsLinks) {
  const ScratchFile file("slider.urdf",
                         R"(<robot name="slider"><link name="rail"/><link name="cart"/><link name="lamp"/>
    <joint name="drive" type="prismatic"><parent link="rail"/><child link="cart"/><axis xyz="1 0 0"/>
      <limit lower="0" upper="2" effort="1" velocity="1"/></joint>
    <joint name="post" type="fixed"><parent link="cart"/><child link="lamp"/><origin xyz="0 0 1"/></joint></robot>)");
  std::string asked_for;
  fake::server().command = [&](const std::string& name, const nlohmann::json& arguments, const Shape&) {
    asked_for = name + " " + arguments.value("name", "");
    const auto row = [](const std::string& link) {
      return R"({"name":"slider/)" + link + R"(","id":1,"kind":"box","moving":true,"scene":"slider","publisher":"",
                "position":[0,0,0],"triangles":0,"layers":1,"stale":false})";
    };
    return Result<std::string>(R"({"count":2,"version":3,"objects":[)" + row("lamp") + "," + row("cart") + "]}");
  };
  const std::string words = "what-if --robot " + file.path() + " --joints - --at 0,5,0 ";
  const Ran ran = with_input(words, "config,drive\nleft,50cm\nright,1.5\nstays,\nbeyond,3\n");
  EXPECT_EQ(asked_for, "list slider/*");
  EXPECT_EQ(ran.code, 6) << ran.err;
  EXPECT_EQ(ran.out, "left\tfree\t\t\t\nright\ttouching\tslider/cart\twall\t\nstays\ttouching\tslider/cart\twall\t\n");
  EXPECT_NE(ran.err.find("stdin line 5: joint 'drive': 3 m is beyond its limits, allowed 0 to 2"), std::string::npos)
      << ran.err;
  EXPECT_EQ(last.objects, (std::vector<std::string>{"slider/cart", "slider/lamp"}));
  ASSERT_EQ(last.poses.size(), 6u);
  EXPECT_EQ(last.poses[0].position, Vec3(0.5, 5, 0));
  EXPECT_EQ(last.poses[1].position, Vec3(0.5, 5, 1));
  EXPECT_EQ(with_input(words + "--beyond-limits", "drive\n3\n").code, 1);
  EXPECT_EQ(with_input(words, "drv\n3\n").code, 2);
  EXPECT_EQ(with_input("what-if --robot " + file.path(), "").code, 2);
  EXPECT_EQ(with_input("what-if plan.csv --joints -", "").code, 2);
  EXPECT_EQ(with_input("what-if - --beyond-limits", kPlan).code, 2);
}

}  // namespace
}  // namespace collided
