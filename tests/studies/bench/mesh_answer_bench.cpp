// Two meshes as a user asks of them, one thread: the distance with its nearest points, the report of a pair that touches
// (triangles, deepest contact, manifold), and a step in which one moves in the other; beside FCL and ODE in turn.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <random>

#include "server/intake/mesh/sphere_mesh.hpp"
#include "server/world/query/pair_report.hpp"
#include "server/world/world.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/studies/bench/peers/mesh_pair_peers.hpp"
#include "tests/studies/bench/rows.hpp"

namespace collided::bench {
using namespace engine;
namespace {

/// Two meshes in a world: the first rests, the second goes where it is told.
class TwoMeshes {
 public:
  TwoMeshes(const TriangleMesh& a, const TriangleMesh& b, const Pose& pose) {
    first_ = add("a", a, {}, 0);
    second_ = add("b", b, pose, 1);
    step();
  }
  PairReport report(bool triangles) const {
    return report_pair(*world_.newest(), first_, second_, {.triangles = triangles});
  }
  void move(const Pose& pose) {
    world_.move(second_, pose, time_ns_ + kPeriodNs, false);
    world_.advance(1, time_ns_ + kPeriodNs);
    step();
  }
  std::size_t contacts() const { return world_.contacts().size(); }

 private:
  static constexpr std::int64_t kPeriodNs = 10'000'000;

  ObjectId add(const std::string& name, const TriangleMesh& mesh, const Pose& pose, std::uint64_t publisher) {
    ObjectDefinition definition{.name = name, .scene = "", .shape = {}, .pose = pose, .filter = {}};
    definition.shape.mesh = std::make_shared<const TriangleMesh>(mesh);
    definition.publisher = publisher;
    return std::get<ObjectId>(world_.define(definition));
  }
  void step() {
    time_ns_ += kPeriodNs;
    if (!world_.step(time_ns_, 1, {})) std::abort();
  }

  World world_{WorldOptions{}};
  ObjectId first_ = 0;
  ObjectId second_ = 0;
  std::int64_t time_ns_ = 1'000'000'000'000;
};

using Peers = std::vector<std::unique_ptr<MeshPairPeer>>;

Peers all_peers([[maybe_unused]] const TriangleMesh& a, [[maybe_unused]] const TriangleMesh& b, const Pose& pose) {
  Peers peers;
#ifdef COLLIDED_BENCH_FCL
  peers.push_back(fcl_pair_peer(a, b));
#endif
#ifdef COLLIDED_BENCH_ODE
  peers.push_back(ode_pair_peer(a, b));
#endif
  for (const auto& peer : peers) peer->move(frame_of(pose));
  return peers;
}

Pose any_turn_at(const Vec3& position, std::mt19937_64& random) {
  std::normal_distribution<double> part;
  const double w = part(random), x = part(random), y = part(random);
  return {.position = position, .rotation = Quat(w, x, y, part(random)).normalized()};
}

std::size_t repeats_for(std::size_t triangles) { return std::max<std::size_t>(1, 20'000 / triangles); }

template <class Run>
std::function<void()> repeated(std::size_t repeats, Run run) {
  return [repeats, run] {
    for (std::size_t i = 0; i < repeats; ++i) run();
  };
}

void distance(const Options& options, const char* scene, const TriangleMesh& a, const TriangleMesh& b,
              const Pose& pose) {
  if (!options.wants(scene, "distance")) return;
  const TwoMeshes ours(a, b, pose);
  const std::size_t repeats = repeats_for(b.triangles.size());
  const Separation told = ours.report(false).separation;
  std::vector<Method> methods{{.name = "collided", .run = repeated(repeats, [&ours] { ours.report(false); })}};
  const Peers peers = all_peers(a, b, pose);
  for (const auto& peer : peers) {
    const std::optional<double> theirs = peer->distance_m();
    if (!theirs) continue;
    const bool is_equal = std::abs(*theirs - told.distance_m) <= told.error_m + 1e-9;
    methods.push_back({.name = peer->name(),
                       .run = repeated(repeats, [p = peer.get()] { p->distance_m(); }),
                       .equal = is_equal ? std::size_t{1} : 0,
                       .of = 1});
  }
  measure(options, {scene, b.triangles.size(), "distance", repeats, "peers equal within 1e-9 m"}, methods);
}

void contacts(const Options& options, const char* scene, const TriangleMesh& mesh, const Pose& pose) {
  TwoMeshes ours(mesh, mesh, pose);
  const Peers peers = all_peers(mesh, mesh, pose);
  const std::size_t repeats = repeats_for(mesh.triangles.size());
  std::vector<Method> with_contacts;
  for (const auto& peer : peers) {
    if (!peer->contacts()) continue;
    with_contacts.push_back({.name = peer->name(), .run = repeated(repeats, [p = peer.get()] { p->contacts(); })});
  }
  const auto measure_ours = [&](const char* work, const std::function<void()>& run) {
    if (!options.wants(scene, work)) return;
    std::vector<Method> methods{{.name = "collided", .run = repeated(repeats, run)}};
    methods.insert(methods.end(), with_contacts.begin(), with_contacts.end());
    const std::string note = std::to_string(ours.report(true).crossing_count) + " triangle pairs";
    measure(options, {scene, mesh.triangles.size(), work, repeats, note}, methods);
  };
  measure_ours("pair report", [&] { ours.report(true); });
  measure_ours("pair, no triangles", [&] { ours.report(false); });
  // There and back by so little that the same triangles meet.
  Pose moved = pose;
  moved.position += Vec3(1e-6, 0, 0);
  bool is_there = false;
  measure_ours("step with contacts", [&] {
    is_there = !is_there;
    ours.move(is_there ? moved : pose);
    if (ours.contacts() != 1) std::abort();
  });
}

struct SphereSize {
  unsigned longitudes;
  unsigned latitudes;
};
constexpr SphereSize kSizes[] = {{18, 8}, {64, 33}, {130, 64}, {258, 128}};  // 252 to 65,532 triangles
constexpr SphereSize kShell = {200, 180};                                    // 71,600

void run(const Options& options, std::mt19937_64& random) {
  for (const SphereSize& size : kSizes) {
    const TriangleMesh mesh = latitude_longitude_sphere(1, size.longitudes, size.latitudes);
    const Vec3 away = Vec3(0.48, 0.64, 0.6);
    const Pose apart = any_turn_at(2.5 * away, random);
    const Pose deep = any_turn_at(0.5 * away, random);
    const Pose edge = any_turn_at(1.9 * away, random);
    if (options.quick && mesh.triangles.size() > 5000) continue;
    distance(options, "apart", mesh, mesh, apart);
    contacts(options, "deep", mesh, deep);
    contacts(options, "edge", mesh, edge);
  }
  const Pose within = any_turn_at(Vec3(0.01, -0.02, 0.03), random);
  const Pose tight = any_turn_at(Vec3::Zero(), random);
  if (options.quick) return;
  const TriangleMesh shell = latitude_longitude_sphere(1, kShell.longitudes, kShell.latitudes);
  distance(options, "shells", shell, latitude_longitude_sphere(0.9, kShell.longitudes, kShell.latitudes), within);
  distance(options, "tight shells", shell, latitude_longitude_sphere(0.999, kShell.longitudes, kShell.latitudes),
           tight);
}

}  // namespace
}  // namespace collided::bench

int main(int argc, char** argv) {
  using namespace collided;
  const bench::Options options = bench::read_options(argc, argv);
  std::mt19937_64 random = oracle::seeded(20261124);
  bench::run(options, random);
  return 0;
}
