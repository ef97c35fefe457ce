#include <gtest/gtest.h>

#include <collided/vcollide.hpp>

#include <cfenv>
#include <cstdio>
#include <limits>
#include <map>
#include <random>
#include <set>

#include "server/geometry/aabb.hpp"
#include "server/intake/mesh/sphere_mesh.hpp"
#include "tests/oracle/exact_oracle.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/oracle/simple_prototype.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::engine {
namespace {

using namespace vcollide;

using TrianglePair = std::array<int, 2>;
using Found = std::map<std::array<int, 2>, std::vector<TrianglePair>>;

void set_matrix(const Frame& frame, double trans[4][4]) {
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      trans[row][column] = row == 3      ? (column == 3 ? 1 : 0)
                           : column == 3 ? frame.position[row]
                                         : frame.rotation(row, column);
    }
  }
}

/// Triangle ids are their numbers plus first_id.
int add(VCollide& vc, const TriangleMesh& mesh, int first_id = 0) {
  int id = -1;
  EXPECT_EQ(vc.NewObject(&id), VC_OK);
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle t = mesh.triangle(i);
    EXPECT_EQ(vc.AddTri(t.a.data(), t.b.data(), t.c.data(), first_id + static_cast<int>(i)), VC_OK);
  }
  EXPECT_EQ(vc.EndObject(), VC_OK);
  return id;
}

void move(VCollide& vc, int id, const Pose& pose) {
  double trans[4][4];
  set_matrix(frame_of(pose), trans);
  ASSERT_EQ(vc.UpdateTrans(id, trans), VC_OK) << vc.LastError();
}

Found found(const VCReport& report) {
  Found all;
  for (int i = 0; i < report.numObjPairs(); ++i) {
    auto& triangles = all[{report.obj1ID(i), report.obj2ID(i)}];
    for (int j = 0; j < report.numTriPairs(i); ++j) triangles.push_back({report.tri1ID(i, j), report.tri2ID(i, j)});
  }
  return all;
}

Found collide(VCollide& vc, int flag = VC_ALL_CONTACTS) {
  VCReport report;
  EXPECT_EQ(vc.Collide(&report, flag), VC_OK) << vc.LastError();
  return found(report);
}

/// What a matrix makes of a pose, since UpdateTrans is given matrices.
Frame through_matrix(const Pose& pose) {
  const Mat3 rotation = frame_of(pose).rotation;
  return frame_of(Pose{.position = pose.position, .rotation = Quat(rotation).normalized()});
}

/// Every pair of objects, every pair of triangles, in rationals.
Found by_oracle(const std::vector<TriangleMesh>& meshes, const std::vector<Pose>& poses) {
  using Exact = oracle::Moeller<oracle::Rational>;
  const Exact meet;
  Found all;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    for (std::size_t j = i + 1; j < meshes.size(); ++j) {
      const Frame of_i = through_matrix(poses[i]), of_j = through_matrix(poses[j]);
      std::vector<TrianglePair> triangles;
      for (std::uint32_t k = 0; k < meshes[i].triangles.size(); ++k) {
        const Triangle a = place(of_i, meshes[i].triangle(k));
        for (std::uint32_t l = 0; l < meshes[j].triangles.size(); ++l) {
          const Triangle b = place(of_j, meshes[j].triangle(l));
          if (!overlaps(bounds(a), bounds(b)) || !meet(Exact::corners(a), Exact::corners(b))) continue;
          triangles.push_back({static_cast<int>(k), static_cast<int>(l)});
        }
      }
      if (!triangles.empty()) all[{static_cast<int>(i), static_cast<int>(j)}] = triangles;
    }
  }
  return all;
}

Pose random_pose(std::mt19937_64& random, double reach_m) {
  std::normal_distribution<double> part;
  std::uniform_real_distribution<double> place(-reach_m, reach_m);
  Pose pose;
  for (int axis = 0; axis < 3; ++axis) pose.position[axis] = place(random);
  const double w = part(random), x = part(random), y = part(random);
  pose.rotation = Quat(w, x, y, part(random)).normalized();
  return pose;
}

// B1, B3: objects and triangles as rationals have them.
TEST(VCollideAdapter, ReportsTheOraclesObjectsAndTriangles) {
  std::mt19937_64 random = oracle::seeded(2000);
  std::size_t pairs = 0, triangles = 0;
  for (int round = 0; round < 8; ++round) {
    std::vector<TriangleMesh> meshes;
    std::vector<Pose> poses;
    VCollide vc;
    for (int i = 0; i < 6; ++i) {
      meshes.push_back(i == 5 ? scenes::box({0.4, 0.3, 0.2}) : latitude_longitude_sphere(0.15 + 0.04 * i, 6, 4));
      poses.push_back(random_pose(random, 0.4));
      move(vc, add(vc, meshes.back()), poses.back());
    }
    const Found expected = by_oracle(meshes, poses);
    EXPECT_EQ(collide(vc), expected) << "round " << round;
    // First contact: the same objects, one true pair of triangles each.
    const Found first = collide(vc, VC_FIRST_CONTACT);
    ASSERT_EQ(first.size(), expected.size());
    for (const auto& [objects, one] : first) {
      ASSERT_EQ(one.size(), 1u);
      const auto& all = expected.at(objects);
      EXPECT_TRUE(std::find(all.begin(), all.end(), one[0]) != all.end());
    }
    pairs += expected.size();
    for (const auto& [objects, list] : expected) triangles += list.size();
  }
  std::printf("%zu object pairs, %zu triangle pairs equal\n", pairs, triangles);
  EXPECT_GT(pairs, 20u);
}

// B3: on a lattice everything touches: whole faces in one plane, edges, vertices.
TEST(VCollideAdapter, ReportsTouchingAndCoplanarTriangles) {
  const TriangleMesh cube = scenes::box({0.5, 0.5, 0.5});
  for (const Vec3& place :
       {Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(1, 1, 1), Vec3(0.5, 0, 0), Vec3(1, 0.5, 0.25), Vec3(0, 0, 0)}) {
    VCollide vc;
    add(vc, cube);
    move(vc, add(vc, cube), {.position = place});
    const Found expected = by_oracle({cube, cube}, {{}, {.position = place}});
    EXPECT_EQ(expected.size(), 1u);
    EXPECT_EQ(collide(vc), expected) << place.transpose();
  }
  VCollide vc;
  add(vc, cube);
  move(vc, add(vc, cube), {.position = {1 + 0x1p-52, 0, 0}});
  EXPECT_TRUE(collide(vc).empty());
}

// B3: which object was made first does not matter.
TEST(VCollideAdapter, SwappingTwoObjectsSwapsThePairs) {
  std::mt19937_64 random = oracle::seeded(17);
  std::size_t pairs = 0;
  for (int round = 0; round < 40; ++round) {
    const TriangleMesh a = latitude_longitude_sphere(0.5, 16, 9);
    const TriangleMesh b = latitude_longitude_sphere(0.3, 12, 6);
    const Pose at_a = random_pose(random, 0.25), at_b = random_pose(random, 0.25);
    VCollide one, other;
    move(one, add(one, a), at_a);
    move(one, add(one, b), at_b);
    move(other, add(other, b), at_b);
    move(other, add(other, a), at_a);
    std::set<TrianglePair> straight, turned;
    for (const auto& [objects, list] : collide(one)) straight.insert(list.begin(), list.end());
    for (const auto& [objects, list] : collide(other)) {
      for (const TrianglePair& pair : list) turned.insert({pair[1], pair[0]});
    }
    EXPECT_EQ(straight, turned);
    pairs += straight.size();
  }
  EXPECT_GT(pairs, 100u);
}

TEST(VCollideAdapter, WhatIsInactiveOrDeletedMeetsNothing) {
  const TriangleMesh cube = scenes::box({0.5, 0.5, 0.5});
  VCollide vc;
  for (int i = 0; i < 3; ++i) move(vc, add(vc, cube), {.position = {0.3 * i, 0, 0}});
  const auto pairs = [&] {
    std::set<std::array<int, 2>> all;
    for (const auto& [objects, list] : collide(vc, VC_FIRST_CONTACT)) all.insert(objects);
    return all;
  };
  using Pairs = std::set<std::array<int, 2>>;
  EXPECT_EQ(pairs(), (Pairs{{0, 1}, {0, 2}, {1, 2}}));
  EXPECT_EQ(vc.DeactivatePair(2, 0), VC_OK);
  EXPECT_EQ(pairs(), (Pairs{{0, 1}, {1, 2}}));
  EXPECT_EQ(vc.DeactivateObject(1), VC_OK);
  EXPECT_EQ(pairs(), Pairs{});
  EXPECT_EQ(vc.ActivatePair(0, 2), VC_OK);
  EXPECT_EQ(pairs(), (Pairs{{0, 2}}));
  EXPECT_EQ(vc.ActivateObject(1), VC_OK);
  EXPECT_EQ(vc.DeleteObject(0), VC_OK);
  EXPECT_EQ(pairs(), (Pairs{{1, 2}}));
  EXPECT_EQ(vc.DeleteObject(0), VC_ERR_INVALID_ID);
  EXPECT_EQ(add(vc, cube), 3);
  EXPECT_EQ(pairs(), (Pairs{{1, 2}, {1, 3}, {2, 3}}));
}

TEST(VCollideAdapter, CallsOutOfOrderAndBadNumbersSaySo) {
  VCollide vc;
  VCReport report;
  const double zero[3] = {0, 0, 0}, x[3] = {1, 0, 0}, bad[3] = {0, std::numeric_limits<double>::quiet_NaN(), 0};
  double trans[4][4];
  set_matrix({}, trans);
  EXPECT_EQ(vc.AddTri(zero, x, x, 0), VC_ERR_CALL_OUT_OF_SEQUENCE);
  EXPECT_EQ(vc.EndObject(), VC_ERR_CALL_OUT_OF_SEQUENCE);
  int id = -1;
  ASSERT_EQ(vc.NewObject(&id), VC_OK);
  EXPECT_EQ(vc.NewObject(&id), VC_ERR_CALL_OUT_OF_SEQUENCE);
  EXPECT_EQ(vc.UpdateTrans(id, trans), VC_ERR_CALL_OUT_OF_SEQUENCE);
  EXPECT_EQ(vc.Collide(&report), VC_ERR_CALL_OUT_OF_SEQUENCE);
  EXPECT_EQ(vc.EndObject(), VC_ERR_EMPTY_OBJECT);
  EXPECT_EQ(vc.AddTri(zero, x, bad, 77), VC_ERR);
  EXPECT_EQ(vc.LastError(), "AddTri: triangle 77, corner 3 is (0, nan, 0); allowed are finite numbers");
  EXPECT_EQ(vc.AddTri(zero, x, x, 77), VC_OK);  // a degenerate triangle is a segment
  EXPECT_EQ(vc.EndObject(), VC_OK);
  EXPECT_EQ(vc.UpdateTrans(5, trans), VC_ERR_INVALID_ID);
  EXPECT_EQ(vc.Collide(&report, 3), VC_ERR);
  EXPECT_EQ(vc.Collide(nullptr), VC_ERR);
  EXPECT_EQ(vc.DeactivatePair(0, 0), VC_ERR_INVALID_ID);
  trans[0][0] = 2;
  EXPECT_EQ(vc.UpdateTrans(0, trans), VC_ERR);
  EXPECT_EQ(vc.LastError(),
            "UpdateTrans: object 0: the columns are off a rotation's by 3, allowed 1e-06; it stays where it was");
  trans[0][0] = -1;
  EXPECT_EQ(vc.UpdateTrans(0, trans), VC_ERR);
  trans[0][0] = 1;
  trans[3][0] = 1;
  EXPECT_EQ(vc.UpdateTrans(0, trans), VC_ERR);
}

TEST(VCollideAdapter, AMatrixThatIsNoPlaceIsRefusedByWhatIsWrongWithIt) {
  VCollide vc;
  const TriangleMesh cube = scenes::box({0.5, 0.5, 0.5});
  add(vc, cube);
  move(vc, add(vc, cube), {.position = {0.25, 0, 0}});
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const std::string not_finite = "a number of the matrix is not finite";
  struct Wrong {
    int row, column;
    double value;
    std::string what;
  };
  for (const Wrong& wrong : {Wrong{0, 0, nan, not_finite},
                             {1, 2, inf, not_finite},
                             {2, 1, -inf, not_finite},
                             {0, 3, nan, not_finite},
                             {2, 3, inf, not_finite},
                             {3, 1, 0.5, "the matrix's last row has 0.5 in column 1, allowed are 0 0 0 1"},
                             {3, 3, 2, "the matrix's last row has 2 in column 3, allowed are 0 0 0 1"},
                             {1, 1, -1, "the matrix mirrors (determinant -1), allowed are rotations"},
                             {0, 1, 0.5, "the columns are off a rotation's by 0.5, allowed 1e-06"}}) {
    double trans[4][4];
    set_matrix(frame_of(Pose{.position = {9, 9, 9}}), trans);
    trans[wrong.row][wrong.column] = wrong.value;
    EXPECT_EQ(vc.UpdateTrans(1, trans), VC_ERR) << wrong.row << wrong.column;
    EXPECT_EQ(vc.LastError(), "UpdateTrans: object 1: " + wrong.what + "; it stays where it was");
  }
  EXPECT_EQ(collide(vc, VC_FIRST_CONTACT).size(), 1u) << "it stays where it was";
}

TEST(VCollideAdapter, CandidatesAreThoseOfTheNewestCall) {
  VCollide vc;
  const TriangleMesh cube = scenes::box({0.5, 0.5, 0.5});
  for (int i = 0; i < 3; ++i) move(vc, add(vc, cube), {.position = {0.7 * i, 0, 0}});
  collide(vc);
  const std::size_t objects = vc.ObjectCandidates(), triangles = vc.TriangleCandidates();
  EXPECT_EQ(objects, 2u);
  EXPECT_GT(triangles, 0u);
  collide(vc);
  EXPECT_EQ(vc.ObjectCandidates(), objects);
  EXPECT_EQ(vc.TriangleCandidates(), triangles);
  move(vc, 1, {.position = {0, 50, 0}});
  collide(vc);
  EXPECT_EQ(vc.ObjectCandidates(), 0u);
  EXPECT_EQ(vc.TriangleCandidates(), 0u);
}

// Messages name the object and the corner that they are about, counted as the calls do.
TEST(VCollideAdapter, AComplaintNamesTheObjectThatIsOpen) {
  VCollide vc;
  add(vc, scenes::icosphere(1, 1.0));
  add(vc, scenes::icosphere(1, 1.0));
  int id = -1;
  ASSERT_EQ(vc.NewObject(&id), VC_OK);
  ASSERT_EQ(id, 2);
  int other = -1;
  EXPECT_EQ(vc.NewObject(&other), VC_ERR_CALL_OUT_OF_SEQUENCE);
  EXPECT_EQ(vc.LastError(), "NewObject: object 2 is open; EndObject comes first");
  EXPECT_EQ(vc.EndObject(), VC_ERR_EMPTY_OBJECT);
  EXPECT_EQ(vc.LastError(), "EndObject: object 2 has no triangle");
  VCReport report;
  EXPECT_EQ(vc.Collide(&report, VC_ALL_CONTACTS), VC_ERR_CALL_OUT_OF_SEQUENCE);
  EXPECT_EQ(vc.LastError(), "Collide: object 2 is open; EndObject comes first");
  const double good[3] = {0, 0, 0};
  const double bad[3] = {1, std::numeric_limits<double>::infinity(), 3};
  EXPECT_EQ(vc.AddTri(bad, good, good, 9), VC_ERR);
  EXPECT_EQ(vc.LastError(), "AddTri: triangle 9, corner 1 is (1, inf, 3); allowed are finite numbers");
}

TEST(VCollideAdapter, TakesARotationRoundedToSixDigits) {
  VCollide vc;
  add(vc, scenes::box({0.5, 0.5, 0.5}));
  double trans[4][4];
  set_matrix({}, trans);
  trans[0][0] = trans[1][1] = 0.8660254;
  trans[0][1] = -0.5;
  trans[1][0] = 0.5;
  EXPECT_EQ(vc.UpdateTrans(0, trans), VC_OK) << vc.LastError();
}

// The host may round as it likes: the answer is that of the proofs' arithmetic, and the host's setting is as before.
TEST(VCollideAdapter, DoesNotHangOnTheHostsRounding) {
  VCollide vc;
  const TriangleMesh cube = scenes::box({0.5, 0.5, 0.5});
  add(vc, cube);
  move(vc, add(vc, cube), {.position = {1, 0.1, 0.7}});
  const Found expected = collide(vc);
  for (const int mode : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
    std::fesetround(mode);
    VCReport report;
    const int code = vc.Collide(&report, VC_ALL_CONTACTS);
    const int after = std::fegetround();
    std::fesetround(FE_TONEAREST);
    EXPECT_EQ(code, VC_OK);
    EXPECT_EQ(after, mode);
    EXPECT_EQ(found(report), expected);
  }
}

// Far out, large, and with products that overflow: still the oracle's answer.
TEST(VCollideAdapter, TakesEveryFiniteNumber) {
  for (const double scale : {1e-300, 1e-150, 1e150, 1e300}) {
    TriangleMesh one, other;
    one.vertices = {{0, 0, 0}, {scale, 0, 0}, {0, scale, 0}};
    one.triangles = {{0, 1, 2}};
    other = one;
    for (Vec3& vertex : other.vertices)
      vertex = Vec3(vertex[2], vertex[0], vertex[1]) + Vec3(scale / 4, -scale / 4, -scale / 4);
    for (const double apart : {0.0, 0.5, 2.0}) {
      VCollide vc;
      add(vc, one);
      const Pose pose{.position = {apart * scale, 0, 0}};
      move(vc, add(vc, other), pose);
      const Found expected = by_oracle({one, other}, {{}, pose});
      EXPECT_EQ(expected.empty(), apart > 1);
      EXPECT_EQ(collide(vc), expected) << scale << " " << apart;
    }
  }
}

// B18, B20: the simple prototype is right about spheres in general position, so it may be the others' baseline.
TEST(SimplePrototypeBaseline, FindsTheSamePairsOfSpheresInGeneralPosition) {
  std::mt19937_64 random = oracle::seeded(5);
  const auto mesh = std::make_shared<const TriangleMesh>(latitude_longitude_sphere(0.2, 16, 9));
  VCollide vc;
  oracle::SimplePrototype prototype;
  std::size_t pairs = 0;
  for (int i = 0; i < 20; ++i) {
    add(vc, *mesh);
    prototype.add(mesh);
  }
  for (int frame = 0; frame < 10; ++frame) {
    for (int i = 0; i < 20; ++i) {
      const Pose pose = random_pose(random, 0.5);
      move(vc, i, pose);
      prototype.move(static_cast<std::size_t>(i), through_matrix(pose));
    }
    Found expected;
    for (const oracle::MeetingPair& pair : prototype.collide()) {
      auto& list = expected[{static_cast<int>(pair.object[0]), static_cast<int>(pair.object[1])}];
      for (const auto& t : pair.triangles) list.push_back({static_cast<int>(t[0]), static_cast<int>(t[1])});
    }
    EXPECT_EQ(collide(vc), expected);
    EXPECT_LE(vc.ObjectCandidates(), 190u);
    pairs += expected.size();
  }
  EXPECT_GT(pairs, 50u);
}

}  // namespace
}  // namespace collided::engine
