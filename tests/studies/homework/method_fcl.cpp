#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/narrowphase/collision.h>

#include <algorithm>
#include <limits>

#include "tests/studies/bench/peers/fcl_mesh.hpp"
#include "tests/studies/homework/method.hpp"

namespace collided::homework {
using namespace engine;
namespace {

/// Its dynamic tree of boxes, then its trees of oriented boxes; one pair of polygons of two objects, or all of them.
class Fcl final : public Method {
 public:
  Fcl(const Recording& recording, bool all_polygons) : all_polygons_(all_polygons) {
    std::vector<std::shared_ptr<bench::FclMesh>> models;
    for (const auto& size : recording.sizes) models.push_back(bench::fcl_mesh(*size->mesh));
    std::vector<fcl::CollisionObjectd*> all;
    for (std::size_t i = 0; i < recording.objects(); ++i) {
      objects_.push_back(std::make_unique<fcl::CollisionObjectd>(models[recording.size_of[i]]));
      objects_.back()->setUserData(reinterpret_cast<void*>(i));
      place(i, recording.poses[0][i]);
      all.push_back(objects_.back().get());
    }
    manager_.registerObjects(all);
    manager_.setup();
  }
  std::string name() const override { return all_polygons_ ? "FCL, all polygons" : "FCL"; }
  void frame(const std::vector<Pose>& poses) override {
    for (std::size_t i = 0; i < poses.size(); ++i) place(i, poses[i]);
    manager_.update();
    found_.clear();
    polygon_pairs_ = candidates_ = 0;
    manager_.collide(this, [](fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* self) {
      static_cast<Fcl*>(self)->test(a, b);
      return false;
    });
  }
  ObjectPairs pairs() const override {
    ObjectPairs sorted = found_;
    std::sort(sorted.begin(), sorted.end());
    return sorted;
  }
  std::optional<std::size_t> polygon_pairs() const override {
    return all_polygons_ ? std::optional(polygon_pairs_) : std::nullopt;
  }
  std::size_t candidates() const override { return candidates_; }

 private:
  void place(std::size_t i, const Pose& pose) {
    const Frame frame = frame_of(pose);
    objects_[i]->setTransform(frame.rotation, frame.position);
    objects_[i]->computeAABB();
  }
  void test(fcl::CollisionObjectd* a, fcl::CollisionObjectd* b) {
    ++candidates_;
    fcl::CollisionRequest<double> request;
    if (all_polygons_) request.num_max_contacts = std::numeric_limits<std::size_t>::max();
    fcl::CollisionResult<double> result;
    if (fcl::collide(a, b, request, result) == 0) return;
    polygon_pairs_ += result.numContacts();
    const auto i = static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(a->getUserData()));
    const auto j = static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(b->getUserData()));
    found_.push_back({std::min(i, j), std::max(i, j)});
  }

  bool all_polygons_;
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects_;
  fcl::DynamicAABBTreeCollisionManagerd manager_;
  ObjectPairs found_;
  std::size_t polygon_pairs_ = 0;
  std::size_t candidates_ = 0;
};

}  // namespace

std::unique_ptr<Method> fcl_objects(const Recording& recording) { return std::make_unique<Fcl>(recording, false); }
std::unique_ptr<Method> fcl_polygons(const Recording& recording) { return std::make_unique<Fcl>(recording, true); }

}  // namespace collided::homework
