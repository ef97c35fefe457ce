#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "server/exact_phase/distance/convex.hpp"

namespace collided::engine::kernel {

/// The edges and faces of a point, segment, triangle, box or hull as numbers of corners. The faces are flat and convex, and
/// with the edges they are all of the set's border.
class FlatFeatures {
 public:
  using Edge = std::array<std::uint32_t, 2>;
  struct Face {
    std::array<std::uint32_t, 4> corner;
    std::size_t count;
  };

  /// Nothing where a hull's placed corners do not span space, or are more than kMostRebuilt and no longer in convex
  /// position as its faces have them.
  /// cost  a hull: its faces, allocates; where rounding has bent them, corners times faces
  static std::optional<FlatFeatures> of(const Convex& set);

  const std::vector<Edge>& edges() const { return edges_; }
  const std::vector<Face>& faces() const { return faces_; }
  std::uint32_t corner_count() const { return box_ != nullptr ? 8 : static_cast<std::uint32_t>(corners_.size()); }
  bool is_solid() const { return is_solid_; }

  /// The corner as seen from a point.
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
  std::vector<Edge> edges_;
  std::vector<Face> faces_;
  bool is_solid_ = false;
};

}  // namespace collided::engine::kernel
