#include <gtest/gtest.h>

#include "tests/cli/fakes/fake_client.hpp"
#include "tests/cli/scratch_file.hpp"
#include "tests/cli/terminal.hpp"

namespace collided {
namespace {

/// A floor at z = 0 that every ray going down meets; its name carries the ray's start, so that answers can't be mixed up.
class Batch : public testing::Test {
 protected:
  void SetUp() override {
    fake::reset();
    fake::server().ray = [](const RayQuestion& ray, const AskOptions&) {
      const double distance = -ray.origin.z() / ray.direction.z();
      if (!(distance >= 0) || distance > ray.length_m) return fake::hit_answer({});
      return fake::hit_answer({fake::hit("floor", distance, ray.origin + distance * ray.direction)});
    };
  }

  static Ran rays(const std::string& options, const std::string& input) {
    return collide("ray - -q " + options, {.in = input});
  }
};

TEST_F(Batch, EveryFormOfAFileIsTheSameRays) {
  const std::string expected = "7\thit\t5\n8\tmiss\t\n";
  const std::string fields = "--fields id,answer,distance";
  EXPECT_EQ(rays(fields, "id,fx,fy,fz,dx,dy,dz\n7,0,0,5,0,0,-1\n8,0,0,5,0,0,1\n").out, expected);
  EXPECT_EQ(rays(fields, "dz dy dx fz fy fx id\n-1 0 0 5 0 0 7\n1 0 0 5 0 0 8\n").out, expected);
  EXPECT_EQ(
      rays(fields, "{\"id\":7,\"from\":[0,0,5],\"dir\":[0,0,-1]}\n{\"id\":8,\"from\":[0,0,5],\"to\":[0,0,6]}\n").out,
      expected);
  EXPECT_EQ(rays(fields, "\xef\xbb\xbfid;fx;fy;fz;tx;ty;tz\r\n7;0;0;5;0;0;4\r\n# comment\r\n\r\n8;0;0;5;0;0;6").out,
            expected);
  EXPECT_EQ(
      rays(fields, "id\tfx\tfy\tfz\tdx\tdy\tdz\tlength\n7\t0\t0\t5\t0\t0\t-1\tinf\n8\t0\t0\t5\t0\t0\t-1\t4.5\n").out,
      expected);
}

TEST_F(Batch, WithoutAnIdRecordsAreNumbered) {
  EXPECT_EQ(rays("--fields id,answer", "0 0 5 0 0 -1\n-1 0 5 0 0 -1\n0 0 5 0 0 -1 2\n").out,
            "0\thit\n1\thit\n2\tmiss\n");
}

TEST_F(Batch, TheCallersIdComesBackAsItWas) {
  EXPECT_EQ(rays("--json --fields id,answer",
                 "{\"id\":\"a\\\"b\",\"from\":[0,0,5],\"dir\":[0,0,-1]}\n{\"id\":[1,{\"x\":2}],\"from\":[0,0,5],"
                 "\"dir\":[0,0,-1]}\n")
                .out,
            "{\"id\":\"a\\\"b\",\"answer\":\"hit\"}\n{\"id\":[1,{\"x\":2}],\"answer\":\"hit\"}\n");
  EXPECT_EQ(rays("--json --fields id", "id,fx,fy,fz,dx,dy,dz\n007,0,0,5,0,0,-1\nscan 3,0,0,5,0,0,-1\n").out,
            "{\"id\":\"007\"}\n{\"id\":\"scan 3\"}\n");
}

TEST_F(Batch, EachBadLineIsRefusedWithItsPlace) {
  const Ran ran = rays("--fields id,answer",
                       "id,fx,fy,fz,dx,dy,dz\n1,0,0,5,0,0,-1\n2,0,0,5,0,0,x\n3,0,0,5,0,0\n4,0,0,5,0,0,0\n5,0,0,inf,0,0,"
                       "-1\n6,0,0,5,0,0,\n7,0,0,5,0,0,-1\n");
  EXPECT_EQ(ran.code, 6);
  EXPECT_EQ(ran.out, "1\thit\n2\tinvalid\n2\tinvalid\n4\tinvalid\n5\tinvalid\n6\tinvalid\n7\thit\n");
  EXPECT_EQ(
      ran.err,
      "error: stdin line 3: 'x' in column dz; 1 rays answered, this one refused (--stop-on-error to stop)\n"
      "error: stdin line 4: 6 cells under a header of 7; 1 rays answered, this one refused (--stop-on-error to stop)\n"
      "error: stdin line 5: direction 0 0 0 has no direction; 1 rays answered, this one refused (--stop-on-error to "
      "stop)\n"
      "error: stdin line 6: start 0 0 inf must be finite; 1 rays answered, this one refused (--stop-on-error to stop)\n"
      "error: stdin line 7: where does the ray go?; 1 rays answered, this one refused (--stop-on-error to stop)\n");
}

TEST_F(Batch, BadJsonSaysAtWhichColumn) {
  const Ran ran = rays("--fields id,answer",
                       "{\"from\":[0,0,5],\"dir\":[0,0,NaN]}\n{\"from\":[0,0],\"dir\":[0,0,1]}\n{\"from\":[0,0,\"nan\"]"
                       ",\"dir\":[0,0,1]}\n{\"from\":[0,0,5],\"dir\":[0,0,-1],\"length\":\"inf\"}\n");
  EXPECT_EQ(ran.out, "0\tinvalid\n1\tinvalid\n2\tinvalid\n3\thit\n");
  EXPECT_NE(ran.err.find("stdin line 1: column 28: not JSON;"), std::string::npos) << ran.err;
  EXPECT_NE(ran.err.find("stdin line 2: 'from' must hold 3 numbers;"), std::string::npos) << ran.err;
  EXPECT_NE(ran.err.find("stdin line 3: 'nan' in column from;"), std::string::npos) << ran.err;
}

TEST_F(Batch, WhatIsNoNumberInJsonIsNamedOnOneLine) {
  const Ran ran = rays("--fields id,answer", "{\"from\":[0,{\"x\":[1,true]},5],\"dir\":[0,0,1]}\n");
  EXPECT_EQ(ran.out, "0\tinvalid\n");
  EXPECT_NE(ran.err.find("stdin line 1: {\"x\":[1,true]} in 'from';"), std::string::npos) << ran.err;
}

TEST_F(Batch, StopOnErrorStops) {
  const Ran ran = rays("--stop-on-error --fields id,answer", "0 0 5 0 0 -1\n0 0 5 0 0 x\n0 0 5 0 0 -1\n");
  EXPECT_EQ(ran.code, 6);
  EXPECT_EQ(ran.out, "0\thit\n1\tinvalid\n");
  EXPECT_EQ(ran.err, "error: stdin line 2: 'x' in column dz; 1 rays answered, this one refused; stopped\n");
}

TEST_F(Batch, AHeaderThatIsNotUnderstoodNamesTheColumns) {
  const Ran ran = rays("", "fx,fy,fz,dx,dy,dw\n0,0,5,0,0,-1\n");
  EXPECT_EQ(ran.code, 2);
  EXPECT_EQ(ran.err, "error: ray: line 1: no column 'dw' in rays; did you mean 'dx'?\n");
  EXPECT_EQ(rays("", "fx,fx,fz,dx,dy,dz\n0,0,5,0,0,-1\n").code, 2);
}

TEST_F(Batch, ALongFileBecomesRequestsOfGrowingSizeInOrder) {
  std::string input;
  const int count = 250'000;
  for (int ray = 0; ray < count; ++ray) input += "0 0 " + std::to_string(ray + 1) + " 0 0 -1\n";
  const Ran ran = rays("--fields id,distance", input);
  EXPECT_EQ(ran.code, 0);
  std::size_t at = 0;
  for (int ray = 0; ray < count; ++ray) {
    const std::string line = std::to_string(ray) + "\t" + std::to_string(ray + 1) + "\n";
    const bool same = ran.out.compare(at, line.size(), line) == 0 ||
                      std::stod(ran.out.substr(at + std::to_string(ray).size() + 1)) == ray + 1;
    ASSERT_TRUE(same) << ray;
    at = ran.out.find('\n', at) + 1;
  }
  EXPECT_EQ(at, ran.out.size());
  EXPECT_EQ(fake::server().request_sizes.front(), 1000U);
  for (const std::size_t size : fake::server().request_sizes) EXPECT_LE(size, 8'000U);
  EXPECT_LT(fake::server().request_sizes.size(), 36U);
}

TEST_F(Batch, TheSummaryGoesToStderr) {
  const Ran ran = collide(
      "ray -", {.err_is_terminal = true, .in = "0 0 5 0 0 -1\n0 0 5 0 0 1\n", .environment = {{"NO_COLOR", "1"}}});
  EXPECT_NE(ran.err.find(" 2 rays  "), std::string::npos) << ran.err;
  EXPECT_NE(ran.err.find("hit 1  miss 1  undecided 0"), std::string::npos);
}

TEST_F(Batch, AMissingServerEndsIt) {
  fake::server().ask_error = Error{ErrorCode::timeout, "no answer within 2 s", ""};
  const Ran ran = rays("", "0 0 5 0 0 -1\n");
  EXPECT_EQ(ran.code, 4);
  EXPECT_EQ(ran.err, "error: no answer within 2 s\n");
}

TEST_F(Batch, ALineWithoutEndIsRefusedNotKept) {
  const Ran ran = rays("--fields id,answer", "0 0 5 0 0 -1\n" + std::string(5 << 20, '1') + "\n0 0 5 0 0 -1\n");
  EXPECT_EQ(ran.code, 6);
  EXPECT_EQ(ran.out, "0\thit\n1\tinvalid\n2\thit\n");
  EXPECT_NE(ran.err.find("stdin line 2: longer than 1048576 bytes"), std::string::npos) << ran.err;
}

TEST_F(Batch, AFileIsNamedInItsErrors) {
  const ScratchFile file("rays.csv", "0,0,5,0,0,-1\n0,0,5,0,0,up\n");
  EXPECT_EQ(collide("ray " + file.path() + " -q").err,
            "error: " + file.path() +
                " line 2: 'up' in column dz; 1 rays answered, this one refused (--stop-on-error to stop)\n");
  EXPECT_EQ(collide("ray /").err, "error: ray: / is a folder\n");
}

TEST_F(Batch, SpheresBoxesAndPointsComeFromFilesToo) {
  fake::server().sphere = [](const SphereQuestion& q, const AskOptions&) {
    return q.radius_m > 1 ? fake::hit_answer({fake::hit("a", 0.5, q.center)}) : fake::hit_answer({});
  };
  fake::server().box = [](const BoxQuestion& q, const AskOptions&) {
    return q.half_m.x() > 1 ? fake::hit_answer({fake::hit("a", 0.5, q.center)}) : fake::hit_answer({});
  };
  fake::server().near = [](const NearQuestion& q, const AskOptions&) {
    return q.within_m > 1 ? fake::hit_answer({fake::hit("a", 0.5, q.point)}) : fake::hit_answer({});
  };
  EXPECT_EQ(collide("sphere - --fields id,answer,depth", {.in = "x,y,z,r\n0,0,0,2\n0,0,0,1\n"}).out,
            "0\thit\t0.5\n1\tmiss\t\n");
  EXPECT_EQ(collide("box - --fields id,point", {.in = "-1 -1 -1 3 1 1\n"}).out, "0\t1 0 0\n");
  EXPECT_EQ(
      collide("box - --fields id,answer", {.in = "{\"center\":[0,0,0],\"size\":[4,1,1],\"quat\":[1,0,0,0]}\n"}).out,
      "0\thit\n");
  EXPECT_EQ(collide("near - --count", {.in = "0 0 0\n"}).code, 2);
  EXPECT_EQ(collide("near - --fields id,answer", {.in = "0 0 0\n0 0 0 0.5\n"}).out, "0\thit\n1\tmiss\n");
}

}  // namespace
}  // namespace collided
