#include "server/intake/weld.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>
#include <utility>

#include "server/intake/mixed.hpp"

namespace collided::engine {
namespace {

constexpr std::uint32_t kFree = 0xffffffff;

std::uint64_t hash_of(const Vec3& point) {
  const auto bits = [&](int axis) { return std::bit_cast<std::uint64_t>(point[axis] + 0.0); };  // -0 + 0 is 0
  // Odd factors without a pattern: two places have different sums unless three products happen to cancel.
  return mixed(bits(0) * 0x9e3779b97f4a7c15u + bits(1) * 0xc2b2ae3d27d4eb4fu + bits(2) * 0x165667b19e3779f9u);
}

bool is_same_place(const Vec3& a, const Vec3& b) { return a[0] == b[0] && a[1] == b[1] && a[2] == b[2]; }

std::uint64_t hash_of(const TriangleCorners& corners) {
  return mixed(mixed(std::uint64_t{corners[0]} << 32 | corners[1]) + corners[2]);
}

/// A hash table with open addressing that stores only the numbers of items, which stay where they are.
class IndexTable {
 public:
  explicit IndexTable(std::size_t count) : slots_(std::bit_ceil(4 * count + 1), kFree) {}

  /// The number of the first equal item, which is `index` itself if there is none yet.
  template <class Equal>
  std::uint32_t find_or_add(std::uint64_t hash, std::uint32_t index, const Equal& equals) {
    const std::size_t mask = slots_.size() - 1;
    for (std::size_t slot = hash & mask;; slot = (slot + 1) & mask) {
      if (slots_[slot] == kFree) {
        slots_[slot] = index;
        return index;
      }
      if (equals(slots_[slot])) { return slots_[slot]; }
    }
  }

 private:
  std::vector<std::uint32_t> slots_;
};

/// A set of hashes with false positives: a bit field of 16 to 32 bits for each of `count` hashes.
class HashMarks {
 public:
  explicit HashMarks(std::size_t count)
      : words_(std::bit_ceil(std::max<std::size_t>(count / 4, 1024))), mask_(words_.size() - 1) {}

  void fetch(std::uint64_t hash) const { __builtin_prefetch(&words_[hash / 64 & mask_], 1); }
  bool has(std::uint64_t hash) const { return (words_[hash / 64 & mask_] >> (hash % 64) & 1) != 0; }
  void add(std::uint64_t hash) { words_[hash / 64 & mask_] |= std::uint64_t{1} << (hash % 64); }

 private:
  std::vector<std::uint64_t> words_;
  std::size_t mask_;
};

/// The items, in ascending order, whose hash may occur twice: all that have an equal, including the first of each, and
/// at most about a tenth of the others. If hardly any are equal, as in most meshes, only these need a table; the marks
/// take 2 to 4 bytes per item.
/// source   Bloom, "Space/time trade-offs in hash coding with allowable errors", 1970, with one hash
template <class HashOf>
std::vector<std::uint32_t> likely_equal(std::uint32_t count, const HashOf& hash_of_thing) {
  constexpr std::uint32_t kBlock = 64;  // items whose marks are prefetched together
  std::vector<std::uint32_t> hashes(count);
  std::vector<std::uint32_t> met_again;
  HashMarks met(count);
  for (std::uint32_t first = 0; first < count; first += std::min(kBlock, count - first)) {
    const std::uint32_t end = first + std::min(kBlock, count - first);
    for (std::uint32_t i = first; i < end; ++i) {
      hashes[i] = static_cast<std::uint32_t>(hash_of_thing(i));
      met.fetch(hashes[i]);
    }
    for (std::uint32_t i = first; i < end; ++i) {
      if (met.has(hashes[i])) met_again.push_back(hashes[i]);
      else met.add(hashes[i]);
    }
  }
  // The second round uses other bits of the hashes, so it removes most that agreed by chance.
  HashMarks doubtful(2 * met_again.size());
  for (const std::uint32_t hash : met_again) doubtful.add(mixed(hash));
  std::vector<std::uint32_t> likely;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (doubtful.has(mixed(hashes[i]))) likely.push_back(i);
  }
  return likely;
}

}  // namespace

std::vector<std::uint32_t> first_equal_vertices(const std::vector<Vec3>& vertices) {
  const auto count = static_cast<std::uint32_t>(vertices.size());
  std::vector<std::uint32_t> first(count);
  std::iota(first.begin(), first.end(), 0u);
  const auto candidates = likely_equal(count, [&](std::uint32_t i) { return hash_of(vertices[i]); });
  IndexTable table(candidates.size());
  for (const std::uint32_t i : candidates) {
    first[i] = table.find_or_add(hash_of(vertices[i]), i,
                                 [&](std::uint32_t other) { return is_same_place(vertices[other], vertices[i]); });
  }
  return first;
}

Welder::Welder(std::vector<Vec3>& kept, std::size_t expected_count)
    : kept_(kept), slots_(std::bit_ceil(std::max<std::size_t>(2 * expected_count, 1024)), kFree) {}

std::uint32_t Welder::number_of(const Vec3& vertex) { return find_or_keep(vertex, hash_of(vertex)); }

void Welder::number(std::span<const Vec3> vertices, std::uint32_t* numbers) {
  std::array<std::uint64_t, kBatch> hashes;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    hashes[i] = hash_of(vertices[i]);
    __builtin_prefetch(&slots_[hashes[i] & (slots_.size() - 1)]);
  }
  for (std::size_t i = 0; i < vertices.size(); ++i) numbers[i] = find_or_keep(vertices[i], hashes[i]);
}

std::uint32_t Welder::find_or_keep(const Vec3& vertex, std::uint64_t hash) {
  const std::size_t mask = slots_.size() - 1;
  std::size_t slot = hash & mask;
  for (; slots_[slot] != kFree; slot = (slot + 1) & mask) {
    if (is_same_place(kept_[slots_[slot]], vertex)) return slots_[slot];
  }
  const auto number = static_cast<std::uint32_t>(kept_.size());
  slots_[slot] = number;
  kept_.push_back(vertex);
  if (2 * kept_.size() > slots_.size()) grow();
  return number;
}

void Welder::grow() {
  slots_.assign(2 * slots_.size(), kFree);
  const std::size_t mask = slots_.size() - 1;
  for (std::uint32_t i = 0; i < kept_.size(); ++i) {
    std::size_t slot = hash_of(kept_[i]) & mask;
    while (slots_[slot] != kFree) slot = (slot + 1) & mask;
    slots_[slot] = i;
  }
}

void weld_equal_vertices(TriangleMesh& mesh) {
  const std::vector<Vec3> vertices = std::exchange(mesh.vertices, {});
  Welder welder(mesh.vertices);
  std::vector<std::uint32_t> numbers;
  numbers.reserve(vertices.size());
  for (const Vec3& vertex : vertices) numbers.push_back(welder.number_of(vertex));
  for (TriangleCorners& corners : mesh.triangles) {
    for (std::uint32_t& corner : corners) corner = numbers[corner];
  }
}

std::vector<std::uint32_t> duplicate_triangles(const TriangleMesh& mesh,
                                               const std::vector<std::uint32_t>& first_equal) {
  const auto sorted = [&](std::uint32_t i) {
    TriangleCorners corners = mesh.triangles[i];
    for (std::uint32_t& corner : corners) corner = first_equal[corner];
    const auto put_in_order = [&](std::size_t low, std::size_t high) {
      const std::uint32_t least = std::min(corners[low], corners[high]);
      corners[high] = std::max(corners[low], corners[high]);
      corners[low] = least;
    };
    put_in_order(0, 1);
    put_in_order(1, 2);
    put_in_order(0, 1);
    return corners;
  };
  const auto candidates = likely_equal(static_cast<std::uint32_t>(mesh.triangles.size()),
                                       [&](std::uint32_t i) { return hash_of(sorted(i)); });
  IndexTable table(candidates.size());
  std::vector<std::uint32_t> duplicates;
  for (const std::uint32_t i : candidates) {
    const TriangleCorners corners = sorted(i);
    const std::uint32_t first =
        table.find_or_add(hash_of(corners), i, [&](std::uint32_t other) { return sorted(other) == corners; });
    if (first != i) duplicates.push_back(i);
  }
  return duplicates;
}

}  // namespace collided::engine
