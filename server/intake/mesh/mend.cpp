#include "server/intake/mesh/mend.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <unordered_map>
#include <utility>
#include <memory>
#include <numeric>

#include "server/intake/disjoint_sets.hpp"
#include "server/intake/mesh/mesh_health.hpp"
#include "server/intake/weld.hpp"

namespace collided::engine {
namespace {

/// Most rounds: cutting an edge can put a point beside another edge. Real files take three rounds; the limit ensures
/// that the loop ends.
constexpr int kMostRounds = 8;

/// The findings of a round in the present mesh.
struct SeamRound {
  std::vector<std::uint32_t> point_of;
  EdgeTable edges;
  std::vector<Seam> seams;
  std::uint64_t unseen_count = 0;
  std::uint64_t boundary_edge_count = 0;
};

SeamRound look(const TriangleMesh& mesh, const SeamReach& reach, const Aabb& bounds) {
  SeamRound found;
  found.point_of = first_equal_vertices(mesh.vertices);
  std::vector<bool> is_flat(mesh.triangles.size());
  for (std::uint32_t i = 0; i < is_flat.size(); ++i) is_flat[i] = has_zero_area(mesh.triangle(i));
  found.edges = edge_table(mesh, found.point_of, is_flat);
  for (std::size_t i = 0; i < found.edges.size(); ++i) {
    found.boundary_edge_count += found.edges.uses_of(i).size() == 1 ? 1 : 0;
  }
  Seams seams = find_seams(mesh, found.edges, found.point_of, reach, bounds);
  found.seams = std::move(seams.list);
  found.unseen_count = seams.unseen_count;
  return found;
}

/// Moves points beside each other to the first of them, smallest gaps first; no point goes farther than crack_m.
bool join_points(const SeamRound& found, double crack_m, TriangleMesh& mesh, MendReport& report) {
  std::vector<const Seam*> pairs;
  for (const Seam& seam : found.seams) {
    if (seam.kind == Seam::Kind::beside_point) pairs.push_back(&seam);
  }
  std::stable_sort(pairs.begin(), pairs.end(), [](const Seam* a, const Seam* b) { return a->gap_m < b->gap_m; });
  DisjointSets places(mesh.vertices.size());
  for (const Seam* pair : pairs) {
    const std::uint32_t one = places.find(pair->point);
    const std::uint32_t other = places.find(pair->other_point);
    if ((mesh.vertices[one] - mesh.vertices[other]).norm() <= crack_m) places.join(one, other);
  }
  std::uint64_t joined = 0;
  for (std::uint32_t i = 0; i < mesh.vertices.size(); ++i) {
    const std::uint32_t place = places.find(found.point_of[i]);
    if (place == found.point_of[i]) continue;
    report.largest_move_m = std::max(report.largest_move_m, (mesh.vertices[i] - mesh.vertices[place]).norm());
    joined += found.point_of[i] == i ? 1 : 0;
    mesh.vertices[i] = mesh.vertices[place];
  }
  report.joined_point_count += joined;
  return joined > 0;
}

/// A triangle with the points that its sides must go through, in their order along each side.
struct EdgeCut {
  TriangleCorners corners{};
  std::array<std::vector<std::uint32_t>, 3> points;
};

/// Cuts a triangle into fans from the corner opposite each side in turn, so that every piece has an area if the whole
/// has one.
void cut_up(EdgeCut whole, std::vector<TriangleCorners>& pieces) {
  std::vector<EdgeCut> waiting{std::move(whole)};
  while (!waiting.empty()) {
    EdgeCut cut = std::move(waiting.back());
    waiting.pop_back();
    std::size_t k = 0;
    while (k < 3 && cut.points[k].empty()) ++k;
    if (k == 3) {
      pieces.push_back(cut.corners);
      continue;
    }
    const std::size_t next = (k + 1) % 3;
    const std::size_t last = (k + 2) % 3;
    std::vector<std::uint32_t> along{cut.corners[k]};
    along.insert(along.end(), cut.points[k].begin(), cut.points[k].end());
    along.push_back(cut.corners[next]);
    const std::size_t piece_count = along.size() - 1;
    for (std::size_t i = piece_count; i-- > 0;) {  // in reverse, since the last one pushed is cut first
      EdgeCut piece{.corners = {along[i], along[i + 1], cut.corners[last]}, .points = {}};
      if (i + 1 == piece_count) piece.points[1] = cut.points[next];
      if (i == 0) piece.points[2] = cut.points[last];
      waiting.push_back(std::move(piece));
    }
  }
}

bool cut_edges(const SeamRound& found, MendedMesh& mended) {
  std::map<std::uint32_t, EdgeCut> cuts;  // sorted by triangle, so that pieces follow the order of the file
  MendReport& report = mended.report;
  for (const Seam& seam : found.seams) {
    if (seam.kind == Seam::Kind::beside_point) continue;
    const std::uint32_t triangle = triangle_of(seam.edge);
    const auto [entry, is_new] = cuts.try_emplace(triangle);
    if (is_new) entry->second.corners = mended.mesh.triangles[triangle];
    entry->second.points[seam.edge % 3].push_back(seam.point);
    ++(seam.kind == Seam::Kind::t_vertex ? report.t_vertex_count : report.closed_edge_count);
    if (seam.kind == Seam::Kind::beside_edge) report.largest_move_m = std::max(report.largest_move_m, seam.gap_m);
  }
  std::vector<TriangleCorners> pieces;
  for (auto& [triangle, cut] : cuts) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& from = mended.mesh.vertices[cut.corners[k]];
      std::sort(cut.points[k].begin(), cut.points[k].end(), [&](std::uint32_t a, std::uint32_t b) {
        return (mended.mesh.vertices[a] - from).squaredNorm() < (mended.mesh.vertices[b] - from).squaredNorm();
      });
    }
    pieces.clear();
    cut_up(std::move(cut), pieces);
    mended.mesh.triangles[triangle] = pieces.front();
    mended.mesh.triangles.insert(mended.mesh.triangles.end(), pieces.begin() + 1, pieces.end());
    mended.origin.resize(mended.mesh.triangles.size(), mended.origin[triangle]);
  }
  return !cuts.empty();
}

/// Moves the pieces to the ends of their parts.
void arrange(MendedMesh& mended, std::size_t came_count, Scene& scene) {
  const std::vector<TriangleCorners>& all = mended.mesh.triangles;
  std::vector<std::uint32_t> extra(all.size() - came_count);
  std::iota(extra.begin(), extra.end(), static_cast<std::uint32_t>(came_count));
  std::stable_sort(extra.begin(), extra.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return mended.origin[a] < mended.origin[b]; });
  std::vector<TriangleCorners> arranged;
  arranged.reserve(all.size());
  auto next = extra.begin();
  for (Part& part : scene.parts) {
    const auto first = static_cast<std::uint32_t>(arranged.size());
    const std::uint32_t end = part.first_triangle + part.triangle_count;
    arranged.insert(arranged.end(), all.begin() + part.first_triangle, all.begin() + end);
    std::vector<std::uint32_t> piece_of;
    if (part.cut.piece_of) piece_of = *part.cut.piece_of;
    for (; next != extra.end() && mended.origin[*next] < end; ++next) {
      arranged.push_back(all[*next]);
      piece_of.push_back(part.cut.told(mended.origin[*next] - part.first_triangle, part.triangle_count));
    }
    part.first_triangle = first;
    part.triangle_count = static_cast<std::uint32_t>(arranged.size()) - first;
    if (!piece_of.empty()) part.cut.piece_of = std::make_shared<const std::vector<std::uint32_t>>(std::move(piece_of));
  }
  mended.mesh.triangles = std::move(arranged);
}

}  // namespace

MendedMesh mend(TriangleMesh mesh, double crack_m) {
  MendedMesh mended;
  mended.mesh = std::move(mesh);
  const std::size_t came_count = mended.mesh.triangles.size();
  mended.origin.resize(came_count);
  std::iota(mended.origin.begin(), mended.origin.end(), 0u);
  Aabb bounds;
  for (const Vec3& vertex : mended.mesh.vertices) bounds.extend(vertex);
  const SeamReach reach = seam_reach(mended.mesh, bounds, crack_m);
  mended.report.crack_m = reach.crack_m;
  SeamRound found = look(mended.mesh, reach, bounds);
  mended.report.boundary_edges_before = found.boundary_edge_count;
  for (int round = 0; round < kMostRounds && !found.seams.empty(); ++round) {
    // Edges are cut only in a round that moves no point.
    const bool changed = join_points(found, reach.crack_m, mended.mesh, mended.report) || cut_edges(found, mended);
    if (!changed) break;
    found = look(mended.mesh, reach, bounds);
  }
  mended.report.boundary_edges_after = found.boundary_edge_count;
  mended.report.unseen_point_count = found.unseen_count;
  std::vector<bool> is_cut(came_count, false);
  for (std::size_t i = came_count; i < mended.origin.size(); ++i) {
    mended.report.cut_triangle_count += is_cut[mended.origin[i]] ? 0 : 1;
    is_cut[mended.origin[i]] = true;
  }
  return mended;
}

MendReport mend(Scene& scene, double crack_m) {
  const std::size_t came_count = scene.mesh.triangles.size();
  MendedMesh mended = mend(std::move(scene.mesh), crack_m);
  if (mended.mesh.triangles.size() > came_count) arrange(mended, came_count, scene);
  scene.mesh = std::move(mended.mesh);
  if (mended.report.did_anything()) {
    // Both refer to the old numbers of triangles and vertices.
    scene.index = {};
    scene.collapses = {};
  }
  return mended.report;
}

namespace {

/// A mended mesh that several objects may share.
struct MendedShared {
  std::shared_ptr<const TriangleMesh> mesh;
  CutTriangles cut;
};

MendedShared mend_shared(const SceneObject& object, double crack_m, MendReport& report) {
  const auto came_count = static_cast<std::uint32_t>(object.shape.mesh->triangles.size());
  MendedMesh mended = mend(*object.shape.mesh, crack_m);
  report = mended.report;
  if (!report.did_anything()) return {object.shape.mesh, object.cut};
  std::vector<std::uint32_t> piece_of;
  if (object.cut.piece_of) piece_of = *object.cut.piece_of;
  for (std::size_t i = came_count; i < mended.origin.size(); ++i) {
    piece_of.push_back(object.cut.told(mended.origin[i], came_count));
  }
  CutTriangles cut;
  if (!piece_of.empty()) cut.piece_of = std::make_shared<const std::vector<std::uint32_t>>(std::move(piece_of));
  return {std::make_shared<const TriangleMesh>(std::move(mended.mesh)), std::move(cut)};
}

}  // namespace

std::vector<std::string> mend_objects(Scene& scene, double crack_m) {
  std::unordered_map<const TriangleMesh*, MendedShared> done;
  std::vector<std::shared_ptr<const TriangleMesh>> came;  // kept alive: no new mesh gets an old address
  std::vector<std::string> lines;
  std::size_t untouched_count = 0;
  for (SceneObject& object : scene.objects) {
    if (!object.shape.mesh) continue;
    const auto [entry, is_new] = done.try_emplace(object.shape.mesh.get());
    if (is_new) {
      MendReport report;
      entry->second = mend_shared(object, crack_m, report);
      untouched_count += report.did_anything() ? 0 : 1;
      if (report.did_anything() || report.unseen_point_count > 0) {
        for (const std::string& line : sentences(report)) lines.push_back(object.name + ": " + line);
      }
    }
    if (entry->second.mesh == object.shape.mesh) continue;
    came.push_back(std::exchange(object.shape.mesh, entry->second.mesh));
    object.cut = entry->second.cut;
    object.index = {};
  }
  if (untouched_count > 0)
    lines.push_back(fmt::format("nothing of the meshes of {} objects: no T-vertex and no crack", untouched_count));
  return lines;
}

std::vector<std::string> sentences(const MendReport& report) {
  std::vector<std::string> lines;
  if (report.joined_point_count > 0) {
    lines.push_back(fmt::format("{} points joined with the one beside them", report.joined_point_count));
  }
  if (report.t_vertex_count > 0)
    lines.push_back(fmt::format("{} T-vertices: the edges cut there", report.t_vertex_count));
  if (report.closed_edge_count > 0) {
    lines.push_back(
        fmt::format("{} cracks: the edges cut and bent to the points beside them", report.closed_edge_count));
  }
  if (report.unseen_point_count > 0) {
    lines.push_back(fmt::format("{} points of the border not looked at: too many borders lie near each other",
                                report.unseen_point_count));
  }
  if (!report.did_anything() && lines.empty())
    return {fmt::format("nothing: no T-vertex and no crack up to {:.3g} m", report.crack_m)};
  if (!report.did_anything()) return lines;
  lines.push_back(
      fmt::format("{} triangles are several now, under the numbers they had; nothing moved by more than {:.3g} m "
                  "(cracks up to {:.3g} m); edges of one triangle: {}, before {}",
                  report.cut_triangle_count, report.largest_move_m, report.crack_m, report.boundary_edges_after,
                  report.boundary_edges_before));
  return lines;
}

}  // namespace collided::engine
