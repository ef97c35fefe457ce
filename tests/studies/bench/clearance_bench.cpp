// The clearance of an arm of seven links to a cell of some 35,000 triangles, one configuration after the other, one thread;
// beside FCL's managers. The cell is one mesh, or 36; the configurations are free, and unrelated or along a path.

#include <cmath>
#include <cstdlib>
#include <random>

#include "server/intake/mesh/sphere_mesh.hpp"
#include "server/world/groups/what_if.hpp"
#include "server/world/world.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/studies/bench/peers/clearance_peers.hpp"
#include "tests/studies/bench/rows.hpp"

namespace collided::bench {
using namespace engine;
namespace {

constexpr std::size_t kLinks = 7;
constexpr unsigned kSide = 132;
constexpr double kLinkLength_m = 0.2;

/// A bowl with waves, some of its tiles in one mesh: those from (x, y) on, `side` of them each way.
TriangleMesh bowl(unsigned first_x, unsigned first_y, unsigned side) {
  TriangleMesh mesh;
  for (unsigned y = first_y; y <= first_y + side; ++y) {
    for (unsigned x = first_x; x <= first_x + side; ++x) {
      const double px = 4.0 * x / kSide - 2, py = 4.0 * y / kSide - 2;
      mesh.vertices.push_back({px, py, 0.3 * (px * px + py * py) + 0.05 * std::sin(9 * px) * std::cos(7 * py)});
    }
  }
  for (unsigned y = 0; y < side; ++y) {
    for (unsigned x = 0; x < side; ++x) {
      const unsigned v = y * (side + 1) + x;
      mesh.triangles.push_back({v, v + 1, v + side + 1});
      mesh.triangles.push_back({v + 1, v + side + 2, v + side + 1});
    }
  }
  return mesh;
}

std::vector<TriangleMesh> cell_of(unsigned tiles) {
  std::vector<TriangleMesh> cell;
  const unsigned side = kSide / tiles;
  for (unsigned y = 0; y < tiles; ++y) {
    for (unsigned x = 0; x < tiles; ++x) cell.push_back(bowl(x * side, y * side, side));
  }
  return cell;
}

/// A long ellipsoid of 1,000 triangles.
TriangleMesh link_mesh() {
  TriangleMesh mesh = latitude_longitude_sphere(1, 26, 20);
  for (Vec3& v : mesh.vertices) v = {0.05 * v.x(), 0.05 * v.y(), 0.5 * kLinkLength_m * v.z()};
  return mesh;
}

/// Poses of the links for joints that each turn the rest of the chain.
std::vector<Pose> arm_at(const std::vector<double>& joints) {
  std::vector<Pose> poses;
  Quat turn = Quat::Identity();
  Vec3 end(0, 0, 0.5);
  for (std::size_t i = 0; i < kLinks; ++i) {
    turn = (turn * Quat(Eigen::AngleAxisd(joints[i], i % 2 == 0 ? Vec3(Vec3::UnitZ()) : Vec3(Vec3::UnitY()))))
               .normalized();
    const Vec3 along = turn * Vec3(0, 0, kLinkLength_m);
    poses.push_back({.position = end + 0.5 * along, .rotation = turn});
    end += along;
  }
  return poses;
}

class Arm {
 public:
  Arm(const std::vector<TriangleMesh>& links, const std::vector<TriangleMesh>& cell) {
    WhatIfAsk ask;
    for (std::size_t i = 0; i < links.size(); ++i) ask.moved.push_back(add("link" + std::to_string(i), links[i], 1));
    for (std::size_t i = 0; i < cell.size(); ++i) ask.against.push_back(add("cell" + std::to_string(i), cell[i], 0));
    if (!world_.step(1, 1, {})) std::abort();
    what_if_.emplace(std::make_shared<const Snapshot>(*world_.newest()), ask, part_meshes_);
  }
  WhatIfAnswer at(const std::vector<Pose>& poses) { return what_if_->at(poses, never_); }

 private:
  ObjectId add(const std::string& name, const TriangleMesh& mesh, std::uint32_t group) {
    ObjectDefinition definition{.name = name, .scene = "", .shape = {}, .pose = {}, .filter = {.group = group}};
    definition.shape.mesh = std::make_shared<const TriangleMesh>(mesh);
    return std::get<ObjectId>(world_.define(definition));
  }

  World world_{WorldOptions{}};
  PartMeshes part_meshes_;
  Deadline never_;
  std::optional<WhatIf> what_if_;
};

using Arms = std::vector<std::vector<Pose>>;

/// Free configurations: unrelated ones, or each a hundredth of a radian from the one before.
Arms free_arms(Arm& arm, std::size_t count, bool is_path, std::mt19937_64& random) {
  std::uniform_real_distribution<double> any(-1.5, 1.5);
  std::uniform_real_distribution<double> little(-0.01, 0.01);
  Arms arms;
  std::vector<double> joints(kLinks, 0.1);
  while (arms.size() < count) {
    std::vector<double> next = joints;
    for (double& joint : next) joint = is_path ? joint + little(random) : any(random);
    std::vector<Pose> poses = arm_at(next);
    if (arm.at(poses).touches != Decision::no) continue;
    joints = next;
    arms.push_back(std::move(poses));
  }
  return arms;
}

void clearance(const Options& options, unsigned tiles, bool is_path, std::mt19937_64& random) {
  const char* scene = tiles == 1 ? "one mesh" : "36 meshes";
  const char* work = is_path ? "arm on a path" : "arm anywhere";
  if (!options.wants(scene, work)) return;
  const std::vector<TriangleMesh> links(kLinks, link_mesh());
  const std::vector<TriangleMesh> cell = cell_of(tiles);
  Arm ours(links, cell);
  const Arms arms = free_arms(ours, options.quick ? 50 : 500, is_path, random);
  std::vector<Method> methods{{.name = "collided", .run = [&] {
                                 for (const auto& poses : arms) ours.at(poses);
                               }}};
#ifdef COLLIDED_BENCH_FCL
  const std::unique_ptr<ClearancePeer> fcl = fcl_clearance_peer(links, cell);
  std::size_t equal = 0;
  for (const auto& poses : arms) {
    const ObjectClearance told = ours.at(poses).nearest->clearance;
    constexpr double kPeerError_m = 1e-6;
    equal += std::abs(fcl->distance_m(poses) - told.clearance_m) <= told.error_m + kPeerError_m ? 1 : 0;
  }
  methods.push_back({.name = fcl->name(),
                     .run =
                         [&] {
                           for (const auto& poses : arms) fcl->distance_m(poses);
                         },
                     .equal = equal,
                     .of = arms.size()});
#endif
  measure(options, {scene, 2 * kSide * kSide, work, arms.size(), "peers equal within 1e-6 m"}, methods);
}

}  // namespace
}  // namespace collided::bench

int main(int argc, char** argv) {
  using namespace collided;
  const bench::Options options = bench::read_options(argc, argv);
  std::mt19937_64 random = oracle::seeded(24);
  for (const unsigned tiles : {1u, 6u}) {
    bench::clearance(options, tiles, false, random);
    bench::clearance(options, tiles, true, random);
  }
}
