#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "server/exact_phase/distance/convex.hpp"

namespace collided::engine::kernel {

/// The edges and faces of a polytope by numbers of its corners. The faces are flat and convex; together with the edges
/// they are the whole border.
struct FlatBorder {
  using Edge = std::array<std::uint32_t, 2>;
  struct Face {
    std::array<std::uint32_t, 4> corner;
    std::size_t count;
  };

  std::vector<Edge> edges;
  std::vector<Face> faces;
  bool is_solid = false;
};

/// The edges and faces of a point, segment, triangle, box or hull, and its corners. Keeps a pointer to a box's
/// Convex, which must outlive this.
class FlatFeatures {
 public:
  using Edge = FlatBorder::Edge;
  using Face = FlatBorder::Face;

  /// Nothing if a hull's placed corners do not span space, or if they are more than kMostRebuilt and rounding made its
  /// faces non-convex.
  /// cost  a hull: its faces, allocates; if rounding has bent them, corners times faces
  static std::optional<FlatFeatures> of(const Convex& set);

  const FlatBorder& border() const { return border_; }
  std::uint32_t corner_count() const { return box_ != nullptr ? 8 : static_cast<std::uint32_t>(corners_.size()); }

  /// A corner relative to `from`, formed in N without rounding of its own.
  template <class N>
  Vector<N> corner(std::uint32_t number, const Vec3& from) const {
    if (box_ == nullptr) return Vector<N>(corners_[number]) - Vector<N>(from);
    Vector<N> place = Vector<N>(box_->carrier[0]) - Vector<N>(from);
    for (int i = 0; i < 3; ++i) {
      const Vector<N> reach = N(box_->half_m[i]) * Vector<N>(Vec3(box_->axes.col(i)));
      place = number >> i & 1 ? place + reach : place - reach;
    }
    return place;
  }

 private:
  static constexpr std::size_t kMostRebuilt = 1024;

  void take_box(const Convex& set);
  bool take_hull(const Convex& set);
  void take_faces(const std::vector<std::array<std::uint32_t, 3>>& triangles);

  const Convex* box_ = nullptr;
  std::vector<Vec3> corners_;
  FlatBorder border_;
};

}  // namespace collided::engine::kernel
