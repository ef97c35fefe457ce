#include <CGAL/box_intersection_d.h>

#include <vector>

#include "tests/studies/bench/peers/frame_peers.hpp"

namespace collided::bench {
using namespace engine;
namespace {

using Box3 = CGAL::Box_intersection_d::Box_d<double, 3>;

/// Its streaming segment trees, from nothing in every frame.
class Cgal final : public FramePeer {
 public:
  std::string name() const override { return "CGAL box_intersection"; }
  std::size_t frame(std::span<const Aabb> boxes) override {
    boxes_.clear();
    for (const Aabb& box : boxes)
      boxes_.emplace_back(const_cast<double*>(box.low.data()), const_cast<double*>(box.high.data()));
    std::size_t count = 0;
    CGAL::box_self_intersection_d(boxes_.begin(), boxes_.end(), [&](const Box3&, const Box3&) { ++count; });
    return count;
  }

 private:
  std::vector<Box3> boxes_;
};

}  // namespace

std::unique_ptr<FramePeer> cgal_frames(std::span<const Aabb>) { return std::make_unique<Cgal>(); }

}  // namespace collided::bench
