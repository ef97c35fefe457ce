// Pairs of convex shapes, decision and contact, one thread: ours with certificates beside FCL's collide on the same pairs.

#include <algorithm>
#include <memory>
#include <random>

#include "server/exact_phase/distance/general_shapes.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "tests/oracle/random_shapes.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/studies/bench/peers/convex_peer.hpp"
#include "tests/studies/bench/rows.hpp"

namespace collided::bench {
using namespace engine;
namespace {

constexpr std::size_t kPairs = 2000;

/// A shape about its own middle and where it is, as peers want it.
ConvexCase placed_case(const Primitive& shape, std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto any = [&] { return uniform(random); };
  const double w = any(), x = any(), y = any(), z = any();
  const double a = any(), b = any();
  return {shape, Pose{.position = Vec3(a, b, any()), .rotation = Quat(w, x, y, z).normalized()}};
}

Primitive shape_of(const std::string& kind, std::mt19937_64& random) {
  std::uniform_real_distribution<double> size(0.2, 0.8);
  const double r = size(random);
  const double h = size(random);
  if (kind == "cylinder") return Cylinder{{0, 0, -h}, {0, 0, h}, r};
  if (kind == "cone") return Cone{{0, 0, h}, {0, 0, -h}, r};
  if (kind == "ellipsoid") return Ellipsoid{.center = Vec3::Zero(), .half_m = {r, h, size(random)}};
  if (kind == "box") return Box{.center = Vec3::Zero(), .half_m = {r, h, size(random)}};
  if (kind == "sphere") return Sphere{Vec3::Zero(), r};
  std::vector<Vec3> points;
  std::normal_distribution<double> part;
  for (int i = 0; i < 40; ++i) {
    const double x = part(random), y = part(random);
    points.push_back(r * Vec3(x, y, part(random)).normalized());
  }
  return Hull{std::make_shared<const TriangleMesh>(*convex_hull(points))};
}

Primitive in_world(const ConvexCase& one) { return place(frame_of(one.pose), one.shape); }

void run(const Options& options, const std::string& a, const std::string& b, bool contacts, std::mt19937_64& random) {
  const std::string scene = a + " " + b;
  const std::string work = contacts ? "contact" : "overlap";
  std::vector<ConvexCase> first;
  std::vector<ConvexCase> second;
  for (std::size_t i = 0; i < kPairs; ++i) {
    first.push_back(placed_case(shape_of(a, random), random));
    second.push_back(placed_case(shape_of(b, random), random));
  }
  if (!options.wants(scene, work)) return;
  std::vector<std::pair<Primitive, Primitive>> placed;
  std::vector<bool> answers;
  std::size_t undecided = 0;
  for (std::size_t i = 0; i < kPairs; ++i) {
    placed.emplace_back(in_world(first[i]), in_world(second[i]));
    const ExactResult verdict = overlaps(placed[i].first, placed[i].second);
    answers.push_back(verdict.yes());
    undecided += verdict.decision == Decision::undecided;
  }
  double unread = 0;
  std::vector<Method> methods{{.name = "collided",
                               .run =
                                   [&] {
                                     for (const auto& [x, y] : placed) {
                                       if (overlaps(x, y).yes() && contacts) unread += contact(x, y).depth_m;
                                     }
                                   },
                               .equal = kPairs - undecided,
                               .of = kPairs}};
#ifdef COLLIDED_BENCH_FCL
  const std::unique_ptr<ConvexPeer> peer = fcl_convex_peer(first, second);
  const std::vector<bool> theirs = peer->answers();
  std::size_t equal = 0;
  for (std::size_t i = 0; i < kPairs; ++i) equal += theirs[i] == answers[i];
  methods.push_back({.name = "FCL", .run = [&] { peer->collide(contacts); }, .equal = equal, .of = kPairs});
#endif
  measure(options,
          {scene, kPairs, work, kPairs, std::to_string(std::count(answers.begin(), answers.end(), true)) + " touch"},
          methods);
}

}  // namespace
}  // namespace collided::bench

int main(int argc, char** argv) {
  using namespace collided;
  const bench::Options options = bench::read_options(argc, argv);
  std::mt19937_64 random = oracle::seeded(20261121);
  const char* kinds[] = {"sphere", "box", "cylinder", "cone", "ellipsoid", "hull"};
  for (std::size_t i = 0; i < std::size(kinds); ++i) {
    for (std::size_t j = i; j < std::size(kinds); ++j) {
      for (const bool contacts : {false, true}) bench::run(options, kinds[i], kinds[j], contacts, random);
    }
  }
  return 0;
}
