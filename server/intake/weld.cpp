#include "server/intake/weld.hpp"

#include <algorithm>
#include <bit>

#include "server/intake/mixed.hpp"

namespace collided {
namespace {

constexpr std::uint32_t kFree = 0xffffffff;

std::uint64_t hash_of(const Vec3& point) {
  std::uint64_t hash = 0;
  for (int axis = 0; axis < 3; ++axis) {
    hash = mixed(hash + 0x9e3779b97f4a7c15u + std::bit_cast<std::uint64_t>(point[axis] + 0.0));  // -0 + 0 is 0
  }
  return hash;
}

std::uint64_t hash_of(const TriangleCorners& corners) {
  return mixed(mixed(std::uint64_t{corners[0]} << 32 | corners[1]) + corners[2]);
}

/// Numbers of things in an open table; the things stay where they are.
class IndexTable {
 public:
  explicit IndexTable(std::size_t count) : slots_(std::bit_ceil(2 * count + 1), kFree) {}

  /// The number of the equal thing that came first, which is index itself for a new one.
  template <class Equal>
  std::uint32_t find_or_add(std::uint64_t hash, std::uint32_t index, const Equal& equals) {
    const std::size_t mask = slots_.size() - 1;
    for (std::size_t slot = hash & mask;; slot = (slot + 1) & mask) {
      if (slots_[slot] == kFree) {
        slots_[slot] = index;
        return index;
      }
      if (equals(slots_[slot])) {
        return slots_[slot];
      }
    }
  }

 private:
  std::vector<std::uint32_t> slots_;
};

}  // namespace

std::vector<std::uint32_t> first_equal_vertices(const std::vector<Vec3>& vertices) {
  IndexTable table(vertices.size());
  std::vector<std::uint32_t> first(vertices.size());
  for (std::uint32_t i = 0; i < vertices.size(); ++i) {
    const Vec3& vertex = vertices[i];
    first[i] = table.find_or_add(hash_of(vertex), i, [&](std::uint32_t other) {
      const Vec3& before = vertices[other];
      return before[0] == vertex[0] && before[1] == vertex[1] && before[2] == vertex[2];
    });
  }
  return first;
}

void weld_equal_vertices(TriangleMesh& mesh) {
  std::vector<std::uint32_t> number = first_equal_vertices(mesh.vertices);
  std::uint32_t kept = 0;
  for (std::uint32_t i = 0; i < number.size(); ++i) {
    if (number[i] == i) {
      mesh.vertices[kept] = mesh.vertices[i];
      number[i] = kept++;
    } else {
      number[i] = number[number[i]];
    }
  }
  mesh.vertices.resize(kept);
  for (TriangleCorners& corners : mesh.triangles) {
    for (std::uint32_t& corner : corners) {
      corner = number[corner];
    }
  }
}

std::vector<std::uint32_t> duplicate_triangles(const TriangleMesh& mesh, const std::vector<std::uint32_t>& first_equal) {
  const auto sorted = [&](std::uint32_t i) {
    TriangleCorners corners = mesh.triangles[i];
    for (std::uint32_t& corner : corners) {
      corner = first_equal[corner];
    }
    std::sort(corners.begin(), corners.end());
    return corners;
  };
  IndexTable table(mesh.triangles.size());
  std::vector<std::uint32_t> duplicates;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const TriangleCorners corners = sorted(i);
    const std::uint32_t first =
        table.find_or_add(hash_of(corners), i, [&](std::uint32_t other) { return sorted(other) == corners; });
    if (first != i) {
      duplicates.push_back(i);
    }
  }
  return duplicates;
}

}  // namespace collided
