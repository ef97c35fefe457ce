// What several shards say, made one answer: no server is asked.
#include "client/fleet/shards/answer_merging.hpp"

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "client/fleet/shards/question_reach.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::client {
namespace {

using shards::ShardMap;

constexpr double kFar = std::numeric_limits<double>::infinity();

/// Three shards side by side along x: west up to 0, middle up to 10, east.
ShardMap row() {
  return ShardMap::parse(R"({"margin_m": 1, "shards": [
    {"name": "west", "low": [null, null, null], "high": [0, null, null]},
    {"name": "middle", "low": [0, null, null], "high": [10, null, null]},
    {"name": "east", "low": [10, null, null], "high": [null, null, null]}]})");
}

Hit hit(const std::string& object, double distance_m, const Vec3& point, double error_m = 1e-15) {
  Hit one;
  one.object = object;
  one.distance_m = distance_m;
  one.error_m = error_m;
  one.point = point;
  one.point_error_m = 1e-15;
  return one;
}
Answer hits(std::vector<Hit> list) {
  Answer answer;
  answer.verdict = list.empty() ? Verdict::miss : Verdict::hit;
  answer.hits = std::move(list);
  return answer;
}
Answer undecided(UndecidedReason reason, std::vector<Hit> list = {}) {
  Answer answer;
  answer.verdict = Verdict::undecided;
  answer.reason = reason;
  answer.hits = std::move(list);
  return answer;
}
Answer leaving(const Vec3& point, double covered_m, std::vector<Hit> list = {}) {
  Answer answer = undecided(UndecidedReason::not_covered, std::move(list));
  answer.uncovered = Uncovered{.point = point, .covered_m = covered_m};
  return answer;
}

/// From west to east along the x axis.
const RayQuestion kEastward{.origin = {-5, 0, 0}, .direction = {2, 0, 0}};

template <class Q>
Answer merge(const Q& question, const std::vector<ShardAnswer>& given, const AskOptions& options = {}) {
  return merged(question, row(), options, given);
}

TEST(AnswerMerging, ALeavingOfOneShardIsAnsweredByTheNext) {
  const Answer west = leaving({1, 0, 0}, 6);
  const Answer middle = hits({hit("wall", 9, {4, 0, 0})});
  const Answer east = leaving({-5, 0, 0}, 0);
  const Answer all = merge(kEastward, {{0, &west}, {1, &middle}, {2, &east}});
  EXPECT_EQ(all.verdict, Verdict::hit);
  ASSERT_EQ(all.hits.size(), 1u);
  EXPECT_EQ(all.hits[0].object, "wall");
  EXPECT_FALSE(all.uncovered);
  const Answer none = leaving({11, 0, 0}, 16);
  EXPECT_EQ(merge(kEastward, {{0, &west}, {1, &none}, {2, &east}}).verdict, Verdict::miss);
}

TEST(AnswerMerging, WhatIsNotThereMattersUpToTheDecidedHit) {
  const Answer west = leaving({1, 0, 0}, 6);
  const Answer middle = hits({hit("wall", 9, {4, 0, 0})});
  EXPECT_EQ(merge(kEastward, {{0, &west}, {1, &middle}, {2, nullptr}}).verdict, Verdict::hit);
  const Answer open = merge(kEastward, {{0, nullptr}, {1, &middle}, {2, nullptr}});
  EXPECT_EQ(open.verdict, Verdict::undecided);
  EXPECT_EQ(open.reason, UndecidedReason::not_covered);
  ASSERT_EQ(open.hits.size(), 1u) << "what is known to be there is told";
  ASSERT_TRUE(open.uncovered);
  EXPECT_EQ(open.uncovered->covered_m, 0);
  const Answer nothing = leaving({11, 0, 0}, 16);
  const Answer beyond = merge(kEastward, {{0, &west}, {1, &nothing}, {2, nullptr}});
  EXPECT_EQ(beyond.reason, UndecidedReason::not_covered);
  EXPECT_NEAR(beyond.uncovered->covered_m, 15, 1e-9);
  EXPECT_NEAR(beyond.uncovered->point.x(), 10, 1e-9);
  EXPECT_EQ(merge(kEastward, {{0, nullptr}, {1, nullptr}, {2, nullptr}}).verdict, Verdict::undecided);
  EXPECT_EQ(merge(kEastward, {{0, &west}, {1, &middle}, {2, nullptr}}, {.mode = HitMode::all}).verdict,
            Verdict::undecided);
  EXPECT_EQ(merge(kEastward, {{0, nullptr}, {1, &middle}, {2, nullptr}}, {.mode = HitMode::any}).verdict, Verdict::hit);
  EXPECT_EQ(merge(kEastward, {{0, nullptr}, {1, &west}}, {.mode = HitMode::verdict}).verdict, Verdict::undecided);
}

TEST(AnswerMerging, AHoleInWhatIsKnownWithinAShardsBoxStaysOne) {
  const Answer west = leaving({-2, 0, 0}, 3);
  const Answer middle = hits({hit("wall", 9, {4, 0, 0})});
  const Answer open = merge(kEastward, {{0, &west}, {1, &middle}});
  EXPECT_EQ(open.reason, UndecidedReason::not_covered);
  EXPECT_EQ(open.uncovered->covered_m, 3);
  const Answer behind = leaving({8, 0, 0}, 13);
  const Answer first = hits({hit("post", 5, {0, 0, 0})});
  EXPECT_EQ(merge(kEastward, {{0, &first}, {1, &behind}}).verdict, Verdict::hit) << "it is behind the hit";
}

// A box that meets unknown space need not reach the place of it that is nearest to its middle, so a shard tells none.
TEST(AnswerMerging, UnknownSpaceCountsWithoutAPlaceUnlessSomethingIsMet) {
  const BoxQuestion box{.center = {-1, 0, 0}, .half_m = {2, 1, 1}};
  const Answer west = undecided(UndecidedReason::not_covered);
  const Answer nothing = hits({});
  const Answer wall = hits({hit("wall", 0.5, {1, 0, 0})});
  EXPECT_EQ(merge(box, {{0, &west}, {1, &nothing}}).reason, UndecidedReason::not_covered);
  EXPECT_EQ(merge(box, {{0, &west}, {1, &wall}}).verdict, Verdict::hit);
}

// What a shard does not hold begins a margin away from its box; what it doubts nearer than that, it knows of.
TEST(AnswerMerging, UnknownSpaceAtABorderIsNotTakenForWhatAShardDoesNotHold) {
  const RayQuestion to_border{.origin = {-5, 0, 0}, .direction = {2, 0, 0}, .length_m = 5};
  const Answer west = leaving({1e-15, 0, 0}, 5);
  const Answer middle = hits({});
  EXPECT_EQ(merge(to_border, {{0, &west}, {1, &middle}}).reason, UndecidedReason::not_covered);
}

Hit on_ground(std::uint32_t triangle, double distance_m, double x) {
  Hit one = hit("ground", distance_m, {x, 0, 0});
  one.triangle = triangle;
  return one;
}

// Of a part that is larger than a shard, each holds the triangles in its box and margin, and tells of those alone.
TEST(AnswerMerging, OfAPartThatSeveralHoldInPiecesTheFirstHitIsTheNearest) {
  const Answer west = hits({on_ground(7, 2, -3)});
  const Answer middle = hits({on_ground(1, 9, 4)});
  const Answer east = hits({on_ground(4, 17, 12)});
  for (const auto& given : {std::vector<ShardAnswer>{{0, &west}, {1, &middle}, {2, &east}},
                            std::vector<ShardAnswer>{{2, &east}, {1, &middle}, {0, &west}}}) {
    const Answer first = merge(kEastward, given);
    ASSERT_EQ(first.hits.size(), 1u);
    EXPECT_EQ(first.hits[0].triangle, 7u);
  }
}

// The shard that holds both triangles at a point decides between them; one that holds the farther one alone, by an error
// of its distance nearer, does not.
TEST(AnswerMerging, TheShardWithThePointInItsBoxDecidesBetweenTrianglesThatMeetThere) {
  Hit exact = on_ground(7, 3, -2);
  exact.error_m = 1e-9;
  Hit beyond = on_ground(8, 3 - 1e-10, -2);
  beyond.error_m = 1e-9;
  const Answer west = hits({exact});
  const Answer middle = hits({beyond});
  EXPECT_EQ(merge(kEastward, {{1, &middle}, {0, &west}}).hits[0].triangle, 7u);
  EXPECT_EQ(merge(kEastward, {{0, &west}, {1, &middle}}).hits[0].triangle, 7u);
}

TEST(AnswerMerging, OfAPartThatSeveralHoldInPiecesAllHitsAreTold) {
  const Answer west = hits({on_ground(7, 2, -3), on_ground(3, 5.5, 0.5)});
  const Answer middle = hits({on_ground(3, 5.5, 0.5), on_ground(1, 9, 4)});
  const Answer all = merge(kEastward, {{0, &west}, {1, &middle}}, {.mode = HitMode::all});
  ASSERT_EQ(all.hits.size(), 3u) << "that in both margins once";
  EXPECT_EQ(all.hits[0].triangle, 7u);
  EXPECT_EQ(all.hits[1].triangle, 3u);
  EXPECT_EQ(all.hits[2].triangle, 1u);
  // The west would have told the second one, had it been asked for more than one.
  const Answer cut = hits({on_ground(7, 2, -3)});
  const Answer one = hits({on_ground(3, 5.5, 0.5)});
  const Answer few = merge(kEastward, {{0, &cut}, {1, &one}}, {.mode = HitMode::all, .max_hits = 1});
  ASSERT_EQ(few.hits.size(), 1u);
  EXPECT_EQ(few.hits[0].triangle, 7u);
}

// A mover near a border, told by two shards at different instants, is not told twice.
TEST(AnswerMerging, WhatTwoTellOfOneObjectDifferentlyIsNotAddedUp) {
  const Answer west = hits({hit("cart", 4.8, {-0.2, 0, 0}), hit("cart", 5.4, {0.4, 0, 0})});
  const Answer middle = hits({hit("cart", 5.3, {0.3, 0, 0}), hit("cart", 5.9, {0.9, 0, 0})});
  EXPECT_EQ(merge(kEastward, {{0, &west}, {1, &middle}}, {.mode = HitMode::all}).hits.size(), 2u);
}

TEST(AnswerMerging, OfAPartThatSeveralHoldInPiecesTheDeepestAndTheNearestCount) {
  const SphereQuestion sphere{.center = {0, 0, 0}, .radius_m = 5};
  const Answer west = hits({on_ground(7, 1.5, -3.5)});
  const Answer middle = hits({on_ground(1, 2, 3)});
  EXPECT_EQ(merge(sphere, {{0, &west}, {1, &middle}}).hits.at(0).triangle, 1u);
  const NearQuestion near{.point = {-1, 0, 0}};
  EXPECT_EQ(merge(near, {{1, &middle}, {0, &west}}).hits.at(0).triangle, 7u);
  EXPECT_EQ(merge(near, {{0, &west}, {1, &middle}}).hits.at(0).triangle, 7u);
}

/// As deep is the ball in all triangles that meet at its nearest point; the contact's point lies between ball and triangle.
TEST(AnswerMerging, OfTrianglesThatARegionIsAsDeepInTheFirstIsTold) {
  const SphereQuestion ball{.center = {-3, 0, 0}, .radius_m = 6};
  const auto ground = [](std::uint32_t triangle) {
    Hit one = hit("ground", 4, {-2, 0, 0});
    one.triangle = triangle;
    one.point_error_m = kFar;
    return hits({one});
  };
  const Answer west = ground(8);
  const Answer middle = ground(7);
  EXPECT_EQ(merge(ball, {{0, &west}, {1, &middle}}, {.mode = HitMode::all}).hits.at(0).triangle, 7u);
  EXPECT_EQ(merge(ball, {{1, &middle}, {0, &west}}, {.mode = HitMode::all}).hits.at(0).triangle, 7u);
}

TEST(AnswerMerging, DoubtsBeyondTheHitChangeNothingButThoseOfAPlaceUnknown) {
  const Answer west = hits({hit("post", 2, {-3, 0, 0})});
  for (const UndecidedReason reason :
       {UndecidedReason::numeric, UndecidedReason::recovering, UndecidedReason::deadline}) {
    const Answer doubtful = undecided(reason);
    EXPECT_EQ(merge(kEastward, {{0, &west}, {1, &doubtful}}).verdict, Verdict::hit);
    EXPECT_EQ(merge(kEastward, {{0, &doubtful}, {1, &west}}).reason, reason);
    EXPECT_EQ(merge(kEastward, {{0, &west}, {1, &doubtful}}, {.mode = HitMode::all}).reason, reason);
  }
  const Answer stale = undecided(UndecidedReason::stale_object);
  EXPECT_EQ(merge(kEastward, {{0, &west}, {1, &stale}}).reason, UndecidedReason::stale_object);
  EXPECT_EQ(merge(kEastward, {{0, &west}, {1, &stale}}, {.mode = HitMode::any}).verdict, Verdict::hit);
}

TEST(AnswerMerging, WhatTwoShardsHoldCountsOnceAndInOrder) {
  const SphereQuestion ball{.center = {0, 0, 0}, .radius_m = 3};
  const Answer west = hits({hit("both", 2, {0, 0, 0}), hit("a", 1, {-1, 0, 0})});
  const Answer middle = hits({hit("b", 2, {1, 0, 0}), hit("both", 2, {0, 0, 0})});
  const Answer all = merge(ball, {{0, &west}, {1, &middle}});
  ASSERT_EQ(all.hits.size(), 3u);
  EXPECT_EQ(all.hits[0].object, "b") << "equally deep: by name";
  EXPECT_EQ(all.hits[1].object, "both");
  EXPECT_EQ(all.hits[2].object, "a");
  const Answer cut = merge(ball, {{0, &west}, {1, &middle}}, {.max_hits = 2});
  EXPECT_EQ(cut.reason, UndecidedReason::truncated);
  EXPECT_EQ(cut.hits.size(), 2u);
  EXPECT_EQ(merge(ball, {{0, &west}, {1, nullptr}}).verdict, Verdict::undecided) << "the list may lack something";
  // A mesh that a ray crosses twice is told twice, by each shard that holds it.
  Hit far_side = hit("hull", 7, {2, 0, 0});
  far_side.triangle = 4;
  Hit near_side = hit("hull", 4, {-1, 0, 0});
  near_side.triangle = 3;
  const Answer twice = hits({near_side, far_side});
  EXPECT_EQ(merge(kEastward, {{0, &twice}, {1, &twice}}, {.mode = HitMode::all}).hits.size(), 2u);
}

// West holds `late`, whose point is in the box of the middle, but not `early`: the middle holds both, and its exact
// comparison says which comes first although the doubles say the other.
TEST(AnswerMerging, TheShardInWhoseBoxTheHitIsDecidesWhatComesFirst) {
  const Answer west = hits({hit("late", 7, {2, 0, 0})});
  const Answer middle = hits({hit("early", 7 + 1e-15, {2, 0, 0})});
  const Answer all = merge(kEastward, {{0, &west}, {1, &middle}});
  EXPECT_EQ(all.verdict, Verdict::hit);
  EXPECT_EQ(all.hits[0].object, "early");
  const Answer asked = hits({hit("early", 8, {3, 0, 0}, 2)});
  const Answer rough = merge(kEastward, {{0, &west}, {1, &asked}}, {.error_m = 4});
  EXPECT_EQ(rough.hits[0].object, "late");
  EXPECT_LE(rough.hits[0].distance_m - rough.hits[0].error_m, 6) << "the other may be as near as that";
  const Answer here = hits({hit("west's", 5, {0, 0, 0})});
  const Answer there = hits({hit("middle's", 5, {0, 0, 0})});
  EXPECT_EQ(merge(kEastward, {{0, &here}, {1, &there}}).reason, UndecidedReason::numeric)
      << "at a common border both hold both: they were asked about different worlds";
}

TEST(AnswerMerging, OfTheNearestOnlyShardsAsNearAreLeft) {
  const ShardMap map = row();
  const NearQuestion from_west{.point = {-5, 0, 0}};
  const Answer near = hits({hit("post", 4, {-1, 0, 0})});
  EXPECT_EQ(shards_left(from_west, map, {}, near), 0b001u);
  EXPECT_EQ(shards_left(from_west, map, {.max_hits = 2}, near), 0b111u);
  const Answer at_border = hits({hit("post", 5, {0, 0, 0})});
  EXPECT_EQ(shards_left(from_west, map, {}, at_border), 0b011u);
  EXPECT_EQ(shards_left({.point = {-5, 0, 0}, .within_m = 4}, map, {}, hits({})), 0b001u);
  const Answer farther = hits({hit("tower", 6, {1, 0, 0})});
  EXPECT_EQ(merge(from_west, {{0, &farther}, {1, nullptr}}).verdict, Verdict::undecided);
  EXPECT_EQ(merge(from_west, {{0, &near}, {1, nullptr}}).verdict, Verdict::hit);
  const Answer two = merge(from_west, {{0, &farther}, {1, &near}}, {.max_hits = 2});
  ASSERT_EQ(two.hits.size(), 2u);
  EXPECT_EQ(two.hits[0].object, "post");
}

// A ray is cut into points; each must lie in the box of a shard that counts as touched, and not before its entry.
TEST(QuestionReach, NoShardOfARaysPointsIsLeftOut) {
  std::mt19937_64 random = oracle::seeded(28);
  const ShardMap map = row();
  std::uniform_real_distribution<double> any(-20, 20);
  for (int i = 0; i < 20'000; ++i) {
    RayQuestion ray{.origin = {any(random), any(random), any(random)},
                    .direction = {any(random), any(random), any(random)}};
    if (random() % 4 == 0) ray.origin.x() = random() % 2 == 0 ? 0 : 10;
    if (random() % 4 == 0) ray.direction.x() = 0;
    if (random() % 4 == 0) ray.direction *= std::ldexp(1, static_cast<int>(random() % 1000) - 500);
    ray.length_m = std::abs(any(random));
    const shards::ShardSet touched = touched_shards(map, ray);
    for (int step = 0; step <= 20; ++step) {
      const double along_m = ray.length_m * step / 20;
      const Vec3 point = ray.origin + along_m * (ray.direction / ray.direction.stableNorm());
      const std::size_t owner = map.owner_of({point.x(), point.y(), point.z()});
      const bool is_near_border = std::abs(point.x()) < 1e-12 || std::abs(point.x() - 10) < 1e-12;
      if (is_near_border && step > 0) continue;  // this point's own rounding decides
      ASSERT_TRUE(touched >> owner & 1) << ray.origin.transpose() << "  " << ray.direction.transpose();
      ASSERT_LE(*entry_m(map.at(owner).box, ray), along_m * (1 + 1e-12));
    }
  }
}

TEST(QuestionReach, NumbersAtTheirLimitsTouchTooMuchRatherThanTooLittle) {
  const ShardMap map = row();
  const double least = std::numeric_limits<double>::denorm_min();
  EXPECT_EQ(touched_shards(map, RayQuestion{.origin = {-1e308, 0, 0}, .direction = {1e308, 0, 0}}), 0b111u);
  EXPECT_EQ(touched_shards(map, RayQuestion{.origin = {-5, 0, 0}, .direction = {least, 0, 0}}), 0b111u);
  EXPECT_EQ(touched_shards(map, RayQuestion{.origin = {-5, 0, 0}, .direction = {least, 1, 0}}), 0b111u);
  EXPECT_EQ(touched_shards(map, RayQuestion{.origin = {-5, 0, 0}, .direction = {0, 1, 0}}), 0b001u);
  EXPECT_EQ(touched_shards(map, RayQuestion{.origin = {0, 0, 0}, .direction = {0, 1, 0}}), 0b011u);
  EXPECT_EQ(touched_shards(map, RayQuestion{.origin = {-5, 0, 0}, .direction = {1, 0, 0}, .length_m = 5}), 0b011u);
  EXPECT_EQ(touched_shards(map, RayQuestion{.origin = {-5, 0, 0}, .direction = {1, 0, 0}, .length_m = 4.9}), 0b001u);
  EXPECT_EQ(touched_shards(map, SphereQuestion{.center = {-1e308, 0, 0}, .radius_m = 1.5e308}), 0b111u);
  EXPECT_EQ(touched_shards(map, SphereQuestion{.center = {-5, 0, 0}, .radius_m = 5}), 0b011u);
  EXPECT_EQ(touched_shards(map, InsideQuestion{.point = {10, 0, 0}}), 0b010u);
  EXPECT_EQ(touched_shards(map, NearQuestion{.point = {-5, 0, 0}, .within_m = kFar}), 0b111u);
  const Quat turned(std::sqrt(0.5), 0, 0, std::sqrt(0.5));
  EXPECT_EQ(touched_shards(map, BoxQuestion{.center = {-5, 0, 0}, .half_m = {1, 6, 1}, .rotation = turned}), 0b011u);
  EXPECT_EQ(touched_shards(map, BoxQuestion{.center = {-5, 0, 0}, .half_m = {6, 1, 1}, .rotation = turned}), 0b001u);
}

}  // namespace
}  // namespace collided::client
