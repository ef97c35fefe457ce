// Whether a closed mesh holds a point, as a whole answer to `inside` and by the test alone, one thread; beside CGAL.
// Points anywhere in the mesh's bounds, and on its corners, edges and faces, where only exact tests agree. And what else a
// solid's tree tells: segments, convex bodies, the order of its faces from an eye.

#include <cstdlib>
#include <functional>
#include <random>

#include "server/exact_phase/solid/face_order.hpp"
#include "server/exact_phase/solid/solid_polytope.hpp"
#include "server/exact_phase/solid/solid_segment.hpp"
#include "server/exact_phase/solid/winding_tree.hpp"
#include "server/world/objects/indexed_mesh.hpp"
#include "server/world/query/query.hpp"
#include "server/world/solids/solid.hpp"
#include "server/world/world.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/scenes/planted.hpp"
#include "tests/studies/bench/peers/solid_peers.hpp"
#include "tests/studies/bench/rows.hpp"

namespace collided::bench {
using namespace engine;
namespace {

/// A world with one solid at rest in its own frame.
class SolidWorld {
 public:
  explicit SolidWorld(const TriangleMesh& mesh) {
    ObjectDefinition definition{.name = "solid", .scene = "", .shape = {}, .pose = {}, .filter = {}};
    definition.shape.mesh = std::make_shared<const TriangleMesh>(mesh);
    definition.indexed =
        indexed_mesh(definition.shape.mesh, Bvh::build(mesh, {.threads = 1, .progress = {}, .cancelled = {}}));
    SolidFindings findings;
    definition.solid = solid_ = solid_within(definition.indexed, findings);
    if (!solid_ || !std::holds_alternative<ObjectId>(world_.define(definition))) std::abort();
    world_.step(1, 1, {});
    lease_ = world_.newest();
  }
  SolidSide side(const Vec3& point) const {
    WalkCost cost;
    return side_of(*solid_, point, cost).side;
  }
  /// Answers all at once; returns how many are hits.
  std::size_t ask(const std::vector<double>& numbers, HitMode mode) {
    answer(*lease_, {.kind = QuestionKind::inside, .mode = mode, .numbers = numbers}, answers_, scratch_);
    return answers_.hits.size();
  }
  /// With its faces; the one that answers keeps none.
  SolidTree tree_with_faces() const {
    const auto is_inside = [&](const Vec3& point) {
      WalkCost cost;
      return side_by_ray(*solid_->surface, point, cost).side == SolidSide::in;
    };
    return *SolidTree::build(solid_->surface->mesh, is_inside, {.cancelled = {}, .keeps_faces = true});
  }
  std::string structure() const { return solid_->tree ? "by its BSP" : "by a ray"; }

 private:
  World world_{WorldOptions{}};
  std::shared_ptr<const SolidMesh> solid_;
  SnapshotRing::Lease lease_;
  Answers answers_;
  QueryScratch scratch_;
};

std::vector<Vec3> points_in_bounds(std::size_t count, std::mt19937_64& random) {
  std::uniform_real_distribution<double> any(-1.1, 1.1);
  std::vector<Vec3> points;
  while (points.size() < count) points.push_back({any(random), any(random), any(random)});
  return points;
}

/// On corners, in the middle of edges and in triangles, as near as doubles are.
std::vector<Vec3> points_on_surface(const TriangleMesh& mesh, std::size_t count, std::mt19937_64& random) {
  std::uniform_int_distribution<std::uint32_t> any(0, static_cast<std::uint32_t>(mesh.triangles.size() - 1));
  std::vector<Vec3> points;
  while (points.size() < count) {
    const Triangle t = mesh.triangle(any(random));
    points.push_back(t.a);
    points.push_back((t.a + t.b) / 2);
    points.push_back((t.a + t.b + t.c) / 3);
  }
  points.resize(count);
  return points;
}

void solid(const Options& options, int levels, bool on_surface, std::mt19937_64& random) {
  const std::string scene = "stone " + std::to_string(levels);
  const char* work = on_surface ? "inside, on the surface" : "inside, anywhere";
  if (!options.wants(scene, work)) return;
  const TriangleMesh mesh = scenes::rough_sphere(levels, random);
  SolidWorld ours(mesh);
  const std::size_t count = options.quick ? 2'000 : 20'000;
  const std::vector<Vec3> points =
      on_surface ? points_on_surface(mesh, count, random) : points_in_bounds(count, random);
  std::vector<double> numbers;
  for (const Vec3& p : points) numbers.insert(numbers.end(), {p.x(), p.y(), p.z()});
  std::vector<Method> methods{{.name = "collided, yes or no", .run = [&] { ours.ask(numbers, HitMode::any); }},
                              {.name = "collided, with depth", .run = [&] { ours.ask(numbers, HitMode::closest); }},
                              {.name = "collided, test alone", .run = [&] {
                                 for (const Vec3& p : points) ours.side(p);
                               }}};
#ifdef COLLIDED_BENCH_CGAL
  const std::unique_ptr<SolidPeer> cgal = cgal_solid_peer(mesh);
  std::size_t equal = 0;
  for (const Vec3& p : points) equal += cgal->side(p) == ours.side(p) ? 1 : 0;
  methods.push_back({.name = cgal->name(),
                     .run =
                         [&] {
                           for (const Vec3& p : points) cgal->side(p);
                         },
                     .equal = equal,
                     .of = points.size()});
#endif
  measure(options, {scene, mesh.triangles.size(), work, count, ours.structure()}, methods);
}

/// The same stone with a hole, so that only its winding number says what lies in it: the test alone, and making the tree.
void winding(const Options& options, int levels, std::mt19937_64& random) {
  const std::string scene = "stone " + std::to_string(levels) + " with a hole";
  if (!options.wants(scene, "winding")) return;
  TriangleMesh mesh = scenes::rough_sphere(levels, random);
  mesh.triangles.pop_back();
  const WindingTree tree(mesh);
  const std::size_t count = options.quick ? 200 : 2'000;
  const auto whole = [&](const char* work, std::size_t items, const std::function<void()>& run) {
    std::vector<Method> methods{{.name = "collided", .run = run}};
    measure(options, {scene, mesh.triangles.size(), work, items, "by winding number"}, methods);
  };
  const auto sides = [&](const std::vector<Vec3>& points) {
    std::uint32_t nodes = 0;
    for (const Vec3& p : points) tree.side(p, 0, nodes);
    if (nodes == 0) std::abort();
  };
  const std::vector<Vec3> anywhere = points_in_bounds(count, random);
  whole("winding, anywhere", count, [&] { sides(anywhere); });
  std::vector<Vec3> beside = points_on_surface(mesh, count, random);
  for (Vec3& p : beside) p *= 1 + 1e-6;
  whole("winding, 1e-6 beside it", count, [&] { sides(beside); });
  whole("winding, making the tree", mesh.triangles.size(), [&] { WindingTree{mesh}; });
}

/// What the tree tells of more than points, in exact numbers.
void tree(const Options& options, int levels, std::mt19937_64& random) {
  const std::string scene = "stone " + std::to_string(levels);
  if (!options.wants(scene, "tree")) return;
  const TriangleMesh mesh = scenes::rough_sphere(levels, random);
  const SolidTree with_faces = SolidWorld(mesh).tree_with_faces();
  const std::size_t count = options.quick ? 40 : 400;
  const std::vector<Vec3> points = points_in_bounds(2 * count, random);
  const auto whole = [&](const char* work, std::size_t items, const std::function<void()>& run) {
    std::vector<Method> methods{{.name = "collided", .run = run}};
    measure(options, {scene, mesh.triangles.size(), work, items, "by its BSP"}, methods);
  };
  whole("tree, segments", count, [&] {
    for (std::size_t i = 0; i < count; ++i) segment_parts(with_faces, points[2 * i], points[2 * i + 1]);
  });
  for (const double half_m : {0.02, 0.2}) {
    const std::string work = "tree, boxes of " + std::to_string(half_m).substr(0, 4) + " m";
    whole(work.c_str(), count, [&] {
      for (std::size_t i = 0; i < count; ++i) polytope_side(with_faces, scenes::box(Vec3::Constant(half_m), points[i]));
    });
  }
  whole("tree, all faces from an eye", with_faces.report().fragments, [&] {
    std::uint64_t corners = 0;
    show_front_to_back(with_faces, points[0], [&](const SolidFace& face) {
      corners += face.outline.size();
      return true;
    });
    if (corners == 0) std::abort();
  });
}

}  // namespace
}  // namespace collided::bench

int main(int argc, char** argv) {
  using namespace collided;
  const bench::Options options = bench::read_options(argc, argv);
  std::mt19937_64 random = oracle::seeded(25);
  for (const int levels : {3, 5, 6}) {
    bench::solid(options, levels, false, random);
    bench::solid(options, levels, true, random);
  }
  for (const int levels : {3, 5}) bench::tree(options, levels, random);
  for (const int levels : {3, 5, 6}) bench::winding(options, levels, random);
}
