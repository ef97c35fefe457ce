#include "server/exact_phase/solid/face_order.hpp"

namespace collided::engine {

/// Walks a tree in the order in which an eye sees its cells.
class FaceOrder {
 public:
  FaceOrder(const SolidTree& tree, const Vec3& eye, FunctionRef<bool(const SolidFace&)> show)
      : tree_(tree), eye_(eye), show_(show) {}

  void run() {
    enter(0);
    while (!waiting_.empty()) {
      const Far far = waiting_.back();
      waiting_.pop_back();
      if (!show_faces(far.node)) return;
      enter(far.child);
    }
  }

 private:
  /// A node whose near half was shown: its own faces come next, and then the far half.
  struct Far {
    std::uint32_t node;
    std::uint32_t child;
  };

  void enter(std::uint32_t at) {
    while (at < SolidTree::kIn) {
      const SolidTree::SplitNode& node = tree_.nodes_[at];
      const bool is_front_near = tree_.side_of(node, eye_) >= 0;
      waiting_.push_back({at, is_front_near ? node.back : node.front});
      at = is_front_near ? node.front : node.back;
    }
  }
  bool show_faces(std::uint32_t node) const {
    for (std::uint32_t i = tree_.first_face_[node]; i < tree_.first_face_[node + 1]; ++i) {
      const SolidTree::KeptFace& face = tree_.faces_[i];
      if (!show_({face.triangle, std::span(tree_.outlines_).subspan(face.first, face.count)})) return false;
    }
    return true;
  }

  const SolidTree& tree_;
  Vec3 eye_;
  FunctionRef<bool(const SolidFace&)> show_;
  std::vector<Far> waiting_;
};

void show_front_to_back(const SolidTree& tree, const Vec3& eye, FunctionRef<bool(const SolidFace&)> show) {
  FaceOrder(tree, eye, show).run();
}

}  // namespace collided::engine
