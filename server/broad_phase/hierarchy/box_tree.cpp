#include "server/broad_phase/hierarchy/box_tree.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include "server/broad_phase/box_tests.hpp"
#include "server/broad_phase/hierarchy/bvh_node.hpp"
#include "server/broad_phase/hierarchy/bvh_walk.hpp"

namespace collided::engine {
namespace {

using bvh::FloatBox;
using bvh::kWidth;
using bvh::Node;
using bvh::Range;
using bvh::Ref;

/// A refitted tree is rebuilt when its nodes have grown by this factor, measured by the expected visits of a ray.
constexpr double kMostGrowth = 1.5;
/// How far beyond their bounds boxes may move before a new frame is chosen, in sizes of the whole.
constexpr double kRoom = 0.25;

/// Boxes that the floats of the tree cannot distinguish from their neighbours are tested one by one, up to this many:
/// one distant object must not make all boxes of a crowd alike.
constexpr std::size_t kMostOutliers = 64;
/// Sizes of an ordinary box within which floats can distinguish boxes.
constexpr double kSharpReach = 0x1p18;

bool is_bounded(const Aabb& box) { return box.low.allFinite() && box.high.allFinite(); }

/// A number in local coordinates as a float, rounded outward by more than all roundings on the way: two in double, of
/// numbers within [-1, 1], and one to float.
float outward_down(double local) { return static_cast<float>(local - 0x1p-23 * std::abs(local) - 0x1p-50); }
float outward_up(double local) { return static_cast<float>(local + 0x1p-23 * std::abs(local) + 0x1p-50); }

FloatBox float_box(const bvh::LocalFrame& frame, const Aabb& box) {
  const Vec3 low = frame.to_local(box.low);
  const Vec3 high = frame.to_local(box.high);
  FloatBox local;
  for (int axis = 0; axis < 3; ++axis) {
    local.low[axis] = outward_down(low[axis]);
    local.high[axis] = outward_up(high[axis]);
  }
  return local;
}

/// The walks' assumption about a node's planes; allows for the outward rounding of a box at the frame's border.
bool is_within_frame(const FloatBox& box) {
  constexpr float kEnd = 1 + 0x1p-20f;
  bool is_within = true;
  for (int axis = 0; axis < 3; ++axis) is_within = is_within && box.low[axis] >= -kEnd && box.high[axis] <= kEnd;
  return is_within;
}

/// The children of a node over a few boxes, near to far by their centres.
void set_children(std::span<const bvh::Primitive> few, Node& node) {
  const std::size_t size = few.size();
  for (std::uint32_t i = 0; i < size; ++i) node.child[i] = bvh::leaf_ref(few[i].triangle(), 1);
  for (unsigned octant = 0; octant < 4; ++octant) {
    std::array<std::uint32_t, kWidth> nearest{0, 1, 2, 3, 4, 5, 6, 7};
    std::array<float, kWidth> along{};
    for (std::uint32_t i = 0; i < size; ++i) {
      const bvh::Float4 center = few[i].low + few[i].high;
      for (int axis = 0; axis < 3; ++axis) along[i] += (octant >> axis & 1u) == 0 ? center[axis] : -center[axis];
    }
    std::sort(nearest.begin(), nearest.begin() + size,
              [&](std::uint32_t a, std::uint32_t b) { return along[a] != along[b] ? along[a] < along[b] : a < b; });
    std::uint32_t forward = 0;
    std::uint32_t backward = 0;
    for (std::uint32_t i = 0; i < kWidth; ++i) {
      forward |= nearest[i] << (3 * i);
      backward |= nearest[i < size ? size - 1 - i : i] << (3 * i);
    }
    node.order[octant] = forward;
    node.order[7 - octant] = backward;
  }
}

}  // namespace

struct BoxTreeNodes {
  /// A box that is tested separately.
  struct Outlier {
    std::uint32_t number;
    Aabb box;

    double low(int axis) const { return box.low[axis]; }
    double high(int axis) const { return box.high[axis]; }
  };

  bvh::Layout layout;  // its nodes are those below
  std::vector<Node> nodes;
  std::vector<FloatBox> node_bounds;
  std::vector<Outlier> outliers;  // not in the tree: unbounded, or far from the rest
  std::size_t box_count = 0;      // in the tree
  double built_weight = 0;        // weight() when the tree was built

  void build(std::span<const Aabb> boxes);
  void set_aside(std::span<const Aabb> boxes);
  bool is_aside(std::uint32_t number) const;
  Ref add(std::span<bvh::Primitive> primitives, const Range& range, std::uint32_t depth);
  bool fit(std::span<const Aabb> boxes);
  double weight() const;
};

BoxTree::BoxTree() : nodes_(std::make_unique<BoxTreeNodes>()) {}
BoxTree::~BoxTree() = default;
BoxTree::BoxTree(BoxTree&&) noexcept = default;
BoxTree& BoxTree::operator=(BoxTree&&) noexcept = default;

/// Adds the node over a range, with bounds still unset. Parents precede their children.
Ref BoxTreeNodes::add(std::span<bvh::Primitive> primitives, const Range& range, std::uint32_t depth) {
  const auto index = static_cast<Ref>(nodes.size());
  nodes.push_back(bvh::empty_node());
  if (range.size() <= kWidth) {
    set_children(primitives.subspan(range.begin, range.size()), nodes.back());
    return index;
  }
  Range children[kWidth];
  bvh::Cut cuts[kWidth];
  const int count = bvh::cut_wide(primitives, range, depth >= bvh::kMaxHeuristicDepth, children, cuts);
  bvh::set_order(cuts, count, nodes.back());
  for (int i = 0; i < count; ++i) {
    const Ref child = children[i].size() == 1 ? bvh::leaf_ref(primitives[children[i].begin].triangle(), 1)
                                              : add(primitives, children[i], depth + 1);
    nodes[index].child[i] = child;
  }
  return index;
}

/// Chooses the outliers: unbounded boxes, and if the rest spans more than floats resolve, those farthest from the
/// middle one, relative to its size.
void BoxTreeNodes::set_aside(std::span<const Aabb> boxes) {
  outliers.clear();
  std::vector<std::uint32_t> bounded;
  bounded.reserve(boxes.size());
  Aabb whole;
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    if (boxes[i].empty()) continue;
    if (!is_bounded(boxes[i])) {
      outliers.push_back({i, boxes[i]});
      continue;
    }
    bounded.push_back(i);
    whole.extend(boxes[i]);
  }
  if (bounded.empty()) return;
  const auto middle_of = [&](const auto& value) {
    const auto middle = bounded.begin() + static_cast<std::ptrdiff_t>(bounded.size() / 2);
    std::nth_element(bounded.begin(), middle, bounded.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return value(boxes[a]) < value(boxes[b]); });
    return value(boxes[*middle]);
  };
  const double size_m = middle_of([](const Aabb& box) { return (box.high / 2 - box.low / 2).maxCoeff(); });
  if ((whole.high / 2 - whole.low / 2).maxCoeff() <= kSharpReach * size_m) return;
  Vec3 middle;
  for (int axis = 0; axis < 3; ++axis) middle[axis] = middle_of([axis](const Aabb& box) { return box.low[axis]; });
  std::vector<Outlier> far;
  for (const std::uint32_t i : bounded) {
    const double away_m = (boxes[i].low - middle).cwiseAbs().cwiseMax((boxes[i].high - middle).cwiseAbs()).maxCoeff();
    if (!(away_m <= kSharpReach * size_m)) far.push_back({i, boxes[i]});
  }
  // If they are many, they are not outliers.
  if (far.size() <= kMostOutliers) outliers.insert(outliers.end(), far.begin(), far.end());
}

bool BoxTreeNodes::is_aside(std::uint32_t number) const {
  return std::any_of(outliers.begin(), outliers.end(), [&](const Outlier& other) { return other.number == number; });
}

/// Chooses the outliers, the frame and the nodes; their bounds are set by fit().
void BoxTreeNodes::build(std::span<const Aabb> boxes) {
  set_aside(boxes);
  Aabb bounds;
  std::vector<std::uint32_t> numbers;
  numbers.reserve(boxes.size());
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    if (boxes[i].empty() || is_aside(i)) continue;
    numbers.push_back(i);
    bounds.extend(boxes[i]);
  }
  const Vec3 room = kRoom * (bounds.high / 2 - bounds.low / 2);
  const Aabb grown{.low = bounds.low - room, .high = bounds.high + room};
  layout.frame = bvh::local_frame(is_bounded(grown) ? grown : bounds);
  std::vector<bvh::Primitive> primitives;
  primitives.reserve(numbers.size());
  Range all;
  for (const std::uint32_t i : numbers) {
    const FloatBox local = float_box(layout.frame, boxes[i]);
    bvh::Primitive primitive{local.low, local.high};
    primitive.low[3] = std::bit_cast<float>(i);
    primitive.high[3] = 0;
    all.add(primitive);
    primitives.push_back(primitive);
  }
  all.end = static_cast<std::uint32_t>(primitives.size());
  box_count = primitives.size();
  nodes.clear();
  layout.root = box_count == 0 ? bvh::kNothing : add(primitives, all, 0);
  nodes.shrink_to_fit();
  layout.nodes = bvh::PlainArray<Node>::borrowed(nodes);
  node_bounds.resize(nodes.size());
}

/// Sets the bounds of all nodes, last to first. False if a box was removed, or one in the tree has left the frame.
bool BoxTreeNodes::fit(std::span<const Aabb> boxes) {
  for (Outlier& other : outliers) {
    if (other.number >= boxes.size() || boxes[other.number].empty()) return false;
    other.box = boxes[other.number];
  }
  for (std::size_t i = nodes.size(); i-- > 0;) {
    Node& node = nodes[i];
    FloatBox& whole = node_bounds[i] = FloatBox{};
    for (int slot = 0; slot < kWidth && node.child[slot] != bvh::kNothing; ++slot) {
      const Ref child = node.child[slot];
      FloatBox box;
      if (bvh::is_leaf(child)) {
        const std::uint32_t number = child & bvh::kIndexMask;
        if (number >= boxes.size() || boxes[number].empty()) return false;
        box = float_box(layout.frame, boxes[number]);
        if (!is_within_frame(box)) return false;
      } else {
        box = node_bounds[child];
      }
      bvh::set_child(node, slot, box, child);
      whole.extend(box);
    }
  }
  for (int axis = 0; axis < 3 && !nodes.empty(); ++axis) {
    layout.root_low[axis] = node_bounds[0].low[axis];
    layout.root_high[axis] = node_bounds[0].high[axis];
  }
  return true;
}

/// How many nodes a ray through the root meets, on average.
double BoxTreeNodes::weight() const {
  double sum = 0;
  for (const FloatBox& box : node_bounds) sum += static_cast<double>(box.half_area());
  return sum / std::max(static_cast<double>(node_bounds[0].half_area()), 1e-30);
}

void BoxTree::rebuild(std::span<const Aabb> boxes) {
  BoxTreeNodes& s = *nodes_;
  std::size_t count = 0;
  for (const Aabb& box : boxes) count += box.empty() ? 0 : 1;
  if (s.box_count > 0 && count == s.box_count + s.outliers.size() && s.fit(boxes) &&
      s.weight() <= kMostGrowth * s.built_weight)
    return;
  s.build(boxes);
  if (s.box_count == 0) return;
  s.fit(boxes);
  s.built_weight = s.weight();
}

std::size_t BoxTree::bytes() const {
  const BoxTreeNodes& s = *nodes_;
  return s.nodes.capacity() * sizeof(Node) + s.node_bounds.capacity() * sizeof(FloatBox) +
         s.outliers.capacity() * sizeof(BoxTreeNodes::Outlier);
}

void BoxTree::walk_ray(const Ray& ray, double limit, RayFound found, WalkCost& cost) const {
  const BoxTreeNodes& s = *nodes_;
  for (const BoxTreeNodes::Outlier& other : s.outliers) {
    const SlabSpan span = clip(ray, other, limit);
    if (!(span.entry <= span.exit)) continue;
    ++cost.candidates;
    limit = found(other.number, limit);
    if (!(limit >= 0)) return;
  }
  if (s.box_count > 0 && limit >= 0) bvh::walk_ray_boxes(s.layout, ray, limit, found, cost);
}

void BoxTree::walk_near(const Vec3& point, double limit_m2, NearFound found, WalkCost& cost) const {
  const BoxTreeNodes& s = *nodes_;
  for (const BoxTreeNodes::Outlier& other : s.outliers) {
    if (!is_within(other, point, limit_m2)) continue;
    ++cost.candidates;
    limit_m2 = found(other.number, limit_m2);
    if (!(limit_m2 >= 0)) return;
  }
  if (s.box_count > 0 && limit_m2 >= 0)
    bvh::walk_near_boxes(s.layout, bvh::local_point(s.layout.frame, point, 0), limit_m2, found, cost);
}

void BoxTree::walk_box(const Aabb& asked, BoxFound found, WalkCost& cost) const {
  const BoxTreeNodes& s = *nodes_;
  if (asked.empty()) return;
  for (const BoxTreeNodes::Outlier& other : s.outliers) {
    if (!overlaps(other.box, asked)) continue;
    ++cost.candidates;
    if (!found(other.number)) return;
  }
  if (s.box_count > 0) bvh::walk_box_boxes(s.layout, bvh::local_box(s.layout.frame, asked), found, cost);
}

}  // namespace collided::engine
