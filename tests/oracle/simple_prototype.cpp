#include "tests/oracle/simple_prototype.hpp"

namespace collided::oracle {
using namespace engine;

void SimplePrototype::add(std::shared_ptr<const TriangleMesh> mesh) {
  Object object;
  for (const Vec3& vertex : mesh->vertices) object.radius_m = std::max(object.radius_m, vertex.norm());
  object.mesh = std::move(mesh);
  objects_.push_back(std::move(object));
}

const std::vector<SimplePrototype::Corners>& SimplePrototype::placed(Object& object) const {
  if (!object.is_placed) {
    object.placed.clear();
    for (std::uint32_t i = 0; i < object.mesh->triangles.size(); ++i) {
      object.placed.push_back(Moeller<double>::corners(place(object.frame, object.mesh->triangle(i))));
    }
    object.is_placed = true;
  }
  return object.placed;
}

std::vector<MeetingPair> SimplePrototype::collide() {
  object_candidates_ = triangle_candidates_ = 0;
  for (Object& object : objects_) object.is_placed = false;
  std::vector<MeetingPair> found;
  for (std::uint32_t i = 0; i < objects_.size(); ++i) {
    for (std::uint32_t j = i + 1; j < objects_.size(); ++j) {
      Object& a = objects_[i];
      Object& b = objects_[j];
      const double reach_m = a.radius_m + b.radius_m;
      if (!((a.frame.position - b.frame.position).squaredNorm() < reach_m * reach_m)) continue;
      ++object_candidates_;
      MeetingPair pair{{i, j}, {}};
      const std::vector<Corners>& of_a = placed(a);
      const std::vector<Corners>& of_b = placed(b);
      triangle_candidates_ += of_a.size() * of_b.size();
      for (std::uint32_t k = 0; k < of_a.size(); ++k) {
        for (std::uint32_t l = 0; l < of_b.size(); ++l) {
          if (test_(of_a[k], of_b[l])) pair.triangles.push_back({k, l});
        }
      }
      if (!pair.triangles.empty()) found.push_back(std::move(pair));
    }
  }
  return found;
}

}  // namespace collided::oracle
