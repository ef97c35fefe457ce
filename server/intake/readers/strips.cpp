#include "server/intake/readers/strips.hpp"

#include <algorithm>
#include <numeric>
#include <optional>
#include <utility>

namespace collided::engine {
namespace {

/// The triangles that are in no strip or fan yet, by their directed edges.
class FreeTriangles {
 public:
  explicit FreeTriangles(const TriangleMesh& mesh) : mesh_(mesh), is_taken_(mesh.triangles.size(), false) {
    edges_.reserve(3 * mesh.triangles.size());
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      for (std::uint32_t k = 0; k < 3; ++k)
        edges_.push_back({key(mesh.triangles[i][k], mesh.triangles[i][(k + 1) % 3]), i});
    }
    std::sort(edges_.begin(), edges_.end());
  }

  bool is_taken(std::uint32_t triangle) const { return is_taken_[triangle]; }
  void take(std::uint32_t triangle) { is_taken_[triangle] = true; }
  void give_back(std::uint32_t triangle) { is_taken_[triangle] = false; }

  /// A free triangle that has the directed edge from a to b.
  std::optional<std::uint32_t> along(std::uint32_t a, std::uint32_t b) const {
    const std::uint64_t wanted = key(a, b);
    for (auto at = std::lower_bound(edges_.begin(), edges_.end(), std::pair(wanted, 0u));
         at != edges_.end() && at->first == wanted; ++at) {
      if (!is_taken_[at->second]) return at->second;
    }
    return std::nullopt;
  }

  /// The third corner of a triangle that has the directed edge from a to b.
  std::uint32_t tip(std::uint32_t triangle, std::uint32_t a, std::uint32_t b) const {
    const TriangleCorners& c = mesh_.triangles[triangle];
    for (std::size_t k = 0; k < 3; ++k) {
      if (c[k] == a && c[(k + 1) % 3] == b) return c[(k + 2) % 3];
    }
    return c[0];
  }

 private:
  static std::uint64_t key(std::uint32_t a, std::uint32_t b) { return std::uint64_t{a} << 32 | b; }

  const TriangleMesh& mesh_;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> edges_;
  std::vector<bool> is_taken_;
};

/// Takes a fan around the corner `center`: free triangles starting with the given one, as far as they go.
std::vector<std::uint32_t> fan_from(FreeTriangles& free, std::uint32_t center, std::uint32_t second,
                                    std::uint32_t triangle) {
  std::vector<std::uint32_t> fan{center, second};
  std::optional<std::uint32_t> next = triangle;
  while (next) {
    free.take(*next);
    fan.push_back(free.tip(*next, center, fan.back()));
    next = free.along(center, fan.back());
  }
  return fan;
}

/// Takes the strip that begins with the triangle's corners, from a given corner on.
std::vector<std::uint32_t> strip_from(const TriangleMesh& mesh, FreeTriangles& free, std::uint32_t triangle,
                                      std::size_t first, std::vector<std::uint32_t>& taken) {
  const TriangleCorners& c = mesh.triangles[triangle];
  std::vector<std::uint32_t> strip{c[first], c[(first + 1) % 3], c[(first + 2) % 3]};
  taken.assign(1, triangle);
  free.take(triangle);
  while (true) {
    // Triangle i of the strip runs from vertex i to i + 1 if i is even, the other way if it is odd.
    const std::size_t i = strip.size() - 2;
    const std::uint32_t a = strip[i + i % 2];
    const std::uint32_t b = strip[i + 1 - i % 2];
    const std::optional<std::uint32_t> next = free.along(a, b);
    if (!next) return strip;
    free.take(*next);
    taken.push_back(*next);
    strip.push_back(free.tip(*next, a, b));
  }
}

std::size_t vertex_count(const Runs& runs) {
  return std::accumulate(runs.begin(), runs.end(), std::size_t{0},
                         [](std::size_t sum, const auto& run) { return sum + run.size(); });
}

}  // namespace

Runs fans_of(const TriangleMesh& mesh) {
  FreeTriangles free(mesh);
  std::vector<std::uint32_t> uses(mesh.vertices.size(), 0);
  for (const TriangleCorners& corners : mesh.triangles) {
    for (const std::uint32_t corner : corners) ++uses[corner];
  }
  std::vector<std::uint32_t> by_place(mesh.triangles.size() * 3);
  std::iota(by_place.begin(), by_place.end(), 0u);
  std::stable_sort(by_place.begin(), by_place.end(), [&](std::uint32_t a, std::uint32_t b) {
    const std::uint32_t va = mesh.triangles[a / 3][a % 3];
    const std::uint32_t vb = mesh.triangles[b / 3][b % 3];
    return uses[va] != uses[vb] ? uses[va] > uses[vb] : va < vb;
  });
  Runs fans;
  for (const std::uint32_t place : by_place) {
    if (free.is_taken(place / 3)) continue;
    const TriangleCorners& c = mesh.triangles[place / 3];
    fans.push_back(fan_from(free, c[place % 3], c[(place % 3 + 1) % 3], place / 3));
  }
  return fans;
}

Runs strips_of(const TriangleMesh& mesh) {
  FreeTriangles free(mesh);
  Runs strips;
  std::vector<std::uint32_t> taken;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    if (free.is_taken(i)) continue;
    std::size_t best = 0;
    std::size_t longest = 0;
    for (std::size_t first = 0; first < 3; ++first) {
      const std::size_t length = strip_from(mesh, free, i, first, taken).size();
      for (const std::uint32_t triangle : taken) free.give_back(triangle);
      if (length > longest) best = first, longest = length;
    }
    strips.push_back(strip_from(mesh, free, i, best, taken));
  }
  return strips;
}

std::vector<EncodingSize> encoding_sizes(const TriangleMesh& mesh) {
  constexpr std::size_t kVertexBytes = 24;
  const auto with_runs = [](const Runs& runs) { return vertex_count(runs) * kVertexBytes + runs.size() * 4; };
  std::vector<EncodingSize> sizes{
      {"list", 3 * mesh.triangles.size() * kVertexBytes},
      {"fans", with_runs(fans_of(mesh))},
      {"strips", with_runs(strips_of(mesh))},
      {"mesh", mesh.vertices.size() * kVertexBytes + mesh.triangles.size() * sizeof(TriangleCorners)}};
  const double count = static_cast<double>(std::max<std::size_t>(1, mesh.triangles.size()));
  for (EncodingSize& size : sizes) size.bytes_a_triangle = static_cast<double>(size.bytes) / count;
  return sizes;
}

}  // namespace collided::engine
