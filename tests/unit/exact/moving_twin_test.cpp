#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <vector>

#include "server/exact_phase/motion/moving_exactly.hpp"
#include "server/exact_phase/motion/moving_features.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::moving_twin_test {
namespace {

/// Places and motions that take turns at being hard: what is asked is where doubles stop being sure.
enum class Family { random, lattice, planar, one_line, rounding_off_plane, far_out, needle, tiny, still };
constexpr std::array kFamilies{
    Family::random,  Family::lattice, Family::planar, Family::one_line, Family::rounding_off_plane,
    Family::far_out, Family::needle,  Family::tiny,   Family::still};

class Makers {
 public:
  explicit Makers(std::mt19937_64& generator) : generator_(generator) {}

  std::array<MovingPoint, 4> four_points(Family family) {
    std::array<MovingPoint, 4> p;
    const Vec3 line = vector(1);
    for (MovingPoint& each : p) {
      each = {place(family), place(family)};
      if (family == Family::one_line) each = {whole(4) * line, whole(4) * line};
      if (family == Family::rounding_off_plane) {
        for (Vec3* v : {&each.start, &each.end}) (*v)[2] = whole(1) * 0x1p-53 + (*v)[0] + (*v)[1];
      }
      if (family == Family::still) each.end = each.start;
    }
    return p;
  }

  double uniform() { return std::uniform_real_distribution<double>(-1, 1)(generator_); }
  double whole(int most) { return std::uniform_int_distribution<int>(-most, most)(generator_); }
  Vec3 vector(double size) { return size * Vec3(uniform(), uniform(), uniform()); }

 private:
  Vec3 place(Family family) {
    switch (family) {
      case Family::lattice: return {whole(2), whole(2), whole(2)};
      case Family::planar: return {whole(3), whole(3), 0};
      case Family::rounding_off_plane: return {whole(8) / 8, whole(8) / 8, 0};
      case Family::far_out: return Vec3(1e6, 1e6, -1e6) + vector(1);
      case Family::needle: return {uniform(), 1e-7 * uniform(), 1e-7 * uniform()};
      case Family::tiny: return vector(1e-150);
      case Family::still: return {whole(1), whole(1), whole(1)};
      default: return vector(1);
    }
  }

  std::mt19937_64& generator_;
};

struct Tally {
  int hits = 0;
  int by_rationals = 0;
};

/// The whole ladder against rationals alone, which begin at the start and know nothing of what doubles ruled out.
void compare_with_rationals(const std::array<MovingPoint, 4>& p, kernel::Quartet::Kind kind, Tally& tally) {
  const bool edges = kind == kernel::Quartet::Kind::edge_edge;
  TimeBracket bracket;
  const ExactResult verdict = edges ? first_contact(MovingSegment{p[0], p[1]}, MovingSegment{p[2], p[3]}, 1e-6, bracket)
                                    : first_contact(p[0], MovingTriangle{p[1], p[2], p[3]}, 1e-6, bracket);
  TimeBracket exact;
  ASSERT_EQ(verdict.decision, kernel::first_contact_exactly({p, kind}, 0, 0, exact));
  tally.by_rationals += verdict.level == Level::rational;
  if (!verdict.yes()) return;
  ++tally.hits;
  ASSERT_LE(bracket.low, exact.low);
  ASSERT_GE(bracket.high, exact.high);
  ASSERT_LE(bracket.high - bracket.low, 1e-6);
  ASSERT_EQ(bracket.high == 0, exact.high == 0);
}

TEST(ExactMovingTwin, TheLadderAnswersAsRationalsAlone) {
  std::mt19937_64 generator = oracle::seeded(2024);
  Makers make(generator);
  for (const Family family : kFamilies) {
    Tally tally;
    for (int i = 0; i < 600 && !HasFatalFailure(); ++i) {
      compare_with_rationals(make.four_points(family), kernel::Quartet::Kind::point_face, tally);
      compare_with_rationals(make.four_points(family), kernel::Quartet::Kind::edge_edge, tally);
    }
    std::printf("family %d: 1200 asked, %d hits, %d by rationals\n", static_cast<int>(family), tally.hits,
                tally.by_rationals);
    EXPECT_GT(tally.hits, 0);
  }
}

/// A corner's place at i / kSamples is a double: coordinates have 12 binary places, times 14.
constexpr int kSamples = 16384;

MovingTriangle lattice_sweep(Makers& make) {
  const auto on_grid = [](const Vec3& v) { return Vec3((v * 4096).array().round() / 4096); };
  const Vec3 from = make.vector(1);
  const Vec3 to = make.vector(1);
  const auto corner = [&] { return MovingPoint{on_grid(from + make.vector(0.5)), on_grid(to + make.vector(0.5))}; };
  return {corner(), corner(), corner()};
}

Triangle at_sample(const MovingTriangle& t, int i) {
  const double s = static_cast<double>(i) / kSamples;
  const auto at = [s](const MovingPoint& p) { return Vec3((1 - s) * p.start + s * p.end); };
  return {at(t.a), at(t.b), at(t.c)};
}

/// How many samples from here on cannot overlap, because on some axis the boxes are farther apart than what their
/// corners, none faster than that, can close.
int samples_apart(const MovingTriangle& a, const MovingTriangle& b, int i) {
  const Triangle s = at_sample(a, i);
  const Triangle t = at_sample(b, i);
  double most = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto [low_s, high_s] = std::minmax({s.a[axis], s.b[axis], s.c[axis]});
    const auto [low_t, high_t] = std::minmax({t.a[axis], t.b[axis], t.c[axis]});
    const auto speed = [axis](const MovingTriangle& m) {
      return std::max({std::abs(m.a.end[axis] - m.a.start[axis]), std::abs(m.b.end[axis] - m.b.start[axis]),
                       std::abs(m.c.end[axis] - m.c.start[axis])});
    };
    const double gap = std::max(low_t - high_s, low_s - high_t);
    if (gap > 0) most = std::max(most, gap / (speed(a) + speed(b) + 0x1p-100) * kSamples);
  }
  return static_cast<int>(std::min(most, 1.0 * kSamples));
}

int asked_sweeps() {
  const char* asked = std::getenv("COLLIDED_SWEEPS");
  return asked != nullptr ? std::atoi(asked) : 10000;
}

TEST(ExactMovingTwin, SamplingFindsNoContactBeforeTheFirst) {
  std::mt19937_64 generator = oracle::seeded(77);
  Makers make(generator);
  int hits = 0;
  int undecided = 0;
  int missed = 0;
  const int sweeps = asked_sweeps();
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    const MovingTriangle a = lattice_sweep(make);
    const MovingTriangle b = lattice_sweep(make);
    TimeBracket bracket;
    const ExactResult verdict = first_contact(a, b, 1e-6, bracket);
    hits += verdict.yes();
    undecided += verdict.decision == Decision::undecided;
    const int clear = verdict.yes() ? static_cast<int>(std::floor(bracket.low * kSamples)) : kSamples;
    for (int i = bracket.high == 0 && verdict.yes() ? 1 : 0; i <= clear; ++i) {
      i += std::max(samples_apart(a, b, i) - 1, 0);
      if (i > clear || !overlaps(at_sample(a, i), at_sample(b, i)).yes()) continue;
      ++missed;
      ADD_FAILURE() << "sweep " << sweep << " meets at " << i << " / " << kSamples;
      break;
    }
    if (verdict.yes() && bracket.high == 0) { EXPECT_TRUE(overlaps(at_sample(a, 0), at_sample(b, 0)).yes()); }
  }
  std::printf("%d sweeps, %d hits, %d undecided, %d missed\n", sweeps, hits, undecided, missed);
  EXPECT_EQ(undecided, 0);
  EXPECT_GT(hits, sweeps / 10);
}

TEST(ExactMovingTwin, TrianglesAnswerAlikeInEitherOrder) {
  std::mt19937_64 generator = oracle::seeded(78);
  Makers make(generator);
  for (int i = 0; i < 2000; ++i) {
    const MovingTriangle a = lattice_sweep(make);
    const MovingTriangle b = lattice_sweep(make);
    TimeBracket one;
    TimeBracket other;
    const ExactResult verdict = first_contact(a, b, 1e-9, one);
    const ExactResult swapped =
        first_contact(MovingTriangle{b.c, b.a, b.b}, MovingTriangle{a.b, a.a, a.c}, 1e-9, other);
    ASSERT_EQ(swapped.decision, verdict.decision);
    if (!verdict.yes()) continue;
    ASSERT_LE(one.low, other.high);
    ASSERT_LE(other.low, one.high);
  }
}

template <class Ask>
void time_calls(const char* name, int count, const Ask& ask) {
  std::vector<double> spent_us;
  int hits = 0;
  for (int i = 0; i < count; ++i) {
    const auto start = std::chrono::steady_clock::now();
    hits += ask(i).yes();
    spent_us.push_back(std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count());
  }
  std::sort(spent_us.begin(), spent_us.end());
  std::printf("%s: median %.2f us, p99 %.2f us, worst %.1f us; %d of %d hit\n", name, spent_us[spent_us.size() / 2],
              spent_us[spent_us.size() * 99 / 100], spent_us.back(), hits, count);
  EXPECT_GT(hits, 0);
}

TEST(ExactMovingTwin, TimeOfACallForTheRecord) {
  std::mt19937_64 generator = oracle::seeded(79);
  Makers make(generator);
  constexpr int kCount = 4000;
  std::vector<std::array<MovingPoint, 4>> quartets;
  std::vector<MovingTriangle> triangles;
  for (int i = 0; i < kCount; ++i) quartets.push_back(make.four_points(Family::random));
  for (int i = 0; i < 2 * kCount; ++i) triangles.push_back(lattice_sweep(make));
  std::vector<std::array<MovingPoint, 4>> flat;
  for (int i = 0; i < kCount; ++i) flat.push_back(make.four_points(Family::planar));
  TimeBracket bracket;
  const auto face = [&](const auto& p) { return first_contact(p[0], MovingTriangle{p[1], p[2], p[3]}, 1e-6, bracket); };
  time_calls("point and face", kCount, [&](int i) { return face(quartets[i]); });
  time_calls("point and face in one plane", kCount, [&](int i) { return face(flat[i]); });
  time_calls("edge and edge", kCount, [&](int i) {
    const auto& p = quartets[i];
    return first_contact(MovingSegment{p[0], p[1]}, MovingSegment{p[2], p[3]}, 1e-6, bracket);
  });
  time_calls("two triangles", kCount,
             [&](int i) { return first_contact(triangles[2 * i], triangles[2 * i + 1], 1e-6, bracket); });
}

}  // namespace
}  // namespace collided::engine::moving_twin_test
