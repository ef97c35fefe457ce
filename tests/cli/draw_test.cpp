#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "idl/answers/standing.hpp"
#include "idl/described_json.hpp"
#include "tests/cli/fakes/fake_client.hpp"
#include "tests/cli/scratch_file.hpp"
#include "tests/cli/terminal.hpp"

namespace collided {
namespace {

/// A box in an empty world; nothing hides anything unless a test says so.
class DrawVerb : public testing::Test {
 protected:
  void SetUp() override {
    fake::reset();
    fake::server().shapes = [](const ShapesOptions& options) {
      asked = options;
      return shown;
    };
    fake::server().command = [](const std::string& name, const nlohmann::json&, const Shape&) -> Result<std::string> {
      EXPECT_EQ(name, "fences");
      return fences;
    };
    fences = R"({"standing":[]})";
    shown = {};
    shown.objects.push_back(
        {.id = 1, .name = "crate", .scene = {}, .pose = {}, .parts = {BoxShape{{1, 1, 1}}}, .runs = {}});
  }
  std::string path(const std::string& name) const { return file_.path() + name; }
  static std::string text_of(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
  }

  static OutlinedStanding region(const std::string& name, const std::string& carrier,
                                 const std::vector<std::vector<double>>& lines) {
    OutlinedStanding region;
    region.name = name;
    region.kind = "box";
    region.to = carrier;
    region.lines = lines;
    return region;
  }

  ScratchFile file_{"draw_", ""};
  static inline ShapesOptions asked;
  static inline std::string fences;  // the server's answer
  static inline ShownObjects shown;
};

TEST_F(DrawVerb, SaysWhatItWroteAndWhatItAsked) {
  const Ran ran = at_terminal("draw --style wireframe -o " + path("a.svg"));
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(ran.out.substr(0, ran.out.find(" kB")), "wrote " + path("a.svg") + "  12 edges, 1");
  EXPECT_NE(ran.out.find("0 visibility rays"), std::string::npos) << ran.out;
  EXPECT_TRUE(text_of(path("a.svg")).starts_with("<svg "));
  EXPECT_TRUE(asked.edges);
  const Ran plain = collide("draw -o " + path("b.png") + " --fields file,edges,undecided");
  EXPECT_EQ(plain.out, path("b.png") + "\t12\t0\n");
  EXPECT_EQ(text_of(path("b.png")).substr(1, 3), "PNG");
}

TEST_F(DrawVerb, WhatAnswersIsWhatIsDrawn) {
  ASSERT_EQ(collide("draw -o " + path("a.svg") + " --only 'cr*' --skip floor --mask 0x6 --crease 60deg").code, 0);
  EXPECT_EQ(asked.only, "cr*");
  EXPECT_EQ(asked.skip, "floor");
  EXPECT_EQ(asked.mask, 6U);
  EXPECT_NEAR(asked.crease_cosine, 0.5, 1e-15);
  EXPECT_EQ(fake::server().last_options.only, "cr*");
  EXPECT_EQ(fake::server().last_options.skip, "floor");
  EXPECT_EQ(fake::server().last_options.mask, 6U);
}

TEST_F(DrawVerb, WhatIsHiddenIsLeftOutOrLighter) {
  fake::server().ray = [](const RayQuestion&, const AskOptions&) {
    return fake::hit_answer({fake::hit("wall", 1, {0, 0, 0})});
  };
  ASSERT_EQ(collide("draw -o " + path("a.svg")).code, 0);
  EXPECT_EQ(text_of(path("a.svg")).find("<path"), std::string::npos);
  ASSERT_EQ(collide("draw --style obscured-line -o " + path("a.svg")).code, 0);
  EXPECT_NE(text_of(path("a.svg")).find("<path class=\"hidden\""), std::string::npos);
}

TEST_F(DrawVerb, UndecidedRaysAreCounted) {
  fake::server().ray = [](const RayQuestion&, const AskOptions&) {
    Answer answer;
    answer.verdict = Verdict::undecided;
    return answer;
  };
  const Ran ran = collide("draw -o " + path("a.svg") + " --fields rays,undecided");
  std::istringstream numbers(ran.out);
  std::uint64_t rays = 0, undecided = 1;
  numbers >> rays >> undecided;
  EXPECT_GT(rays, 1'000U);
  EXPECT_EQ(rays, undecided);
  EXPECT_NE(text_of(path("a.svg")).find("<path class=\"crease\""), std::string::npos) << "what is in doubt is drawn";
}

TEST_F(DrawVerb, OpenContactsAreRingsAsDeepAsTheyAre) {
  shown.objects.push_back(shown.objects[0]);
  shown.objects[1].name = "floor";
  fake::server().status.contacts = 2;
  for (const char* other : {"floor", "not drawn"}) {
    Event event;
    event.kind = EventKind::open;
    event.a = "crate";
    event.b = other;
    fake::server().events.push_back(event);
  }
  std::vector<std::string> pairs;
  fake::server().pair = [&](const std::string& a, const std::string& b, const PairOptions&) {
    pairs.push_back(a + " " + b);
    PairAnswer answer;
    answer.verdict = Verdict::hit;
    answer.normal = {0, 0, 1};
    answer.manifold = {{.point = {1, 1, -1}, .depth_m = 0.01}, {.point = {-1, 1, -1}, .depth_m = 0.3}};
    return answer;
  };
  const Ran ran = collide("draw -o " + path("a.svg") + " --fields contacts");
  EXPECT_EQ(ran.out, "2\n") << ran.err;
  EXPECT_EQ(pairs, std::vector<std::string>{"crate floor"});
  ASSERT_EQ(collide("draw --no-contacts -o " + path("a.svg")).code, 0);
  EXPECT_EQ(text_of(path("a.svg")).find("<circle"), std::string::npos);
}

// Two lines of one region in the world, which something is in, and one that an object carries; that of another object is
// left out with it.
TEST_F(DrawVerb, FencesAreDashedAndInTheAccentIfTheyAreEntered) {
  std::vector<OutlinedStanding> rows{region("dock", "", {{-1, -1, 2, 1, -1, 2}, {1, -1, 2, 1, 1, 2}}),
                                     region("zone", "crate", {{0, 0, 3, 1, 0, 3, 1, 1, 3}}),
                                     region("gone", "other", {{0, 0, 0, 1, 0, 0}})};
  rows[0].holds = {{.object = "ball"}};
  fences = nlohmann::json{{"standing", json_of(rows)}}.dump();
  ASSERT_EQ(collide("draw -o " + path("a.svg")).code, 0);
  const std::string svg = text_of(path("a.svg"));
  EXPECT_NE(svg.find("class=\"fence-entered\""), std::string::npos);
  EXPECT_NE(svg.find("class=\"fence\""), std::string::npos);
  const auto dashes = [&](const std::string& name) {
    const std::size_t begin = svg.find("class=\"" + name + "\"");
    const std::string mark = svg.substr(begin, svg.find("/>", begin) - begin);
    return std::count(mark.begin(), mark.end(), 'M');
  };
  EXPECT_GT(dashes("fence-entered"), 20);
  EXPECT_GT(dashes("fence"), 20);
  ASSERT_EQ(collide("draw --no-fences -o " + path("b.svg")).code, 0);
  EXPECT_EQ(text_of(path("b.svg")).find("fence"), std::string::npos);
  // If they cannot be listed the drawing is made all the same.
  fences = "no list";
  const Ran ran = collide("draw -o " + path("c.svg"));
  EXPECT_EQ(ran.code, 0);
  EXPECT_NE(ran.err.find("fences are not drawn"), std::string::npos) << ran.err;
}

// From the nearest point of the one to that of the other; two that touch have no line.
TEST_F(DrawVerb, WhatIsNearestIsALine) {
  ListedStanding listed;
  listed.name = "escape";
  listed.form = StandingForm::nearest;
  listed.to = "guest";
  listed.holds = {{.object = "door_1"}};
  fake::server().listed_standing = {listed};
  Verdict verdict = Verdict::miss;
  fake::server().pair = [&](const std::string& a, const std::string& b, const PairOptions&) {
    EXPECT_EQ(a + " " + b, "guest door_1");
    PairAnswer answer;
    answer.verdict = verdict;
    answer.distance_m = 2;
    answer.on_a = {-1, -1, 2};
    answer.on_b = {1, -1, 2};
    return answer;
  };
  ASSERT_EQ(collide("draw -o " + path("a.svg")).code, 0);
  EXPECT_NE(text_of(path("a.svg")).find("class=\"fence-entered\""), std::string::npos);
  verdict = Verdict::hit;
  ASSERT_EQ(collide("draw -o " + path("b.svg")).code, 0);
  EXPECT_EQ(text_of(path("b.svg")).find("fence"), std::string::npos);
}

TEST_F(DrawVerb, RaysAreAskedAndDrawn) {
  std::vector<Vec3> origins;
  fake::server().ray = [&](const RayQuestion& ray, const AskOptions& options) {
    if (options.mode != HitMode::closest) return Answer{};
    origins.push_back(ray.origin);
    return ray.direction.z() < 0 ? fake::hit_answer({fake::hit("crate", 3, {0, 0, 1})}) : Answer{};
  };
  ASSERT_EQ(collide("draw -o " + path("a.svg") + " --ray 0 0 4  0 0 -1 --ray 0 0 40cm 1 0 0").code, 0);
  EXPECT_EQ(origins, (std::vector<Vec3>{{0, 0, 4}, {0, 0, 0.4}}));
  const std::string svg = text_of(path("a.svg"));
  EXPECT_NE(svg.find("class=\"ray\""), std::string::npos);
  EXPECT_EQ(svg.find("class=\"ray-hit\""), svg.rfind("class=\"ray-hit\"")) << "one of the two met something";
}

TEST_F(DrawVerb, ThePlanInTheTerminalIsASquareFromAbove) {
  const Ran ran = collide("draw --term --width 16");
  EXPECT_EQ(ran.code, 0) << ran.err;
  std::istringstream lines(ran.out);
  std::vector<std::string> rows;
  for (std::string line; std::getline(lines, line);) rows.push_back(line);
  EXPECT_EQ(rows.size(), 8U) << "two dots a column, four a row\n" << ran.out;
  EXPECT_NE(ran.out.find("⠀"), std::string::npos);
}

TEST_F(DrawVerb, BadUseSaysWhatIsWrongBeforeAnythingIsAsked) {
  const auto error = [](const std::string& words) {
    const Ran ran = collide("draw " + words);
    EXPECT_EQ(ran.code, 2) << words;
    return ran.err.substr(0, ran.err.find('\n'));
  };
  EXPECT_EQ(error(""), "error: draw: where to? -o FILE.svg, -o FILE.png or --term");
  EXPECT_EQ(error("-o a.bmp"), "error: draw: 'a.bmp' is neither .svg nor .png");
  EXPECT_EQ(error("-o a.svg --style cubist"), "error: draw: no style 'cubist'");
  EXPECT_EQ(error("-o a.svg --up 0 0 0"), "error: draw: --up 0 0 0 has no direction");
  EXPECT_EQ(error("-o a.svg --width 3"), "error: draw: --width 3 is not from 16 to 4000");
  EXPECT_EQ(error("-o a.svg --fov 200deg"), "error: draw: --fov 200deg is not between 0 and 171deg");
  EXPECT_EQ(error("-o a.svg --from 0 0"), "error: draw: '0,0' holds 2 numbers where 3 are needed");
  EXPECT_EQ(error("-o a.svg --ray 0 0 1 0 0"),
            "error: draw: --ray 0,0,1,0,0: 5 numbers; an origin and a direction are six");
  EXPECT_EQ(error("-o a.svg --ray 0 0 1 0 0 0"), "error: draw: --ray 0,0,1,0,0,0: its direction is 0 0 0");
  EXPECT_EQ(error("-o a.svg --clearance crate --reach 0"), "error: draw: --reach 0 is not above 0");
  EXPECT_EQ(fake::server().connect_count, 0);
  EXPECT_EQ(error("-o /no/such/folder/a.svg"), "error: draw: /no/such/folder/a.svg: could not be written");
}

TEST_F(DrawVerb, NothingToDrawIsNo) {
  shown.objects.clear();
  EXPECT_EQ(collide("draw -o " + path("a.svg") + " --only nobody").code, 1);
}

}  // namespace
}  // namespace collided
