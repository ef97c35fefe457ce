#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <span>
#include <type_traits>
#include <vector>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/geometry/aabb.hpp"

namespace collided::engine::bvh {

/// Children of a node, and triangles of a leaf.
inline constexpr int kWidth = 8;

/// Levels of wide nodes cut by the surface-area heuristic. Below them ranges are halved by count, so that even
/// identical triangles end in leaves: 2^32 triangles take at most 11 levels of eight halves.
inline constexpr std::uint32_t kMaxHeuristicDepth = 48;
inline constexpr std::uint32_t kMaxDepth = kMaxHeuristicDepth + 12;
/// A walk keeps at most seven waiting siblings per level.
inline constexpr int kStackSize = static_cast<int>(kMaxDepth) * (kWidth - 1) + kWidth;

/// A reference to a child: an inner node, a leaf with its number of triangles, or nothing.
using Ref = std::uint32_t;
inline constexpr Ref kLeafBit = 0x80000000u;
inline constexpr Ref kIndexMask = 0x0fffffffu;
inline constexpr Ref kNothing = 0x7fffffffu;
inline Ref leaf_ref(std::uint32_t index, int count) { return kLeafBit | (static_cast<Ref>(count - 1) << 28) | index; }
inline bool is_leaf(Ref ref) { return (ref & kLeafBit) != 0; }
inline int leaf_count(Ref ref) { return static_cast<int>((ref >> 28) & 7u) + 1; }

/// Eight children with bounds in local coordinates, rounded outward: plane[axis][0] low, plane[axis][1] high. A missing
/// child has low = +inf, high = -inf. order[octant] lists the children near to far, three bits each, for rays whose
/// direction is negative on axis k if bit k of octant is set. For each cut that made the node, the side from which the
/// ray comes goes first, so the walk need not sort by distance. occlusion_order() lists them for a ray that any
/// triangle stops, in any direction; it is stored in the spare bits of the first three orders.
struct alignas(64) Node {
  float plane[3][2][kWidth];
  Ref child[kWidth];
  std::uint32_t order[kWidth];

  std::uint32_t occlusion_order() const { return order[0] >> 24 | order[1] >> 24 << 8 | order[2] >> 24 << 16; }
  void set_occlusion_order(std::uint32_t list) {
    for (int i = 0; i < 3; ++i) order[i] = (order[i] & 0xffffffu) | (list >> (8 * i) & 0xffu) << 24;
  }
};
inline constexpr std::uint32_t kPlaneBytes = sizeof(float) * kWidth;
static_assert(sizeof(Node) == 256);

/// Up to eight triangles in local coordinates. If every vertex of the mesh is a float there, as in most imported
/// meshes, a, b, c are the exact corners. Otherwise a is the first corner and b, c are the edges from it, each rounded
/// to float: a corner is off by at most 2^-24, an edge by 2^-24 of its largest component.
struct alignas(64) Leaf {
  float a[3][kWidth];
  float b[3][kWidth];
  float c[3][kWidth];
  std::uint32_t triangle[kWidth];
};
static_assert(sizeof(Leaf) == 320);
static_assert(kWidth == BvhReport::kChildren && kWidth == BvhReport::kLeafTriangles);

/// Local coordinates: (world - origin) * scale, within [-1, 1] for every vertex. The origin has so few binary digits
/// that the subtraction is exact; the scale is a power of two.
struct LocalFrame {
  Vec3 origin = Vec3::Zero();
  double scale = 1;
  double inverse_scale = 1;
  int scale_exponent = 0;  // scale = 2^scale_exponent

  Vec3 to_local(const Vec3& world) const { return (world - origin) * scale; }
  double to_world(float local, int axis) const { return static_cast<double>(local) * inverse_scale + origin[axis]; }
  /// True if the point survives the conversion to local floats and back.
  bool is_float(const Vec3& world) const {
    const Vec3 local = to_local(world);
    bool same = true;
    for (int axis = 0; axis < 3; ++axis) same = same && to_world(static_cast<float>(local[axis]), axis) == world[axis];
    return same;
  }
};

/// The local frame of a mesh with these bounds.
LocalFrame local_frame(const Aabb& bounds);

/// The nearest float below or equal, and above or equal.
float round_down(double value);
float round_up(double value);

/// Memory for PlainArray; long blocks are aligned to huge pages. Throws std::bad_alloc.
std::span<std::byte> allocate_pages(std::size_t bytes);
void free_pages(std::span<std::byte> memory);

/// Memory for many plain records, aligned for SIMD; long arrays lie on huge pages, because an incoherent ray touches
/// pages all over the tree and would otherwise wait for address translation as well as for data. New records are not
/// initialised.
template <typename T>
class PlainArray {
  static_assert(std::is_trivially_destructible_v<T>);

 public:
  PlainArray() = default;
  explicit PlainArray(std::size_t size)
      : data_(reinterpret_cast<T*>(allocate_pages(size * sizeof(T)).data()), Free{size * sizeof(T), true}) {}
  /// Read-only records stored elsewhere, which must outlive this.
  static PlainArray borrowed(std::span<const T> records) {
    PlainArray array;
    array.data_ = {const_cast<T*>(records.data()), Free{records.size_bytes(), false}};
    return array;
  }
  T* data() { return data_.get(); }
  const T* data() const { return data_.get(); }
  T& operator[](std::size_t i) { return data_.get()[i]; }
  const T& operator[](std::size_t i) const { return data_.get()[i]; }
  std::size_t bytes() const { return data_.get_deleter().bytes; }
  std::size_t size() const { return bytes() / sizeof(T); }

 private:
  struct Free {
    std::size_t bytes = 0;
    bool is_own = false;
    void operator()(T* memory) const {
      if (is_own) free_pages({reinterpret_cast<std::byte*>(memory), bytes});
    }
  };
  std::unique_ptr<T[], Free> data_;
};

/// A triangle that entered the tree as several boxes: at most piece_count.
struct Split {
  std::uint32_t triangle;
  std::uint32_t piece_count;
};

/// The finished tree. An empty one has root kNothing.
struct Layout {
  LocalFrame frame;
  bool has_corners = false;  // false: leaves hold edges
  float root_low[3] = {1, 1, 1};
  float root_high[3] = {-1, -1, -1};
  Ref root = kNothing;
  PlainArray<Node> nodes;
  PlainArray<Leaf> leaves;
  std::vector<Split> splits;           // ascending by triangle
  std::shared_ptr<const void> keeper;  // owner of the memory of borrowed nodes and leaves
};

}  // namespace collided::engine::bvh
