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

/// Cost of a walk: nodes or grid rows, and candidates. Walks add to it and never reset it.
struct WalkCost {
  std::uint32_t nodes = 0;
  std::uint32_t candidates = 0;
};

/// How much effort a build spends. best: large slanted triangles enter as several boxes if that pays, at up to 1.25
/// references per triangle.
enum class BvhForm { fast, best };

/// Size and shape of a built or loaded tree.
struct BvhReport {
  static constexpr int kChildren = 8;       // most children of a node
  static constexpr int kLeafTriangles = 8;  // most triangles of a leaf

  std::uint32_t depth = 0;
  std::uint32_t nodes = 0;
  std::uint32_t leaves = 0;
  std::uint64_t references = 0;  // triangle references in leaves; exceeds triangles if splits clipped
  std::uint64_t bytes = 0;
  std::uint64_t peak_bytes = 0;  // largest memory use of the build at one time, the tree included
  double build_s = 0;            // seconds; of the check for a loaded tree
  bool is_loaded = false;
  std::uint32_t split_triangles = 0;  // held in several leaves by clipped splits
};

struct BvhOptions {
  unsigned threads = 0;                  // 0: one per core
  std::function<void(double)> progress;  // fraction done in [0, 1], from a building thread
  std::function<bool()> cancelled;       // checked now and then; true ends the build with an empty tree
  BvhForm form = BvhForm::fast;
};

/// Why bytes are not the tree of a mesh, worded as the end of a sentence.
struct BvhRefusal {
  std::string reason;
};

/// Bounding volume hierarchy over static triangles: offers the triangles that a query may meet. Generous, never misses:
/// every triangle that meets the query becomes a candidate, unless a callback has ended the walk before.
/// A triangle may be offered twice (a clipped split holds it in two leaves).
/// threads  immutable after build; any number may walk it
class Bvh {
 public:
  Bvh();
  ~Bvh();
  Bvh(Bvh&&) noexcept;
  Bvh& operator=(Bvh&&) noexcept;

  /// cost  a full build; see BvhOptions::threads
  static Bvh build(const TriangleMesh& mesh, const BvhOptions& options = {});

  /// The tree as bytes for load(), on this kind of machine; valid only with this mesh. Empty for an empty tree.
  std::vector<std::byte> saved(const TriangleMesh& mesh) const;
  /// A saved tree. Its bytes are used in place if they are aligned to 64 and `keeper` keeps them alive, else copied.
  /// The bytes may come from an untrusted source: the result answers like a built tree, and anything else is refused.
  /// cost      a pass over the mesh and the bytes on that many threads (0: one per core); a quarter of a build
  static std::variant<Bvh, BvhRefusal> load(const TriangleMesh& mesh, std::span<const std::byte> bytes,
                                            std::shared_ptr<const void> keeper, unsigned threads = 0);

  const BvhReport& report() const;
  /// Contains every vertex, exactly.
  const Aabb& bounds() const;

  /// Receives a candidate; returns the new limit (s along the ray, see walk_ray).
  using RayCandidate = FunctionRef<double(std::uint32_t triangle, double limit)>;
  /// Offers candidates near to far along the ray.
  ///
  /// limit    only s in [0, limit] counts, in units of the direction's length; a negative returned limit ends the walk
  /// slack_m  widens every bound (0 for static meshes; otherwise the rounding of the pose)
  void walk_ray(const Ray& ray, double limit, double slack_m, RayCandidate candidate, WalkCost& cost) const;

  /// Passes the candidate's corners too, equal to the mesh's. If the tree holds them itself, this saves access to the
  /// mesh, the most expensive part of a ray in a large scene.
  using RayTriangle = FunctionRef<double(std::uint32_t triangle, const Triangle& corners, double limit)>;
  void walk_ray(const Ray& ray, double limit, double slack_m, const TriangleMesh& mesh, RayTriangle candidate,
                WalkCost& cost) const;

  /// For a caller that accepts every triangle the ray meets and needs the nearest: leaves out those that a certain
  /// nearer hit rules out, so seldom more than one remains.
  void walk_ray_nearest(const Ray& ray, double limit, const TriangleMesh& mesh, RayTriangle candidate,
                        WalkCost& cost) const;

  static constexpr std::uint32_t kNoTriangle = 0xffffffffu;
  /// A triangle that the ray meets with s in [0, limit], or kNoTriangle. Calls `candidate` only if floats are
  /// uncertain; a negative returned limit confirms that the ray meets it. The limit must equal that of the ray to
  /// within 2^-40, and be infinite only for an endless ray.
  ///
  /// corners  of the triangle returned, equal to the mesh's
  std::uint32_t meet_ray(const Ray& ray, double limit, const TriangleMesh& mesh, RayTriangle candidate, WalkCost& cost,
                         Triangle& corners) const;

  /// The goal of a batch of rays: every candidate as in walk_ray, the nearest as in walk_ray_nearest, or any as in
  /// meet_ray.
  enum class RayGoal { every, nearest, any };

  /// The default callback of a task: ignores its candidates.
  static double tell_nobody(std::uint32_t, const Triangle&, double limit) { return limit; }

  /// One ray of a batch, with the arguments of walk_ray. The ray and the callback must outlive the walk.
  struct RayTask {
    const Ray* ray = nullptr;
    double limit = 0;
    RayTriangle candidate = tell_nobody;
    WalkCost* cost = nullptr;
    std::uint32_t met = kNoTriangle;  // met and corners are written for RayGoal::any
    Triangle corners = {};            // of that triangle
  };
  /// Walks many rays, some of them in turn, so that one works while others wait for memory: for unrelated rays through
  /// large scenes. Each ray gets the same candidates in the same order as alone.
  void walk_rays(std::span<RayTask> tasks, const TriangleMesh& mesh, RayGoal goal) const;

  /// Receives a candidate; returns false to end the walk.
  using BoxCandidate = FunctionRef<bool(std::uint32_t triangle)>;
  /// Offers the triangles whose bounds overlap the queried box, touching included.
  void walk_box(const Aabb& asked, BoxCandidate candidate, WalkCost& cost) const;

  /// Receives a candidate; returns the new limit, a squared distance.
  using NearCandidate = FunctionRef<double(std::uint32_t triangle, double limit_m2)>;
  /// Offers the triangles that may lie within sqrt(limit_m2) of the point, roughly near to far.
  void walk_near(const Vec3& point, double limit_m2, double slack_m, NearCandidate candidate, WalkCost& cost) const;

  /// Receives a candidate pair; returns false to end the walk.
  using PairCandidate = FunctionRef<bool(std::uint32_t triangle, std::uint32_t other_triangle)>;
  /// Visits pairs of a triangle of this tree and one of the other that may meet, with the other's point p at rotation *
  /// p + position here, off by at most slack_m on each axis. Descends both trees at once. rotation should be
  /// orthonormal up to rounding; with any other nothing is missed, but the walk is slow.
  void walk_pairs(const Bvh& other, const Mat3& rotation, const Vec3& position, double slack_m, PairCandidate candidate,
                  WalkCost& cost) const;
  /// Checked now and then between candidates; true ends the walk.
  using Interrupt = FunctionRef<bool()>;
  /// Can be interrupted: a long walk of close surfaces may pass without a candidate.
  void walk_pairs(const Bvh& other, const Mat3& rotation, const Vec3& position, double slack_m, PairCandidate candidate,
                  Interrupt is_over, WalkCost& cost) const;

  /// Receives a candidate pair; returns the new limit, metres; a negative one ends the walk.
  using NearPairCandidate = FunctionRef<double(std::uint32_t triangle, std::uint32_t other_triangle, double limit_m)>;
  /// Offers pairs of a triangle of this tree and one of the other, placed as for walk_pairs, that may lie within
  /// limit_m of each other, roughly near to far.
  void walk_near_pairs(const Bvh& other, const Mat3& rotation, const Vec3& position, double slack_m, double limit_m,
                       NearPairCandidate candidate, Interrupt is_over, WalkCost& cost) const;

 private:
  void pair_all(const Bvh& other, const Mat3& rotation, const Vec3& position, double slack_m, PairCandidate candidate,
                WalkCost& cost) const;

  struct Storage;
  std::unique_ptr<Storage> storage_;
};

}  // namespace collided::engine
