#include <gtest/gtest.h>
#include <sys/stat.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <set>
#include <thread>

#include "client/cli/failure.hpp"
#include "client/cli/publish/path.hpp"
#include "tests/cli/fakes/fake_client.hpp"
#include "tests/cli/scratch_file.hpp"
#include "tests/cli/terminal.hpp"
#include "tests/service/own_domain.hpp"

namespace collided {
namespace {

class Publish : public testing::Test {
 protected:
  void SetUp() override { fake::reset(); }

  static const fake::Published& published() { return fake::server().publishers.at(0); }
};

constexpr const char* kPoses =
    "t,name,x,y,z,qw,qx,qy,qz\n"
    "100,a,0,0,1,1,0,0,0\n"
    "100,b,1,0,1,1,0,0,0\n"
    "100.01,a,0,0,2,0,1,0,0\n"
    "100.02,a,0,0,3,1,0,0,0\n"
    "100.02,c,5,0,3,1,0,0,0\n";

TEST_F(Publish, RowsOfOneTimeAreOneFrame) {
  const ScratchFile file("poses.csv", kPoses);
  const Ran ran =
      collide("publish " + file.path() + " --shape box:0.4,0.2,0.1 --json --fields frames,poses,objects,lost");
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(ran.out, "{\"frames\":3,\"poses\":5,\"objects\":3,\"lost\":0}\n");
  ASSERT_EQ(published().batches.size(), 3U);
  EXPECT_EQ(published().batches[0].size(), 2U);
  EXPECT_EQ(published().batches[1].at(1).position, Vec3(0, 0, 2));
  EXPECT_EQ(published().batches[1].at(1).rotation.x(), 1);
  EXPECT_EQ(published().objects.at(3).name, "c");
  EXPECT_EQ(published().objects.at(3).pose.position, Vec3(5, 0, 3));
  EXPECT_EQ(std::get<BoxShape>(published().objects.at(1).shape[0]).half_m, Vec3(0.2, 0.1, 0.05));
}

// The pose waits for the next flush; one that is refused ends the run.
TEST_F(Publish, AServerThatIsSilentForAWhileEndsNothing) {
  const ScratchFile file("poses.csv", "t,name,x,y,z\n0,a,1,2,3\n0.01,a,1,2,4\n0.02,a,1,2,5\n");
  int moves = 0;
  fake::server().on_move = [&]() -> std::optional<Error> {
    return ++moves == 2 ? std::optional(Error{ErrorCode::timeout, "publish: the server takes nothing more", ""})
                        : std::nullopt;
  };
  EXPECT_EQ(collide("publish " + file.path() + " --shape box:0.4,0.2,0.1 --json --fields frames").out,
            "{\"frames\":3}\n");
  EXPECT_EQ(moves, 3);
  fake::server().on_move = [] {
    return std::optional(Error{ErrorCode::bad_input, "object 'a': its pose is none", ""});
  };
  EXPECT_EQ(collide("publish " + file.path() + " --shape box:0.4,0.2,0.1").code, 2);
}

// However late a busy machine sends a frame, its poses are of the file's time.
TEST_F(Publish, StampsAreTheFilesOwnTimes) {
  const ScratchFile file("poses.csv", "t,x,y,z\n5,0,0,0\n5.01,1,0,0\n5.04,2,0,0\n");
  EXPECT_EQ(collide("publish " + file.path()).code, 0);
  const std::vector<std::chrono::nanoseconds> stamps = published().stamps;
  ASSERT_EQ(stamps.size(), 3U);
  EXPECT_NEAR(static_cast<double>((stamps[1] - stamps[0]).count()), 1e7, 2);
  EXPECT_NEAR(static_cast<double>((stamps[2] - stamps[0]).count()), 4e7, 2);
  EXPECT_FALSE(published().is_streamed) << "every frame names every object";
}

TEST_F(Publish, AFileWhoseObjectsHaveInstantsOfTheirOwnIsStreamed) {
  const ScratchFile file("poses.csv", "t,name,x,y,z\n0,a,0,0,0\n0.002,b,1,0,0\n0.01,a,2,0,0\n");
  EXPECT_EQ(collide("publish " + file.path()).code, 0);
  EXPECT_TRUE(published().is_streamed);
}

// While a pipe pauses, the publisher lives: a source slower than the lease is not lost after each row.
TEST_F(Publish, WhileItWaitsForInputItGivesSignsOfLifeWithItsTime) {
  const ScratchFile folder("beside", "");
  const std::string pipe = folder.path() + ".fifo";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  std::atomic<int> signs{0};
  std::atomic<std::int64_t> newest_ns{0};
  fake::server().on_keep_alive = [&](std::chrono::nanoseconds time) { ++signs, newest_ns = time.count(); };
  std::thread source([&] {
    std::ofstream rows(pipe);
    rows << "t,name,x,y,z\n0,a,0,0,0\n0.001,a,0,0,1\n" << std::flush;
    for (int i = 0; signs < 3 && i < 20'000; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    rows << "0.002,a,0,0,2\n";
  });
  const Ran ran = collide("publish " + pipe + " --gap 2s --json --fields frames");
  source.join();
  std::remove(pipe.c_str());
  EXPECT_EQ(ran.out, "{\"frames\":3}\n") << ran.err;
  EXPECT_GE(signs, 3);
  EXPECT_GT(newest_ns, published().stamps.front().count());
  EXPECT_EQ(published().options.gap, std::chrono::seconds(2));
}

TEST_F(Publish, ALossIsNamedOnce) {
  const ScratchFile file("poses.csv", "t,x,y,z\n0,0,0,0\n0.01,1,0,0\n0.02,2,0,0\n");
  fake::server().lost = "publisher 'a' was silent for 2 s";
  const Ran ran = collide("publish " + file.path());
  const std::size_t named = ran.err.find("publisher 'a' was silent for 2 s");
  EXPECT_NE(named, std::string::npos) << ran.err;
  EXPECT_EQ(ran.err.find("silent", named + 20), std::string::npos) << ran.err;
}

TEST_F(Publish, AGapIsWithinItsBounds) {
  for (const char* gap : {"0.5ms", "9s"}) {
    const Ran ran = collide(std::string("publish --waypoints '0,0,0 1,0,0' --gap ") + gap);
    EXPECT_EQ(ran.code, 2);
    EXPECT_NE(ran.err.find(std::string("--gap ") + gap + "; allowed 1ms to 8s"), std::string::npos) << ran.err;
  }
}

TEST_F(Publish, ASourceSlowerThanItsGapIsNamedOnce) {
  const ScratchFile file("slow.csv",
                         "t,name,x,y,z\n0,a,0,0,0\n0.02,a,1,0,0\n0.04,a,2,0,0\n0.06,a,3,0,0\n0.08,a,4,0,0\n");
  const std::string words = "frames are 0.02 s apart, longer than the gap of 0.01 s";
  const Ran slow = collide("publish " + file.path() + " --gap 10ms");
  const std::size_t named = slow.err.find(words);
  EXPECT_NE(named, std::string::npos) << slow.err;
  EXPECT_EQ(slow.err.find(words, named + 1), std::string::npos) << slow.err;
  EXPECT_EQ(collide("publish " + file.path()).err.find("gap"), std::string::npos);
}

TEST_F(Publish, FramesComeWhenTheyAreDue) {
  const ScratchFile file("poses.csv", "t,x,y,z\n0,0,0,0\n0.1,1,0,0\n0.2,2,0,0\n");
  std::vector<std::chrono::steady_clock::time_point> times;
  fake::server().on_flush = [&](fake::Published&) { times.push_back(std::chrono::steady_clock::now()); };
  // From before the run begins: on a busy machine its first frame may be late, and the second then comes sooner after it.
  std::chrono::steady_clock::time_point start;
  const auto publish = [&](const std::string& how) {
    times.clear();
    start = std::chrono::steady_clock::now();
    collide("publish " + file.path() + how);
  };
  const auto seconds = [&](std::size_t frame) {
    return std::chrono::duration<double>(times.at(frame) - start).count();
  };
  publish("");
  ASSERT_EQ(times.size(), 3U);
  EXPECT_GE(seconds(1), 0.1);
  EXPECT_GE(seconds(2), 0.2);
  // A busy machine may be late once, but not every time.
  double fastest = 1e9;
  for (int trial = 0; trial < 20 && fastest >= 0.2; ++trial) {
    publish(" --speed 4");
    EXPECT_GE(seconds(2), 0.05);
    fastest = std::min(fastest, seconds(2));
  }
  EXPECT_LT(fastest, 0.2);
  publish(" --rate 20");
  EXPECT_GE(seconds(2), 0.1);
}

TEST_F(Publish, ALoopGoesOnUntilItsTime) {
  const ScratchFile file("poses.csv", kPoses);
  const Ran ran = collide("publish " + file.path() + " --loop --steps 10 --rate 1kHz --json --fields frames,objects");
  EXPECT_EQ(ran.out, "{\"frames\":10,\"objects\":3}\n");
  EXPECT_EQ(published().objects.size(), 3U);
  EXPECT_EQ(published().batches[3].at(1).position, Vec3(0, 0, 1));
  const Ran timed = collide("publish " + file.path() + " --loop --for 50ms --plain --fields seconds");
  EXPECT_LT(std::stod(timed.out), 1);
}

TEST_F(Publish, BadRowsAreNamedAndLeftOut) {
  const ScratchFile file("poses.csv",
                         "t,name,x,y,z,qw,qx,qy,qz\n0,a,0,0,1,1,0,0,0\n0.001,a,0,nan,1,1,0,0,0\n0.002,a,0,0,1,0.5,0,0,"
                         "0\n0.003,a,0,0\n0.004,a,0,0,7,1,0,0,0\n");
  const Ran ran = collide("publish " + file.path() + " --json --fields frames,refused");
  EXPECT_EQ(ran.code, 6);
  EXPECT_EQ(ran.out, "{\"frames\":2,\"refused\":3}\n");
  EXPECT_EQ(ran.err, "error: " + file.path() + " line 3: 'nan' in column y; this pose was not sent\n" + "error: " +
                         file.path() + " line 4: quaternion norm 0.5, allowed 1 +- 1e-3; this pose was not sent\n" +
                         "error: " + file.path() + " line 5: 4 cells, 9 are needed; this pose was not sent\n");
}

// Its name was another's, or the keys did not allow it: nothing was in the world, and the run ended like any other.
TEST_F(Publish, WhatIsNotInTheWorldIsReportedCountedAndEndsWith5) {
  const ScratchFile file("poses.csv", kPoses);
  fake::server().left_out =
      Error{ErrorCode::refused, "object 'a' is not in the world: the name is taken; so are 1 more", "it waits"};
  fake::server().report.left_out_count = 2;
  const Ran ran = collide("publish " + file.path() + " --json --fields frames,refused");
  EXPECT_EQ(ran.code, 5);
  EXPECT_EQ(ran.out, "{\"frames\":3,\"refused\":2}\n") << "the run goes on: other objects may be in the world";
  EXPECT_EQ(ran.err, "error: object 'a' is not in the world: the name is taken; so are 1 more\n       it waits\n");
}

TEST_F(Publish, AFollowerOfRosThatIsNotTakenSaysWhyAndEndsWith5) {
  fake::server().report.refused = "1000 publishers are there";
  const Ran ran = collide("ros --ros-domain " + std::to_string(testing_support::own_domain()) +
                          " --for 10ms --json --fields poses");
  EXPECT_EQ(ran.code, 5);
  EXPECT_NE(ran.err.find("the server takes nothing of a publisher of this bridge: 1000 publishers are there"),
            std::string::npos)
      << ran.err;
}

TEST_F(Publish, AServerThatIsGoneAtTheEndIsReported) {
  const ScratchFile file("poses.csv", kPoses);
  fake::server().left_out = Error{ErrorCode::disconnected, "the server has been silent", ""};
  const Ran ran = collide("publish " + file.path() + " --json --fields frames");
  EXPECT_EQ(ran.code, 4);
  EXPECT_EQ(ran.err, "error: the server has been silent\n");
}

TEST_F(Publish, PosesThatAnOverloadedServerMergedAreCounted) {
  const ScratchFile file("poses.csv", kPoses);
  fake::server().report.merged_poses = 7;
  const Ran ran = collide("publish " + file.path() + " --json --fields frames,merged");
  EXPECT_EQ(ran.code, 0);
  EXPECT_EQ(ran.out, "{\"frames\":3,\"merged\":7}\n");
  EXPECT_NE(ran.err.find("7 poses gave way to newer ones"), std::string::npos) << ran.err;
}

TEST_F(Publish, PosesComeThroughAPipe) {
  const Ran ran = collide("publish - --json --fields frames,poses", {.in = "name,x,y,z\na,0,0,0\na,1,0,0\nb,2,0,0\n"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(ran.out, "{\"frames\":2,\"poses\":3}\n");
}

TEST_F(Publish, WithoutTimesAFileNeedsARate) {
  const ScratchFile file("poses.csv", "x,y,z\n0,0,0\n");
  EXPECT_EQ(collide("publish " + file.path()).err,
            "error: publish: " + file.path() +
                " has no column t\n       give --rate HZ to publish its frames at that rate\n");
  EXPECT_EQ(collide("publish " + file.path() + " --rate 100").code, 0);
}

TEST_F(Publish, OptionsOfAnotherKindAreRefused) {
  EXPECT_EQ(collide("publish --spheres 3 --unit 1cm").err,
            "error: publish: --unit has no meaning for this kind of publisher\n       collide help publish\n");
  EXPECT_EQ(collide("publish").code, 2);
  EXPECT_EQ(collide("publish --spheres 3 --waypoints '0,0,0 1,0,0'").code, 2);
  EXPECT_TRUE(fake::server().publishers.empty());
}

TEST_F(Publish, ADroneFliesItsPathAtItsSpeed) {
  const Ran ran = collide(
      "publish --waypoints '0,0,1 2,0,1 2,1,1' --speed 10m/s --rate 100 --shape box:0.4,0.4,0.1 --name drone_2 --json "
      "--fields frames,length,flown");
  EXPECT_EQ(ran.out, "{\"frames\":31,\"length\":3,\"flown\":3}\n") << ran.err;
  EXPECT_EQ(published().objects.at(1).name, "drone_2");
  EXPECT_EQ(published().batches[0].at(1).position, Vec3(0, 0, 1));
  EXPECT_NEAR((published().batches[10].at(1).position - Vec3(1, 0, 1)).norm(), 0, 1e-12);
  EXPECT_EQ(published().batches[30].at(1).position, Vec3(2, 1, 1));
}

TEST_F(Publish, APathFileNamesItsBadCell) {
  const ScratchFile file("path.csv", "x,y,z\n0,0,1\n2,zero,1\n");
  EXPECT_EQ(collide("publish --path " + file.path()).err,
            "error: publish: " + file.path() + " line 3: 'zero' in column y\n");
}

TEST(PathOfPoints, SegmentsOfNoLengthAreStepped) {
  const cli::Path path({{0, 0, 0}, {0, 0, 0}, {2, 0, 0}, {2, 0, 0}, {2, 2, 0}, {2, 2, 0}});
  EXPECT_EQ(path.length_m(), 4);
  EXPECT_EQ(path.at(0), Vec3(0, 0, 0));
  EXPECT_EQ(path.at(1), Vec3(1, 0, 0));
  EXPECT_EQ(path.at(2), Vec3(2, 0, 0));
  EXPECT_EQ(path.at(3), Vec3(2, 1, 0));
  EXPECT_EQ(path.at(99), Vec3(2, 2, 0));
  EXPECT_EQ(path.direction(0), Vec3(1, 0, 0));
  EXPECT_EQ(path.direction(2), Vec3(0, 1, 0));
  EXPECT_EQ(path.direction(4), Vec3(0, 1, 0));
  EXPECT_THROW(cli::Path({{0, 0, 0}, {0, 0, 0}}), cli::Failure);
}

TEST_F(Publish, ARecordingBecomesAPersonOfOneGroup) {
  const ScratchFile file(
      "walk.bvh",
      "HIERARCHY\nROOT Hips\n{\n OFFSET 0 0 0\n CHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation "
      "Xrotation\n"
      " JOINT LeftFoot\n {\n  OFFSET 0 -2 0\n  CHANNELS 3 Zrotation Yrotation Xrotation\n  End Site\n  {\n   OFFSET 0 "
      "0 1\n  }\n }\n}\n"
      "MOTION\nFrames: 3\nFrame Time: 0.001\n9 9 9 0 0 0 0 0 0\n1 2 3 0 0 0 0 0 0\n1 2 4 0 0 0 0 0 0\n");
  const Ran ran =
      collide("publish " + file.path() + " --unit 50cm --radius 0.2 --name ada --json --fields frames,poses,objects");
  EXPECT_EQ(ran.out, "{\"frames\":2,\"poses\":4,\"objects\":2}\n") << ran.err;
  EXPECT_EQ(published().objects.at(1).name, "ada/Hips");
  EXPECT_EQ(published().objects.at(2).name, "ada/LeftFoot");
  EXPECT_NE(published().objects.at(1).group, 0U);
  EXPECT_EQ(published().objects.at(1).group, published().objects.at(2).group);
  EXPECT_EQ(published().batches[1].at(1).position, Vec3(0.5, 1, 2));
}

/// Reports the spheres that touch, from the poses of each frame, as the server's events.
void report_contacts(fake::Published& published) {
  static std::set<std::pair<std::string, std::string>> open;
  if (published.batches.size() == 1) open.clear();
  std::set<std::pair<std::string, std::string>> now;
  const auto& poses = published.batches.back();
  const auto radius = [&](std::uint32_t handle) {
    return std::get<SphereShape>(published.objects.at(handle).shape[0]).radius_m;
  };
  for (auto a = poses.begin(); a != poses.end(); ++a) {
    for (auto b = std::next(a); b != poses.end(); ++b) {
      const bool touch = (a->second.position - b->second.position).norm() <= radius(a->first) + radius(b->first);
      if (touch) now.emplace(published.objects.at(a->first).name, published.objects.at(b->first).name);
    }
  }
  const auto send = [](EventKind what, const std::pair<std::string, std::string>& pair) {
    Event event;
    event.kind = what;
    event.a = pair.first;
    event.b = pair.second;
    fake::server().events.push_back(event);
  };
  for (const auto& pair : now) {
    if (!open.contains(pair)) send(EventKind::began, pair);
  }
  for (const auto& pair : open) {
    if (!now.contains(pair)) send(EventKind::ended, pair);
  }
  open = now;
}

// B4, A45: the server's events turn the spheres, and the energy stays.
TEST_F(Publish, SpheresBounceByTheServersEvents) {
  fake::server().on_flush = report_contacts;
  const Ran ran =
      collide("publish --spheres 20 --round --size 0.25 --speed 20 --seed 7 --bounce --rate 2000 --steps 400 --json");
  EXPECT_EQ(ran.code, 0) << ran.err;
  const nlohmann::json result = nlohmann::json::parse(ran.out);
  EXPECT_EQ(result["frames"], 400);
  EXPECT_GT(result["contacts"].get<int>(), 10);
  EXPECT_EQ(result["flips"], result["contacts"]);
  EXPECT_EQ(result["sticking"], 0);
  EXPECT_EQ(result["energy_before"], result["energy_after"]);
  fake::reset();
  fake::server().on_flush = report_contacts;
  const Ran literal =
      collide("publish --spheres 20 --round --size 0.25 --speed 20 --seed 7 --as-asked --rate 2000 --steps 400 --json");
  EXPECT_GT(nlohmann::json::parse(literal.out)["sticking"].get<int>(), 0);
}

// B8, B9
TEST_F(Publish, SpheresArePolygonsInACubeOfTwelve) {
  EXPECT_EQ(collide("publish --spheres 2 --polygons 256 --size 0.2 --seed 7 --steps 1").code, 0);
  ASSERT_EQ(published().objects.size(), 3U);
  EXPECT_EQ(published().objects.at(1).name, "spheres/cube");
  EXPECT_FALSE(published().objects.at(1).moving);
  EXPECT_EQ(std::get<MeshShape>(published().objects.at(1).shape[0]).triangles.size(), 12U);
  EXPECT_EQ(std::get<MeshShape>(published().objects.at(2).shape[0]).triangles.size(), 256U);
}

}  // namespace
}  // namespace collided
