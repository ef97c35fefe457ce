// Every option changes what is asked, or what is shown, in the way that it says.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "tests/cli/fakes/fake_client.hpp"
#include "tests/cli/scratch_file.hpp"
#include "tests/cli/terminal.hpp"

namespace collided {
namespace {

using nlohmann::json;

class Options : public testing::Test {
 protected:
  void SetUp() override {
    fake::reset();
    fake::server().status.state = "ready";
    fake::server().command = [this](const std::string& name, const json& arguments,
                                    const Shape&) -> Result<std::string> {
      asked[name] = arguments;
      return json{{"name", "x"},  {"id", 1},
                  {"version", 2}, {"pose", {1, 2, 3, 1, 0, 0, 0}},
                  {"scene", "s"}, {"objects", name == "load" ? json(0) : json::array()},
                  {"count", 0},   {"moved_m", 0}}
          .dump();
    };
    fake::server().ray = [](const RayQuestion&, const AskOptions&) {
      return fake::hit_answer({fake::hit("wall", 1, {0, 0, 0})});
    };
  }
  AskOptions ray_options(const std::string& options) {
    const Ran ran = collide("ray 0 0 5 0 0 -1 " + options);
    EXPECT_EQ(ran.code, 0) << ran.err;
    return fake::server().last_options;
  }

  std::map<std::string, json> asked;  // by command, the last one
};

TEST_F(Options, OfAQuestionReachTheServerEachForItself) {
  const AskOptions plain = ray_options("");
  EXPECT_EQ(plain.mode, HitMode::closest);
  EXPECT_EQ(plain.importance, Importance::normal);
  EXPECT_EQ(plain.mask, 0xffffffffU);
  EXPECT_EQ(plain.error_m, 0);
  EXPECT_EQ(plain.deadline.count(), 0);
  EXPECT_FALSE(plain.fresh);
  EXPECT_EQ(plain.only + plain.skip, "");
  EXPECT_EQ(ray_options("--any").mode, HitMode::any);
  EXPECT_EQ(ray_options("--verdict").mode, HitMode::verdict);
  EXPECT_EQ(ray_options("--all").mode, HitMode::all);
  EXPECT_EQ(collide("ray 0 0 5 0 0 -1 --all --any").code, 2);
  EXPECT_EQ(collide("ray 0 0 5 0 0 -1 --verdict --any").code, 2);
  EXPECT_EQ(ray_options("--importance low").importance, Importance::low);
  EXPECT_EQ(ray_options("--importance high").importance, Importance::high);
  EXPECT_EQ(ray_options("--importance normal").importance, Importance::normal);
  EXPECT_EQ(collide("ray 0 0 5 0 0 -1 --importance urgent").code, 2);
  EXPECT_EQ(ray_options("--mask 0b101").mask, 5U);
  EXPECT_EQ(ray_options("--within 1mm").error_m, 1e-3);
  EXPECT_EQ(collide("ray 0 0 5 0 0 -1 --within -1mm").code, 2);
  EXPECT_EQ(ray_options("--deadline 3ms").deadline, std::chrono::milliseconds(3));
  EXPECT_EQ(ray_options("--max-hits 4294967295").max_hits, 4294967295U);
  EXPECT_EQ(collide("ray 0 0 5 0 0 -1 --max-hits 4294967296").code, 2);
  EXPECT_EQ(collide("ray 0 0 5 0 0 -1 --max-hits 0").code, 2);
  const auto as_of = [&](const std::string& text) {
    const Instant instant = ray_options("--as-of " + text).as_of;
    return std::pair(instant.kind, instant.time.count());
  };
  EXPECT_EQ(plain.as_of.kind, Instant::Kind::latest);
  EXPECT_EQ(as_of("latest"), std::pair(Instant::Kind::latest, std::int64_t{0}));
  EXPECT_EQ(as_of("settled"), std::pair(Instant::Kind::settled, std::int64_t{0}));
  EXPECT_EQ(as_of("-2s"), std::pair(Instant::Kind::back, std::int64_t{2'000'000'000}));
  EXPECT_EQ(as_of("2026-11-22T12:03:10.5Z"), std::pair(Instant::Kind::at, std::int64_t{1'795'348'990'500'000'000}));
  EXPECT_EQ(collide("ray 0 0 5 0 0 -1 --as-of +2s").code, 2);
  const Ran soon = collide("ray 0 0 5 0 0 -1 --as-of soon");
  EXPECT_EQ(soon.code, 2);
  EXPECT_EQ(soon.err,
            "error: ray: --as-of 'soon' is no time\n       latest, settled, -2s, 2026-11-22T12:03:10.5Z or seconds "
            "since 1970\n");
  EXPECT_TRUE(ray_options("--fresh").fresh);
  EXPECT_FALSE(ray_options("").fresh) << "not the next time";
}

// The same options, of the other questions and of those from a file.
TEST_F(Options, OfAQuestionCountForEveryKindAndForFiles) {
  fake::server().sphere = [](const SphereQuestion&, const AskOptions&) { return fake::hit_answer({}); };
  fake::server().box = [](const BoxQuestion&, const AskOptions&) { return fake::hit_answer({}); };
  fake::server().near = [](const NearQuestion&, const AskOptions&) { return fake::hit_answer({}); };
  fake::server().sweep = [](const Shape&, const SweepQuestion&, const AskOptions&) { return fake::hit_answer({}); };
  const ScratchFile file("rays.csv", "fx,fy,fz,dx,dy,dz\n0,0,5,0,0,-1\n");
  for (const std::string words : {"ray 0 0 5 0 0 -1", "sphere 0 0 0 1", "box 0 0 0 1 1 1", "near 0 0 0",
                                  "sweep sphere 1 --from 0 0 0 --to 1 1 1", "file"}) {
    fake::server().last_options = {};
    collide((words == "file" ? "ray -q '" + file.path() + "'" : words) +
            " --only 'a*' --skip b --mask 6 --within 1um --deadline 2ms --importance low --as-of settled --fresh");
    const AskOptions& options = fake::server().last_options;
    EXPECT_EQ(options.only, "a*") << words;
    EXPECT_EQ(options.skip, "b") << words;
    EXPECT_EQ(options.mask, 6U) << words;
    EXPECT_EQ(options.error_m, 1e-6) << words;
    EXPECT_EQ(options.deadline, std::chrono::milliseconds(2)) << words;
    EXPECT_EQ(options.importance, Importance::low) << words;
    EXPECT_EQ(options.as_of.kind, Instant::Kind::settled) << words;
    EXPECT_TRUE(options.fresh) << words;
  }
}

TEST_F(Options, OfAnObjectReachTheServerEachForItself) {
  const auto add = [&](const std::string& options) {
    const Ran ran = collide("add x box 1 1 1 " + options);
    EXPECT_EQ(ran.code, 0) << ran.err;
    return asked["add"];
  };
  json plain = add("");
  EXPECT_EQ(
      plain,
      json::parse(
          R"({"name":"x","pose":[0,0,0,1,0,0,0],"layers":1,"mask":4294967295,"group":0,"scale":[1,1,1],"moving":true})"));
  const auto expect_changed = [&](const std::string& options, const char* key, const json& value) {
    json expected = plain;
    expected[key] = value;
    EXPECT_EQ(add(options), expected) << options;
  };
  expect_changed("--layers 0b110", "layers", 6);
  expect_changed("--mask 0xf0", "mask", 240);
  expect_changed("--group 7", "group", 7);
  expect_changed("--scale 2", "scale", {2, 2, 2});
  expect_changed("--scale 2,3,5", "scale", {2, 3, 5});
  expect_changed("--static", "moving", false);
  expect_changed("--durable", "durable", true);
  expect_changed("--at 1 2cm 3", "pose", {1, 0.02, 3, 1, 0, 0, 0});
  expect_changed("--quat 0 0 1 0", "pose", {0, 0, 0, 0, 0, 1, 0});
  EXPECT_EQ(collide("add x box 1 1 1 --scale 2,3").code, 2);
  const json turned = add("--rpy 90deg 0 90deg")["pose"];
  const Quat q(turned[3], turned[4], turned[5], turned[6]);
  EXPECT_LT((q * Vec3(1, 2, 3) - Vec3(3, 1, 2)).norm(), 1e-15) << "roll about x first, then yaw about z";
}

TEST_F(Options, OfAMoveReachTheServer) {
  collide("move x 4 5 6");
  EXPECT_EQ(asked["move"], json::parse(R"({"name":"x","pose":[4,5,6,1,0,0,0],"teleport":false})"));
  collide("move x 4 5 6 --teleport");
  EXPECT_EQ(asked["move"]["teleport"], true);
  collide("move x 4 5 6 --by");
  EXPECT_EQ(asked["move"]["pose"], json({5, 7, 9, 1, 0, 0, 0}));
  collide("move x 4 5 6 --by --quat 0 1 0 0");
  EXPECT_EQ(asked["move"]["pose"], json({5, 7, 9, 0, 1, 0, 0}));
}

TEST_F(Options, OfALoadReachTheServerEachForItself) {
  const auto load = [&](const std::string& options) {
    const Ran ran = collide("load /a/b.obj " + options);
    EXPECT_EQ(ran.code, 0) << ran.err;
    return asked["load"];
  };
  const json plain = load("");
  EXPECT_EQ(
      plain,
      json::parse(
          R"({"name":"","unit_m":1,"up":"","radius_m":0,"strict":false,"mend":false,"crack_m":0,"srdf":"","replace":false,"path":"/a/b.obj"})"));
  const auto expect_changed = [&](const std::string& options, const char* key, const json& value) {
    json expected = plain;
    expected[key] = value;
    EXPECT_EQ(load(options), expected) << options;
  };
  expect_changed("--name hall", "name", "hall");
  expect_changed("--unit in", "unit_m", 0.0254);
  expect_changed("--unit 2.5cm", "unit_m", 0.025);
  expect_changed("--unit 0.5", "unit_m", 0.5);
  expect_changed("--up z", "up", "z");
  expect_changed("--radius 5mm", "radius_m", 0.005);
  expect_changed("--strict", "strict", true);
  expect_changed("--mend", "mend", true);
  expect_changed("--crack 2mm", "crack_m", 0.002);
  expect_changed("--srdf /c/d.srdf", "srdf", "/c/d.srdf");
  expect_changed("--replace", "replace", true);
  for (const char* wrong : {"--unit 0", "--unit -1m", "--unit 3s", "--up x", "--radius x", "--crack 1deg"})
    EXPECT_EQ(collide("load /a/b.obj " + std::string(wrong)).code, 2) << wrong;
}

TEST_F(Options, OfAListReachTheServer) {
  collide("ls 'a*'");
  EXPECT_EQ(asked["list"], json::parse(R"({"name":"a*","limit":10000})"));
  collide("ls --limit 7 --moving");
  EXPECT_EQ(asked["list"], json::parse(R"({"name":"","limit":7,"moving":true})"));
  collide("ls --static");
  EXPECT_EQ(asked["list"], json::parse(R"({"name":"","limit":10000,"moving":false})"));
  EXPECT_EQ(collide("ls --static --moving").code, 2);
  collide("ls --count");
  EXPECT_EQ(asked["list"]["limit"], 0);
}

TEST_F(Options, OfThePairAndTheMenuReachTheServer) {
  PairOptions last;
  fake::server().pair = [&](const std::string&, const std::string&, const PairOptions& options) {
    last = options;
    return PairAnswer{};
  };
  collide("pair a b");
  EXPECT_FALSE(last.triangles);
  EXPECT_FALSE(last.certificate);
  EXPECT_EQ(last.most_triangle_pairs, 10'000U);
  collide("pair a b --triangles --most 7");
  EXPECT_TRUE(last.triangles);
  EXPECT_EQ(last.most_triangle_pairs, 7U);
  collide("pair a b --certificate --timeout 7s");
  EXPECT_TRUE(last.certificate);
  EXPECT_EQ(last.timeout, std::chrono::seconds(7));
  collide("menu --questions 17 --seed 23");
  EXPECT_EQ(asked["menu"], json::parse(R"({"questions":17,"seed":23})"));
}

// Whoever reads: colours where they are wanted, whatever the terminal is.
TEST_F(Options, ColourIsForcedOrForbidden) {
  EXPECT_NE(collide("ray 0 0 5 0 0 -1 --table --color always").out.find("\x1b[32mhit\x1b[0m"), std::string::npos);
  EXPECT_EQ(collide("ray 0 0 5 0 0 -1 --table --color never").out.find('\x1b'), std::string::npos);
  const Terminal terminal{.out_is_terminal = true, .err_is_terminal = true, .in = {}, .environment = {}};
  EXPECT_NE(collide("ray 0 0 5 0 0 -1", terminal).out.find('\x1b'), std::string::npos);
  EXPECT_EQ(collide("ray 0 0 5 0 0 -1 --color never", terminal).out.find('\x1b'), std::string::npos);
  EXPECT_EQ(at_terminal("ray 0 0 5 0 0 -1").out.find('\x1b'), std::string::npos) << "NO_COLOR";
  EXPECT_NE(collide("ray 0 0 5 0 0 -1 --color always",
                    {.out_is_terminal = true, .err_is_terminal = true, .in = {}, .environment = {{"NO_COLOR", "1"}}})
                .out.find('\x1b'),
            std::string::npos);
  EXPECT_EQ(collide("ray 0 0 5 0 0 -1 --color sometimes").code, 2);
}

/// A box that stands in an empty world, drawn with those options.
class DrawOptions : public Options {
 protected:
  void SetUp() override {
    Options::SetUp();
    fake::server().shapes = [](const ShapesOptions&) -> Result<ShownObjects> {
      ShownObjects shown;
      shown.objects.push_back(
          {.id = 1, .name = "crate", .scene = {}, .pose = {}, .parts = {BoxShape{{1, 2, 3}}}, .runs = {}});
      return shown;
    };
    // Seen from anywhere outside: the box itself answers.
    fake::server().ray = [](const RayQuestion& ray, const AskOptions&) {
      const Vec3 half(1, 2, 3);
      double enter = 0, leave = std::numeric_limits<double>::infinity();
      Vec3 normal = Vec3::Zero();
      for (int axis = 0; axis < 3; ++axis) {
        const double speed = ray.direction[axis];
        if (speed == 0 && std::abs(ray.origin[axis]) > half[axis]) return fake::hit_answer({});
        if (speed == 0) continue;
        const double near = (-std::copysign(half[axis], speed) - ray.origin[axis]) / speed;
        const double far = (std::copysign(half[axis], speed) - ray.origin[axis]) / speed;
        if (near > enter) {
          enter = near;
          normal = Vec3::Zero();
          normal[axis] = speed > 0 ? -1 : 1;
        }
        leave = std::min(leave, far);
      }
      if (enter > leave || enter * ray.direction.norm() > ray.length_m) return fake::hit_answer({});
      Hit hit = fake::hit("crate", enter * ray.direction.norm(), ray.origin + enter * ray.direction);
      hit.object_id = 1;
      hit.normal = normal;
      return fake::hit_answer({hit});
    };
  }
  std::string drawn(const std::string& options) {
    const ScratchFile file("drawn.svg", "");
    const Ran ran = collide("draw --width 200 -o '" + file.path() + "' " + options);
    EXPECT_EQ(ran.code, 0) << options << ": " << ran.err;
    std::ifstream in(file.path());
    return {std::istreambuf_iterator<char>(in), {}};
  }
  /// The area of each paint in pixels.
  static std::map<std::string, std::size_t> paints(const std::string& svg) {
    std::map<std::string, std::size_t> sizes;
    const std::string head = "fill=\"";
    for (std::size_t at = svg.find("class=\"tone\""); at != std::string::npos;
         at = svg.find("class=\"tone\"", at + 1)) {
      const std::size_t begin = svg.find(head, at) + head.size();
      sizes[svg.substr(begin, svg.find('"', begin) - begin)] += svg.find("/>", at) - at;
    }
    return sizes;
  }
};

TEST_F(DrawOptions, FewerTonesAreFewerPaints) {
  const std::string place = "--style toon --from 9 7 8 --light 3 2 1 ";
  const auto two = paints(drawn(place + "--tones 2"));
  const auto many = paints(drawn(place + "--tones 16"));
  EXPECT_LE(two.size(), 3U);
  EXPECT_GT(many.size(), two.size()) << "its three sides are lit unlike";
  EXPECT_EQ(collide("draw -o a.svg --tones 1").code, 2);
}

TEST_F(DrawOptions, LightFromTheOtherSideMakesOtherTones) {
  const std::string place = "--style toon --from 9 7 8 --tones 16 ";
  EXPECT_NE(drawn(place + "--light 1 0 0"), drawn(place + "--light 0 1 0"));
  EXPECT_EQ(drawn(place + "--light 1 0 0"), drawn(place + "--light 2 0 0")) << "a direction has no length";
  EXPECT_EQ(collide("draw -o a.svg --light 0 0 0").code, 2);
}

// Of lines that are parallel the pictures are parallel, or they meet in the distance.
TEST_F(DrawOptions, WithoutPerspectiveParallelEdgesStayParallel) {
  const auto slopes = [&](const std::string& options) {
    const std::string svg = drawn("--style wireframe --from 9 7 8 " + options);
    std::vector<double> found;
    for (std::size_t path = svg.find(" d=\"M"); path != std::string::npos; path = svg.find(" d=\"M", path + 1)) {
      std::string text = svg.substr(path + 4, svg.find('"', path + 4) - path - 4);
      std::replace(text.begin(), text.end(), ',', ' ');
      std::istringstream numbers(text);
      char command = 0;
      double x = 0, y = 0, to_x = 0, to_y = 0;
      while (numbers >> command >> to_x >> to_y) {
        if (command == 'L') found.push_back(std::abs(std::remainder(std::atan2(to_y - y, to_x - x), M_PI)));
        x = to_x;
        y = to_y;
      }
    }
    EXPECT_EQ(found.size(), 12U);
    std::sort(found.begin(), found.end());
    // Four edges along each of the three axes: the widest spread within a direction.
    double spread = 0;
    for (std::size_t i = 0; i + 3 < found.size(); i += 4) spread = std::max(spread, found[i + 3] - found[i]);
    return spread;
  };
  EXPECT_LT(slopes("--ortho"), 2e-3);
  EXPECT_GT(slopes(""), 2e-2);
}

TEST_F(Options, ASavedRunSaysWhichWayIsUp) {
  fake::server().shapes = [](const ShapesOptions&) -> Result<ShownObjects> {
    return ShownObjects{.epoch = 1, .version = 1, .table_version = 1, .objects = {}};
  };
  for (const std::string up : {"y", "z"}) {
    const ScratchFile file("up.html", "");
    ASSERT_EQ(collide("view --save '" + file.path() + "' --last 60ms --up " + up).code, 0);
    std::ifstream in(file.path());
    const std::string page((std::istreambuf_iterator<char>(in)), {});
    EXPECT_NE(page.find("\\\"up\\\":\\\"" + up + "\\\""), std::string::npos);
  }
}

}  // namespace
}  // namespace collided
