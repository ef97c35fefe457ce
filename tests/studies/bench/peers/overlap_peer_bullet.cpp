#include "tests/studies/bench/clock.hpp"
#include "tests/studies/bench/peers/bullet_mesh.hpp"
#include "tests/studies/bench/peers/overlap_peers.hpp"
#include "tests/studies/bench/plain_triangle.hpp"

namespace collided::bench {
using namespace engine;
namespace {

using Own3 = Three<btScalar>;

Own3 own(const btVector3& v) { return {v.x(), v.y(), v.z()}; }
template <class Test>
struct Visit final : btTriangleCallback {
  Test test;
  long count = 0;
  explicit Visit(Test wanted) : test(wanted) {}
  void processTriangle(btVector3* triangle, int, int) override {
    if (test(own(triangle[0]), own(triangle[1]), own(triangle[2]))) ++count;
  }
};

/// Its quantised tree of triangles; the walk has no early end.
class Bullet final : public OverlapPeer {
 public:
  explicit Bullet(const TriangleMesh& mesh) {
    const double start = thread_seconds();
    mesh_ = std::make_unique<BulletMesh>(mesh);
    build_s = thread_seconds() - start;
  }
  std::string name() const override { return "Bullet"; }

  long sphere(const Vec3& center, double radius_m, bool any) override {
    const auto radius = static_cast<btScalar>(radius_m);
    const Own3 at = own(bullet(center));
    return walk(center, Vec3::Constant(radius_m), any, [at, radius](const Own3& a, const Own3& b, const Own3& c) {
      return squared_distance(at, a, b, c) <= radius * radius;
    });
  }
  long box(const Vec3& center, const Vec3& half_m, bool any) override {
    const Own3 at = own(bullet(center));
    const Own3 half = own(bullet(half_m));
    return walk(center, half_m, any,
                [at, half](const Own3& a, const Own3& b, const Own3& c) { return box_meets(at, half, a, b, c); });
  }

 private:
  template <class Test>
  long walk(const Vec3& center, const Vec3& half_m, bool any, Test test) {
    Visit<Test> visit(test);
    mesh_->shape->processAllTriangles(&visit, bullet(center - half_m), bullet(center + half_m));
    return any ? std::min(visit.count, 1L) : visit.count;
  }

  std::unique_ptr<BulletMesh> mesh_;
};

}  // namespace

std::unique_ptr<OverlapPeer> bullet_peer(const TriangleMesh& mesh) { return std::make_unique<Bullet>(mesh); }

}  // namespace collided::bench
