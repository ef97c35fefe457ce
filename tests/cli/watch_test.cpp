#include <gtest/gtest.h>

#include "tests/cli/fakes/fake_client.hpp"
#include "tests/cli/scratch_file.hpp"
#include "tests/cli/terminal.hpp"

namespace collided {
namespace {

class WatchVerb : public testing::Test {
 protected:
  void SetUp() override {
    fake::reset();
    Event began;
    began.kind = EventKind::began;
    began.a = "drone_2";
    began.b = "pallet_07";
    began.sequence = 881;
    began.episode = 881;
    began.world_time = began.began = std::chrono::milliseconds(12'201);
    began.depth_m = 0.0031;
    began.depth_error_m = 8.9e-16;
    began.point = {0.93, 2, 0.5};
    began.relative_velocity = {-1.5, 0, 0.25};
    Event ended = began;
    ended.kind = EventKind::ended;
    ended.reason = EndReason::separated;
    ended.sequence = 884;
    ended.world_time = std::chrono::milliseconds(12'455);
    Event open = began;
    open.kind = EventKind::open;
    open.a = "arm/link_5";
    open.b = "shelf_3";
    fake::server().events = {open, began, ended};
  }
};

TEST_F(WatchVerb, ALineAnEvent) {
  const Ran ran = at_terminal("watch -n 3");
  EXPECT_EQ(ran.code, 0);
  EXPECT_EQ(ran.out,
            "open     arm/link_5 x shelf_3  since 12.201\n"
            "12.201 began  drone_2 x pallet_07  depth 0.0031 m at 0.93 2 0.5  seq 881\n"
            "12.455 ended  drone_2 x pallet_07  after 254 ms  (separated)  seq 884\n");
  EXPECT_EQ(ran.err.substr(0, 12), "3 events in ");
  EXPECT_NE(ran.err.find(", 0 lost\n"), std::string::npos);
}

TEST_F(WatchVerb, MachinesGetEveryField) {
  EXPECT_EQ(collide("watch -n 3 --json --fields what,a,b,depth,after,why,sequence").out,
            "{\"what\":\"open\",\"a\":\"arm/link_5\",\"b\":\"shelf_3\",\"depth\":0.0031,\"sequence\":881}\n"
            "{\"what\":\"began\",\"a\":\"drone_2\",\"b\":\"pallet_07\",\"depth\":0.0031,\"sequence\":881}\n"
            "{\"what\":\"ended\",\"a\":\"drone_2\",\"b\":\"pallet_07\",\"after\":0.254,\"why\":\"separated\","
            "\"sequence\":884}\n");
}

// The server's order of a pair follows its numbers for the objects, which differ from run to run.
TEST_F(WatchVerb, APairStandsInTheOrderOfItsNames) {
  Event event = fake::server().events[1];
  event.normal = {0, 0, 1};
  event.surface_normal = {0, 1, 0};
  event.a_triangle = 3;
  const std::string fields = " --json --fields a,b,a_triangle,b_triangle,normal,surface_normal,velocity";
  fake::server().events = {event};
  EXPECT_EQ(collide("watch -n 1" + fields).out,
            "{\"a\":\"drone_2\",\"b\":\"pallet_07\",\"a_triangle\":3,\"normal\":[0,0,1],"
            "\"surface_normal\":[0,1,0],\"velocity\":[-1.5,0,0.25]}\n");
  std::swap(event.a, event.b);
  fake::server().events = {event};
  EXPECT_EQ(collide("watch -n 1" + fields).out,
            "{\"a\":\"drone_2\",\"b\":\"pallet_07\",\"b_triangle\":3,\"normal\":[0,0,-1],"
            "\"surface_normal\":[0,-1,0],\"velocity\":[1.5,0,-0.25]}\n");
  fake::server().events = {event};
  EXPECT_NE(at_terminal("watch -n 1").out.find("  drone_2 x pallet_07  "), std::string::npos);
  fake::server().events = {event};
  EXPECT_EQ(collide("watch -n 1 --format '{what} {a} {b}'").out, "began drone_2 pallet_07\n");
}

// A late joiner's open contacts and endings bear on nothing.
TEST_F(WatchVerb, WhereTheyBearIsAskedForAsTheyBegin) {
  const auto events = fake::server().events;
  std::string asked;
  fake::server().pair = [&](const std::string& a, const std::string& b, const PairOptions&) {
    asked += a + " " + b + ";";
    PairAnswer answer;
    answer.verdict = Verdict::hit;
    answer.manifold = {{.point = {1, 2, 0.5}, .depth_m = 0.003, .error_m = 1e-15},
                       {.point = {1, 3, 0.5}, .depth_m = 0.002, .error_m = 1e-15}};
    return answer;
  };
  const Ran ran = at_terminal("watch -n 3 --manifold");
  EXPECT_EQ(asked, "drone_2 pallet_07;");
  EXPECT_NE(ran.out.find("seq 881\n  bears at 1 2 0.5  0.003 m deep\n  bears at 1 3 0.5  0.002 m deep\n12.455 ended"),
            std::string::npos)
      << ran.out;
  fake::server().events = events;
  const std::string records = collide("watch -n 3 --manifold --json --fields what,a,depth,point").out;
  EXPECT_NE(records.find("{\"what\":\"persisted\",\"a\":\"drone_2\",\"depth\":0.002,\"point\":[1,3,0.5]}"),
            std::string::npos)
      << records;
  fake::server().events = events;
  fake::server().pair = nullptr;
  EXPECT_EQ(collide("watch -n 3 --manifold").code, 0) << "they may have parted, or be gone";
}

TEST_F(WatchVerb, HowFastTheyMetIsToldOfBeginnings) {
  EXPECT_EQ(collide("watch -n 3 --json --fields what,velocity").out,
            "{\"what\":\"open\"}\n{\"what\":\"began\",\"velocity\":[-1.5,0,0.25]}\n{\"what\":\"ended\"}\n");
}

TEST_F(WatchVerb, AFormatNamesItsFields) {
  EXPECT_EQ(collide("watch -n 2 --format '{t} {what} {a}|{b} {depth}'").out,
            "12.201 open arm/link_5|shelf_3 0.0031\n12.201 began drone_2|pallet_07 0.0031\n");
  const Ran ran = collide("watch --format '{deth}'");
  EXPECT_EQ(ran.code, 2);
  EXPECT_EQ(ran.err.substr(0, ran.err.find('\n')), "error: watch: no field '{deth}'; did you mean 'depth'?");
}

TEST_F(WatchVerb, SinceAsksForWhatTheServerRemembers) {
  EXPECT_EQ(collide("watch -n 1").code, 0);
  EXPECT_EQ(fake::server().watched_with.since, std::nullopt);
  EXPECT_EQ(at_terminal("watch -n 1 --since 1970-01-01T00:00:12.25Z").code, 0);
  EXPECT_EQ(fake::server().watched_with.since, std::chrono::milliseconds(12'250));
  const std::chrono::nanoseconds now = std::chrono::system_clock::now().time_since_epoch();
  EXPECT_EQ(collide("watch -n 1 --since -10s").code, 0);
  const std::chrono::nanoseconds late = *fake::server().watched_with.since - (now - std::chrono::seconds(10));
  EXPECT_GE(late.count(), 0);
  EXPECT_LT(late, std::chrono::seconds(5));
  const Ran ahead = collide("watch --since +2s");
  EXPECT_EQ(ahead.code, 2);
  EXPECT_EQ(ahead.err,
            "error: watch: --since: a time after the begin is for recordings\n       -10s, 2026-11-22T12:03:10.5Z or "
            "seconds since 1970\n");
}

TEST_F(WatchVerb, AMemoryThatIsTooShortSaysFromWhenOn) {
  fake::server().tells_since = std::chrono::milliseconds(12'500);
  EXPECT_EQ(at_terminal("watch -n 1 --since 12.25")
                .err.find("the server remembers what happened from 12.500 on\n1 event in "),
            0U);
  fake::server().tells_since = std::chrono::milliseconds(12'250);
  EXPECT_EQ(at_terminal("watch -n 1 --since 12.25").err.substr(0, 11), "1 event in ");
}

TEST_F(WatchVerb, NothingInTimeIsANo) {
  fake::server().events.clear();
  EXPECT_EQ(collide("watch --for 20ms").code, 1);
}

// A name is data: the shell sees it in a variable, never as words of a command.
TEST_F(WatchVerb, AHostileNameIsNotRunByTheShell) {
  const ScratchFile log("log", "");
  fake::server().events.resize(1);
  const std::string act = "touch " + log.path() + ".owned";
  const std::string hostile = "$(" + act + ")`" + act + "`\"; " + act + "; \"";
  fake::server().events[0].a = hostile;
  const Ran ran = collide("watch -n 1 --exec 'printf \"%s\" \"{a} hit {b}\" > " + log.path() + "'");
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_FALSE(std::filesystem::exists(log.path() + ".owned"));
  std::ifstream written(log.path());
  const std::string text((std::istreambuf_iterator<char>(written)), {});
  EXPECT_EQ(text, hostile + " hit shelf_3");
}

}  // namespace
}  // namespace collided
