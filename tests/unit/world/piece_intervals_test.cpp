// Between two poses: every touch, parting, entering and leaving is reported, in order and with a narrow bracket.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "tests/oracle/sampled_contacts.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/unit/world/posed_ways.hpp"

namespace collided::engine {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

Shape ball(double radius_m) {
  Shape shape;
  shape.primitives = {Sphere{Vec3::Zero(), radius_m}};
  return shape;
}

Shape bar(const Vec3& half_m) {
  Shape shape;
  shape.primitives = {Box{.center = Vec3::Zero(), .half_m = half_m}};
  return shape;
}

Shape cube_mesh(double half_m) {
  TriangleMesh mesh;
  for (const double x : {-half_m, half_m}) {
    for (const double y : {-half_m, half_m}) {
      for (const double z : {-half_m, half_m}) mesh.vertices.emplace_back(x, y, z);
    }
  }
  mesh.triangles = {{0, 1, 3}, {0, 3, 2}, {4, 6, 7}, {4, 7, 5}, {0, 4, 5}, {0, 5, 1},
                    {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3}};
  Shape shape;
  shape.mesh = std::make_shared<const TriangleMesh>(mesh);
  return shape;
}

Pose turned(double angle_rad, const Vec3& at) {
  return {.position = at, .rotation = Quat(std::cos(angle_rad / 2), 0, 0, std::sin(angle_rad / 2))};
}

/// What is expected: a kind, and when, in seconds.
struct ExpectedChange {
  EventKind kind;
  double at_s;
};

void expect_changes(const PairEvents& story, const std::string& pair, const std::vector<ExpectedChange>& expected) {
  const auto found = story.find(pair);
  const std::vector<PairEvent> events = found == story.end() ? std::vector<PairEvent>() : found->second;
  ASSERT_EQ(events.size(), expected.size()) << pair;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(events[i].kind, expected[i].kind) << pair << " " << i;
    EXPECT_EQ(events[i].doubt, Doubt::none);
    EXPECT_LE(static_cast<double>(events[i].low_ns), 1e9 * expected[i].at_s + 1) << pair << " " << i;
    EXPECT_GE(static_cast<double>(events[i].high_ns), 1e9 * expected[i].at_s - 1) << pair << " " << i;
    EXPECT_LE(events[i].high_ns - events[i].low_ns, 1000) << pair << " " << i;
  }
}

/// How the other object is in the world, which decides the way in which the pair is.
enum class OtherOwner { fixed, of_the_server, of_the_same_publisher, of_another_publisher };

class PieceIntervals : public testing::TestWithParam<OtherOwner> {
 protected:
  PairEvents fly(const Shape& mover, const std::vector<PoseAt>& way, const Shape& other, bool is_solid,
                 const Vec3& at = Vec3::Zero()) {
    const bool is_published =
        GetParam() == OtherOwner::of_the_same_publisher || GetParam() == OtherOwner::of_another_publisher;
    std::vector<PoseAt> rest{{0, {.position = at}}};
    for (const PoseAt& pose : way) {
      if (is_published && pose.time_ns > 0) rest.push_back({pose.time_ns, {.position = at}});
    }
    const std::uint64_t publisher = GetParam() == OtherOwner::of_the_same_publisher ? 1 : is_published ? 2 : 0;
    return story_of({{.name = "other",
                      .shape = other,
                      .publisher = publisher,
                      .poses = rest,
                      .is_solid = is_solid,
                      .is_moving = GetParam() != OtherOwner::fixed},
                     {.name = "mover", .shape = mover, .publisher = 1, .poses = way}},
                    {}, fences_);
  }

  std::vector<FenceDefinition> fences_;
};

// Of radius 0.1 through walls at -1 and 1, at 8 m/s.
const std::vector<PoseAt> kThrough{{0, {.position = {-4, 0.1, 0.2}}}, {kSecond, {.position = {4, 0.1, 0.2}}}};

TEST_P(PieceIntervals, ABallThroughAHollowCubeTouchesBothWalls) {
  expect_changes(
      fly(ball(0.1), kThrough, cube_mesh(1), false), "other mover",
      {{EventKind::began, 0.3625}, {EventKind::ended, 0.3875}, {EventKind::began, 0.6125}, {EventKind::ended, 0.6375}});
}

TEST_P(PieceIntervals, ABallThroughASolidCubeIsContainedAndEmerges) {
  expect_changes(fly(ball(0.1), kThrough, cube_mesh(1), true), "other mover",
                 {{EventKind::began, 0.3625},
                  {EventKind::contained, 0.3875},
                  {EventKind::emerged, 0.6125},
                  {EventKind::ended, 0.6375}});
}

// From the middle of the cube into its wall and back, twice in a way of several pieces.
TEST_P(PieceIntervals, ABallFromWithinASolidCubeOutOfItAndBack) {
  const std::vector<PoseAt> way{{0, {}}, {kSecond, {.position = {2, 0, 0}}}, {2 * kSecond, {.position = {0, 0, 0}}}};
  const PairEvents story = fly(ball(0.25), way, cube_mesh(1), true);
  ASSERT_EQ(story.at("other mover").size(), 6u);
  const std::vector<PairEvent>& events = story.at("other mover");
  const EventKind kinds[] = {EventKind::began, EventKind::contained, EventKind::emerged,
                             EventKind::ended, EventKind::began,     EventKind::contained};
  const double at_s[] = {-1e-6, -1e-6, 0.375, 0.625, 1.375, 1.625};
  std::size_t i = 0;
  for (const EventKind kind : kinds) {
    EXPECT_EQ(events[i].kind, kind) << i;
    EXPECT_NEAR(1e-9 * static_cast<double>(events[i].high_ns), at_s[i], 1e-8) << i;
    ++i;
  }
}

// 1.5 m long to either side, from -0.4 rad on by 2.4 rad in a second, past a post at 0 rad. The bar's face is 0.02 m from
// its axis, and the post's radius is 0.05 m: they touch while the axis is less than 0.07 m beside the post.
TEST_P(PieceIntervals, ABarThatTurnsPastAPostTouchesItForAsLongAsItIsNear) {
  const std::vector<PoseAt> way{{0, turned(-0.4, Vec3::Zero())}, {kSecond, turned(2.0, Vec3::Zero())}};
  const double half_rad = std::asin(0.07);
  expect_changes(fly(bar({1.5, 0.02, 0.02}), way, ball(0.05), false, {1, 0, 0}), "other mover",
                 {{EventKind::began, (0.4 - half_rad) / 2.4}, {EventKind::ended, (0.4 + half_rad) / 2.4}});
}

// Two balls of radius 0.5, 4 m apart, on one object. Their surfaces are within 0.5 m of a ball of radius 0.5 while a
// centre is within 1.5 m of its centre: at 8 m/s from 1.5 m before it to 1.5 m behind it.
Shape barbell() {
  Shape shape;
  shape.primitives = {Sphere{Vec3::Zero(), 0.5}, Sphere{{-4, 0, 0}, 0.5}};
  return shape;
}

TEST_P(PieceIntervals, ABarbellThroughAMarginComesInWithEachOfItsBalls) {
  if (GetParam() == OtherOwner::fixed) return;  // a margin has an object that moves
  fences_ = {{.name = "close", .only = "mover", .margin = MarginBands{.around = "other", .bands_m = {0.5, 0}}}};
  const std::vector<PoseAt> way{{0, {.position = {-4, 0, 0}}}, {kSecond, {.position = {8, 0, 0}}}};
  const PairEvents story = fly(barbell(), way, ball(0.5), false);
  for (const auto& [pair, events] : story) {
    if (pair.find("0.5") == std::string::npos) continue;
    ASSERT_EQ(events.size(), 4u) << pair;
    const double at_s[] = {2.5 / 12, 5.5 / 12, 6.5 / 12, 9.5 / 12};
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_EQ(events[i].kind, i % 2 == 0 ? EventKind::began : EventKind::ended);
      EXPECT_NEAR(1e-9 * static_cast<double>(events[i].high_ns), at_s[i], 1e-6);
      EXPECT_LE(events[i].high_ns - events[i].low_ns, 1000);
    }
  }
  EXPECT_GE(story.size(), 2u);
}

// Between two poses at which it is in.
TEST_P(PieceIntervals, ABarbellLeavesAMarginAndComesBackWithinAPiece) {
  if (GetParam() == OtherOwner::fixed) return;
  fences_ = {{.name = "close", .only = "mover", .margin = MarginBands{.around = "other", .bands_m = {0.5, 0}}}};
  const std::vector<PoseAt> way{{0, {.position = {0.75, 1.25, 0}}}, {kSecond, {.position = {3.25, 1.25, 0}}}};
  const PairEvents story = fly(barbell(), way, ball(0.5), false);
  ASSERT_EQ(story.size(), 1u);
  const std::vector<PairEvent>& events = story.begin()->second;
  ASSERT_EQ(events.size(), 3u);
  const double out_m = std::sqrt(1.5 * 1.5 - 1.25 * 1.25);
  EXPECT_EQ(events[1].kind, EventKind::ended);
  EXPECT_NEAR(1e-9 * static_cast<double>(events[1].high_ns), (out_m - 0.75) / 2.5, 1e-6);
  EXPECT_EQ(events[2].kind, EventKind::began);
  EXPECT_NEAR(1e-9 * static_cast<double>(events[2].high_ns), (4 - out_m - 0.75) / 2.5, 1e-6);
}

// More walls in one piece than are cut: what is behind the last one is in doubt.
TEST(PieceIntervalsLimit, ContactsBeyondTheMostOfAPieceAreInDoubt) {
  TriangleMesh walls;
  for (int i = 0; i < 10; ++i) {
    const auto first = static_cast<std::uint32_t>(walls.vertices.size());
    const double x = i;
    walls.vertices.insert(walls.vertices.end(), {{x, -5, -5}, {x, 5, -5}, {x, 0, 5}});
    walls.triangles.push_back({first, first + 1, first + 2});
  }
  Shape shape;
  shape.mesh = std::make_shared<const TriangleMesh>(walls);
  const auto events_with = [&](std::uint32_t most) {
    WorldOptions options;
    options.max_intervals = most;
    return story_of({{.name = "walls", .shape = shape, .publisher = 2, .poses = {{0, {}}, {kSecond, {}}}},
                     {.name = "ball",
                      .shape = ball(0.25),
                      .publisher = 1,
                      .poses = {{0, {.position = {-2, 0, 0}}}, {kSecond, {.position = {12, 0, 0}}}}}},
                    options)
        .at("walls ball");
  };
  EXPECT_EQ(events_with(64).size(), 20u);
  const std::vector<PairEvent> few = events_with(4);
  ASSERT_GE(few.size(), 2u);
  EXPECT_LE(few.size(), 8u);
  EXPECT_EQ(few.front().doubt, Doubt::none);
  EXPECT_EQ(few.back().doubt, Doubt::cost_limit);
  EXPECT_NEAR(1e-9 * static_cast<double>(few.back().high_ns), (2 + 9.25) / 14, 1e-6) << "it is known when all is over";
}

std::vector<oracle::Figure> figures_of(const Shape& shape, const Vec3& at) {
  std::vector<oracle::Figure> figures;
  for (const Primitive& primitive : shape.primitives) {
    if (const auto* sphere = std::get_if<Sphere>(&primitive)) figures.push_back(oracle::figure(*sphere));
    else if (const auto* box = std::get_if<Box>(&primitive)) figures.push_back(oracle::figure(*box));
    else figures.push_back(oracle::figure(std::get<Capsule>(primitive)));
  }
  for (std::uint32_t i = 0; shape.mesh && i < shape.mesh->triangles.size(); ++i)
    figures.push_back(oracle::figure(shape.mesh->triangle(i)));
  for (oracle::Figure& figure : figures) figure = oracle::shifted(figure, oracle::exact(at));
  return figures;
}

// A ball of 5,120 triangles that turns in a hollow one hardly larger than itself: it goes from the wall to the middle, and
// all its triangles are near others until the end.
TEST(PieceIntervalsLimit, AContactWhoseEndIsNotFoundEndsAndIsInDoubtAfterwards) {
  const auto sphere = [](double radius_m) {
    Shape shape;
    shape.mesh = std::make_shared<const TriangleMesh>(scenes::icosphere(4, radius_m));
    return shape;
  };
  const PairEvents story =
      story_of({{.name = "hollow", .shape = sphere(1.02), .publisher = 0, .poses = {{0, {}}}, .is_moving = false},
                {.name = "ball",
                 .shape = sphere(1),
                 .publisher = 1,
                 .poses = {{0, turned(0, {0.03, 0, 0})}, {kSecond, turned(0.1, {0.01, 0, 0})}}}});
  ASSERT_EQ(story.size(), 1u);
  const std::vector<PairEvent>& events = story.begin()->second;
  ASSERT_EQ(events.size(), 4u);
  EXPECT_EQ(events[1].kind, EventKind::ended);
  EXPECT_EQ(events[1].doubt, Doubt::none);
  EXPECT_EQ(events[2].kind, EventKind::began);
  EXPECT_EQ(events[2].doubt, Doubt::cost_limit);
  EXPECT_EQ(events[3].kind, EventKind::ended);
  EXPECT_EQ(events[3].doubt, Doubt::cost_limit);
}

// One piece, sampled densely in rationals: no sample is on the wrong side of a bracket.
TEST(PieceIntervalsSampled, EveryContactOfAPieceIsThatOfItsSamples) {
  std::mt19937_64 random = oracle::seeded(20261130);
  const char* asked = std::getenv("COLLIDED_SAMPLED");
  const int count = asked != nullptr ? std::atoi(asked) : 8;
  const auto in = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
  // Dyadic, so that the way has exact places at all samples.
  const auto lattice = [&](double size) {
    return Vec3(std::round(in(-size, size) * 256) / 256, std::round(in(-size, size) * 256) / 256,
                std::round(in(-size, size) * 256) / 256);
  };
  constexpr long kSamples = 128;
  constexpr std::int64_t kPiece_ns = std::int64_t{1} << 29;
  int changes = 0;
  for (int i = 0; i < count; ++i) {
    Shape mover;
    if (i % 3 == 0) mover = ball(in(0.05, 0.5));
    else if (i % 3 == 1) mover = bar({in(0.05, 0.5), in(0.05, 0.5), in(0.05, 0.5)});
    else mover.primitives = {Capsule{{in(-1, 1), 0, 0}, {0, in(-1, 1), 0}, in(0.05, 0.3)}, Sphere{{1, 1, 0}, 0.2}};
    const Shape other = i % 2 == 0 ? cube_mesh(in(0.3, 1)) : barbell();
    const Vec3 from = Vec3(-4, 0, 0) + lattice(1);
    const Vec3 to = Vec3(4, 0, 0) + lattice(1);
    const PairEvents story =
        story_of({{.name = "other", .shape = other, .publisher = 2, .poses = {{0, {}}, {kPiece_ns, {}}}},
                  {.name = "mover",
                   .shape = mover,
                   .publisher = 1,
                   .poses = {{0, {.position = from}}, {kPiece_ns, {.position = to}}}}});
    const auto found = story.find("other mover");
    const std::vector<PairEvent> events = found == story.end() ? std::vector<PairEvent>() : found->second;
    changes += static_cast<int>(events.size());
    const oracle::SampledContacts truth(figures_of(other, Vec3::Zero()), figures_of(mover, from), to - from);
    for (long k = 0; k <= kSamples; ++k) {
      const std::int64_t time_ns = kPiece_ns / kSamples * k;
      bool is_open = false;
      bool is_within_a_bracket = false;
      for (const PairEvent& event : events) {
        if (event.high_ns < time_ns) is_open = event.kind != EventKind::ended;
        is_within_a_bracket = is_within_a_bracket || (event.low_ns <= time_ns && time_ns <= event.high_ns);
      }
      if (is_within_a_bracket) continue;
      ASSERT_EQ(is_open, truth.touch_at(k, kSamples)) << "way " << i << " at sample " << k;
    }
  }
  EXPECT_GE(changes, count);
}

INSTANTIATE_TEST_SUITE_P(Pairs, PieceIntervals,
                         testing::Values(OtherOwner::fixed, OtherOwner::of_the_server,
                                         OtherOwner::of_the_same_publisher, OtherOwner::of_another_publisher));

}  // namespace
}  // namespace collided::engine
