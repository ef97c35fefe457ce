#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "idl/clocks.hpp"
#include "idl/question_rules.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "server/world/query/query.hpp"
#include "server/world/world.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"

// Rays that static scenes alone can stop are answered without the state that other questions carry. A deadline, however
// far away, takes the general way: the slow twin.
namespace collided::engine {
namespace {

constexpr double kEndless = std::numeric_limits<double>::infinity();
constexpr std::int64_t kAnHourNs = 3'600'000'000'000;

class WorldPlainRays : public testing::Test {
 protected:
  /// Two halves a scene, each an object of its own.
  void add(const std::string& name, const TriangleMesh& mesh, BvhForm form = BvhForm::best) {
    const auto half = static_cast<std::uint32_t>(mesh.triangles.size() / 2);
    const auto rest = static_cast<std::uint32_t>(mesh.triangles.size()) - half;
    Scene scene{.name = name, .mesh = mesh};
    scene.parts = {{name + "/a", 0, half, {}}, {name + "/b", half, rest, {}}};
    indexed_.push_back(
        World::index_scene(std::move(scene), {.threads = 1, .progress = {}, .cancelled = {}, .form = form}));
    ASSERT_TRUE(std::holds_alternative<std::uint32_t>(world_.add_scene(indexed_.back())));
    world_.step(++now_ns_, 1, {});
  }
  Answers ask(HitMode mode, std::span<const double> numbers, std::int64_t deadline_ns, bool with_hits = true) {
    Answers answers;
    const Questions asked{.kind = QuestionKind::ray,
                          .mode = mode,
                          .with_hits = with_hits,
                          .deadline_ns = deadline_ns,
                          .numbers = numbers};
    answer(*world_.newest(), asked, answers, scratch_);
    return answers;
  }
  Answers plainly(HitMode mode, std::span<const double> numbers) { return ask(mode, numbers, 0); }
  Answers generally(HitMode mode, std::span<const double> numbers) {
    return ask(mode, numbers, wire_contract::steady_ns() + kAnHourNs);
  }

  World world_{WorldOptions{}};
  std::vector<IndexedScene> indexed_;
  QueryScratch scratch_;
  std::int64_t now_ns_ = 0;
};

void expect_same_bits(const Answers& a, const Answers& b) {
  EXPECT_EQ(a.answers, b.answers);
  EXPECT_EQ(a.reasons, b.reasons);
  EXPECT_EQ(a.levels, b.levels);
  EXPECT_EQ(a.nodes, b.nodes);
  EXPECT_EQ(a.exact_tests, b.exact_tests);
  EXPECT_EQ(a.oldest_pose_ns, b.oldest_pose_ns);
  ASSERT_EQ(a.hit_counts, b.hit_counts);
  ASSERT_EQ(a.hits.size(), b.hits.size());
  const auto same = [](double x, double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
  };
  for (std::size_t i = 0; i < a.hits.size(); ++i) {
    const AnswerHit& x = a.hits[i];
    const AnswerHit& y = b.hits[i];
    EXPECT_TRUE(x.object == y.object && x.triangle == y.triangle && x.flags == y.flags) << i;
    EXPECT_TRUE(same(x.distance_m, y.distance_m) && same(x.error_m, y.error_m) && same(x.exit_m, y.exit_m)) << i;
    EXPECT_TRUE(same(x.point_error_m, y.point_error_m)) << i;
    for (int k = 0; k < 3; ++k) {
      EXPECT_TRUE(same(x.point[k], y.point[k]) && same(x.normal[k], y.normal[k])) << i;
      EXPECT_TRUE(same(x.weights[k], y.weights[k])) << i;
    }
  }
}

Vec3 in_cube(std::mt19937_64& random) {
  std::uniform_real_distribution<double> number(-1, 1);
  const double x = number(random);
  const double y = number(random);
  return {x, y, number(random)};
}

void add_ray(const Vec3& origin, const Vec3& direction, double length_m, std::vector<double>& numbers) {
  numbers.insert(numbers.end(), {origin.x(), origin.y(), origin.z(), direction.x(), direction.y(), direction.z()});
  numbers.push_back(length_m);
}

/// At corners, edges and nothing in particular; some short, some of extreme scale, some no rays at all.
std::vector<double> hard_rays(const TriangleMesh& mesh, std::size_t count, std::mt19937_64& random) {
  std::vector<double> numbers;
  while (numbers.size() < count * kRayNumbers) {
    const Triangle t = mesh.triangle(static_cast<std::uint32_t>(random() % mesh.triangles.size()));
    const Vec3 targets[4] = {t.a, (t.a + t.b) / 2, (t.a + t.b + t.c) / 3, in_cube(random)};
    const Vec3 target = targets[random() % 4];
    Vec3 origin = random() % 8 == 0 ? t.b : 2 * in_cube(random);
    Vec3 direction = target - origin;
    double length_m = random() % 3 == 0 ? direction.norm() : kEndless;
    const auto kind = random() % 40;
    if (kind == 0) direction.setZero();
    if (kind == 1) direction *= 0x1p-1060;
    if (kind == 2) direction *= 0x1p900;
    if (kind == 3) length_m = 0x1p1000;
    if (kind == 4) length_m = std::numeric_limits<double>::quiet_NaN();
    // Each is within the limit, and their sum is not.
    if (kind == 5) origin.setConstant(wire_contract::kMostCoordinate);
    if (kind == 6) origin[static_cast<int>(random() % 3)] = kEndless;
    if (kind == 7) direction[static_cast<int>(random() % 3)] = std::numeric_limits<double>::quiet_NaN();
    add_ray(origin, direction, length_m, numbers);
  }
  return numbers;
}

/// From one place into nearly one direction: walked eight at a time.
std::vector<double> fan(std::size_t count, std::mt19937_64& random) {
  std::vector<double> numbers;
  const Vec3 eye = 2 * in_cube(random);
  for (std::size_t i = 0; i < count; ++i) {
    add_ray(eye, -eye + 0.05 * in_cube(random), i % 9 == 0 ? 2.5 : kEndless, numbers);
  }
  return numbers;
}

TEST_F(WorldPlainRays, HaveTheAnswersOfTheGeneralWay) {
  std::mt19937_64 random = oracle::seeded(20261125);
  TriangleMesh mesh = scenes::scattered(500, 0.3, random());
  scenes::append(mesh, scenes::degenerate(200, random()));
  scenes::append(mesh, scenes::slanted(20, 1, random()));
  add("z", mesh);
  // The same once more: every hit ties with one in the other scene, and the name decides.
  add("b", mesh);
  add("sphere", scenes::icosphere(3, 0.8));
  std::size_t hits = 0;
  for (const HitMode mode : {HitMode::closest, HitMode::any}) {
    for (int round = 0; round < 8; ++round) {
      const std::vector<double> numbers = round % 2 == 0 ? hard_rays(mesh, 300, random) : fan(300, random);
      const Answers expected = generally(mode, numbers);
      expect_same_bits(plainly(mode, numbers), expected);
      hits += expected.hits.size();
      std::size_t hit = 0;
      for (std::size_t i = 0; i < 300; ++i) {
        const auto one = std::span(numbers).subspan(i * kRayNumbers, kRayNumbers);
        const Answers alone = plainly(mode, one);
        ASSERT_EQ(alone.answers[0], expected.answers[i]);
        ASSERT_EQ(alone.hit_counts[0], expected.hit_counts[i]);
        expect_same_bits(alone, generally(mode, one));
        if (alone.hits.empty()) continue;
        EXPECT_EQ(alone.hits[0].triangle, expected.hits[hit].triangle);
        EXPECT_EQ(alone.hits[0].distance_m, expected.hits[hit].distance_m);
        ++hit;
      }
    }
  }
  EXPECT_GT(hits, 2000U);
}

// Among movers too, whether the nearest is one of them or a scene's triangle, and where nothing but movers is there.
TEST_F(WorldPlainRays, AmongMoversTheyAreAnsweredAsInTheGeneralWay) {
  std::mt19937_64 random = oracle::seeded(20261129);
  const auto join = [&](int count, const std::string& name) {
    for (int i = 0; i < count; ++i) {
      const double size_m = 0.02 + 0.1 * std::abs(in_cube(random).x());
      const Primitive shapes[] = {Sphere{.center = Vec3::Zero(), .radius_m = size_m},
                                  Box{.center = Vec3::Zero(), .half_m = Vec3(size_m, 0.5 * size_m, 0.2)},
                                  Capsule{.a = {-size_m, 0, 0}, .b = {size_m, 0, 0}, .radius_m = 0.03}};
      const Vec3 turn = in_cube(random);
      ASSERT_TRUE(std::holds_alternative<ObjectId>(world_.define(
          {.name = name + std::to_string(i),
           .scene = {},
           .shape = {.primitives = {shapes[i % 3]}, .mesh = nullptr},
           .pose = {.position = 2 * in_cube(random), .rotation = Quat(1, turn.x(), turn.y(), turn.z()).normalized()},
           .filter = {.layers = i % 7 == 0 ? 2U : 1U, .mask = 1}})));
    }
    world_.step(++now_ns_, 1, {});
  };
  std::size_t of_movers = 0;
  std::size_t of_scenes = 0;
  const auto compare = [&] {
    for (int round = 0; round < 6; ++round) {
      std::vector<double> numbers;
      for (int i = 0; i < 300; ++i) add_ray(3 * in_cube(random), in_cube(random), i % 9 == 0 ? 2.5 : kEndless, numbers);
      for (const HitMode mode : {HitMode::closest, HitMode::any}) {
        const Answers expected = generally(mode, numbers);
        expect_same_bits(plainly(mode, numbers), expected);
        for (const AnswerHit& hit : expected.hits) ++(hit.triangle == kNoTriangle ? of_movers : of_scenes);
        for (std::size_t i = 0; i < 300; i += 17) {
          const auto one = std::span(numbers).subspan(i * kRayNumbers, kRayNumbers);
          expect_same_bits(plainly(mode, one), generally(mode, one));
        }
      }
    }
  };
  join(5, "few");
  compare();
  EXPECT_EQ(of_scenes, 0U);
  add("sphere", scenes::icosphere(3, 0.8));
  compare();
  join(400, "many");
  compare();
  compare();
  EXPECT_GT(of_movers, 300U);
  EXPECT_GT(of_scenes, 300U);
}

// Where only the verdict is asked, most walks end without a test in doubles: floats were certain already.
TEST_F(WorldPlainRays, TheVerdictAloneIsThatOfAnyHit) {
  std::mt19937_64 random = oracle::seeded(20261128);
  TriangleMesh mesh = scenes::scattered(500, 0.3, random());
  scenes::append(mesh, scenes::degenerate(200, random()));
  scenes::append(mesh, scenes::slanted(20, 1, random()));
  add("z", mesh);
  add("sphere", scenes::icosphere(3, 0.8));
  std::size_t hits = 0;
  std::uint64_t tests = 0;
  std::uint64_t tests_of_any = 0;
  for (int round = 0; round < 16; ++round) {
    const std::vector<double> numbers = round % 2 == 0 ? hard_rays(mesh, 300, random) : fan(300, random);
    const Answers expected = plainly(HitMode::any, numbers);
    for (const std::int64_t deadline_ns : {std::int64_t{0}, wire_contract::steady_ns() + kAnHourNs}) {
      const Answers together = ask(HitMode::any, numbers, deadline_ns, false);
      EXPECT_EQ(together.answers, expected.answers);
      EXPECT_EQ(together.reasons, expected.reasons);
      EXPECT_TRUE(together.hits.empty());
      EXPECT_EQ(together.hit_counts, std::vector<std::uint32_t>(300, 0));
      for (std::size_t i = 0; i < 300; ++i) {
        const auto one = std::span(numbers).subspan(i * kRayNumbers, kRayNumbers);
        const Answers alone = ask(HitMode::any, one, deadline_ns, false);
        ASSERT_EQ(alone.answers[0], expected.answers[i]) << "ray " << i;
        EXPECT_TRUE(alone.hits.empty() && alone.hit_counts[0] == 0);
        tests += alone.exact_tests[0];
        tests_of_any += expected.exact_tests[i];
      }
    }
    hits += expected.hits.size();
  }
  EXPECT_GT(hits, 1000U);
  // Both ways of the two are counted; most hits need no test of their own.
  EXPECT_LT(tests + hits, tests_of_any);
}

/// What the walk tells, taken as the product takes it; told again: while it was the nearest already.
struct Listener {
  const Ray& ray;
  double limit = kEndless;
  double best_m = kEndless;
  std::uint32_t best = Bvh::kNoTriangle;
  std::uint32_t tested = 0;
  std::uint32_t told_again = 0;

  double operator()(std::uint32_t triangle, const Triangle& corners, double) {
    if (triangle == best) {
      ++told_again;
      return limit;
    }
    ++tested;
    RayHit hit;
    if (!cast_ray(ray, corners, hit).yes() || hit.distance_m >= best_m) return limit;
    best = triangle;
    best_m = hit.distance_m;
    const double reach = (hit.distance_m + hit.distance_error_m) / ray.direction.norm() * (1 + 0x1p-50);
    return limit = std::min(limit, reach);
  }
};

// Clipped splits hold a triangle in several leaves. Told again it would tie with itself, which only expansions decide.
TEST_F(WorldPlainRays, ATriangleToldTwiceIsTestedOnceAndHitOnce) {
  std::mt19937_64 random = oracle::seeded(20261126);
  TriangleMesh mesh = scenes::scattered(600, 0.03, random());
  scenes::append(mesh, scenes::slanted(40, 1, random()));
  add("s", mesh);
  const StaticScene& scene = *indexed_.front().geometry;
  ASSERT_GT(scene.tree.report().split_triangles, 0U);
  std::uint32_t told_again = 0;
  for (int i = 0; i < 3000; ++i) {
    const Triangle bar = mesh.triangle(600 + static_cast<std::uint32_t>(random() % 40));
    const Vec3 target = 0.45 * bar.a + 0.35 * bar.b + 0.2 * bar.c;
    const Vec3 origin = 2 * in_cube(random);
    const Ray ray{origin, target - origin};
    std::vector<double> numbers;
    add_ray(ray.origin, ray.direction, kEndless, numbers);
    Listener heard{ray};
    WalkCost unread;
    scene.tree.walk_ray_nearest(ray, kEndless, scene.mesh, heard, unread);
    told_again += heard.told_again;
    for (const bool is_plain : {true, false}) {
      const auto answers = [&](HitMode mode) { return is_plain ? plainly(mode, numbers) : generally(mode, numbers); };
      EXPECT_EQ(answers(HitMode::closest).exact_tests[0], heard.tested) << i;
      const Answers all = answers(HitMode::all);
      for (std::size_t k = 1; k < all.hits.size(); ++k) {
        const bool same =
            all.hits[k].object == all.hits[k - 1].object && all.hits[k].triangle == all.hits[k - 1].triangle;
        EXPECT_FALSE(same) << i;
      }
    }
  }
  // Else nothing was proved.
  EXPECT_GT(told_again, 20U);
}

}  // namespace
}  // namespace collided::engine
