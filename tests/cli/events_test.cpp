#include <gtest/gtest.h>

#include <filesystem>

#include "client/cli/failure.hpp"
#include "client/cli/input/time_text.hpp"
#include "client/library/recordings/recorded_events.hpp"
#include "tests/cli/fakes/event_recording.hpp"
#include "tests/cli/fakes/fake_client.hpp"
#include "tests/cli/scratch_file.hpp"
#include "tests/cli/terminal.hpp"

namespace collided {
namespace {

using test::EventRecording;
using Kind = EventRecording::Kind;
using Reason = EventRecording::Reason;
using News = StandingEventKind;

constexpr std::uint64_t kCrate = 1, kShelf = 2, kDrone = 3,
                        kCart = kDrone + (std::uint64_t{1} << 32);  // in the drone's place

class EventsVerb : public testing::Test {
 protected:
  void SetUp() override { fake::reset(); }

  static void name_all(EventRecording& run) {
    run.name(kCrate, "crate");
    run.name(kShelf, "shelf");
    run.name(kDrone, "drone");
    run.name(kCart, "cart");
  }
  /// The crate lies on the shelf; a drone bumps into both, the crate first, leaves the shelf and is removed; a cart takes its
  /// place in the server's table and stays at the shelf; the crate is lifted.
  void write_run(const std::function<bool(std::uint64_t)>& kept = [](std::uint64_t) { return true; }) const {
    EventRecording run(path(), 1);
    name_all(run);
    run.shard(99, 10, {{kCrate, kShelf, 3, 90}});
    run.status(100, 10, {{kCrate, kShelf, 3, 90}});
    run.status(100.05, 10, {{kCrate, kShelf, 3, 90}});
    if (kept(11))
      run.frame(101, 11,
                {{Kind::began, kShelf, kDrone, 11, 0.003, 0.002}, {Kind::began, kCrate, kDrone, 12, 0.006, 0.005}});
    if (kept(13)) run.frame(102, 13, {{Kind::ended, kShelf, kDrone, 11, 0.002, 0.001, Reason::separated}});
    if (kept(14)) run.frame(103, 14, {{Kind::ended, kCrate, kDrone, 12, 0, 0, Reason::removed}});
    if (kept(15)) run.frame(104, 15, {{Kind::began, kShelf, kCart, 15}});
    if (kept(16)) run.frame(105, 16, {{Kind::ended, kCrate, kShelf, 3, 0, 0, Reason::separated}});
    run.status(106, 16, {{kShelf, kCart, 15, 104}});
  }
  std::string path() const { return scratch_.path(); }
  /// What, who and which, in a line each.
  std::string told(const std::string& options) const {
    const Ran ran = collide("events " + path() + " " + options + " --json --fields what,a,b,sequence");
    std::string lines;
    std::istringstream all(ran.out);
    for (std::string line; std::getline(all, line);) {
      const nlohmann::json event = nlohmann::json::parse(line);
      lines += event["what"].get<std::string>() + " " + event["a"].get<std::string>() + " " +
               event["b"].get<std::string>() + " " + std::to_string(event["sequence"].get<std::uint64_t>()) + "\n";
    }
    return lines;
  }

  const ScratchFile scratch_{"run.mcap", ""};
};

// Two that were told in one frame come in the order in which they happened.
TEST_F(EventsVerb, ALineAnEventInOrderOfTime) {
  write_run();
  const Ran ran = at_terminal("events " + path());
  EXPECT_EQ(ran.code, 0);
  EXPECT_EQ(ran.out,
            "open     crate x shelf  since 90.000\n"
            "100.995 began  crate x drone  depth 0.004 m at 1 2 0.5  seq 12\n"
            "100.998 began  drone x shelf  depth 0.004 m at 1 2 0.5  seq 11\n"
            "101.999 ended  drone x shelf  after 1 s  (separated)  seq 13\n"
            "103.000 ended  crate x drone  after 2.01 s  (removed)  seq 14\n"
            "104.000 began  cart x shelf  depth 0.004 m at 1 2 0.5  seq 15\n"
            "105.000 ended  crate x shelf  after 15 s  (separated)  seq 16\n");
  EXPECT_EQ(ran.err, "7 events in " + path() + ", recorded from 100.000 to 106.000; 0 lost\n");
  EXPECT_EQ(fake::server().connect_count, 0) << "no server is asked";
}

TEST_F(EventsVerb, MachinesGetTheFieldsOfWatch) {
  write_run();
  EXPECT_EQ(
      collide("events " + path() + " --json --to 100.996").out,
      "{\"time\":90,\"time_ns\":90000000000,\"what\":\"open\",\"a\":\"crate\",\"b\":\"shelf\",\"depth\":0.004,"
      "\"error\":1e-15,"
      "\"point\":[1,2,0.5],\"normal\":[0,0,1],\"resync\":true,\"sequence\":10,\"episode\":3,\"bracket_low\":0,"
      "\"bracket_high\":0,\"epoch\":1}\n"
      "{\"time\":101,\"time_ns\":101000000000,\"first_ns\":100994000000,\"last_ns\":100995000000,\"what\":\"began\","
      "\"a\":\"crate\","
      "\"b\":\"drone\",\"depth\":0.004,\"error\":1e-15,\"point\":[1,2,0.5],\"normal\":[0,0,1],\"sequence\":12,"
      "\"episode\":12,"
      "\"bracket_low\":0.006,\"bracket_high\":0.005,\"epoch\":1,\"velocity\":[-1,0,0],\"velocity_error\":1e-09}\n");
}

TEST_F(EventsVerb, WhatHeldAtTheBeginOfTheWindowIsOpen) {
  write_run();
  EXPECT_EQ(
      told("--from 101.5 --to 103.5"),
      "open crate shelf 12\nopen crate drone 12\nopen drone shelf 12\nended drone shelf 13\nended crate drone 14\n");
  EXPECT_EQ(told("--from 102.5 --to 102.6"), "open crate shelf 13\nopen crate drone 13\n")
      << "what ended before does not hold";
  EXPECT_EQ(told("--from 103.5 --to 104"), "open crate shelf 14\nbegan cart shelf 15\n");
}

TEST_F(EventsVerb, BothEndsOfTheWindowBelongToIt) {
  write_run();
  const std::string both = "open crate shelf 14\nbegan cart shelf 15\nended crate shelf 16\n";
  EXPECT_EQ(told("--from 104 --to 105"), both);
  EXPECT_EQ(told("--from +4s --to -1s"), both);
  EXPECT_EQ(told("--from 1970-01-01T00:01:44Z --to 1970-01-01T00:01:45Z"), both);
  EXPECT_EQ(told("--from 104.000000001 --to 104.999999999"), "open crate shelf 15\nopen cart shelf 15\n");
  EXPECT_EQ(told("--from 105 --to 105"), "open crate shelf 15\nopen cart shelf 15\nended crate shelf 16\n")
      << "it held until then";
  // By when it happened, not by when it was told.
  EXPECT_EQ(told("--from 100.998 --to 100.998"), "open crate shelf 12\nopen crate drone 12\nbegan drone shelf 11\n");
}

TEST_F(EventsVerb, NamesChoosePairs) {
  write_run();
  EXPECT_EQ(told("--only 'd*'"),
            "began crate drone 12\nbegan drone shelf 11\nended drone shelf 13\nended crate drone 14\n");
  EXPECT_EQ(told("--skip 'd*'"), "open crate shelf 10\nbegan cart shelf 15\nended crate shelf 16\n");
  EXPECT_EQ(told("--only 'c*' --skip shelf"), "began crate drone 12\nended crate drone 14\n");
}

// A watch that begins in the past goes on with new events, so what it tells first is numbered upward too, though the second
// of two events happened first.
TEST(EventsSinceATime, AreNumberedUpward) {
  const auto event = [](const char* b, std::uint64_t sequence, double bracket_s) {
    Event began;
    began.a = "crate";
    began.b = b;
    began.epoch = 1;
    began.sequence = sequence;
    began.world_time = std::chrono::seconds(101);
    began.bracket_high_s = bracket_s;
    return began;
  };
  const std::vector<Event> heard{event("floor", 10, 0.5), event("shelf", 11, 0.002), event("drone", 12, 0.2),
                                 event("wall", 13, 0.005)};
  const auto numbers = [&](client::EventOrder order) {
    std::vector<std::uint64_t> told;
    for (const Event& one :
         client::in_window(heard, std::chrono::milliseconds(100'900), std::chrono::seconds(102), order))
      told.push_back(one.sequence);
    return told;
  };
  EXPECT_EQ(numbers(client::EventOrder::happened), (std::vector<std::uint64_t>{12, 12, 13, 11}));
  EXPECT_EQ(numbers(client::EventOrder::sequence), (std::vector<std::uint64_t>{10, 10, 11, 13}));
}

TEST_F(EventsVerb, NothingInTheWindowIsANo) {
  write_run();
  const Ran ran = at_terminal("events " + path() + " --from 103.2 --to 103.4 --only drone");
  EXPECT_EQ(ran.code, 1);
  EXPECT_EQ(ran.out, "");
  EXPECT_EQ(ran.err, "0 events in " + path() + ", recorded from 100.000 to 106.000; 0 lost\n");
}

TEST_F(EventsVerb, ACutFileIsReadUpToThereAndSaysSo) {
  std::uintmax_t whole = 0;
  write_run([&](std::uint64_t first) {
    if (first == 14) whole = std::filesystem::file_size(path());
    return true;
  });
  std::filesystem::resize_file(path(), whole + 20);
  const Ran ran = at_terminal("events " + path());
  EXPECT_EQ(ran.code, 0);
  EXPECT_EQ(ran.out,
            "open     crate x shelf  since 90.000\n"
            "100.995 began  crate x drone  depth 0.004 m at 1 2 0.5  seq 12\n"
            "100.998 began  drone x shelf  depth 0.004 m at 1 2 0.5  seq 11\n"
            "101.999 ended  drone x shelf  after 1 s  (separated)  seq 13\n");
  EXPECT_EQ(ran.err, "warning: " + path() + ": breaks off in the record at byte " + std::to_string(whole) +
                         "; what stands before it was read\n"
                         "4 events in " +
                         path() + ", recorded from 100.000 to 102.000; 0 lost\n");
}

// That the drone left the shelf is in no sample, and nothing is made up for it.
TEST_F(EventsVerb, LostEventsAreCounted) {
  write_run([](std::uint64_t first) { return first != 13; });
  const Ran ran = at_terminal("events " + path());
  EXPECT_EQ(ran.code, 0);
  EXPECT_EQ(ran.err, "warning: " + path() +
                         ": 1 events are not in it; what they changed is marked resync as far as it shows\n"
                         "6 events in " +
                         path() + ", recorded from 100.000 to 106.000; 1 lost\n");
  EXPECT_EQ(told("--only drone"), "began crate drone 12\nbegan drone shelf 11\nended crate drone 14\n");
  write_run([](std::uint64_t first) { return first < 15; });
  EXPECT_NE(collide("events " + path()).err.find("; 2 lost\n"), std::string::npos) << "the last ones too";
}

TEST_F(EventsVerb, AnEndWhoseBeginningWasLostBeginsThere) {
  write_run([](std::uint64_t first) { return first != 11; });
  const Ran ran = at_terminal("events " + path() + " --only drone");
  EXPECT_EQ(ran.out,
            "101.999 began  drone x shelf  depth 0.004 m at 1 2 0.5  seq 13  resync\n"
            "101.999 ended  drone x shelf  after 0 ns  (separated)  seq 13\n"
            "103.000 began  crate x drone  depth 0.004 m at 1 2 0.5  seq 14  resync\n"
            "103.000 ended  crate x drone  after 0 ns  (removed)  seq 14\n");
  EXPECT_NE(ran.err.find("; 2 lost\n"), std::string::npos) << ran.err;
}

TEST_F(EventsVerb, AContactWhoseBeginningIsInNoSampleHoldsFromTheBegin) {
  {
    EventRecording run(path());
    name_all(run);
    run.status(100, 10, {{kCrate, kShelf, 3, 90}});
    run.frame(105, 11, {{Kind::ended, kCrate, kShelf, 3, 0, 0, Reason::separated}});
    run.status(106, 11);
  }
  const Ran ran = at_terminal("events " + path());
  EXPECT_EQ(ran.out,
            "open     crate x shelf  since 100.000\n105.000 ended  crate x shelf  after 5 s  (separated)  seq 11\n");
  EXPECT_EQ(ran.err, "warning: " + path() +
                         ": of 1 contacts it tells the end but not since when they held: at least from its begin\n"
                         "2 events in " +
                         path() + ", recorded from 100.000 to 106.000; 0 lost\n");
}

TEST_F(EventsVerb, AContactThatNoSampleNamesIsMissedAloud) {
  {
    EventRecording run(path());
    run.status(100, 10, {{kCrate, kShelf, 3, 90}});
    run.status(101, 10, {{kCrate, kShelf, 3, 90}});
  }
  const Ran ran = collide("events " + path());
  EXPECT_EQ(ran.code, 1);
  EXPECT_NE(ran.err.find(": it does not tell of every contact that held at its begin\n"), std::string::npos) << ran.err;
}

// A shard that is too large leaves the names out: the contact's end has them. Who never gets a name is a number.
TEST_F(EventsVerb, NamesComeFromWhereTheyAre) {
  {
    EventRecording run(path(), 2);
    run.shard(99, 10, {{kCrate, kShelf, 3, 90}});
    run.shard(99, 10, {{4, 5, 4, 91}});
    name_all(run);
    run.status(100, 10, {{kCrate, kShelf, 3, 90}, {4, 5, 4, 91}});
    run.frame(105, 11, {{Kind::ended, kCrate, kShelf, 3, 0, 0, Reason::separated}});
    run.status(106, 11, {{4, 5, 4, 91}});
  }
  EXPECT_EQ(told(""), "open crate shelf 10\nopen #4 #5 10\nended crate shelf 11\n");
}

// A later shard knows what held before, and since when.
TEST_F(EventsVerb, ALaterSampleOfWhatHoldsTellsOfTheBegin) {
  {
    EventRecording run(path());
    name_all(run);
    run.status(100, 10, {{kCrate, kShelf, 3, 90}});
    run.frame(101, 11, {{Kind::began, kShelf, kDrone, 11}});
    run.shard(101, 11, {{kCrate, kShelf, 3, 90}});
    run.shard(101, 11, {{kShelf, kDrone, 11, 101}});
    run.status(102, 11, {{kCrate, kShelf, 3, 90}, {kShelf, kDrone, 11, 101}});
  }
  const Ran ran = at_terminal("events " + path());
  EXPECT_EQ(ran.out,
            "open     crate x shelf  since 90.000\n101.000 began  drone x shelf  depth 0.004 m at 1 2 0.5  seq 11\n");
  EXPECT_EQ(ran.err, "2 events in " + path() + ", recorded from 100.000 to 102.000; 0 lost\n");
}

TEST_F(EventsVerb, AServerThatStartsAgainEndsWhatIsGone) {
  {
    EventRecording run(path());
    name_all(run);
    run.status(100, 0);
    run.frame(101, 1, {{Kind::began, kCrate, kShelf, 1}});
    run.begin_life(2);
    run.empty_shards(109);
    run.status(110, 0);
    run.frame(111, 1, {{Kind::began, kShelf, kCart, 1}});
    run.status(112, 1, {{kShelf, kCart, 1, 111}});
  }
  const Ran ran = at_terminal("events " + path());
  EXPECT_EQ(ran.out,
            "101.000 began  crate x shelf  depth 0.004 m at 1 2 0.5  seq 1\n"
            "110.000 ended  crate x shelf  after 9 s  (server_restarted)  seq 0  resync\n"
            "111.000 began  cart x shelf  depth 0.004 m at 1 2 0.5  seq 1\n");
}

// The crate lies in the dock, the drone flies in and out of it and past the crate's band; it is the nearest for a while.
TEST_F(EventsVerb, StandingQuestionsAreListedTogetherAndByTheirForms) {
  constexpr std::uint64_t kDock = test::standing_id(1), kBand = test::standing_id(2), kNext = test::standing_id(3);
  const test::StandingStay crate{.standing = kDock, .object = kCrate, .episode = 5, .began_ns = 90'000'000'000};
  {
    EventRecording run(path());
    name_all(run);
    run.name(kDock, "dock");
    run.name(kBand, "close");
    run.name(kNext, "next");
    run.status(100, 0);
    run.standing_shard(100, 5, {crate});
    run.standing_sum(100.1, 5, {crate});
    run.standing_frame(101, 6,
                       {{.kind = News::approach,
                         .standing = kBand,
                         .object = kDrone,
                         .other = kCrate,
                         .episode = 6,
                         .band_m = 2,
                         .bracket_low_s = 0.003,
                         .bracket_high_s = 0.002},
                        {.kind = News::enter,
                         .standing = kDock,
                         .object = kDrone,
                         .episode = 7,
                         .bracket_low_s = 0.002,
                         .bracket_high_s = 0.001}});
    run.standing_frame(102, 8, {{.kind = News::changed, .standing = kNext, .object = kDrone}});
    run.standing_frame(
        103, 9, {{.kind = News::exit, .standing = kDock, .object = kDrone, .episode = 7, .reason = Reason::separated}});
    run.standing_frame(
        104, 10,
        {{.kind = News::changed, .standing = kNext, .other = kDrone, .episode = 8, .reason = Reason::removed}});
    run.standing_frame(104, 11,
                       {{.kind = News::leave,
                         .standing = kBand,
                         .object = kDrone,
                         .other = kCrate,
                         .episode = 6,
                         .band_m = 2,
                         .reason = Reason::removed}});
    run.standing_sum(105, 11, {crate});
  }
  const Ran fences = at_terminal("events " + path() + " --of fences");
  EXPECT_EQ(fences.code, 0);
  EXPECT_EQ(fences.out,
            "inside   dock  crate  since 90.000\n"
            "100.999 enter  dock  drone  seq 7\n"
            "103.000 exit  dock  drone  after 2 s  (separated)  seq 9\n");
  EXPECT_EQ(fences.err, "3 events in " + path() + ", recorded from 100.000 to 105.000; 0 lost\n");
  const auto plain = [&](const std::string& options) { return collide("events " + path() + " -q " + options).out; };
  EXPECT_EQ(plain("--of fences --from 102 --csv --fields what,object"),
            "what,object\ninside,crate\ninside,drone\nexit,drone\n");
  EXPECT_EQ(plain("--of fences --only drone --csv --fields what,sequence"), "what,sequence\nenter,7\nexit,9\n");
  EXPECT_EQ(plain("--of margins --csv --fields what,object,other,band,why"),
            "what,object,other,band,why\napproach,drone,crate,2,\nleave,drone,crate,2,removed\n");
  EXPECT_EQ(plain("--of nearest --csv --fields what,standing,other,object,why"),
            "what,standing,other,object,why\nchanged,next,,drone,\nchanged,next,drone,,removed\n");
  EXPECT_EQ(plain("--of standing --csv --fields form,what,object"),
            "form,what,object\nregion,inside,crate\nbands,approach,drone\nregion,enter,drone\nnearest,changed,drone\n"
            "region,exit,drone\nnearest,changed,\nbands,leave,drone\n")
      << "in the order of their numbers";
  EXPECT_EQ(collide("events " + path()).code, 1) << "no contacts";
  EXPECT_EQ(collide("events " + path() + " --of doors").code, 2);
}

TEST_F(EventsVerb, EventsOfStandingQuestionsThatAreLostAreCounted) {
  constexpr std::uint64_t kDock = test::standing_id(1);
  {
    EventRecording run(path());
    name_all(run);
    run.name(kDock, "dock");
    run.standing_sum(100, 0, {});
    run.standing_frame(101, 1, {{.kind = News::enter, .standing = kDock, .object = kDrone, .episode = 1}});
    run.standing_frame(102, 3, {{.kind = News::enter, .standing = kDock, .object = kDrone, .episode = 3}});
    run.standing_sum(103, 3, {{.standing = kDock, .object = kDrone, .episode = 3}});
  }
  const Ran ran = at_terminal("events " + path() + " --of fences");
  EXPECT_NE(ran.err.find(": 1 events of standing questions are not in it; "), std::string::npos) << ran.err;
  EXPECT_NE(ran.err.find("; 1 lost\n"), std::string::npos) << ran.err;
}

TEST_F(EventsVerb, WhatMakesNoSenseIsRefused) {
  write_run();
  EXPECT_EQ(collide("events").code, 2);
  const Ran turned = collide("events " + path() + " --from 104 --to 103");
  EXPECT_EQ(turned.code, 2);
  EXPECT_EQ(turned.err, "error: events: the end of what is asked for lies before its begin\n       nothing was read\n");
  const Ran when = collide("events " + path() + " --from noon");
  EXPECT_EQ(when.code, 2);
  EXPECT_EQ(when.err,
            "error: events: --from 'noon' is no time\n       2026-11-22T12:03:10.5Z, seconds since 1970, +2s after the "
            "begin or -2s before the end\n");
  const ScratchFile other("poses.csv", "t,name,x\n");
  const Ran csv = collide("events " + other.path());
  EXPECT_EQ(csv.code, 2);
  EXPECT_EQ(csv.err, "error: events: " + other.path() + ": is no MCAP file. Nothing was read\n");
}

// Whose columns had no names yet.
TEST_F(EventsVerb, ARecordingOfTheFirstWireIsSaidToBeOne) {
  {
    mcap::FileOutput output(path());
    mcap::FileWriter writer(
        output, "collided 0.1.0",
        {{"collided/event", "cdr", "collided::wire::EventFrame", "omgidl", "struct EventFrame {};", {}}});
    writer.write(1, 1, 1, {});
    ASSERT_TRUE(writer.close());
  }
  EXPECT_EQ(collide("events " + path()).err,
            "error: events: " + path() +
                ": was recorded by an earlier version, whose messages were laid out differently. Nothing was read\n");
}

TEST(TimeText, IsReadToTheNanosecond) {
  const auto ns = [](const char* text) {
    const RunTime time = cli::parse_time("--from", text, "");
    EXPECT_EQ(time.since, RunTime::Since::year_1970) << text;
    return time.offset.count();
  };
  EXPECT_EQ(ns("2026-11-22T12:03:10.5Z"), 1'795'348'990'500'000'000);
  EXPECT_EQ(ns("2026-11-22T13:03:10.5+01:00"), 1'795'348'990'500'000'000);
  EXPECT_EQ(ns("2026-11-22T06:33:10.5-05:30"), 1'795'348'990'500'000'000);
  EXPECT_EQ(ns("1795348990.500000001"), 1'795'348'990'500'000'001);
  EXPECT_EQ(ns("2028-02-29T00:00:00Z"), 1'835'395'200'000'000'000);
  EXPECT_EQ(ns("0"), 0);
  EXPECT_EQ(cli::parse_time("--from", "+1.5s", "").since, RunTime::Since::begin);
  EXPECT_EQ(cli::parse_time("--from", "+1.5s", "").offset, std::chrono::milliseconds(1500));
  EXPECT_EQ(cli::parse_time("--from", "-2min", "").since, RunTime::Since::end);
  EXPECT_EQ(cli::parse_time("--from", "-2min", "").offset, -std::chrono::minutes(2));
  for (const char* bad :
       {"", ".5", "5.", "1e9", "2026-11-22", "2026-11-22T12:03:10", "2026-02-29T00:00:00Z", "2026-13-01T00:00:00Z",
        "2026-11-22T24:00:00Z", "2026-11-22T12:03:10.Z", "2026-11-22T12:03:10.1234567890Z", "2026-11-22T12:03:10Zz",
        "99999999999", "1969-12-31T23:59:59Z", "+", "-", "+-2s", "-nan"}) {
    EXPECT_THROW(cli::parse_time("--from", bad, ""), cli::Failure) << bad;
  }
}

}  // namespace
}  // namespace collided
