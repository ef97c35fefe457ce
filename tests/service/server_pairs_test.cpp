// Pairs of objects and probes through the library and a real server.  // A25 A46 B3
#include <atomic>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <thread>

#include "tests/service/server_fixture.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;

class ServerPairs : public testing_support::ServerTest {
 protected:
  static std::mt19937_64 seeded(std::uint64_t fallback) {
    const char* asked = std::getenv("COLLIDED_SEED");
    const std::uint64_t seed = asked != nullptr ? std::strtoull(asked, nullptr, 10) : fallback;
    std::printf("COLLIDED_SEED=%llu\n", static_cast<unsigned long long>(seed));
    return std::mt19937_64(seed);
  }
  PairAnswer pair(Client& client, const std::string& a, const std::string& b, const PairOptions& options = {}) {
    Result<PairAnswer> answer = client.pair(a, b, options);
    EXPECT_TRUE(answer) << answer.error().message << " " << answer.error().hint;
    return answer ? *answer : PairAnswer{};
  }
};

MeshShape tetrahedron() {
  return {.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
          .triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
}

std::vector<ShapePart> all_kinds() {
  return {SphereShape{.radius_m = 0.4},
          BoxShape{.half_m = {0.4, 0.3, 0.5}},
          CapsuleShape{.a = {0, 0, -0.4}, .b = {0, 0, 0.4}, .radius_m = 0.2},
          CylinderShape{.a = {0, 0, -0.4}, .b = {0, 0, 0.4}, .radius_m = 0.3},
          ConeShape{.apex = {0, 0, 0.6}, .base = {0, 0, -0.3}, .radius_m = 0.4},
          EllipsoidShape{.half_m = {0.5, 0.3, 0.2}},
          HullShape{.points = {{0, 0, 0}, {0.8, 0, 0}, {0, 0.8, 0}, {0, 0, 0.8}, {0.5, 0.5, 0.5}}},
          tetrahedron()};
}

/// How far a part reaches along n, in plain double, for the gap that the reader of a certificate works out himself.
double reach(const CertifiedPart& part, const Vec3& n) {
  const auto vec = [](const CertifiedPart::Numbers& v) { return Vec3(v[0], v[1], v[2]); };
  using Summand = CertifiedPart::Summand;
  double most = -1e300;
  for (std::size_t i = 0; i < part.points.size(); ++i) {
    double here = n.dot(vec(part.points[i]));
    if (part.summand == Summand::ball) here += part.radius_m * n.norm();
    if (part.summand == Summand::disc && (i == 1 || !part.tapers)) {
      here += part.radius_m * n.cross((vec(part.points[1]) - vec(part.points[0])).normalized()).norm();
    }
    double squares = 0;
    for (std::size_t k = 0; k < 3 && (part.summand == Summand::box || part.summand == Summand::ellipsoid); ++k) {
      const double along = part.half_m[k] * n.dot(vec(part.axes[k]));
      if (part.summand == Summand::box) here += std::abs(along);
      squares += along * along;
    }
    if (part.summand == Summand::ellipsoid) here += std::sqrt(squares);
    most = std::max(most, here);
  }
  return most;
}

/// Where one plane parts all: the gap between the two along its normal.
double gap_of(const Certificate& c) {
  const auto& n = c.steps.at(0).normal;
  const Vec3 normal = Vec3(n[0], n[1], n[2]).normalized();
  double a = -1e300;
  double b = -1e300;
  for (const CertifiedPart& part : c.a) a = std::max(a, reach(part, normal));
  for (const CertifiedPart& part : c.b) b = std::max(b, reach(part, -normal));
  return -(a + b);
}

TEST_F(ServerPairs, EveryAnswerComesWithAProofThatIsCheckedHere) {
  start();
  Client client = connect();
  Publisher publisher = publish(client, "kinds");
  std::mt19937_64 generator = seeded(25);
  std::uniform_real_distribution<double> any(-1, 1);
  std::vector<Publisher::Object> objects;
  const std::vector<ShapePart> kinds = all_kinds();
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    const Result<Publisher::Object> added = publisher.add({.name = "kind" + std::to_string(i), .shape = {kinds[i]}});
    ASSERT_TRUE(added) << added.error().message;
    objects.push_back(*added);
  }
  int touching = 0;
  int apart = 0;
  int with_one_plane = 0;
  for (int round = 0; round < 6; ++round) {
    for (const Publisher::Object object : objects) {
      const Quat turn = Quat(any(generator), any(generator), any(generator), any(generator)).normalized();
      ASSERT_TRUE(publisher.move(
          object,
          {.position = {0.6 * any(generator), 0.6 * any(generator), 20 + 0.6 * any(generator)}, .rotation = turn}));
    }
    ASSERT_TRUE(publisher.flush());
    ASSERT_TRUE(publisher.wait_applied(20s));
    for (std::size_t i = 0; i < kinds.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const PairAnswer answer =
            pair(client, "kind" + std::to_string(i), "kind" + std::to_string(j), {.certificate = true});
        ASSERT_NE(answer.verdict, Verdict::undecided);
        ASSERT_TRUE(answer.certificate) << answer.no_certificate << " " << i << " and " << j;
        Certificate certificate = *answer.certificate;
        ASSERT_EQ(certificate.touches, answer.verdict == Verdict::hit);
        ASSERT_TRUE(proves(certificate)) << i << " and " << j;
        (certificate.touches ? touching : apart) += 1;
        if (certificate.touches) {
          certificate.point[0].push_back(5 * certificate.divisor[0]);
          ASSERT_FALSE(proves(certificate)) << "a point that is somewhere else";
          continue;
        }
        if (certificate.steps.size() == 1) {
          ++with_one_plane;
          ASSERT_GT(gap_of(certificate), 0);
          ASSERT_LE(gap_of(certificate), answer.distance_m + answer.error_m + 1e-12)
              << "no gap is wider than the distance";
        }
        for (CertifiedPart& part : certificate.b) {
          for (CertifiedPart::Numbers& point : part.points) {
            for (std::size_t k = 0; k < 3; ++k)
              point[k] -= (answer.distance_m * 1.01 + 1e-9) * answer.normal[static_cast<Eigen::Index>(k)];
          }
        }
        ASSERT_FALSE(proves(certificate)) << "moved together, the two touch";
      }
    }
  }
  EXPECT_GT(touching, 20);
  EXPECT_GT(apart, 20);
  EXPECT_GT(with_one_plane, 15);
  std::printf("%d touching, %d apart (%d by one plane), all proved here\n", touching, apart, with_one_plane);
}

// FCL runs in a process of its own beside the server, and only where it was asked for.
TEST_F(ServerPairs, FclsOpinionComesWhereItIsAskedFor) {
  start();
  Client client = connect();
  const std::vector<ShapePart> kinds = all_kinds();
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    for (const double x : {0.1, 3.0}) {
      const std::string name = "thing" + std::to_string(i) + (x < 1 ? "_in" : "_apart");
      ASSERT_TRUE(client.add({.name = name, .shape = {kinds[i]}, .pose = at(x, 0.1 * static_cast<double>(i), 20)}));
    }
    const std::string name = "thing" + std::to_string(i);
    EXPECT_FALSE(pair(client, name + "_in", name + "_apart").opinion);
    const PairAnswer answer = pair(client, name + "_in", name + "_apart", {.opinion = "fcl"});
    ASSERT_TRUE(answer.opinion);
    if (answer.opinion->why.find("which is not in") != std::string::npos) GTEST_SKIP() << "built without FCL";
    EXPECT_EQ(answer.opinion->verdict, OpinionVerdict::agree) << name << " " << answer.opinion->why;
    EXPECT_EQ(answer.opinion->touches, false);
    EXPECT_NEAR(answer.opinion->distance_m.value_or(-1), answer.distance_m, 1e-5);
  }
  const Result<PairAnswer> refused = client.pair("thing0_in", "thing1_in", {.opinion = "bullet"});
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("allowed: fcl"), std::string::npos) << refused.error().message;
}

/// A ball's surface as 4 rings (rings - 1) triangles.
void write_shell(const std::string& path, int rings, double radius_m) {
  std::ofstream file(path);
  file.precision(17);
  const int around = 2 * rings;
  for (int i = 0; i <= rings; ++i) {
    for (int j = 0; j < around; ++j) {
      const double down = M_PI * i / rings;
      const double turn = M_PI * j / rings;
      file << "v " << radius_m * std::sin(down) * std::cos(turn) << ' ' << radius_m * std::sin(down) * std::sin(turn)
           << ' ' << radius_m * std::cos(down) << '\n';
    }
  }
  for (int i = 0; i < rings; ++i) {
    for (int j = 0; j < around; ++j) {
      const int here = i * around + j + 1;
      const int next = i * around + (j + 1) % around + 1;
      if (i > 0) file << "f " << here << ' ' << here + around << ' ' << next << '\n';
      if (i < rings - 1) file << "f " << next << ' ' << here + around << ' ' << next + around << '\n';
    }
  }
}

/// Two shells a millimetre apart, of 68,120 triangles each: examining them takes a second or more.
class ServerCostlyPairs : public ServerPairs {
 protected:
  void load_shells(Client& client) {
    for (const auto& [name, radius_m] : {std::pair("inner", 0.999), std::pair("outer", 1.0)}) {
      const std::string path = folder_.path() + "/" + name + ".obj";
      write_shell(path, 131, radius_m);
      const Result<Loaded> loaded = client.load(path, {.name = name});
      ASSERT_TRUE(loaded) << loaded.error().message;
    }
  }
  static double ms_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  }
};

TEST_F(ServerCostlyPairs, EndAtTheirDeadline) {
  start();
  Client client = connect();
  load_shells(client);
  auto start = std::chrono::steady_clock::now();
  const PairAnswer whole = pair(client, "inner", "outer", {.timeout = 60s});
  const double whole_ms = ms_since(start);
  EXPECT_EQ(whole.verdict, Verdict::miss);
  double fastest_ms = whole_ms;
  for (int i = 0; i < 5; ++i) {
    start = std::chrono::steady_clock::now();
    const PairAnswer late = pair(client, "inner", "outer", {.deadline = 5ms, .timeout = 60s});
    fastest_ms = std::min(fastest_ms, ms_since(start));
    EXPECT_EQ(late.verdict, Verdict::undecided);
    EXPECT_EQ(late.reason, UndecidedReason::deadline);
  }
  std::printf("pair of two shells: %.1f ms, with a deadline of 5 ms %.1f ms\n", whole_ms, fastest_ms);
  EXPECT_LT(fastest_ms, whole_ms / 10);
  EXPECT_EQ(pair(client, "inner", "outer", {.deadline = 10min, .timeout = 60s}).distance_m, whole.distance_m);
}

// The costly ones of eight clients take turns on a thread of their own.
TEST_F(ServerCostlyPairs, AnothersCheapPairDoesNotWaitBehindThem) {
  start();
  Client client = connect();
  load_shells(client);
  for (const double x : {40.0, 43.0})
    ASSERT_TRUE(
        client.add({.name = x < 41 ? "left" : "right", .shape = {BoxShape{.half_m = {1, 1, 1}}}, .pose = at(x, 0, 0)}));
  const auto cheap_ms = [&] {
    const auto start = std::chrono::steady_clock::now();
    EXPECT_EQ(pair(client, "left", "right", {.timeout = 60s}).verdict, Verdict::miss);
    return ms_since(start);
  };
  double alone_ms = cheap_ms();
  for (int i = 0; i < 4; ++i) alone_ms = std::min(alone_ms, cheap_ms());
  std::vector<Client> askers;
  for (int i = 0; i < 8; ++i) askers.push_back(connect());
  std::atomic<int> answered{0};
  std::vector<std::thread> threads;
  for (Client& asker : askers) {
    threads.emplace_back([&] {
      const Result<PairAnswer> answer = asker.pair("inner", "outer", {.timeout = 100s});
      EXPECT_TRUE(answer) << answer.error().message;
      ++answered;
    });
  }
  const auto give_up = std::chrono::steady_clock::now() + 60s;
  while (answered.load() == 0 && std::chrono::steady_clock::now() < give_up) std::this_thread::sleep_for(1ms);
  double beside_ms = cheap_ms();
  for (int i = 0; i < 4; ++i) beside_ms = std::min(beside_ms, cheap_ms());
  EXPECT_LT(answered.load(), 8) << "none was left to wait behind";
  for (std::thread& thread : threads) thread.join();
  std::printf("cheap pair: alone %.1f ms, beside eight costly ones %.1f ms\n", alone_ms, beside_ms);
  EXPECT_LT(beside_ms, 100);
}

// Such a name is nobody's, and must not become another one's on the way.
TEST_F(ServerPairs, NamesThatAreNotTextAreRefusedBeforeAnythingIsSent) {
  start();
  Client client = connect();
  const Result<PairAnswer> pair = client.pair("\xff", "warehouse/floor");
  ASSERT_FALSE(pair);
  EXPECT_EQ(pair.error().code, ErrorCode::bad_input);
  EXPECT_EQ(pair.error().message, "pair: a name is not UTF-8 text. Nothing was sent");
  const Result<void> probe = client.add_probe({.name = "eye", .object = "cr\xc3te"});
  ASSERT_FALSE(probe);
  EXPECT_EQ(probe.error().code, ErrorCode::bad_input);
}

TEST_F(ServerPairs, TrianglesComeAsTheyAreAskedFor) {
  start();
  Client client = connect();
  Publisher publisher = publish(client, "meshes");
  ASSERT_TRUE(publisher.add({.name = "a", .shape = {tetrahedron()}, .pose = at(0, 0, 20)}));
  ASSERT_TRUE(publisher.add({.name = "b", .shape = {tetrahedron()}, .pose = at(0.1, 0.1, 19.5)}));
  ASSERT_TRUE(publisher.flush());
  ASSERT_TRUE(publisher.wait_applied(20s));
  const PairAnswer all = pair(client, "a", "b", {.triangles = true});
  EXPECT_EQ(all.verdict, Verdict::hit);
  EXPECT_FALSE(all.cut);
  ASSERT_EQ(all.triangle_pairs.size(), all.triangle_pair_count);
  ASSERT_GT(all.triangle_pair_count, 2u);
  for (const TrianglePair& t : all.triangle_pairs) {
    EXPECT_LT(t.a_triangle, 4u);
    EXPECT_LT(t.error_m, 1e-12);
  }
  const PairAnswer turned = pair(client, "b", "a", {.triangles = true});
  EXPECT_EQ(turned.triangle_pair_count, all.triangle_pair_count);
  EXPECT_EQ(turned.normal, -all.normal);
  ASSERT_EQ(turned.manifold.size(), all.manifold.size());
  for (std::size_t i = 0; i < all.manifold.size(); ++i) EXPECT_EQ(turned.manifold[i].point, all.manifold[i].point);
  const PairAnswer two = pair(client, "a", "b", {.triangles = true, .most_triangle_pairs = 2});
  EXPECT_TRUE(two.cut);
  EXPECT_EQ(two.triangle_pairs.size(), 2u);
  EXPECT_EQ(two.triangle_pair_count, all.triangle_pair_count);
  EXPECT_EQ(client.pair("a", "c").error().message,
            "server refused: object 'c' is not in the world (33 objects); nearest names: a, b");
  EXPECT_FALSE(client.pair("a", "a"));
  EXPECT_FALSE(client.pair("a", "b", {.most_triangle_pairs = 100'001}));
}

TEST_F(ServerPairs, ProbesAreReadAfterEveryStep) {
  start();
  Client client = connect();
  Publisher publisher = publish(client, "cars");
  const Result<Publisher::Object> car = publisher.add({.name = "car",
                                                       .shape = {BoxShape{.half_m = {1, 0.5, 0.25}}},
                                                       .pose = at(0, 3, 2),
                                                       .lost_policy = LostPolicy::hold});
  ASSERT_TRUE(car);
  ASSERT_TRUE(publisher.flush());
  ASSERT_TRUE(publisher.wait_applied(20s));
  for (const double x : {-0.9, 0.9}) {
    ASSERT_TRUE(client.add_probe({.name = x < 0 ? "rear" : "front", .object = "car", .origin = {x, 0, -0.25}}));
  }
  ASSERT_TRUE(
      client.add_probe({.name = "lost", .object = "lorry", .reach_m = std::numeric_limits<double>::infinity()}));
  const Result<std::vector<ProbeReading>> now = client.probes();
  ASSERT_TRUE(now) << now.error().message;
  ASSERT_EQ(now->size(), 3u);
  EXPECT_EQ((*now)[0].met, "warehouse/floor");
  EXPECT_NEAR((*now)[0].clearance_m, 1.75, 1e-12);
  EXPECT_EQ((*now)[2].state, Clearance::absent);
  Result<ProbeWatch> watch = client.watch_probes({.only = "[fr]*"});
  ASSERT_TRUE(watch) << watch.error().message;
  int moves = 0;
  struct Wanted {
    double z;
    Clearance state;
  };
  for (const Wanted& wanted : {Wanted{0.75, Clearance::gap},
                               {0.25, Clearance::touching},
                               {0.125, Clearance::collision},
                               {-5, Clearance::nothing}}) {
    std::set<std::string> told;
    const auto give_up = std::chrono::steady_clock::now() + 30s;
    while (told.size() < 2) {
      ASSERT_LT(std::chrono::steady_clock::now(), give_up);
      // To and fro: the server may not have met the reader by the first pose, and the same one again is no step.
      move(publisher, *car, at(0, ++moves % 2 == 0 ? 3 : 3.001, wanted.z));
      const std::optional<ProbeReading> reading = watch->next(1s);
      if (!reading || reading->state != wanted.state) continue;
      EXPECT_EQ(reading->object, "car");
      if (wanted.state != Clearance::nothing) { EXPECT_NEAR(reading->clearance_m, wanted.z - 0.25, 1e-12); }
      told.insert(reading->probe);
    }
    EXPECT_EQ(told, (std::set<std::string>{"front", "rear"}));
  }
  EXPECT_EQ(watch->lost(), 0u);
  // Each of both words leaves out, whatever the other says.
  Result<ProbeWatch> one = client.watch_probes({.only = "[fr]*", .skip = "r*"});
  Result<ProbeWatch> others = client.watch_probes({.skip = "front"});
  ASSERT_TRUE(one && others);
  std::set<std::string> of_one, of_others;
  ASSERT_TRUE(test::eventually([&] {
    move(publisher, *car, at(0, ++moves % 2 == 0 ? 3 : 3.001, 2));
    while (const std::optional<ProbeReading> reading = one->next(10ms)) of_one.insert(reading->probe);
    while (const std::optional<ProbeReading> reading = others->next(10ms)) of_others.insert(reading->probe);
    return !of_one.empty() && of_others.size() >= 2;
  }));
  EXPECT_EQ(of_one, std::set<std::string>{"front"});
  EXPECT_EQ(of_others, (std::set<std::string>{"lost", "rear"}));
  EXPECT_EQ(*client.remove_probes("*"), 3u);
  EXPECT_TRUE(client.probes()->empty());
  EXPECT_FALSE(client.add_probe({.name = "p", .object = "car", .direction = Vec3::Zero()}));
  EXPECT_FALSE(client.add_probe({.name = "", .object = "car"}));
}

// A ball passes another by 0.2 m between two poses, 0.1 s before it stops 2.6 m from it.
TEST_F(ServerPairs, HowNearTwoCameBetweenPosesIsExplained) {
  start();
  Client client = connect();
  ASSERT_TRUE(client.add(
      {.name = "post", .shape = {SphereShape{.radius_m = 0.4}}, .pose = {.position = {0, 1, 50}}, .layers = 4}));
  Publisher publisher = publish(client, "flight");
  const Result<Publisher::Object> drone =
      publisher.add({.name = "drone", .shape = {SphereShape{.radius_m = 0.4}}, .pose = at(-3, 0, 50), .mask = 1});
  ASSERT_TRUE(drone) << drone.error().message;
  ASSERT_TRUE(publisher.flush());
  std::this_thread::sleep_for(200ms);  // the way from here takes as long
  move(publisher, *drone, at(3, 0, 50));
  ASSERT_TRUE(publisher.wait_applied(20s));
  const auto explained = [&](const std::string& rest) {
    Result<std::string> text = client.command("explain", R"({"a":"drone","b":"post")" + rest + "}");
    EXPECT_TRUE(text) << text.error().message;
    return text ? nlohmann::json::parse(*text) : nlohmann::json();
  };
  const nlohmann::json answer = explained("");
  EXPECT_EQ(answer.at("answer"), "miss");
  EXPECT_EQ(answer.at("why_not"), (std::vector<std::string>{"layers 0x4 of 'post' are not in mask 0x1 of 'drone'"}));
  const nlohmann::json& nearest = answer.at("nearest");
  EXPECT_EQ(nearest.at("end"), "found");
  EXPECT_NEAR(nearest.at("distance").get<double>(), 0.2, 3e-4);
  EXPECT_LE(nearest.at("at_least").get<double>(), 0.2 + 1e-12);
  EXPECT_GE(nearest.at("at_least").get<double>(), 0.1995);
  EXPECT_LE(nearest.at("time_ns").get<std::int64_t>(), nearest.at("to_ns").get<std::int64_t>());
  // Of the last microsecond only the end of the way is left.
  EXPECT_GT(explained(R"(,"last_ns":1000)").at("nearest").at("distance").get<double>(), 2);
  for (const char* bad : {R"(,"last_ns":-1)", R"(,"last":5)", R"(,"b":"drone")"}) {
    Result<std::string> refused = client.command("explain", R"({"a":"drone","b":"post")" + std::string(bad) + "}");
    EXPECT_FALSE(refused) << bad;
  }
}

}  // namespace
}  // namespace collided
