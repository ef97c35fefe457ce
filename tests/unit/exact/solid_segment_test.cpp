#include "server/exact_phase/solid/solid_segment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

#include "tests/oracle/seed.hpp"
#include "tests/oracle/tree_and_truth.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/scenes/planted.hpp"

namespace collided::engine {
namespace {

std::string told(const std::vector<SegmentPart>& parts) {
  std::string text;
  for (const SegmentPart& part : parts) {
    const char* name = part.side == SolidSide::in ? "in" : part.side == SolidSide::on ? "on" : "out";
    text += (text.empty() ? "" : " ") + std::string(name);
  }
  return text;
}

TEST(ExactSolidSegment, PassesABoxInThreeParts) {
  const oracle::TreeAndTruth box(scenes::box({1, 1, 1}));
  const auto parts = segment_parts(*box.tree, {-2, 0.25, 0.5}, {2, 0.25, 0.5});
  ASSERT_EQ(told(parts), "out in out");
  EXPECT_NEAR(parts[1].from.low, 0.25, 1e-15);
  EXPECT_LE(parts[1].from.low, 0.25);
  EXPECT_GE(parts[1].from.high, 0.25);
  EXPECT_LE(parts[1].to.low, 0.75);
  EXPECT_GE(parts[1].to.high, 0.75);
  EXPECT_EQ(parts[0].from.high, 0);
  EXPECT_EQ(parts[2].to.low, 1);
}

TEST(ExactSolidSegment, TouchesAtCornersAlongEdgesAndInFaces) {
  const oracle::TreeAndTruth box(scenes::box({1, 1, 1}));
  const auto of = [&](const Vec3& a, const Vec3& b) { return told(segment_parts(*box.tree, a, b)); };
  EXPECT_EQ(of({-2, 1, 1}, {2, 1, 1}), "out on out") << "along an edge";
  EXPECT_EQ(of({-2, 0.3, 1}, {2, 0.3, 1}), "out on out") << "in a face";
  EXPECT_EQ(of({0, 2, 0}, {2, 0, 0}), "out on out") << "past an edge, at a point";
  EXPECT_EQ(of({2, 2, -1}, {0, 0, 3}), "out on out") << "past a corner, at a point";
  EXPECT_EQ(of({-2, -2, -2}, {2, 2, 2}), "out in out") << "from corner to corner";
  EXPECT_EQ(of({0, 0, 0}, {0.5, 0, 0}), "in");
  EXPECT_EQ(of({0, 0, 0}, {1, 0, 0}), "in on") << "it ends on the surface";
  EXPECT_EQ(of({1, 0, 0}, {2, 0, 0}), "on out");
  EXPECT_EQ(of({0.5, 0, 0}, {0.5, 0, 0}), "in") << "a point";
  EXPECT_EQ(of({3, 0, 0}, {4, 1, 1}), "out");
  EXPECT_EQ(of({0, 0, 1}, {0.5, 0.25, 1}), "on");
}

struct TruePart {
  SolidSide side;
  mpq_class from;
  mpq_class to;
};

/// The parts from the crossings with every triangle's plane, each point and each piece between two asked for in rationals.
std::vector<TruePart> true_parts(const oracle::TreeAndTruth& solid, const Vec3& a, const Vec3& b,
                                 std::mt19937_64& random) {
  const auto start = oracle::rational(a), stop = oracle::rational(b);
  const auto side_at = [&](const mpq_class& t) {
    oracle::RationalPoint p;
    for (int i = 0; i < 3; ++i) p[i] = start[i] + t * (stop[i] - start[i]);
    return solid.oracle.side(p, random);
  };
  std::vector<mpq_class> at{0, 1};
  for (std::uint32_t i = 0; i < solid.shared->triangles.size(); ++i) {
    const Triangle t = solid.shared->triangle(i);
    const mpq_class high = oracle::height(t, start), low = oracle::height(t, stop);
    if (high == low) continue;
    const mpq_class crossing = high / (high - low);
    if (crossing > 0 && crossing < 1) at.push_back(crossing);
  }
  std::sort(at.begin(), at.end());
  at.erase(std::unique(at.begin(), at.end()), at.end());
  std::vector<TruePart> pieces;
  for (std::size_t i = 0; i < at.size(); ++i) {
    pieces.push_back({side_at(at[i]), at[i], at[i]});
    if (i + 1 < at.size()) pieces.push_back({side_at((at[i] + at[i + 1]) / 2), at[i], at[i + 1]});
  }
  std::vector<TruePart> merged;
  for (const TruePart& piece : pieces) {
    if (!merged.empty() && merged.back().side == piece.side) merged.back().to = piece.to;
    else merged.push_back(piece);
  }
  // A point between one that is in and one that is out goes without saying.
  std::vector<TruePart> parts;
  for (std::size_t i = 0; i < merged.size(); ++i) {
    const bool is_inner_point = merged[i].from == merged[i].to && i > 0 && i + 1 < merged.size();
    if (is_inner_point && merged[i - 1].side != merged[i + 1].side) continue;
    parts.push_back(merged[i]);
  }
  return parts;
}

TEST(ExactSolidSegment, PartsAreThoseOfRationals) {
  std::mt19937_64 random = oracle::seeded(65);
  const char* asked = std::getenv("COLLIDED_SOLID_SEGMENTS");
  const int count = asked != nullptr ? std::atoi(asked) : 150;
  std::uniform_real_distribution<double> any(-2, 2);
  std::map<std::string, int> kinds;
  for (const TriangleMesh& mesh : {scenes::box({1, 1, 1}), oracle::with_cavity(), scenes::icosphere(1, 1),
                                   scenes::rough_sphere(1, random), scenes::icosphere(1, 1e-200)}) {
    const oracle::TreeAndTruth solid(mesh);
    ASSERT_TRUE(solid.tree);
    double reach = 0;
    for (const Vec3& vertex : mesh.vertices) reach = std::max(reach, vertex.cwiseAbs().maxCoeff());
    const auto vertex = [&] { return mesh.vertices[random() % mesh.vertices.size()]; };
    const auto point = [&](int kind) -> Vec3 {
      const Triangle t = mesh.triangle(static_cast<std::uint32_t>(random() % mesh.triangles.size()));
      switch (kind) {
        case 0: return vertex();
        case 1: return (t.a + t.b) / 2;
        case 2: return t.a / 2 + t.b / 4 + t.c / 4;
        case 3: return Vec3(vertex().x(), vertex().y(), vertex().z());
        default: return reach * Vec3(any(random), any(random), any(random));
      }
    };
    for (int i = 0; i < count; ++i) {
      Vec3 a = point(static_cast<int>(random() % 6));
      Vec3 b = point(static_cast<int>(random() % 6));
      if (random() % 3 == 0) {  // on beyond both, along the same line where doubles allow it
        const Vec3 way = b - a;
        a -= way;
        b += way;
      }
      if (a == b) continue;
      const auto parts = segment_parts(*solid.tree, a, b);
      const auto truth = true_parts(solid, a, b, random);
      ASSERT_EQ(parts.size(), truth.size())
          << told(parts) << std::hexfloat << ": " << a.transpose() << " to " << b.transpose();
      for (std::size_t k = 0; k < parts.size(); ++k) {
        ASSERT_EQ(parts[k].side, truth[k].side) << told(parts);
        ASSERT_TRUE(mpq_class(parts[k].from.low) <= truth[k].from && truth[k].from <= mpq_class(parts[k].from.high));
        ASSERT_TRUE(mpq_class(parts[k].to.low) <= truth[k].to && truth[k].to <= mpq_class(parts[k].to.high));
        ASSERT_LE(parts[k].from.high - parts[k].from.low, 1e-14);
      }
      ++kinds[told(parts)];
    }
  }
  for (const char* kind : {"out in out", "on", "in", "on in on", "out on out", "in out", "on in out"})
    EXPECT_GT(kinds[kind], 0) << kind;
}

}  // namespace
}  // namespace collided::engine
