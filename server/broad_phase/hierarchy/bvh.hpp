#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "server/geometry/aabb.hpp"
#include "server/geometry/function_ref.hpp"
#include "server/geometry/mesh.hpp"
#include "server/geometry/ray.hpp"

namespace collided::engine {

/// What a walk touched; added to, never reset.
struct WalkCost {
  std::uint32_t nodes = 0;
  std::uint32_t candidates = 0;
};

/// How much care a build takes. best: large slanted triangles enter as several boxes where that pays, for at most 1.25
/// references a triangle.
enum class BvhForm { fast, best };

struct BvhReport {
  static constexpr int kChildren = 8;       // of a node, at most
  static constexpr int kLeafTriangles = 8;  // at most

  std::uint32_t depth = 0;
  std::uint32_t nodes = 0;
  std::uint32_t leaves = 0;
  std::uint64_t references = 0;  // triangle references in leaves; more than triangles where splits clipped
  std::uint64_t bytes = 0;
  std::uint64_t peak_bytes = 0;  // that the build had in use at once, the tree included
  double build_s = 0;            // or, for a loaded tree, of its check
  bool is_loaded = false;
  std::uint32_t split_triangles = 0;  // that clipped splits hold in several leaves
};

struct BvhOptions {
  unsigned threads = 0;                          // 0: one a core
  std::function<void(double)> progress;          // fraction done in [0, 1], from a building thread
  std::function<bool()> cancelled;               // asked now and then; true ends the build with an empty tree
  BvhForm form = BvhForm::fast;
};

/// Why bytes are not the tree of a mesh, as the end of a sentence.
struct BvhRefusal {
  std::string reason;
};

/// Axis-aligned space partition of static triangles: says which triangles a question may meet. Generous, never
/// misses: for every triangle that meets the asked set the walk calls back, or has been told to stop before.
/// A triangle may be called twice (a clipped split holds it in two leaves).
/// Immutable after build; any number of threads may walk it.
class Bvh {
 public:
  Bvh();
  ~Bvh();
  Bvh(Bvh&&) noexcept;
  Bvh& operator=(Bvh&&) noexcept;

  static Bvh build(const TriangleMesh& mesh, const BvhOptions& options = {});

  /// The tree as bytes for load, on this kind of machine; bound to the mesh. Empty for an empty tree.
  std::vector<std::byte> saved(const TriangleMesh& mesh) const;
  /// A saved tree, used where its bytes lie when they are aligned to 64 and keeper keeps them, else copied. The bytes
  /// may come from anybody: what is returned answers as a built tree does, and what does not is refused.
  /// cost      a pass over the mesh and the bytes on that many threads (0: one a core); a quarter of a build
  static std::variant<Bvh, BvhRefusal> load(const TriangleMesh& mesh, std::span<const std::byte> bytes,
                                                std::shared_ptr<const void> keeper, unsigned threads = 0);

  const BvhReport& report() const;
  /// Contains every vertex exactly.
  const Aabb& bounds() const;

  /// Called with a candidate; returns the limit from then on (s along the ray, see walk_ray).
  using RayCandidate = FunctionRef<double(std::uint32_t triangle, double limit)>;
  /// Near to far along the ray. limit: only s in [0, limit] matters, in units of the direction's length; a negative
  /// returned limit ends the walk. slack_m widens every bound (0 for static meshes; the pose's rounding otherwise).
  void walk_ray(const Ray& ray, double limit, double slack_m, RayCandidate candidate, WalkCost& cost) const;

  /// The same with the candidate's corners, equal to the mesh's. Where the tree holds them itself this saves the
  /// way to the mesh, the dearest part of a ray in a large scene.
  using RayTriangle = FunctionRef<double(std::uint32_t triangle, const Triangle& corners, double limit)>;
  void walk_ray(const Ray& ray, double limit, double slack_m, const TriangleMesh& mesh, RayTriangle candidate,
                WalkCost& cost) const;

  /// The same for who takes every triangle that the ray meets and wants the nearest: told are those that no surely met
  /// nearer one rules out, seldom more than one.
  void walk_ray_nearest(const Ray& ray, double limit, const TriangleMesh& mesh, RayTriangle candidate,
                        WalkCost& cost) const;

  static constexpr std::uint32_t kNoTriangle = 0xffffffffu;
  /// A triangle that the ray meets with s in [0, limit], or kNoTriangle. Candidates are told only where floats leave
  /// doubt; a negative returned limit says that the ray meets it. The limit must be that of the ray to 2^-40, infinite
  /// for an endless ray only.
  std::uint32_t meet_ray(const Ray& ray, double limit, const TriangleMesh& mesh, RayTriangle candidate,
                         WalkCost& cost) const;

  /// What a batch of rays wants: every candidate as walk_ray tells them, or as walk_ray_nearest, or as meet_ray.
  enum class RayGoal { every, nearest, any };

  /// Who hears of the candidates of a task that names nobody.
  static double tell_nobody(std::uint32_t, const Triangle&, double limit) { return limit; }

  /// One ray of a batch: as the arguments of walk_ray. The ray and who hears of its candidates must live as long as the
  /// walk.
  struct RayTask {
    const Ray* ray = nullptr;
    double limit = 0;
    RayTriangle candidate = tell_nobody;
    WalkCost* cost = nullptr;
    std::uint32_t met = kNoTriangle;  // written for RayGoal::any
  };
  /// Many rays, some of them walked in turn, so that one works while the others wait for memory: for rays of no common
  /// direction through large scenes. Each ray hears of the same candidates in the same order as alone.
  void walk_rays(std::span<RayTask> tasks, const TriangleMesh& mesh, RayGoal goal) const;

  /// Called with a candidate; false ends the walk.
  using BoxCandidate = FunctionRef<bool(std::uint32_t triangle)>;
  /// Triangles whose bounds overlap the asked box, touching included.
  void walk_box(const Aabb& asked, BoxCandidate candidate, WalkCost& cost) const;

  /// Called with a candidate; returns the limit from then on, the square of a distance.
  using NearCandidate = FunctionRef<double(std::uint32_t triangle, double limit_m2)>;
  /// Triangles that may lie within sqrt(limit_m2) of the point, roughly near to far.
  void walk_near(const Vec3& point, double limit_m2, double slack_m, NearCandidate candidate, WalkCost& cost) const;

  /// Called with a candidate pair; false ends the walk.
  using PairCandidate = FunctionRef<bool(std::uint32_t triangle, std::uint32_t other_triangle)>;
  /// Pairs of this tree's triangles and the other's that may meet, where the other's point p lies at
  /// rotation * p + position here, off by at most slack_m on each axis. Both trees are descended at once. rotation is
  /// orthonormal to within rounding; any other keeps the promise but not the speed.
  void walk_pairs(const Bvh& other, const Mat3& rotation, const Vec3& position, double slack_m,
                  PairCandidate candidate, WalkCost& cost) const;

 private:
  void pair_all(const Bvh& other, const Mat3& rotation, const Vec3& position, double slack_m,
                PairCandidate candidate, WalkCost& cost) const;

  struct Storage;
  std::unique_ptr<Storage> storage_;
};

}  // namespace collided::engine
