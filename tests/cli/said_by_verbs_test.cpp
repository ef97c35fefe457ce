#include <gtest/gtest.h>

#include <pty.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <sstream>

#include "client/cli/output/progress.hpp"
#include "client/cli/run.hpp"
#include "idl/answers/figures.hpp"
#include "idl/described_json.hpp"
#include "tests/cli/fakes/fake_client.hpp"
#include "tests/cli/scratch_file.hpp"
#include "tests/cli/terminal.hpp"

namespace collided {
namespace {

using nlohmann::json;

/// The answer of a server that has done nothing yet to what it has done.
json figures_of_nothing() { return json_of(Figures{.up_ns = 1'000, .version = 1, .step_period_ns = 10'000'000}); }

/// What single verbs send and say, each compared whole.
class SaidByVerbs : public testing::Test {
 protected:
  void SetUp() override { fake::reset(); }

  static const fake::Published& published() { return fake::server().publishers.at(0); }
};

// A thousand lines make the first request, so that a first answer comes early; each request after it is twice as large.
TEST_F(SaidByVerbs, EachRequestOfABatchIsTwiceAsLargeAsTheOneBefore) {
  std::string lines;
  for (int i = 0; i < 7'500; ++i) lines += "0 0 5 0 0 -1\n";
  EXPECT_EQ(collide("ray -", {.in = lines}).code, 0);
  EXPECT_EQ(fake::server().request_sizes, (std::vector<std::size_t>{1'000, 2'000, 4'000, 500}));
}

TEST_F(SaidByVerbs, AProgressLineIsErasedWhenItsWorkEnds) {
  std::ostringstream out;
  std::ostringstream err;
  cli::Io io{.in = 0,
             .out = out,
             .err = err,
             .out_is_terminal = false,
             .err_is_terminal = true,
             .environment = [](const char*) -> const char* { return nullptr; }};
  {
    cli::Progress progress(io, {});
    while (err.str().empty()) progress.show(0, "loading");
    EXPECT_EQ(err.str(), "\r loading\x1b[K");
  }
  EXPECT_EQ(err.str(), "\r loading\x1b[K\r\x1b[K");
}

TEST_F(SaidByVerbs, APublishersRateIsItsFramesOverItsTime) {
  const Ran ran = collide("publish --waypoints '0,0,0 1,0,0' --speed 20 --rate 200 --json");
  const json said = json::parse(ran.out);
  EXPECT_EQ(said["frames"], 11);
  EXPECT_GE(said["seconds"].get<double>(), 0.05);
  EXPECT_NEAR(said["rate"].get<double>() * said["seconds"].get<double>(), 11, 1e-9);
}

TEST_F(SaidByVerbs, APathsObjectHasTheLayersAndTheMaskThatWereGiven) {
  EXPECT_EQ(collide("publish --waypoints '0,0,0 1,0,0' --speed 1000 --rate 1000 --layers 0x6 --mask 0x9").code, 0);
  EXPECT_EQ(published().objects.at(1).layers, 6U);
  EXPECT_EQ(published().objects.at(1).mask, 9U);
}

TEST_F(SaidByVerbs, AWordTooManyIsNoOption) {
  EXPECT_EQ(collide("version now").err, "error: version: 'now' has no meaning here\n       collide help version\n");
  EXPECT_EQ(collide("version -5").err, "error: version: '-5' has no meaning here\n       collide help version\n");
  EXPECT_EQ(collide("version --servr").err, "error: version: unknown option '--servr'; did you mean '--server'?\n");
}

TEST_F(SaidByVerbs, AShapeOfAFileHasThePointsThatStandThere) {
  Shape shape;
  fake::server().command = [&](const std::string&, const json& arguments, const Shape& sent) -> Result<std::string> {
    shape = sent;
    return json{{"name", arguments["name"]}, {"id", 7}, {"version", 2}}.dump();
  };
  const ScratchFile points("points.txt", "# x y z\n1 2 3\n\n4,5;6  # the last\n");
  ASSERT_EQ(collide("add cloud points " + points.path() + " 0.1").code, 0);
  const auto& cloud = std::get<CloudShape>(shape.at(0));
  EXPECT_EQ(cloud.points, (std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}}));
  EXPECT_EQ(cloud.radius_m, 0.1);
  ASSERT_EQ(collide("add wire polyline " + points.path() + " 20cm").code, 0);
  const auto& line = std::get<PolylineShape>(shape.at(0));
  EXPECT_EQ(line.points, (std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}}));
  EXPECT_EQ(line.radius_m, 0.2);
  ASSERT_EQ(collide("add hill heights " + points.path() + " 0.5 2").code, 0);
  const auto& field = std::get<HeightFieldShape>(shape.at(0));
  EXPECT_EQ(field.columns, 3U);
  EXPECT_EQ(field.heights_m.size(), 6U);
  EXPECT_EQ(field.spacing_x_m, 0.5);
  EXPECT_EQ(field.spacing_y_m, 2);
}

// The second answer is of the state of the first: whatever it holds, nothing has changed.
TEST_F(SaidByVerbs, AStandingQuestionComparesNewStatesAloneAndSaysHowOftenItAsked) {
  int asked = 0;
  fake::server().near = [&](const NearQuestion&, const AskOptions&) {
    if (++asked == 2) ++fake::server().version;  // of the answers after this one
    if (asked == 2) return fake::hit_answer({fake::hit("shelf", 1, {0, 0, 0})});
    std::vector<Hit> hits{fake::hit("crate", 1, {0, 0, 0})};
    if (asked == 3) hits.push_back(fake::hit("shelf", 2, {0, 0, 0}));
    return fake::hit_answer(hits);
  };
  const Ran ran = collide("near 0 0 0 --watch --every 1ms -n 2 --fields change,object",
                          {.err_is_terminal = true, .environment = {{"NO_COLOR", "1"}}});
  EXPECT_EQ(ran.out, "enter\tcrate\nenter\tshelf\n");
  EXPECT_EQ(ran.err.substr(0, 13), "2 changes in ");
  EXPECT_TRUE(ran.err.ends_with(", asked 3 times\n")) << ran.err;
}

TEST_F(SaidByVerbs, TopBreaksTheListOfWhatIsNotBuiltBeforeEightyColumns) {
  fake::server().command = [](const std::string&, const json&, const Shape&) -> Result<std::string> {
    json figures = figures_of_nothing();
    figures["not_built"] = {std::string(60, 'a'), "b", std::string(10, 'c'), "d"};
    return figures.dump();
  };
  fake::server().status.state = "ready";
  const Ran ran = at_terminal("top --once --every 10ms");
  const std::size_t at = ran.out.find("NOT BUILT");
  ASSERT_NE(at, std::string::npos) << ran.out << ran.err;
  EXPECT_EQ(ran.out.substr(at), "NOT BUILT  " + std::string(60, 'a') + ", b,\n           cccccccccc, d\n");
}

/// This program's standard output is a terminal of so many columns while it lives; 0: one that does not say.
class StandardTerminal {
 public:
  explicit StandardTerminal(unsigned short columns) {
    std::fflush(stdout);
    const winsize size{.ws_row = 24, .ws_col = columns, .ws_xpixel = 0, .ws_ypixel = 0};
    EXPECT_EQ(::openpty(&master_, &terminal_, nullptr, nullptr, &size), 0);
    before_ = ::dup(STDOUT_FILENO);
    ::dup2(terminal_, STDOUT_FILENO);
  }
  ~StandardTerminal() {
    ::dup2(before_, STDOUT_FILENO);
    for (const int file : {before_, terminal_, master_}) ::close(file);
  }
  StandardTerminal(const StandardTerminal&) = delete;
  StandardTerminal& operator=(const StandardTerminal&) = delete;

 private:
  int master_ = -1;
  int terminal_ = -1;
  int before_ = -1;
};

TEST_F(SaidByVerbs, TopIsAsWideAsItsTerminalAndEightyColumnsWhereThatDoesNotSay) {
  fake::server().command = [](const std::string&, const json&, const Shape&) -> Result<std::string> {
    return figures_of_nothing().dump();
  };
  fake::server().status.scenes = {std::string(200, 'x')};
  const auto columns_at = [](unsigned short columns) {
    const StandardTerminal terminal(columns);
    const Ran ran = at_terminal("top -n 1 --every 10ms", 0);
    const std::size_t from = ran.out.find("\x1b[H") + 3;
    const std::string screen = ran.out.substr(from, ran.out.find("\x1b[J") - from);
    std::ptrdiff_t widest = 0;
    for (std::size_t begin = 0; begin < screen.size();) {
      const std::size_t end = std::min(screen.find("\x1b[K", begin), screen.size());
      const std::string line = screen.substr(begin, end - begin);
      widest = std::max(widest, std::count_if(line.begin(), line.end(), [](char c) {
                          return (static_cast<unsigned char>(c) & 0xc0) != 0x80 && c != '\n' && c != '\r';
                        }));
      begin = end + 3;
    }
    return widest;
  };
  EXPECT_EQ(columns_at(43), 43);
  EXPECT_EQ(columns_at(0), 80);
}

TEST_F(SaidByVerbs, WatchedProbesAreThoseThatMatch) {
  fake::server().readings = {{.probe = "front",
                              .object = "car",
                              .state = Clearance::gap,
                              .clearance_m = 0.12,
                              .error_m = 1e-15,
                              .met = "road"}};
  EXPECT_EQ(collide("probe --watch -n 1 --only 'fr*' --skip rear --fields probe").out, "front\n");
  EXPECT_EQ(fake::server().probes_watched_with.only, "fr*");
  EXPECT_EQ(fake::server().probes_watched_with.skip, "rear");
}

// Its reader is gone, as `head` goes: what comes then is not waited for.
TEST_F(SaidByVerbs, WatchedProbesEndWithWhoReadsThem) {
  fake::server().readings = {{.probe = "front", .object = "car", .state = Clearance::gap, .met = "road"},
                             {.probe = "rear", .object = "car", .state = Clearance::gap, .met = "road"}};
  std::ostringstream out;
  std::ostringstream err;
  out.setstate(std::ios::badbit);
  cli::Io io{.in = 0,
             .out = out,
             .err = err,
             .out_is_terminal = false,
             .err_is_terminal = false,
             .environment = [](const char*) -> const char* { return nullptr; }};
  cli::run({"probe", "--watch", "-n", "2"}, io);
  EXPECT_EQ(fake::server().readings.size(), 2U) << "none was taken";
}

TEST_F(SaidByVerbs, ARecordingsUpIsYOrZ) {
  const ScratchFile file("walk.bvh",
                         "HIERARCHY\nROOT Hips\n{\n OFFSET 0 0 0\n CHANNELS 3 Xposition Yposition Zposition\n End "
                         "Site\n {\n  OFFSET 0 0 1\n }\n}\n"
                         "MOTION\nFrames: 2\nFrame Time: 0.001\n9 9 9\n1 2 3\n");
  const auto hips = [&](const std::string& up) {
    fake::reset();
    EXPECT_EQ(collide("publish " + file.path() + up).code, 0) << up;
    return Vec3(published().batches.back().at(1).position);
  };
  const Vec3 y_is_up = hips(" --up y");
  const Vec3 z_is_up = hips(" --up z");
  EXPECT_EQ(y_is_up, Vec3(1, 2, 3));
  EXPECT_EQ(z_is_up, Vec3(1, -3, 2));
  EXPECT_EQ(collide("publish " + file.path() + " --up x").err.substr(0, 42),
            "error: publish: --up 'x'; allowed: y, z\n");
}

TEST_F(SaidByVerbs, ASweepTellsItsCostToAPersonAndToWhoAsks) {
  fake::server().sweep = [](const Shape&, const SweepQuestion&, const AskOptions&) { return fake::hit_answer({}); };
  const std::string cost = "     41 us: 7 nodes, 2 exact tests; world 18204, poses 2.1 ms old\n";
  const std::string words = "sweep sphere 0.1 --from 0 0 1 --to 2 0 1";
  EXPECT_EQ(at_terminal(words).err, cost);
  EXPECT_EQ(collide(words + " --json -v").err, cost);
  EXPECT_EQ(collide(words + " --json").err, "");
}

TEST_F(SaidByVerbs, AnAuditsRecordIsALine) {
  fake::server().command = [](const std::string&, const json&, const Shape&) -> Result<std::string> {
    return json{{"every", 1000},
                {"chosen", 5},
                {"audited", 4},
                {"differing", 1},
                {"skipped", 2},
                {"float_repairs", 3},
                {"differences", {"ray", "box"}},
                {"questions", {{{"kind", "ray"}, {"double", 3}, {"expansion", 0}, {"rational", 0}}}}}
        .dump();
  };
  EXPECT_EQ(
      collide("audit --json").out,
      R"({"every":1000,"chosen":5,"audited":4,"differing":1,"skipped":2,"float_repairs":3,"questions":[{"double":3,"expansion":0,"kind":"ray","rational":0}],"differences":["ray","box"]})"
      "\n");
}

}  // namespace
}  // namespace collided
