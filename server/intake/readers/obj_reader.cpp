#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <utility>

#include "server/intake/limits.hpp"
#include "server/intake/parallel.hpp"
#include "server/intake/polygons/polygon_counts.hpp"
#include "server/intake/polygons/triangulate.hpp"
#include "server/intake/readers/obj_chunk.hpp"
#include "server/intake/readers/reading.hpp"

namespace collided::engine {
namespace {

/// The object, group and material that a face belongs to. An `o` line begins a new object even if the name occurred
/// before; a group or material with an earlier name is the same one.
struct Belonging {
  std::uint64_t object_number = 0;
  std::string_view group;
  std::string_view material;
  auto operator<=>(const Belonging&) const = default;  // NOLINT(modernize-use-nullptr): it compares with 0
};

/// A run of faces of one chunk that belong to one part, and the end of its triangles in the chunk.
struct FaceRun {
  std::size_t chunk_index;
  std::size_t first_face;
  std::size_t end_face;
  std::size_t part_index;
  std::size_t first_triangle = 0;
  std::size_t end_triangle = 0;
};

/// A polygon that crosses itself, and the begin of its triangles in the chunk.
struct CrossingFace {
  std::vector<std::uint32_t> corners;
  std::size_t first_triangle;
};

struct ChunkTriangles {
  std::vector<TriangleCorners> triangles;
  std::vector<CrossingFace> crossing;
  PolygonCounts counts;
};

class ObjReader {
 public:
  explicit ObjReader(const Reading& reading)
      : reading_(reading), splitter_(reading), chunks_(splitter_.chunk_count_at_most()) {}

  Scene read() {
    run_in_parallel(
        chunks_.size(),
        [this](std::size_t i) {
          if (is_cut(i)) parse_obj_chunk(reading_, chunks_[i]);
        },
        [this](std::size_t done) { tell_progress(reading_, 0.6 * fraction(done)); });
    chunks_.resize(cut_count_);
    gather_vertices();
    find_runs();
    triangles_.resize(chunks_.size());
    run_in_parallel(
        chunks_.size(), [this](std::size_t i) { cut_chunk(i); },
        [this](std::size_t done) { tell_progress(reading_, 0.6 + 0.2 * fraction(done)); });
    split_crossing_faces();
    gather_triangles();
    report();
    return std::move(scene_);
  }

 private:
  /// Cuts chunks off the file up to that one, which a thread needs next. False if there are fewer.
  bool is_cut(std::size_t index) {
    const std::lock_guard lock(cutting_);
    while (cut_count_ <= index) {
      ObjChunk chunk = splitter_.next();
      if (chunk.text.empty()) return false;
      chunks_[cut_count_++] = std::move(chunk);
    }
    return true;
  }

  double fraction(std::size_t done) const { return static_cast<double>(done) / static_cast<double>(chunks_.size()); }

  void gather_vertices() {
    std::uint64_t vertex_count = 0;
    std::uint64_t triangle_count = 0;
    for (const ObjChunk& chunk : chunks_) {
      first_vertices_.push_back(static_cast<std::int64_t>(vertex_count));
      vertex_count += chunk.vertices.size();
      triangle_count += chunk.triangle_count;
    }
    check_vertex_count(reading_, vertex_count);
    check_triangle_count(reading_, triangle_count);
    scene_.mesh.vertices.reserve(vertex_count);
    for (ObjChunk& chunk : chunks_) {
      scene_.mesh.vertices.insert(scene_.mesh.vertices.end(), chunk.vertices.begin(), chunk.vertices.end());
      chunk.vertices = {};
    }
  }

  // Makes runs of the faces in file order; a run ends when the part changes.
  void find_runs() {
    for (std::size_t i = 0; i < chunks_.size(); ++i) {
      const ObjChunk& chunk = chunks_[i];
      std::size_t first_face = 0;
      for (const ObjMark& mark : chunk.marks) {
        add_run(i, first_face, mark.face_index);
        first_face = mark.face_index;
        switch (mark.kind) {
          case ObjMark::Kind::object:
            object_names_.push_back(mark.name);
            // By the format a group stays in force, but in real files an object line ends it.
            now_ = {.object_number = object_names_.size(), .group = {}, .material = now_.material};
            break;
          case ObjMark::Kind::group: now_.group = mark.name; break;
          case ObjMark::Kind::material: now_.material = mark.name; break;
        }
      }
      add_run(i, first_face, chunk.face_corner_counts.size());
    }
    name_parts();
  }

  void add_run(std::size_t chunk_index, std::size_t first_face, std::size_t end_face) {
    if (first_face == end_face) { return; }
    const auto [entry, is_new] = part_numbers_.try_emplace(now_, belongings_.size());
    if (is_new) { belongings_.push_back(now_); }
    runs_.push_back({chunk_index, first_face, end_face, entry->second});
  }

  // The material is part of a name only where it distinguishes parts of one group.
  void name_parts() {
    std::map<Belonging, std::size_t> material_counts;
    for (const Belonging& belonging : belongings_) {
      ++material_counts[{belonging.object_number, belonging.group, {}}];
    }
    for (const Belonging& belonging : belongings_) {
      const std::string_view object =
          belonging.object_number == 0 ? std::string_view{} : object_names_[belonging.object_number - 1];
      std::string name(object);
      const auto append = [&name](std::string_view piece) {
        if (!piece.empty() && piece != name) { name.append(name.empty() ? "" : "/").append(piece); }
      };
      append(belonging.group);
      if (material_counts[{belonging.object_number, belonging.group, {}}] > 1) { append(belonging.material); }
      scene_.parts.push_back({.name = std::move(name)});
    }
  }

  void cut_chunk(std::size_t chunk_index) {
    ObjChunk& chunk = chunks_[chunk_index];
    ChunkTriangles& cut = triangles_[chunk_index];
    cut.triangles.reserve(chunk.triangle_count);
    const auto is_before = [](const FaceRun& run, std::size_t index) { return run.chunk_index < index; };
    auto run = std::lower_bound(runs_.begin(), runs_.end(), chunk_index, is_before);
    std::size_t first_corner = 0;
    std::vector<std::uint32_t> corners;
    for (std::size_t face = 0; face < chunk.face_corner_counts.size(); ++face) {
      if (face == run->end_face) {
        (run++)->end_triangle = cut.triangles.size();
        run->first_triangle = cut.triangles.size();
      }
      const std::uint32_t corner_count = chunk.face_corner_counts[face];
      corners.clear();
      for (std::size_t i = first_corner; i < first_corner + corner_count; ++i) {
        corners.push_back(vertex_index(chunk_index, face, i));
      }
      first_corner += corner_count;
      cut_face(chunk_index, face, corners);
    }
    if (!chunk.face_corner_counts.empty()) { run->end_triangle = cut.triangles.size(); }
    chunk.corners = {};
    chunk.is_relative = {};
    chunk.face_corner_counts = {};
    chunk.face_lines = {};
  }

  void cut_face(std::size_t chunk_index, std::size_t face, std::span<const std::uint32_t> corners) {
    ChunkTriangles& cut = triangles_[chunk_index];
    if (corners.size() > 3) cut.counts.measure(corners, scene_.mesh.vertices);
    const std::size_t first_new = cut.triangles.size();
    switch (triangulate(corners, scene_.mesh.vertices, cut.triangles)) {
      case PolygonKind::convex:
      case PolygonKind::concave: return;
      case PolygonKind::crossing:
        if (reading_.options.strict) { refuse_face(chunk_index, face, "polygon crosses or touches itself"); }
        cut.crossing.push_back({{corners.begin(), corners.end()}, first_new});
        return;
      case PolygonKind::too_long:
        refuse_face(chunk_index, face,
                    fmt::format("polygon of {} corners that crosses or touches itself, limit {}", corners.size(),
                                kMaxConcaveCorners));
    }
  }

  /// Splits polygons that cross themselves. At the end and one by one, since each may need a new vertex.
  void split_crossing_faces() {
    for (ChunkTriangles& cut : triangles_) {
      for (const CrossingFace& face : cut.crossing) {
        const auto triangles = std::span(cut.triangles).subspan(face.first_triangle, face.corners.size() - 2);
        counts_.split(face.corners, scene_.mesh.vertices, triangles);
      }
      counts_.add(cut.counts);
    }
    check_vertex_count(reading_, scene_.mesh.vertices.size());
  }

  [[noreturn]] void refuse_face(std::size_t chunk_index, std::size_t face, const std::string& what) const {
    const ObjChunk& chunk = chunks_[chunk_index];
    refuse(reading_, fmt::format("line {}: {}", 1 + chunk.lines_before + chunk.face_lines[face], what));
  }

  std::uint32_t vertex_index(std::size_t chunk_index, std::size_t face, std::size_t corner) const {
    const auto vertex_count = static_cast<std::int64_t>(scene_.mesh.vertices.size());
    const std::int64_t index = chunks_[chunk_index].vertex_of(corner, first_vertices_[chunk_index]);
    if (index < 0 || index >= vertex_count) {
      refuse_face(chunk_index, face,
                  index < 0 ? fmt::format("vertex number {} before the first vertex", index)
                            : fmt::format("vertex number {} of {}", index + 1, vertex_count));
    }
    return static_cast<std::uint32_t>(index);
  }

  // Sorts the triangles by part, in file order within each, so that every part is one run.
  void gather_triangles() {
    std::vector<std::size_t> part_ends(scene_.parts.size(), 0);
    for (const FaceRun& run : runs_) { part_ends[run.part_index] += run.end_triangle - run.first_triangle; }
    std::size_t first = 0;
    for (std::size_t i = 0; i < scene_.parts.size(); ++i) {
      scene_.parts[i].first_triangle = static_cast<std::uint32_t>(first);
      scene_.parts[i].triangle_count = static_cast<std::uint32_t>(part_ends[i]);
      first += std::exchange(part_ends[i], first);
    }
    scene_.mesh.triangles.resize(first);
    for (std::size_t i = 0; i < runs_.size(); ++i) {
      const FaceRun& run = runs_[i];
      std::vector<TriangleCorners>& from = triangles_[run.chunk_index].triangles;
      std::copy(from.begin() + static_cast<std::ptrdiff_t>(run.first_triangle),
                from.begin() + static_cast<std::ptrdiff_t>(run.end_triangle),
                scene_.mesh.triangles.begin() + static_cast<std::ptrdiff_t>(part_ends[run.part_index]));
      part_ends[run.part_index] += run.end_triangle - run.first_triangle;
      const bool is_last_of_chunk = i + 1 == runs_.size() || runs_[i + 1].chunk_index != run.chunk_index;
      if (is_last_of_chunk) from = {};
    }
  }

  void report() {
    ObjChunk sum;
    for (std::size_t i = 0; i < chunks_.size(); ++i) {
      sum.point_lines += chunks_[i].point_lines;
      sum.curve_lines += chunks_[i].curve_lines;
      sum.weighted_vertices += chunks_[i].weighted_vertices;
      sum.short_faces += chunks_[i].short_faces;
      sum.unknown_lines += chunks_[i].unknown_lines;
      if (sum.first_unknown_line == 0) sum.first_unknown_line = chunks_[i].first_unknown_line;
    }
    const auto tell = [](std::vector<std::string>& lines, std::uint64_t count, std::string_view sentence) {
      if (count > 0) { lines.push_back(fmt::format("{} {}", count, sentence)); }
    };
    LoadReport& lines = reading_.report;
    tell(lines.refused, sum.point_lines, "point and line elements left out; only surfaces are loaded");
    tell(lines.refused, sum.curve_lines, "free-form curves and surfaces left out; only polygons are loaded");
    tell(lines.refused, sum.short_faces, "faces of fewer than 3 corners left out");
    if (sum.unknown_lines > 0) {
      lines.refused.push_back(fmt::format("{} lines that begin with no word of OBJ left out, the first is line {}",
                                          sum.unknown_lines, sum.first_unknown_line));
    }
    tell(lines.warnings, sum.weighted_vertices, "vertices with a weight other than 1; the weight is not used");
    counts_.report(lines);
  }

  const Reading& reading_;
  std::mutex cutting_;  // guards the splitter, cut_count_ and the chunks from that one on
  ObjSplitter splitter_;
  std::size_t cut_count_ = 0;
  std::vector<ObjChunk> chunks_;
  std::vector<std::int64_t> first_vertices_;
  Belonging now_;
  std::vector<std::string_view> object_names_;
  std::map<Belonging, std::size_t> part_numbers_;
  std::vector<Belonging> belongings_;
  std::vector<FaceRun> runs_;
  std::vector<ChunkTriangles> triangles_;
  PolygonCounts counts_;
  Scene scene_;
};

}  // namespace

Scene read_obj(const Reading& reading) { return ObjReader(reading).read(); }

}  // namespace collided::engine
