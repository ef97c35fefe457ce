#include "server/programs/files/mesh_findings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>

#include "server/exact_phase/edge_kinds.hpp"
#include "server/programs/files/file_options.hpp"
#include "server/programs/files/interrupt.hpp"

namespace collided::engine::files {
namespace {

/// The number of each triangle's part; parts come from a file's materials and groups.
std::vector<std::uint32_t> part_numbers(const TriangleMesh& mesh, const std::vector<Part>& parts) {
  std::vector<std::uint32_t> numbers(mesh.triangles.size());
  for (std::uint32_t i = 0; i < parts.size(); ++i) {
    std::fill_n(numbers.begin() + parts[i].first_triangle, parts[i].triangle_count, i);
  }
  return numbers;
}

/// One fault at a triangle, and its severity.
struct TriangleFault {
  std::uint32_t triangle = 0;
  double size_m = 0;
  std::string detail{};
  std::optional<std::uint32_t> with{};  // the triangle that it meets
};

class Findings {
 public:
  Findings(const CheckedMesh& checked, std::size_t worst_count) : c_(checked), worst_count_(worst_count) {}

  std::vector<MeshFinding> all() {
    add_edges();
    add_triangles();
    add_seams();
    return std::move(findings_);
  }

 private:
  double length_m(HalfEdge half) const {
    const TriangleCorners& corners = c_.mesh->triangles[triangle_of(half)];
    return (c_.mesh->vertices[corners[half % 3]] - c_.mesh->vertices[corners[(half % 3 + 1) % 3]]).norm();
  }
  double longest_m(std::uint32_t triangle) const {
    return std::max({length_m(3 * triangle), length_m(3 * triangle + 1), length_m(3 * triangle + 2)});
  }

  NamedTriangle named(std::uint32_t triangle) const {
    if (c_.parts == nullptr)
      return {c_.name, c_.cut.told(triangle, static_cast<std::uint32_t>(c_.mesh->triangles.size()))};
    const auto after = std::upper_bound(c_.parts->begin(), c_.parts->end(), triangle,
                                        [](std::uint32_t t, const Part& part) { return t < part.first_triangle; });
    const Part& part = *(after - 1);
    return {part.name, part.cut.told(triangle - part.first_triangle, part.triangle_count)};
  }

  FindingPlace place(const TriangleFault& item) const {
    NamedTriangle at = named(item.triangle);
    FindingPlace place{std::move(at.object), at.triangle, item.detail};
    if (item.with) place.with = named(*item.with);
    return place;
  }

  void add(const char* key, const char* what, std::uint64_t count, std::vector<TriangleFault> items,
           std::string consequence) {
    if (count == 0) return;
    const std::size_t kept = std::min(items.size(), worst_count_);
    std::stable_sort(items.begin(), items.end(),
                     [](const TriangleFault& a, const TriangleFault& b) { return a.size_m > b.size_m; });
    MeshFinding finding{key, what, count, {}, std::move(consequence)};
    for (std::size_t i = 0; i < kept; ++i) finding.worst.push_back(place(items[i]));
    findings_.push_back(std::move(finding));
  }

  std::vector<TriangleFault> sides(const std::vector<HalfEdge>& halves) const {
    std::vector<TriangleFault> items;
    for (const HalfEdge half : halves) {
      items.push_back({triangle_of(half), length_m(half), fmt::format("side {}", half - 3 * triangle_of(half))});
    }
    return items;
  }
  std::vector<TriangleFault> triangles(const std::vector<std::uint32_t>& numbers) const {
    std::vector<TriangleFault> items;
    for (const std::uint32_t number : numbers) items.push_back({number, longest_m(number)});
    return items;
  }

  void add_edges() {
    const MeshHealth& h = c_.health;
    add("boundary_edges", "boundary edges", h.boundary_edge_count, sides(h.boundary_edges),
        "kept; the surface is open: nothing is inside");
    add("nonmanifold_edges", "edges of 3 and more", h.nonmanifold_edge_count, sides(h.nonmanifold_edges),
        "kept; each triangle answers by itself");
    std::vector<TriangleFault> twice;
    for (std::size_t i = 0; i < h.edges.size(); ++i) {
      if (!h.edges.is_inconsistent(i)) continue;
      const HalfEdge half = h.edges.uses_of(i)[0];
      twice.push_back({triangle_of(half), length_m(half), fmt::format("side {}", half - 3 * triangle_of(half))});
    }
    add("inconsistent_edges", "run along twice", h.inconsistent_edge_count, std::move(twice),
        "kept; triangles are met from both sides");
    add("unorientable", "one-sided pieces", h.unorientable_count, {}, "kept; no side of it is outside");
    std::vector<TriangleFault> pinched;
    for (const std::uint32_t point : h.pinched_points)
      pinched.push_back({triangle_at(point), 0, fmt::format("vertex {}", point)});
    add("pinched_points", "pinched points", h.pinched_points.size(), std::move(pinched),
        "kept; several surfaces touch there");
  }

  /// The first triangle that has this vertex; the table is made at the first call.
  std::uint32_t triangle_at(std::uint32_t point) {
    if (first_triangles_.empty()) {
      first_triangles_.assign(c_.mesh->vertices.size(), 0);
      for (auto i = static_cast<std::uint32_t>(c_.mesh->triangles.size()); i-- > 0;) {
        for (const std::uint32_t corner : c_.mesh->triangles[i]) first_triangles_[corner] = i;
      }
    }
    return first_triangles_[point];
  }

  void add_triangles() {
    const MeshHealth& h = c_.health;
    add("flipped", "turned over", h.flipped.size(), triangles(h.flipped), "kept; their normals point the other way");
    add("zero_area", "without area", h.zero_area_count, triangles(h.zero_area),
        "kept as the segments or points they are");
    add("duplicates", "repeat another", h.duplicate_count, triangles(h.duplicates), "kept; the first of them is named");
    std::vector<TriangleFault> crossings;
    for (const TrianglePair& pair : c_.crossings.pairs) {
      if (crossings.size() == worst_count_) break;
      crossings.push_back({pair.a, 0, {}, pair.b});
    }
    add("self_intersections", "meet each other", c_.crossings.pairs.size(), std::move(crossings),
        c_.parts != nullptr && c_.parts->size() > 1 ? "normal where parts join or overlap; every triangle counts"
                                                    : "kept; every triangle counts");
  }

  void add_seams() {
    std::vector<TriangleFault> t_vertices;
    std::vector<TriangleFault> cracks;
    for (const Seam& seam : c_.health.seams) {
      const std::uint32_t triangle = triangle_of(seam.edge);
      const std::string detail =
          fmt::format("side {} at vertex {}, gap {:.3g} m", seam.edge - 3 * triangle, seam.point, seam.gap_m);
      (seam.kind == Seam::Kind::t_vertex ? t_vertices : cracks).push_back({triangle, seam.gap_m, detail});
    }
    const std::size_t t_count = t_vertices.size();
    const std::size_t crack_count = cracks.size();
    add("t_vertices", "T-vertices", t_count, std::move(t_vertices),
        "kept; a ray may pass between their roundings; --mend cuts the edges there");
    add("cracks", "cracks", crack_count, std::move(cracks),
        fmt::format("kept; rays pass; looked for up to {:.3g} m (--crack); --mend closes them",
                    c_.health.seam_reach.crack_m));
  }

  const CheckedMesh& c_;
  std::size_t worst_count_;
  std::vector<MeshFinding> findings_;
  std::vector<std::uint32_t> first_triangles_;
};

}  // namespace

CheckedMesh check_mesh(std::string name, const TriangleMesh& mesh, const std::vector<Part>* parts,
                       const Scrutiny& scrutiny, const std::function<void(double)>& progress) {
  // Shares of the time, measured with a million triangles.
  constexpr double kHealth = 0.15;
  constexpr double kEdges = 0.25;
  constexpr double kIndex = 0.5;
  CheckedMesh checked{.name = std::move(name),
                      .mesh = &mesh,
                      .parts = parts,
                      .health = examine(mesh, scrutiny.crack_m),
                      .crossings = {}};
  progress(kHealth);
  end_if_interrupted();
  const std::vector<std::uint32_t> numbers =
      parts != nullptr ? part_numbers(mesh, *parts) : std::vector<std::uint32_t>{};
  const EdgeView view{.crease_cosine = std::cos(scrutiny.crease_deg * std::numbers::pi / 180),
                      .material = numbers,
                      .eye = scrutiny.eye};
  const std::vector<std::uint8_t> kinds = edge_kinds(mesh, checked.health.edges, view);
  const auto count = [&](EdgeKind asked) {
    return static_cast<std::uint64_t>(
        std::count_if(kinds.begin(), kinds.end(), [&](std::uint8_t kind) { return (kind & asked) != 0; }));
  };
  checked.crease_edge_count = count(kCreaseEdge);
  checked.material_edge_count = count(kMaterialEdge);
  if (scrutiny.eye) checked.silhouette_edge_count = count(kSilhouetteEdge);
  progress(kEdges);
  end_if_interrupted();
  const auto tell_index = [&](double fraction) { progress(kEdges + (kIndex - kEdges) * fraction); };
  const Bvh tree = Bvh::build(mesh, {.progress = tell_index, .cancelled = is_interrupted});
  end_if_interrupted();
  const auto tell_search = [&](double fraction) { progress(kIndex + (1 - kIndex) * fraction); };
  checked.crossings = self_intersections(mesh, tree, {.progress = tell_search, .cancelled = is_interrupted});
  end_if_interrupted();
  return checked;
}

std::vector<MeshFinding> findings_of(const CheckedMesh& checked, std::size_t worst_count) {
  return Findings(checked, worst_count).all();
}

std::vector<MeshFinding> by_weight(std::vector<MeshFinding> findings) {
  constexpr std::string_view kHeaviestFirst[] = {
      "cracks",       "t_vertices",     "flipped",           "inconsistent_edges",
      "unorientable", "boundary_edges", "nonmanifold_edges", "zero_area",
      "duplicates",   "pinched_points", "self_intersections"};
  const auto weight = [&](const MeshFinding& finding) {
    return std::find(std::begin(kHeaviestFirst), std::end(kHeaviestFirst), finding.key);
  };
  std::stable_sort(findings.begin(), findings.end(),
                   [&](const MeshFinding& a, const MeshFinding& b) { return weight(a) < weight(b); });
  return findings;
}

}  // namespace collided::engine::files
