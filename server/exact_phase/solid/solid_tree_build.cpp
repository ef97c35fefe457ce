// Builds a solid's tree cell by cell from a list of undivided cells, without recursion however deep the tree.

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numeric>

#include "server/exact_phase/solid/fragments.hpp"
#include "server/exact_phase/solid/point_signs.hpp"
#include "server/exact_phase/solid/solid_tree.hpp"
#include "server/geometry/edge_table.hpp"

namespace collided::engine {
namespace {

// Cells with at most this many pieces are divided along the pieces' planes. Chosen by measurement on scans: a lower
// value costs cells and pieces, a higher one tests of planes.
constexpr std::size_t kFewPieces = 24;
// A split across an axis must leave each half with fewer than this share of the pieces.
constexpr double kWorthwhile = 0.9;
// Number of planes that are compared for a choice, and of pieces on which they are compared.
constexpr std::size_t kPlanesTried = 6;
constexpr std::size_t kPiecesTried = 32;
// One more cut is worth this many pieces of imbalance.
constexpr double kCutCost = 4;

bool has_area(const Triangle& t) {
  PlainPoint point(t.c);
  for (int axis = 0; axis < 3; ++axis) {
    if (point.turn(t.a, t.b, axis) != 0) return true;
  }
  return false;
}

/// A double strictly between the two; nothing if there is none.
std::optional<double> between(double low, double high) {
  const double middle = low / 2 + high / 2;
  if (middle > low && middle < high) return middle;
  return std::nullopt;
}

}  // namespace

struct SolidCell {
  std::vector<std::uint32_t> pieces;
  Aabb box;
  std::uint32_t parent = 0;
  std::uint32_t depth = 0;
  bool is_front = false;
  bool by_planes = false;
};

class SolidTreeBuild {
 public:
  SolidTreeBuild(std::shared_ptr<const TriangleMesh> mesh, FunctionRef<bool(const Vec3& point)> is_inside,
                 const SolidTreeOptions& options)
      : mesh_(*mesh), bounds_(bounds_of_vertices()), is_inside_(is_inside), options_(options), pieces_(mesh_, bounds_) {
    tree_.mesh_ = std::move(mesh);
    tree_.bounds_ = bounds_;
  }

  bool run();
  SolidTree take() { return std::move(tree_); }

 private:
  Aabb bounds_of_vertices() const {
    Aabb box;
    for (const TriangleCorners& corners : mesh_.triangles) {
      for (const std::uint32_t corner : corners) box.extend(mesh_.vertices[corner]);
    }
    return box;
  }
  void share_planes();
  bool divide(SolidCell cell);
  bool divide_across(SolidCell& cell);
  bool divide_along(SolidCell& cell);
  /// A plane across an axis that divides the cell's pieces well.
  struct Across {
    int axis = -1;
    double at = 0;
    double cost = 0;
  };
  Across best_across(const SolidCell& cell);
  void try_across(const SolidCell& cell, int axis, double at, Across& best) const;
  std::uint32_t best_along(const SolidCell& cell);
  /// Distributes the cell's pieces to the halves of a node's plane; those in the plane stay with the node.
  void deal(const SolidCell& cell, std::uint32_t plane, SolidCell& front, SolidCell& back);
  void keep_faces();
  std::uint32_t put(const SolidCell& cell, std::uint32_t plane);
  void link(const SolidCell& cell, std::uint32_t child);
  bool is_over() const {
    return static_cast<double>(live_) >
               options_.most_fragments_per_triangle * static_cast<double>(tree_.report_.triangles) + 64 ||
           (options_.cancelled && options_.cancelled());
  }

  const TriangleMesh& mesh_;
  Aabb bounds_;
  FunctionRef<bool(const Vec3& point)> is_inside_;
  const SolidTreeOptions& options_;
  SolidTree tree_;
  Fragments pieces_;
  std::vector<SolidCell> cells_;
  struct PieceInPlane {
    std::uint32_t node;
    std::uint32_t piece;
  };
  std::vector<PieceInPlane> in_planes_;  // if faces are kept
  std::uint64_t live_ = 0;               // pieces that were not cut
  std::vector<Aabb> boxes_;              // of the pieces of the current cell
  std::vector<double> coordinates_;      // of these pieces along one axis
};

/// Gives neighbours in one plane that face the same way one plane, so that flat faces are split once.
void SolidTreeBuild::share_planes() {
  const EdgeTable edges = edge_table(mesh_);
  const auto normal = [&](std::uint32_t triangle) {
    const Triangle t = mesh_.triangle(triangle);
    return Vec3((t.b - t.a).cross(t.c - t.a));
  };
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const auto uses = edges.uses_of(i);
    if (uses.size() != 2) continue;
    const std::uint32_t a = triangle_of(uses[0]);
    const std::uint32_t b = triangle_of(uses[1]);
    const Triangle of_a = mesh_.triangle(a);
    const Vec3& apex = mesh_.vertices[mesh_.triangles[b][(uses[1] % 3 + 2) % 3]];
    // They are known to face the same way: for two in one plane the product is plus or minus that of the lengths.
    if (!(normal(a).dot(normal(b)) > 0)) continue;
    if (has_area(of_a) && has_area(mesh_.triangle(b)) && PlainPoint(apex).height(of_a) == 0) pieces_.share_plane(a, b);
  }
}

std::uint32_t SolidTreeBuild::put(const SolidCell& cell, std::uint32_t plane) {
  const auto number = static_cast<std::uint32_t>(tree_.nodes_.size());
  tree_.nodes_.push_back({.plane = pieces_.plane(plane)});
  tree_.report_.across_nodes += pieces_.plane(plane).is_across() ? 1 : 0;
  tree_.report_.depth = std::max(tree_.report_.depth, cell.depth + 1);
  link(cell, number);
  return number;
}

void SolidTreeBuild::link(const SolidCell& cell, std::uint32_t child) {
  if (tree_.nodes_.empty() || child == 0) return;
  SolidTree::SplitNode& parent = tree_.nodes_[cell.parent];
  (cell.is_front ? parent.front : parent.back) = child;
}

void SolidTreeBuild::deal(const SolidCell& cell, std::uint32_t plane, SolidCell& front, SolidCell& back) {
  for (const std::uint32_t piece : cell.pieces) {
    const Fragments::FragmentSides sides = pieces_.sides(piece, plane);
    if (sides.front && sides.back) {
      const Fragments::Halves halves = pieces_.cut(piece, plane);
      front.pieces.push_back(halves.front);
      back.pieces.push_back(halves.back);
      ++live_;
    } else if (sides.front) {
      front.pieces.push_back(piece);
    } else if (sides.back) {
      back.pieces.push_back(piece);
    } else if (options_.keeps_faces) {
      in_planes_.push_back({front.parent, piece});
    }
  }
}

/// Sorts the pieces by the node whose plane contains them.
void SolidTreeBuild::keep_faces() {
  tree_.first_face_.assign(tree_.nodes_.size() + 1, 0);
  for (const PieceInPlane& piece : in_planes_) ++tree_.first_face_[piece.node + 1];
  std::partial_sum(tree_.first_face_.begin(), tree_.first_face_.end(), tree_.first_face_.begin());
  std::stable_sort(in_planes_.begin(), in_planes_.end(),
                   [](const PieceInPlane& a, const PieceInPlane& b) { return a.node < b.node; });
  for (const PieceInPlane& piece : in_planes_) {
    const auto first = static_cast<std::uint32_t>(tree_.outlines_.size());
    pieces_.outline(piece.piece, tree_.outlines_);
    tree_.faces_.push_back(
        {pieces_.triangle_of(piece.piece), first, static_cast<std::uint32_t>(tree_.outlines_.size()) - first});
  }
}

void SolidTreeBuild::try_across(const SolidCell& cell, int axis, double at, Across& best) const {
  if (!(at > cell.box.low[axis]) || !(at < cell.box.high[axis])) return;
  // A cell that may become empty is classified by a double inside it, so there must be one.
  if (!between(cell.box.low[axis], at) || !between(at, cell.box.high[axis])) return;
  std::size_t front = 0;
  std::size_t back = 0;
  for (const Aabb& box : boxes_) {
    front += box.high[axis] > at ? 1 : 0;
    back += box.low[axis] < at ? 1 : 0;
  }
  const std::size_t count = boxes_.size();
  const auto larger = static_cast<double>(std::max(front, back));
  if (larger > kWorthwhile * static_cast<double>(count)) return;
  const double cuts = front + back > count ? static_cast<double>(front + back - count) : 0;
  const double cost = larger + cuts;
  if (best.axis < 0 || cost < best.cost) best = {axis, at, cost};
}

SolidTreeBuild::Across SolidTreeBuild::best_across(const SolidCell& cell) {
  boxes_.clear();
  for (const std::uint32_t piece : cell.pieces) boxes_.push_back(pieces_.roughly(piece));
  Across best;
  for (int axis = 0; axis < 3; ++axis) {
    coordinates_.clear();
    for (const Aabb& box : boxes_) coordinates_.push_back(box.low[axis]);
    const auto middle = coordinates_.begin() + static_cast<std::ptrdiff_t>(coordinates_.size() / 2);
    std::nth_element(coordinates_.begin(), middle, coordinates_.end());
    try_across(cell, axis, *middle, best);  // if faces lie across the axis, this plane does not cut them
    for (std::size_t i = 0; i < boxes_.size(); ++i)
      coordinates_[i] = boxes_[i].low[axis] / 2 + boxes_[i].high[axis] / 2;
    std::nth_element(coordinates_.begin(), middle, coordinates_.end());
    // Few digits keep exact numbers short.
    try_across(cell, axis, static_cast<double>(static_cast<float>(*middle)), best);
    try_across(cell, axis, *middle, best);
  }
  return best;
}

bool SolidTreeBuild::divide_across(SolidCell& cell) {
  const Across best = best_across(cell);
  if (best.axis < 0) return false;
  const std::uint32_t plane = pieces_.plane_across(best.axis, best.at);
  const std::uint32_t node = put(cell, plane);
  SolidCell front{.pieces = {}, .box = cell.box, .parent = node, .depth = cell.depth + 1, .is_front = true};
  SolidCell back{.pieces = {}, .box = cell.box, .parent = node, .depth = cell.depth + 1, .is_front = false};
  front.box.low[best.axis] = best.at;
  back.box.high[best.axis] = best.at;
  deal(cell, plane, front, back);
  cells_.push_back(std::move(front));
  cells_.push_back(std::move(back));
  return true;
}

std::uint32_t SolidTreeBuild::best_along(const SolidCell& cell) {
  const std::size_t count = cell.pieces.size();
  const std::size_t planes = std::min(count, kPlanesTried);
  const std::size_t tried = std::min(count, kPiecesTried);
  std::uint32_t best = pieces_.plane_of(pieces_.triangle_of(cell.pieces.front()));
  if (count <= 2) return best;
  double best_cost = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < planes; ++i) {
    const std::uint32_t plane = pieces_.plane_of(pieces_.triangle_of(cell.pieces[i * count / planes]));
    double front = 0;
    double back = 0;
    double cuts = 0;
    for (std::size_t k = 0; k < tried; ++k) {
      const Fragments::FragmentSides sides = pieces_.rough_sides(cell.pieces[k * count / tried], plane);
      front += sides.front ? 1 : 0;
      back += sides.back ? 1 : 0;
      cuts += sides.front && sides.back ? 1 : 0;
    }
    const double cost = std::max(front, back) + kCutCost * cuts;
    if (cost < best_cost) {
      best = plane;
      best_cost = cost;
    }
  }
  return best;
}

/// A half without pieces is wholly inside or outside, which the piece that defines the plane decides: it faces outside.
bool SolidTreeBuild::divide_along(SolidCell& cell) {
  const std::uint32_t plane = best_along(cell);
  const std::uint32_t node = put(cell, plane);
  SolidCell front{
      .pieces = {}, .box = {}, .parent = node, .depth = cell.depth + 1, .is_front = true, .by_planes = true};
  SolidCell back{
      .pieces = {}, .box = {}, .parent = node, .depth = cell.depth + 1, .is_front = false, .by_planes = true};
  deal(cell, plane, front, back);
  tree_.nodes_[node].front = SolidTree::kOut;
  tree_.nodes_[node].back = SolidTree::kIn;
  if (!front.pieces.empty()) cells_.push_back(std::move(front));
  if (!back.pieces.empty()) cells_.push_back(std::move(back));
  return true;
}

bool SolidTreeBuild::divide(SolidCell cell) {
  if (cell.pieces.empty()) {
    Vec3 inner;
    for (int axis = 0; axis < 3; ++axis) {
      const std::optional<double> middle = between(cell.box.low[axis], cell.box.high[axis]);
      if (!middle) return false;
      inner[axis] = *middle;
    }
    link(cell, is_inside_(inner) ? SolidTree::kIn : SolidTree::kOut);
    return true;
  }
  if (!cell.by_planes && cell.pieces.size() > kFewPieces && divide_across(cell)) return true;
  return divide_along(cell);
}

bool SolidTreeBuild::run() {
  const auto start = std::chrono::steady_clock::now();
  share_planes();
  SolidCell root{.pieces = {}, .box = bounds_};
  for (std::uint32_t i = 0; i < mesh_.triangles.size(); ++i) {
    if (has_area(mesh_.triangle(i))) root.pieces.push_back(pieces_.add(i));
  }
  live_ = tree_.report_.triangles = root.pieces.size();
  if (root.pieces.empty()) return false;
  cells_.push_back(std::move(root));
  while (!cells_.empty()) {
    SolidCell cell = std::move(cells_.back());
    cells_.pop_back();
    if (is_over() || !divide(std::move(cell))) return false;
  }
  tree_.nodes_.shrink_to_fit();
  if (options_.keeps_faces) keep_faces();
  tree_.report_.nodes = static_cast<std::uint32_t>(tree_.nodes_.size());
  tree_.report_.fragments = live_;
  tree_.report_.bytes = tree_.nodes_.size() * sizeof(SolidTree::SplitNode) +
                        tree_.first_face_.size() * sizeof(std::uint32_t) +
                        tree_.faces_.size() * sizeof(SolidTree::KeptFace) + tree_.outlines_.size() * sizeof(Vec3);
  tree_.report_.build_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return true;
}

std::optional<SolidTree> SolidTree::build(std::shared_ptr<const TriangleMesh> mesh,
                                          FunctionRef<bool(const Vec3& point)> is_inside,
                                          const SolidTreeOptions& options) {
  SolidTreeBuild build(std::move(mesh), is_inside, options);
  if (!build.run()) return std::nullopt;
  return build.take();
}

}  // namespace collided::engine
