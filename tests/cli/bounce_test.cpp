#include <gtest/gtest.h>

#include <map>
#include <set>

#include "client/cli/failure.hpp"
#include "client/cli/publish/bounce.hpp"
#include "client/cli/publish/sphere_mesh.hpp"

namespace collided::cli {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;

/// Every directed edge once, and its opposite once: closed and of one orientation.
void expect_closed(const MeshShape& mesh) {
  std::map<Edge, int> count;
  for (const auto& t : mesh.triangles) {
    for (int corner = 0; corner < 3; ++corner) ++count[{t[corner], t[(corner + 1) % 3]}];
  }
  for (const auto& [edge, times] : count) {
    EXPECT_EQ(times, 1);
    EXPECT_EQ(count.count({edge.second, edge.first}), 1U);
  }
}

double volume(const MeshShape& mesh) {
  double six_times = 0;
  for (const auto& t : mesh.triangles)
    six_times += mesh.vertices[t[0]].dot(mesh.vertices[t[1]].cross(mesh.vertices[t[2]]));
  return six_times / 6;
}

// B8
TEST(SphereMesh, HasTheTrianglesOfItsLatitudesAndLongitudes) {
  for (const auto& [latitudes, longitudes] : {std::pair<std::size_t, std::size_t>{9, 16}, {2, 3}, {5, 7}, {40, 80}}) {
    const MeshShape mesh = sphere_mesh(1, latitudes, longitudes);
    EXPECT_EQ(mesh.triangles.size(), 2 * longitudes * (latitudes - 1));
    EXPECT_EQ(mesh.vertices.size(), longitudes * (latitudes - 1) + 2);
    expect_closed(mesh);
    for (const Vec3& vertex : mesh.vertices) EXPECT_NEAR(vertex.norm(), 1, 1e-15);
  }
  EXPECT_EQ(sphere_mesh(1, 9, 16).triangles.size(), 256U);
}

// B8: the error of the volume falls fourfold when the bands double.
TEST(SphereMesh, ItsVolumeTendsToTheSphere) {
  const double whole = 4.0 / 3 * std::acos(-1.0) * 8;
  double before = whole - volume(sphere_mesh(2, 8, 16));
  for (const std::size_t bands : {16, 32, 64}) {
    const double error = whole - volume(sphere_mesh(2, bands, 2 * bands));
    EXPECT_NEAR(before / error, 4, 0.15);
    before = error;
  }
  EXPECT_GT(before, 0);  // inscribed, and its normals point outward
}

TEST(SphereMesh, BandsComeCloseToTheTrianglesAskedFor) {
  EXPECT_EQ(bands_for(256).latitudes, 9U);
  EXPECT_EQ(bands_for(256).longitudes, 16U);
  for (std::size_t asked = 16; asked < 100'000; asked = asked * 3 / 2) {
    const LatitudeLongitude bands = bands_for(asked);
    const auto made = static_cast<double>(2 * bands.longitudes * (bands.latitudes - 1));
    EXPECT_NEAR(made / static_cast<double>(asked), 1, 0.15) << asked;
  }
}

// B9
TEST(CubeWalls, HaveEightVerticesTwelveTrianglesAndLookInward) {
  const MeshShape walls = cube_walls(0.5);
  EXPECT_EQ(walls.vertices.size(), 8U);
  EXPECT_EQ(walls.triangles.size(), 12U);
  expect_closed(walls);
  EXPECT_NEAR(volume(walls), -1, 1e-15);
}

/// What a server would report: which spheres touch.
std::set<std::pair<std::size_t, std::size_t>> touching(const Bounce& bounce) {
  std::set<std::pair<std::size_t, std::size_t>> pairs;
  const auto& spheres = bounce.spheres();
  for (std::size_t a = 0; a < spheres.size(); ++a) {
    for (std::size_t b = a + 1; b < spheres.size(); ++b) {
      if ((spheres[a].position - spheres[b].position).norm() <= spheres[a].radius_m + spheres[b].radius_m)
        pairs.emplace(a, b);
    }
  }
  return pairs;
}

BounceLedger run(Bounce& bounce, int steps, double seconds) {
  std::set<std::pair<std::size_t, std::size_t>> open;
  for (int step = 0; step < steps; ++step) {
    const auto now = touching(bounce);
    for (const auto& [a, b] : now) {
      if (!open.contains({a, b})) bounce.contact_began(a, b);
    }
    for (const auto& [a, b] : open) {
      if (!now.contains({a, b})) bounce.contact_ended(a, b);
    }
    open = now;
    bounce.step(seconds);
  }
  return bounce.ledger();
}

// B5
TEST(Bounce, NoSphereLeavesTheCubeInAMillionSteps) {
  Bounce bounce({.sphere_count = 3, .relative_size = 0.3, .speed_m_s = 5, .seed = 11});
  std::vector<double> speeds;
  for (const Sphere& sphere : bounce.spheres()) speeds.push_back(sphere.velocity.norm());
  for (int step = 0; step < 1'000'000; ++step) {
    bounce.step(0.0173);
    for (const Sphere& sphere : bounce.spheres())
      ASSERT_LE(sphere.position.cwiseAbs().maxCoeff() + sphere.radius_m, 0.5 * (1 + 1e-15)) << step;
  }
  for (std::size_t at = 0; at < speeds.size(); ++at) EXPECT_EQ(bounce.spheres()[at].velocity.norm(), speeds[at]);
  const BounceLedger ledger = bounce.ledger();
  EXPECT_GT(ledger.wall_hits[1], 0U);
  EXPECT_GT(ledger.wall_hits[2], 0U);
  EXPECT_GT(ledger.wall_hits[3], 0U);
}

// B5: only the component along the wall's normal turns.
TEST(Bounce, AWallTurnsOnlyTheComponentAlongItsNormal) {
  Bounce bounce({.sphere_count = 1, .relative_size = 0.2, .speed_m_s = 1, .seed = 3});
  Vec3 before = bounce.spheres()[0].velocity;
  std::uint64_t walls = 0;
  for (int step = 0; step < 10'000; ++step) {
    bounce.step(0.001);
    const Vec3& now = bounce.spheres()[0].velocity;
    EXPECT_EQ(now.cwiseAbs(), before.cwiseAbs());
    const std::uint64_t hits = bounce.ledger().wall_hits[1];
    if (hits > walls) { EXPECT_EQ((now.array() != before.array()).count(), 1); }
    walls = hits;
    before = now;
  }
  EXPECT_GT(walls, 5U);
}

TEST(Bounce, AStepAcrossTheCubeManyTimesEndsWhereSmallStepsDo) {
  const BounceOptions options{.sphere_count = 4, .speed_m_s = 1, .seed = 5};
  Bounce small(options);
  Bounce large(options);
  for (int step = 0; step < 4096; ++step) small.step(1.0 / 64);
  large.step(64);
  for (std::size_t at = 0; at < 4; ++at) {
    EXPECT_NEAR((small.spheres()[at].position - large.spheres()[at].position).norm(), 0, 1e-11);
    EXPECT_EQ(small.spheres()[at].velocity, large.spheres()[at].velocity);
  }
}

// B4: all components flip; the literal rule flips a pair on every frame of a contact and some pairs stick.
TEST(Bounce, FlippingOnEveryFrameSticksAndFlippingOnceDoesNot) {
  BounceOptions options{.sphere_count = 20, .relative_size = 0.2, .speed_m_s = 0.5, .seed = 7};
  options.as_asked = true;
  Bounce literal(options);
  options.as_asked = false;
  Bounce once(options);
  const BounceLedger with = run(literal, 20'000, 1.0 / 60);
  const BounceLedger without = run(once, 20'000, 1.0 / 60);
  EXPECT_GT(with.sticking, 0U);
  EXPECT_GT(with.longest_flips, 10U);
  EXPECT_EQ(without.sticking, 0U);
  EXPECT_EQ(without.longest_flips, 1U);
  EXPECT_GT(without.contacts, 100U);
}

// A45: speeds never change, so the energy is the same to the last bit; momentum is not kept by this rule.
TEST(Bounce, TheLedgerBalances) {
  Bounce bounce({.sphere_count = 20, .relative_size = 0.2, .speed_m_s = 0.5, .seed = 7});
  const BounceLedger ledger = run(bounce, 5'000, 1.0 / 60);
  EXPECT_EQ(ledger.energy_before, ledger.energy_after);
  EXPECT_NE(ledger.momentum_before, ledger.momentum_after);
  EXPECT_EQ(ledger.flips, ledger.contacts);
}

// B6, B7
TEST(Bounce, TheSameSeedIsTheSameRun) {
  const BounceOptions options{.sphere_count = 50, .relative_size = 0.1, .spin_rad_s = 3, .seed = 42};
  Bounce first(options);
  Bounce second(options);
  Bounce other({.sphere_count = 50, .relative_size = 0.1, .spin_rad_s = 3, .seed = 43});
  run(first, 100, 0.01);
  run(second, 100, 0.01);
  for (std::size_t at = 0; at < 50; ++at) {
    EXPECT_EQ(first.spheres()[at].position, second.spheres()[at].position);
    EXPECT_EQ(first.spheres()[at].rotation.coeffs(), second.spheres()[at].rotation.coeffs());
    EXPECT_NE(first.spheres()[at].radius_m, other.spheres()[at].radius_m);
  }
  std::size_t counted = 0;
  for (const std::size_t count : first.size_histogram()) counted += count;
  EXPECT_EQ(counted, 50U);
}

TEST(Bounce, TheCubesOwnContactTurnsASphereOnlyOnItsWayOut) {
  Bounce bounce({.sphere_count = 1, .seed = 3});
  const Sphere before = bounce.spheres()[0];
  int axis = 0;
  (before.position.cwiseProduct(before.velocity)).maxCoeff(&axis);
  ASSERT_GT(before.position[axis] * before.velocity[axis], 0);
  const Vec3 normal = Vec3::Unit(axis);
  bounce.touched_cube(0, normal);
  EXPECT_EQ(bounce.spheres()[0].velocity[axis], -before.velocity[axis]);
  bounce.touched_cube(0, -normal);
  EXPECT_EQ(bounce.spheres()[0].velocity[axis], -before.velocity[axis]);
}

TEST(Bounce, SpheresThatCannotFitAreRefused) {
  EXPECT_THROW(Bounce({.sphere_count = 1, .relative_size = 0.7}), Failure);
}

}  // namespace
}  // namespace collided::cli
