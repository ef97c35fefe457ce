// All intersecting triangle pairs of two tessellated spheres, and whether a placed bunny touches a terrain, one thread:
// ours, exact, beside peers in turn in one run. A ratio is the peer's time over ours, median and range of the repeats;
// above 1 we are faster. "pairs equal" is against the exact test of every pair.
//
// mesh_pair_bench [LARGEST]          spheres of 16 to LARGEST (256) meridians, bunny
// mesh_pair_bench AROUND APART       ours alone, for a profiler

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <random>

#include "server/broad_phase/bsp_tree.hpp"
#include "server/exact_phase/overlap.hpp"
#include "tests/bench/clock.hpp"
#include "tests/bench/mesh_pair_peers.hpp"
#include "tests/bench/obj.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::bench {
namespace {

constexpr int kRepeats = 7;
constexpr double kLeastSeconds = 4e-3;

/// Meridians and parallels: 2 * around * (around / 2) triangles.
TriangleMesh globe(std::uint32_t around) {
  const std::uint32_t rows = around / 2 + 1;
  TriangleMesh mesh;
  mesh.vertices.push_back(Vec3(0, 0, 1));
  for (std::uint32_t row = 1; row < rows; ++row) {
    const double polar = std::numbers::pi * row / rows;
    for (std::uint32_t i = 0; i < around; ++i) {
      const double angle = 2 * std::numbers::pi * i / around;
      mesh.vertices.push_back(Vec3(std::sin(polar) * std::cos(angle), std::sin(polar) * std::sin(angle), std::cos(polar)));
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

class Ours : public MeshPairPeer {
 public:
  Ours(const TriangleMesh& a, const TriangleMesh& b)
      : a_(a), b_(b), tree_a_(BspTree::build(a)), tree_b_(BspTree::build(b)) {
    for (const Vec3& vertex : b.vertices) reach_m_ = std::max(reach_m_, vertex.norm());
  }
  std::string name() const override { return "ours"; }
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

 protected:
  virtual void walk() {
    const double slack_m = 32 * 0x1p-53 * (frame_.position.lpNorm<1>() + 2 * reach_m_);
    yes_ = false;
    cost_ = {};
    above_filter_ = 0;
    placed_number_ = ~0u;
    const auto candidate = [](void* raw, std::uint32_t i, std::uint32_t j) { return static_cast<Ours*>(raw)->test(i, j); };
    tree_a_.walk_pairs(tree_b_, frame_.rotation, frame_.position, slack_m, candidate, this, cost_);
  }
  bool test(std::uint32_t i, std::uint32_t j) {
    if (j != placed_number_) {
      placed_ = place(frame_, b_.triangle(j));
      placed_number_ = j;
    }
    const Verdict verdict = overlaps(a_.triangle(i), placed_);
    above_filter_ += verdict.level != Level::filter;
    if (!verdict.yes()) return true;
    yes_ = true;
    if (out_ == nullptr) return false;
    out_->emplace_back(i, j);
    return true;
  }

  const TriangleMesh& a_;
  const TriangleMesh& b_;
  BspTree tree_a_;
  BspTree tree_b_;
  double reach_m_ = 0;
  Frame frame_;
  TrianglePairs* out_ = nullptr;
  bool yes_ = false;
  std::uint32_t placed_number_ = 0;
  Triangle placed_;
  std::size_t above_filter_ = 0;
  WalkCost cost_;
};

/// What a pair walk saves: each triangle of the placed mesh asks the other one's tree.
class OneByOne final : public Ours {
 public:
  using Ours::Ours;
  std::string name() const override { return "1by1"; }

 protected:
  void walk() override {
    yes_ = false;
    cost_ = {};
    const auto candidate = [](void* raw, std::uint32_t i) {
      OneByOne& self = *static_cast<OneByOne*>(raw);
      self.go_on_ = self.test(i, self.asking_);
      return self.go_on_;
    };
    go_on_ = true;
    for (asking_ = 0; asking_ < b_.triangles.size() && go_on_; ++asking_) {
      placed_ = place(frame_, b_.triangle(asking_));
      placed_number_ = asking_;
      tree_a_.walk_box(bounds_of(placed_), candidate, this, cost_);
    }
  }

 private:
  std::uint32_t asking_ = 0;
  bool go_on_ = true;
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
      if (collided::overlaps(part->bounds, bounds) && collided::overlaps(a.triangle(part->number), placed).yes()) {
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

double microseconds(const std::function<void()>& work) {
  int rounds = 0;
  const double start = thread_seconds();
  double spent = 0;
  do {
    work();
    ++rounds;
    spent = thread_seconds() - start;
  } while (spent < kLeastSeconds);
  return 1e6 * spent / rounds;
}

using Peers = std::vector<std::unique_ptr<MeshPairPeer>>;

Peers all_peers(const TriangleMesh& a, const TriangleMesh& b) {
  Peers peers;
  peers.push_back(std::make_unique<Ours>(a, b));
  peers.push_back(std::make_unique<OneByOne>(a, b));
#ifdef COLLIDED_PAIRS_FCL
  peers.push_back(fcl_pair_peer(a, b));
#endif
#ifdef COLLIDED_PAIRS_CGAL
  peers.push_back(cgal_pair_peer(a, b));
#endif
#ifdef COLLIDED_PAIRS_ODE
  peers.push_back(ode_pair_peer(a, b));
#endif
  return peers;
}

/// times[peer][repeat], in turn.
std::vector<std::vector<double>> measured(const Peers& peers, const std::function<void(MeshPairPeer&)>& work) {
  std::vector<std::vector<double>> times(peers.size());
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    for (std::size_t i = 0; i < peers.size(); ++i) times[i].push_back(microseconds([&] { work(*peers[i]); }));
  }
  return times;
}

struct Spread {
  double low, median, high;
};

Spread spread_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return {values.front(), values[values.size() / 2], values.back()};
}

void print_times(const std::string& name, const std::vector<double>& times, const std::vector<double>& ours) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < times.size(); ++i) ratios.push_back(times[i] / ours[i]);
  const Spread time = spread_of(times);
  const Spread ratio = spread_of(ratios);
  std::printf("  %-5s %10.1f us [%.1f, %.1f], ratio %6.2f [%.2f, %.2f]", name.c_str(), time.median, time.low, time.high,
              ratio.median, ratio.low, ratio.high);
}

void two_spheres(std::uint32_t around, double apart, std::mt19937_64& random) {
  const TriangleMesh mesh = globe(around);
  std::normal_distribution<double> part;
  const double w = part(random), x = part(random), y = part(random);
  const Quat rotation = Quat(w, x, y, part(random)).normalized();
  const Frame frame = frame_of(Pose{.position = apart * Vec3(0.48, 0.64, 0.6), .rotation = rotation});
  const TrianglePairs expected = by_force(mesh, mesh, frame);
  const Peers peers = all_peers(mesh, mesh);
  TrianglePairs pairs;
  for (const auto& peer : peers) peer->move(frame);
  const auto times = measured(peers, [&](MeshPairPeer& peer) {
    pairs.clear();
    peer.all_pairs(pairs);
  });
  std::printf("two spheres of %zu triangles, centres %.2f apart: %zu pairs\n", mesh.triangles.size(), apart, expected.size());
  for (std::size_t i = 0; i < peers.size(); ++i) {
    pairs.clear();
    peers[i]->all_pairs(pairs);
    make_unique(pairs);
    TrianglePairs common;
    std::set_intersection(pairs.begin(), pairs.end(), expected.begin(), expected.end(), std::back_inserter(common));
    print_times(peers[i]->name(), times[i], times[0]);
    std::printf(", pairs equal %zu of %zu, %zu wrong\n", common.size(), expected.size(), pairs.size() - common.size());
  }
  const Ours& ours = static_cast<const Ours&>(*peers[0]);
  std::printf("        %u nodes, %u candidates, %zu above the filter\n", ours.cost().nodes, ours.cost().candidates,
              ours.above_filter());
}

/// Poses at which the bunny just touches the terrain, or just not, or stands in it.
void bunny_over_terrain(const char* name, const TriangleMesh& bunny, const TriangleMesh& hills, std::mt19937_64& random) {
  std::uniform_real_distribution<double> across(-0.4, 0.4), height(-0.2, 0.8), turn(0, 2 * std::numbers::pi);
  const Peers peers = all_peers(hills, bunny);
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
    const auto nearest = std::min_element(hills.vertices.begin(), hills.vertices.end(), [&](const Vec3& p, const Vec3& q) {
      return (p - place).head<2>().squaredNorm() < (q - place).head<2>().squaredNorm();
    });
    place[2] = (*nearest)[2] + tall * height(random) - bounds.low[2] * 0.5;
    frames.push_back(frame_of(Pose{.position = place, .rotation = rotation}));
  }
  std::vector<bool> expected;
  for (const Frame& frame : frames) expected.push_back(!by_force(hills, bunny, frame).empty());
  std::vector<std::vector<double>> sums(peers.size(), std::vector<double>(kRepeats, 0));
  std::vector<std::size_t> right(peers.size(), 0);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    for (const auto& peer : peers) peer->move(frames[k]);
    bool answer = false;
    const auto times = measured(peers, [&](MeshPairPeer& peer) { answer = peer.any(); });
    for (std::size_t i = 0; i < peers.size(); ++i) {
      for (int repeat = 0; repeat < kRepeats; ++repeat) sums[i][static_cast<std::size_t>(repeat)] += times[i][static_cast<std::size_t>(repeat)] / 24;
      right[i] += peers[i]->any() == expected[k] ? 1 : 0;
    }
  }
  std::printf("%s: %zu triangles on a terrain of %zu, any, mean of %zu poses, %ld of them touching\n", name,
              bunny.triangles.size(), hills.triangles.size(), frames.size(),
              static_cast<long>(std::count(expected.begin(), expected.end(), true)));
  for (std::size_t i = 0; i < peers.size(); ++i) {
    print_times(peers[i]->name(), sums[i], sums[0]);
    std::printf(", answers equal %zu of %zu\n", right[i], frames.size());
  }
}

void ours_alone(std::uint32_t around, double apart) {
  const TriangleMesh mesh = globe(around);
  Ours ours(mesh, mesh);
  ours.move(frame_of(Pose{.position = apart * Vec3(0.48, 0.64, 0.6), .rotation = Quat(0.8, 0.1, 0.5, 0.3).normalized()}));
  TrianglePairs pairs;
  const double start = thread_seconds();
  int rounds = 0;
  for (; thread_seconds() - start < 2; ++rounds) {
    pairs.clear();
    ours.all_pairs(pairs);
  }
  std::printf("%.1f us, %zu pairs, %u nodes, %u candidates\n", 2e6 / rounds, pairs.size(), ours.cost().nodes,
              ours.cost().candidates);
}

/// The exact test alone, on the pairs that the walk offers and on those whose bounds merely overlap.
void exact_test_alone(std::mt19937_64& random) {
  std::uniform_real_distribution<double> at(-1, 1);
  const auto corner = [&](double size) {
    const double x = at(random), y = at(random);
    return Vec3(size * Vec3(x, y, at(random)));
  };
  std::vector<std::pair<Triangle, Triangle>> crossing, parted;
  while (crossing.size() < 2000 || parted.size() < 2000) {
    const Triangle a{corner(1), corner(1), corner(1)};
    const Triangle b{corner(1), corner(1), corner(1)};
    if (!collided::overlaps(bounds_of(a), bounds_of(b))) continue;
    auto& kind = collided::overlaps(a, b).yes() ? crossing : parted;
    if (kind.size() < 2000) kind.emplace_back(a, b);
  }
  for (const auto& [name, pairs] : {std::pair("crossing", &crossing), std::pair("parted, bounds overlapping", &parted)}) {
    std::size_t yes = 0;
    std::vector<double> times;
    for (int repeat = 0; repeat < kRepeats; ++repeat) {
      times.push_back(microseconds([&] {
        for (const auto& [a, b] : *pairs) yes += collided::overlaps(a, b).yes();
      }));
    }
    const Spread time = spread_of(times);
    std::printf("exact triangle pair, %s: %.1f ns [%.1f, %.1f]%s\n", name, time.median / 2, time.low / 2, time.high / 2,
                yes == 1 ? " " : "");
  }
}

}  // namespace
}  // namespace collided::bench

int main(int argc, char** argv) {
  using namespace collided;
  std::mt19937_64 random = oracle::seeded(20260120);
  const unsigned long largest = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 256;
  if (argc > 2) return bench::ours_alone(static_cast<std::uint32_t>(largest), std::strtod(argv[2], nullptr)), 0;
  bench::exact_test_alone(random);
  for (std::uint32_t around = 16; around <= largest; around *= 2) {
    for (const double apart : {0.5, 1.9}) bench::two_spheres(around, apart, random);
  }
  const TriangleMesh bunny = bench::read_obj("/usr/share/glmark2/models/bunny.obj");
  const TriangleMesh hills = scenes::terrain(512, 20, 7);
  bench::bunny_over_terrain("icosphere", scenes::icosphere(5, 0.5), hills, random);
  if (!bunny.triangles.empty()) bench::bunny_over_terrain("bunny", bunny, hills, random);
  return 0;
}
