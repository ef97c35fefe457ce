#include <atomic>
#include <bit>
#include <cmath>
#include <random>
#include <thread>
#include <vector>

#include "tests/service/server_fixture.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;
using ServerAnswers = testing_support::ServerTest;

std::vector<RayQuestion> random_rays(std::size_t count) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> x(-9, 9), y(-7, 7), z(-0.5, 4.5);
  std::vector<RayQuestion> rays;
  while (rays.size() < count) {
    const Vec3 origin(x(random), y(random), z(random));
    rays.push_back({.origin = origin, .direction = Vec3(x(random), y(random), z(random)) - origin});
  }
  return rays;
}

std::uint64_t bits(double number) { return std::bit_cast<std::uint64_t>(number); }

TEST_F(ServerAnswers, TheFloorIsFiveMetresBelow) {
  start();
  Client client = connect();
  const Result<Answer> answer = client.ask(RayQuestion{.origin = {6, 0, 5}, .direction = {0, 0, -1}});
  ASSERT_TRUE(answer) << answer.error().message;
  ASSERT_EQ(answer->verdict, Verdict::hit);
  EXPECT_EQ(answer->hits[0].object, "warehouse/floor");
  EXPECT_NEAR(answer->hits[0].distance_m, 5, answer->hits[0].error_m);
  EXPECT_EQ(client.ask(RayQuestion{.origin = {6, 0, 5}, .direction = {0, 0, 1}})->verdict, Verdict::miss);
}

// A ball of 10 cm comes down on the floor; a rod of 2 m turns above it and meets nothing.
TEST_F(ServerAnswers, AShapeOnItsWayMeetsTheFloor) {
  start();
  Client client = connect();
  const SweepQuestion motions[] = {{.from = {.position = {6, 0, 5}}, .to = {.position = {6, 0, -5}}},
                                   {.from = {.position = {6, 0, 5}}, .to = {.position = {6, 0, 4}}}};
  const Result<Answers> answers = client.sweep({SphereShape{.radius_m = 0.1}}, motions);
  ASSERT_TRUE(answers) << answers.error().message;
  ASSERT_EQ(answers->answers.size(), 2u);
  ASSERT_EQ(answers->answers[0].verdict, Verdict::hit);
  const Hit& hit = answers->answers[0].hits.at(0);
  EXPECT_EQ(hit.object, "warehouse/floor");
  EXPECT_LE(hit.time_low, 0.49);
  EXPECT_GE(hit.time_high, 0.49);
  EXPECT_LE(hit.time_high - hit.time_low, 1e-6);
  EXPECT_NEAR(hit.point.z(), 0, 1e-5);
  EXPECT_EQ(answers->answers[1].verdict, Verdict::miss);
  const SweepQuestion turn{.from = {.position = {6, 0, 4}},
                           .to = {.position = {6, 0, 4}, .rotation = Quat(0, 0, 0, 1)}};
  const Result<Answers> rod = client.sweep({BoxShape{.half_m = {1, 0.01, 0.01}}}, std::span(&turn, 1));
  ASSERT_TRUE(rod) << rod.error().message;
  EXPECT_EQ(rod->answers[0].verdict, Verdict::miss);
  const Result<Answers> nothing = client.sweep({}, motions);
  ASSERT_FALSE(nothing);
  EXPECT_EQ(nothing.error().code, ErrorCode::bad_input);
}

// Same version + same question = same bits, for any number of threads.
TEST_F(ServerAnswers, ManyThreadsGiveTheSameBits) {
  start({"--threads", "1", "--namespace", "one"}, "one");
  start({"--threads", "2", "--namespace", "two"}, "two");
  Client one = connect("one");
  Client two = connect("two");
  const std::vector<RayQuestion> rays = random_rays(100'000);
  const Result<Answers> a = one.ask(std::span(rays), {.timeout = 30s});
  const Result<Answers> b = two.ask(std::span(rays), {.timeout = 30s});
  ASSERT_TRUE(a) << a.error().message;
  ASSERT_TRUE(b) << b.error().message;
  std::size_t hits = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ASSERT_EQ(a->answers[i].verdict, b->answers[i].verdict) << i;
    ASSERT_EQ(a->answers[i].hits.size(), b->answers[i].hits.size()) << i;
    for (std::size_t h = 0; h < a->answers[i].hits.size(); ++h) {
      const Hit& left = a->answers[i].hits[h];
      const Hit& right = b->answers[i].hits[h];
      ASSERT_EQ(left.object, right.object) << i;
      ASSERT_EQ(left.triangle, right.triangle) << i;
      ASSERT_EQ(bits(left.distance_m), bits(right.distance_m)) << i;
      ASSERT_EQ(bits(left.error_m), bits(right.error_m)) << i;
      for (int axis = 0; axis < 3; ++axis) ASSERT_EQ(bits(left.point[axis]), bits(right.point[axis])) << i;
      ++hits;
    }
  }
  EXPECT_GT(hits, rays.size() / 2);
}

// A request in chunks is answered on one state, whatever moves meanwhile; the library refuses replies that disagree.
TEST_F(ServerAnswers, ARequestInChunksSeesOneState) {
  start();
  Client client = connect();
  Publisher publisher = publish(client, "mover");
  const Publisher::Object ball = add_ball(publisher, "ball", at(0, 0, 3));
  const std::vector<RayQuestion> rays(20'000, {.origin = {0, 0, 4}, .direction = {0, 0, -1}});
  for (int round = 0; round < 10; ++round) {
    std::future<Result<Answers>> asked = client.ask_async(rays);
    int sent = 0;
    while (asked.wait_for(1ms) != std::future_status::ready) move(publisher, ball, at(0, 0, 3 - 1e-3 * (sent++ % 100)));
    const Result<Answers> answers = asked.get();
    ASSERT_TRUE(answers) << answers.error().message;
    for (const Answer& answer : answers->answers) {
      ASSERT_EQ(answer.verdict, Verdict::hit);
      ASSERT_EQ(bits(answer.hits[0].distance_m), bits(answers->answers[0].hits[0].distance_m));
    }
  }
}

TEST_F(ServerAnswers, FreshReadsOwnWrites) {
  start();
  Client client = connect();
  Publisher publisher = publish(client, "mover");
  const Publisher::Object ball = add_ball(publisher, "ball", at(6, 0, 1));
  for (int i = 0; i < 200; ++i) {
    const double z = 1 + 0.01 * i;
    move(publisher, ball, at(6, 0, z));
    const Result<Answer> answer =
        client.ask(RayQuestion{.origin = {6, 0, 5}, .direction = {0, 0, -1}}, {.fresh = true});
    ASSERT_TRUE(answer) << answer.error().message;
    ASSERT_EQ(answer->verdict, Verdict::hit);
    ASSERT_EQ(answer->hits[0].object, "ball");
    ASSERT_NEAR(answer->hits[0].distance_m, 5 - z - 0.1, 1e-12) << i;
  }
}

TEST_F(ServerAnswers, ADeadlineThatIsOverIsUndecided) {
  start();
  Client client = connect();
  const std::vector<RayQuestion> rays = random_rays(10'000);
  const Result<Answers> answers = client.ask(std::span(rays), {.deadline = 1ns, .timeout = 30s});
  ASSERT_TRUE(answers) << answers.error().message;
  for (const Answer& answer : answers->answers) {
    ASSERT_EQ(answer.verdict, Verdict::undecided);
    ASSERT_EQ(answer.reason, UndecidedReason::deadline);
  }
}

// Who asks for no error or deadline gets the server's: exact and in its own time where it was started without.
TEST_F(ServerAnswers, TheServersErrorAndDeadlineAreOfQuestionsThatBringNone) {
  start({"--namespace", "plain"}, "plain");
  start({"--namespace", "loose", "--error", "1cm", "--deadline", "10min"}, "loose");
  start({"--namespace", "late", "--deadline", "1ns"}, "late");
  // A ray that grazes a tilted sheet at 1e-9 rad: the distance is sharpened for who needs it.
  const std::vector<Vec3> corners{{-1e3, -1e3, 20.1}, {1e3, -1e3, 20.3}, {0, 2e3, 20.7}};
  const Vec3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
  const Vec3 direction = (corners[2] - corners[0]).normalized() - 1e-9 * normal;
  const RayQuestion grazing{.origin = (corners[0] + corners[1] + corners[2]) / 3 - 100 * direction,
                            .direction = direction};
  int sheets = 0;
  const auto error_m = [&](const std::string& name, const AskOptions& options = {}) {
    const std::string sheet = "sheet" + std::to_string(++sheets);
    Client client = connect(name);
    Publisher publisher = publish(client, "tester");
    EXPECT_TRUE(publisher.add({.name = sheet, .shape = {MeshShape{.vertices = corners, .triangles = {{0, 1, 2}}}}}));
    AskOptions fresh = options;
    fresh.fresh = true;
    fresh.only = sheet;
    const Result<Answer> answer = client.ask(grazing, fresh);
    EXPECT_TRUE(answer) << answer.error().message;
    if (!answer || answer->verdict != Verdict::hit) return -1.0;
    return answer->hits[0].error_m;
  };
  const double exact_m = error_m("plain");
  EXPECT_GE(exact_m, 0);
  EXPECT_LT(exact_m, 1e-7);
  EXPECT_GT(error_m("loose"), exact_m);
  EXPECT_LE(error_m("loose"), 1e-2);
  EXPECT_LE(error_m("loose", {.error_m = 1e-9}), 1e-9);
  EXPECT_EQ(error_m("late"), -1.0);
  EXPECT_EQ(error_m("late", {.deadline = 10min}), exact_m);
}

// Reply partitions are fewer than clients may be, so some of these share one: each gets its own answers and no other's.
TEST_F(ServerAnswers, ClientsThatShareAPartitionGetTheirOwn) {
  start();
  constexpr int kClients = 64;
  std::vector<Client> clients;
  for (int i = 0; i < kClients; ++i) clients.push_back(connect());
  std::vector<std::thread> askers;
  std::atomic<int> right{0};
  for (int i = 0; i < kClients; ++i) {
    askers.emplace_back([&, i] {
      for (int round = 0; round < 10; ++round) {
        const double height_m = 5 + 0.01 * i + 0.001 * round;
        const Result<Answer> down =
            clients[static_cast<std::size_t>(i)].ask(RayQuestion{.origin = {6, 0, height_m}, .direction = {0, 0, -1}});
        right += down && !down->hits.empty() && std::abs(down->hits[0].distance_m - height_m) < 1e-9 ? 1 : 0;
      }
    });
  }
  for (std::thread& asker : askers) asker.join();
  EXPECT_EQ(right, 10 * kClients);
}

}  // namespace
}  // namespace collided
