// All intersecting triangle pairs of two tessellated spheres, and whether a placed bunny touches a terrain, one thread:
// ours, exact, beside peers in turn in one run. Equal answers are pairs or poses, by the exact test of every pair.

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <random>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/studies/bench/obj.hpp"
#include "tests/studies/bench/peers/mesh_pair_peers.hpp"
#include "tests/studies/bench/rows.hpp"

namespace collided::bench {
using namespace engine;
namespace {

/// Meridians and parallels: 2 * around * (around / 2) triangles.
TriangleMesh globe(std::uint32_t around) {
  const std::uint32_t rows = around / 2 + 1;
  TriangleMesh mesh;
  mesh.vertices.push_back(Vec3(0, 0, 1));
  for (std::uint32_t row = 1; row < rows; ++row) {
    const double polar = std::numbers::pi * row / rows;
    for (std::uint32_t i = 0; i < around; ++i) {
      const double angle = 2 * std::numbers::pi * i / around;
      mesh.vertices.push_back(
          Vec3(std::sin(polar) * std::cos(angle), std::sin(polar) * std::sin(angle), std::cos(polar)));
    }
  }
  mesh.vertices.push_back(Vec3(0, 0, -1));
  const auto at = [&](std::uint32_t row, std::uint32_t i) { return 1 + (row - 1) * around + i % around; };
  const auto last = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
  for (std::uint32_t i = 0; i < around; ++i) {
    mesh.triangles.push_back({0, at(1, i), at(1, i + 1)});
    for (std::uint32_t row = 1; row + 1 < rows; ++row) {
      mesh.triangles.push_back({at(row, i), at(row + 1, i), at(row + 1, i + 1)});
      mesh.triangles.push_back({at(row, i), at(row + 1, i + 1), at(row, i + 1)});
    }
    mesh.triangles.push_back({at(rows - 1, i), last, at(rows - 1, i + 1)});
  }
  return mesh;
}

Aabb bounds_of(const Triangle& t) { return {t.a.cwiseMin(t.b).cwiseMin(t.c), t.a.cwiseMax(t.b).cwiseMax(t.c)}; }

class Ours final : public MeshPairPeer {
 public:
  Ours(const TriangleMesh& a, const TriangleMesh& b) : a_(a), b_(b), tree_a_(Bvh::build(a)), tree_b_(Bvh::build(b)) {
    for (const Vec3& vertex : b.vertices) reach_m_ = std::max(reach_m_, vertex.norm());
  }
  std::string name() const override { return "collided"; }
  void move(const Frame& frame) override { frame_ = frame; }
  void all_pairs(TrianglePairs& out) override {
    out_ = &out;
    walk();
  }
  bool any() override {
    out_ = nullptr;
    walk();
    return yes_;
  }
  std::size_t above_filter() const { return above_filter_; }
  const WalkCost& cost() const { return cost_; }

 private:
  void walk() {
    const double slack_m = 32 * 0x1p-53 * (frame_.position.lpNorm<1>() + 2 * reach_m_);
    yes_ = false;
    cost_ = {};
    above_filter_ = 0;
    placed_number_ = ~0u;
    const auto candidate = [&](std::uint32_t i, std::uint32_t j) { return test(i, j); };
    tree_a_.walk_pairs(tree_b_, frame_.rotation, frame_.position, slack_m, candidate, cost_);
  }
  bool test(std::uint32_t i, std::uint32_t j) {
    if (j != placed_number_) {
      placed_ = place(frame_, b_.triangle(j));
      placed_number_ = j;
    }
    const ExactResult verdict = overlaps(a_.triangle(i), placed_);
    above_filter_ += verdict.level != Level::filter;
    if (!verdict.yes()) return true;
    yes_ = true;
    if (out_ == nullptr) return false;
    out_->emplace_back(i, j);
    return true;
  }

  const TriangleMesh& a_;
  const TriangleMesh& b_;
  Bvh tree_a_;
  Bvh tree_b_;
  double reach_m_ = 0;
  Frame frame_;
  TrianglePairs* out_ = nullptr;
  bool yes_ = false;
  std::uint32_t placed_number_ = 0;
  Triangle placed_;
  std::size_t above_filter_ = 0;
  WalkCost cost_;
};

/// Every pair whose bounds overlap along x is put to the exact test.
TrianglePairs by_force(const TriangleMesh& a, const TriangleMesh& b, const Frame& frame) {
  struct Part {
    Aabb bounds;
    std::uint32_t number;
  };
  std::vector<Part> parts;
  double widest = 0;
  for (std::uint32_t i = 0; i < a.triangles.size(); ++i) {
    parts.push_back({bounds_of(a.triangle(i)), i});
    widest = std::max(widest, parts.back().bounds.high[0] - parts.back().bounds.low[0]);
  }
  std::sort(parts.begin(), parts.end(), [](const Part& p, const Part& q) { return p.bounds.low[0] < q.bounds.low[0]; });
  TrianglePairs pairs;
  for (std::uint32_t j = 0; j < b.triangles.size(); ++j) {
    const Triangle placed = place(frame, b.triangle(j));
    const Aabb bounds = bounds_of(placed);
    const auto first = std::lower_bound(parts.begin(), parts.end(), bounds.low[0] - 1.001 * widest,
                                        [](const Part& p, double x) { return p.bounds.low[0] < x; });
    for (auto part = first; part != parts.end() && part->bounds.low[0] <= bounds.high[0]; ++part) {
      if (engine::overlaps(part->bounds, bounds) && engine::overlaps(a.triangle(part->number), placed).yes()) {
        pairs.emplace_back(part->number, j);
      }
    }
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

void make_unique(TrianglePairs& pairs) {
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
}

using Peers = std::vector<std::unique_ptr<MeshPairPeer>>;

/// Ours is the first.
Peers all_peers(const TriangleMesh& a, const TriangleMesh& b) {
  Peers peers;
  peers.push_back(std::make_unique<Ours>(a, b));
#ifdef COLLIDED_BENCH_FCL
  peers.push_back(fcl_pair_peer(a, b));
#endif
#ifdef COLLIDED_BENCH_CGAL
  peers.push_back(cgal_pair_peer(a, b));
#endif
#ifdef COLLIDED_BENCH_ODE
  peers.push_back(ode_pair_peer(a, b));
#endif
  return peers;
}

void two_spheres(const Options& options, std::uint32_t around, const char* scene, double apart,
                 std::mt19937_64& random) {
  std::normal_distribution<double> part;
  const double w = part(random), x = part(random), y = part(random);
  const Quat rotation = Quat(w, x, y, part(random)).normalized();
  if (!options.wants(scene, "all pairs")) return;
  const TriangleMesh mesh = globe(around);
  const Frame frame = frame_of(Pose{.position = apart * Vec3(0.48, 0.64, 0.6), .rotation = rotation});
  const TrianglePairs expected = by_force(mesh, mesh, frame);
  const Peers peers = all_peers(mesh, mesh);
  const std::size_t repeats = std::max<std::size_t>(1, 200'000 / mesh.triangles.size());
  TrianglePairs pairs;
  std::vector<Method> methods;
  std::string note;
  for (const auto& peer : peers) {
    peer->move(frame);
    pairs.clear();
    peer->all_pairs(pairs);
    make_unique(pairs);
    TrianglePairs common;
    std::set_intersection(pairs.begin(), pairs.end(), expected.begin(), expected.end(), std::back_inserter(common));
    if (pairs.size() != common.size())
      note += peer->name() + " tells " + std::to_string(pairs.size() - common.size()) + " wrong ";
    methods.push_back({.name = peer->name(),
                       .run =
                           [&pairs, repeats, p = peer.get()] {
                             for (std::size_t i = 0; i < repeats; ++i) {
                               pairs.clear();
                               p->all_pairs(pairs);
                             }
                           },
                       .equal = common.size(),
                       .of = expected.size()});
  }
  const Ours& ours = static_cast<const Ours&>(*peers[0]);
  note += std::to_string(ours.cost().candidates) + " candidates, " + std::to_string(ours.above_filter()) +
          " above the filter";
  measure(options, {scene, mesh.triangles.size(), "all pairs", repeats, note}, methods);
}

/// Places over the terrain at which the mesh touches it, or just not, or stands in it.
std::vector<Frame> frames_over(const TriangleMesh& hills, const TriangleMesh& bunny, std::mt19937_64& random) {
  std::uniform_real_distribution<double> across(-0.4, 0.4), height(-0.2, 0.8), turn(0, 2 * std::numbers::pi);
  Aabb bounds;
  for (const Vec3& vertex : bunny.vertices) bounds.extend(vertex);
  const double tall = (bounds.high - bounds.low).maxCoeff();
  double far = 0;
  for (const Vec3& vertex : hills.vertices) far = std::max(far, vertex[0]);
  std::vector<Frame> frames;
  for (int i = 0; i < 24; ++i) {
    const Quat rotation(Eigen::AngleAxisd(turn(random), Vec3::UnitZ()));
    const double x = 2 * far * across(random);
    Vec3 place(x, 2 * far * across(random), 0);
    const auto nearest =
        std::min_element(hills.vertices.begin(), hills.vertices.end(), [&](const Vec3& p, const Vec3& q) {
          return (p - place).head<2>().squaredNorm() < (q - place).head<2>().squaredNorm();
        });
    place[2] = (*nearest)[2] + tall * height(random) - bounds.low[2] * 0.5;
    frames.push_back(frame_of(Pose{.position = place, .rotation = rotation}));
  }
  return frames;
}

void over_terrain(const Options& options, const char* scene, const TriangleMesh& bunny, std::mt19937_64& random) {
  if (!options.wants(scene, "any pair")) return;
  const TriangleMesh hills = scenes::terrain(512, 20, 7);
  const std::vector<Frame> frames = frames_over(hills, bunny, random);
  const Peers peers = all_peers(hills, bunny);
  std::vector<bool> expected;
  for (const Frame& frame : frames) expected.push_back(!by_force(hills, bunny, frame).empty());
  std::vector<Method> methods;
  for (const auto& peer : peers) {
    std::size_t right = 0;
    for (std::size_t k = 0; k < frames.size(); ++k) {
      peer->move(frames[k]);
      right += peer->any() == expected[k] ? 1 : 0;
    }
    methods.push_back({.name = peer->name(),
                       .run =
                           [&frames, p = peer.get()] {
                             for (const Frame& frame : frames) {
                               p->move(frame);
                               p->any();
                             }
                           },
                       .equal = right,
                       .of = frames.size()});
  }
  const auto touching = std::count(expected.begin(), expected.end(), true);
  measure(options,
          {scene, bunny.triangles.size(), "any pair", frames.size(), std::to_string(touching) + " poses touch"},
          methods);
}

}  // namespace
}  // namespace collided::bench

int main(int argc, char** argv) {
  using namespace collided::engine;
  using namespace collided;
  const bench::Options options = bench::read_options(argc, argv);
  std::mt19937_64 random = oracle::seeded(20260120);
  for (std::uint32_t around = 16; around <= (options.quick ? 64 : 256); around *= 2) {
    bench::two_spheres(options, around, "spheres deep", 0.5, random);
    bench::two_spheres(options, around, "spheres edge", 1.9, random);
  }
  bench::over_terrain(options, "ball on hills", scenes::icosphere(5, 0.5), random);
  const TriangleMesh bunny = bench::read_obj("/usr/share/glmark2/models/bunny.obj");
  if (!bunny.triangles.empty()) bench::over_terrain(options, "bunny on hills", bunny, random);
  return 0;
}
