#include "server/programs/files/check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <unordered_set>

#include "server/programs/files/mesh_findings.hpp"
#include "server/programs/files/progress_line.hpp"
#include "server/programs/files/volumes.hpp"

namespace collided::engine::files {
namespace {

using nlohmann::json;

constexpr std::size_t kWorstInTable = 3;
constexpr std::size_t kWorstInJson = 20;

std::string point_text(const Vec3& point) {
  return fmt::format("{} {} {}", shortest(point.x()), shortest(point.y()), shortest(point.z()));
}

json point_json(const Vec3& point) { return {point.x(), point.y(), point.z()}; }

/// Counts the triangles of the static mesh and, once each, those of the objects' meshes.
std::size_t triangles_of(const Scene& scene) {
  std::unordered_set<const TriangleMesh*> seen;
  std::size_t count = scene.mesh.triangles.size();
  for (const SceneObject& object : scene.objects) {
    const TriangleMesh* mesh = object.shape.mesh.get();
    if (mesh != nullptr && seen.insert(mesh).second) count += mesh->triangles.size();
  }
  return count;
}

/// Checks the static mesh and, once each, the objects' meshes.
///
/// progress  called with the fraction done in [0, 1], by triangles
std::vector<CheckedMesh> check_meshes(const Scene& scene, const Scrutiny& scrutiny,
                                      const std::function<void(double)>& progress) {
  std::vector<CheckedMesh> meshes;
  const auto all = static_cast<double>(std::max<std::size_t>(triangles_of(scene), 1));
  double done = 0;
  const auto add = [&](const std::string& name, const TriangleMesh& mesh, const std::vector<Part>* parts) {
    const auto share = static_cast<double>(mesh.triangles.size());
    meshes.push_back(
        check_mesh(name, mesh, parts, scrutiny, [&](double fraction) { progress((done + share * fraction) / all); }));
    done += share;
  };
  if (!scene.mesh.triangles.empty()) add(scene.name, scene.mesh, &scene.parts);
  std::unordered_set<const TriangleMesh*> seen;
  for (const SceneObject& object : scene.objects) {
    const TriangleMesh* mesh = object.shape.mesh.get();
    if (mesh == nullptr || !seen.insert(mesh).second) continue;
    add(object.name, *mesh, nullptr);
    meshes.back().cut = object.cut;
  }
  return meshes;
}

/// Every kind of finding with its count, even 0, so that a reading program need not test for its presence.
json mesh_json(const CheckedMesh& checked) {
  const MeshHealth& health = checked.health;
  json object{{"triangles", health.triangle_count},
              {"vertices", health.vertex_count},
              {"equal_vertices", health.equal_vertex_count},
              {"zero_area", health.zero_area_count},
              {"duplicates", health.duplicate_count},
              {"flipped", health.flipped.size()},
              {"edges", health.edge_count},
              {"boundary_edges", health.boundary_edge_count},
              {"nonmanifold_edges", health.nonmanifold_edge_count},
              {"inconsistent_edges", health.inconsistent_edge_count},
              {"crease_edges", checked.crease_edge_count},
              {"material_edges", checked.material_edge_count},
              {"pinched_points", health.pinched_points.size()},
              {"t_vertices", health.t_vertex_count()},
              {"cracks", health.crack_count()},
              {"crack_m", health.seam_reach.crack_m},
              {"on_edge_m", health.seam_reach.on_edge_m},
              {"self_intersections", checked.crossings.pairs.size()},
              {"self_intersections_complete", checked.crossings.is_complete},
              {"border_points_unseen", health.seam_unseen_count},
              {"components", health.component_count},
              {"unorientable", health.unorientable_count},
              {"closed", health.is_closed},
              {"oriented", health.is_consistently_oriented},
              {"manifold", health.is_manifold()}};
  if (!health.bounds.empty()) object["bounds"] = {point_json(health.bounds.low), point_json(health.bounds.high)};
  if (checked.silhouette_edge_count) object["silhouette_edges"] = *checked.silhouette_edge_count;
  if (const std::string doubt = unit_suspicion(health.bounds); !doubt.empty()) object["unit_doubt"] = doubt;
  json worst = json::object();
  for (const MeshFinding& finding : findings_of(checked, kWorstInJson)) {
    json places = json::array();
    for (const FindingPlace& place : finding.worst) {
      json one{{"object", place.object}, {"triangle", place.triangle}, {"detail", place.detail}};
      if (place.with) one["with"] = {{"object", place.with->object}, {"triangle", place.with->triangle}};
      places.push_back(std::move(one));
    }
    worst[finding.key] = {{"places", places}, {"service", finding.consequence}};
  }
  object["findings"] = worst;
  return object;
}

/// One JSON object: the members of the static mesh in it, those of the objects' meshes in a list.
void print_json(const Scene& scene, const std::vector<CheckedMesh>& meshes, const LoadReport& report) {
  json object{{"scene", scene.name},      {"parts", scene.parts.size()}, {"objects", scene.objects.size()},
              {"triangles", 0},           {"placed", report.placed},     {"notes", report.notes},
              {"mended", report.mended},  {"refused", report.refused},   {"warnings", report.warnings},
              {"seconds", report.seconds}};
  json of_objects = json::array();
  for (const CheckedMesh& checked : meshes) {
    json one = mesh_json(checked);
    if (checked.parts != nullptr) {
      object.update(one);
    } else {
      one["object"] = checked.name;
      of_objects.push_back(std::move(one));
    }
  }
  if (!of_objects.empty()) object["object_meshes"] = std::move(of_objects);
  std::puts(object.dump(-1, ' ', false, json::error_handler_t::replace).c_str());
}

std::string surface_text(const MeshHealth& health) {
  if (health.is_closed && health.is_consistently_oriented) {
    return fmt::format("closed, of one orientation{}: 'inside' has a meaning",
                       health.is_manifold() ? ", manifold" : "");
  }
  if (health.is_closed) return "closed, but not of one orientation";
  return health.is_manifold() ? "open, manifold" : "open, not manifold";
}

/// Prints the result for people, line by line. Without `full` it fits on a screen.
class CheckReport {
 public:
  CheckReport(const Scene& scene, const std::vector<CheckedMesh>& meshes, const LoadReport& report,
              const CheckOptions& options)
      : scene_(scene), meshes_(meshes), report_(report), full_(options.full), quiet_(options.quiet) {}

  void print() {
    line(scene_line(scene_));
    lines("placed", report_.placed);
    // The screen also needs room for the lines that follow the meshes.
    const std::vector<std::string> warnings = this->warnings();
    lines_after_ =
        report_.notes.size() + report_.mended.size() + report_.refused.size() + warnings.size() + (full_ ? 0 : 1);
    if (full_ || meshes_.size() < 2) {
      for (const CheckedMesh& checked : meshes_) print_mesh(checked);
    } else {
      summarize_meshes();
    }
    lines("note", report_.notes);
    lines("mended", report_.mended);
    lines("refused", report_.refused);
    lines("warning", warnings);
    if (is_cut_ && !quiet_) line("  -v shows every place, --json gives it to programs");
  }

 private:
  static constexpr std::size_t kScreenLines = 23;
  static constexpr std::size_t kScreenColumns = 80;
  static constexpr std::size_t kIndent = 15;

  void line(const std::string& text) {
    fmt::print("{}\n", text);
    ++printed_;
  }
  void lines(const char* label, const std::vector<std::string>& texts) {
    for (const std::string& text : texts) line(fmt::format("  {:<9}{}", label, text));
  }

  /// The short report omits warnings of loading that the findings repeat.
  std::vector<std::string> warnings() const {
    std::vector<std::string> kept;
    for (const std::string& warning : report_.warnings) {
      const bool is_repeated = warning.find(" kept") != std::string::npos;
      if (full_ || !is_repeated) kept.push_back(warning);
    }
    return kept;
  }

  void print_mesh(const CheckedMesh& checked) {
    const MeshHealth& health = checked.health;
    if (checked.parts == nullptr) line(fmt::format("{}  {}", checked.name, counted(health.triangle_count, "triangle")));
    const double size_m = (health.bounds.high - health.bounds.low).norm();
    line(fmt::format("  bounds   {}  to  {}", corner_text(health.bounds.low, size_m),
                     corner_text(health.bounds.high, size_m)));
    line(fmt::format("  surface  {}", surface_text(health)));
    line(fmt::format("  pieces   {}", grouped(health.component_count)));
    line(fmt::format("  points   {} vertices, {} of them equal to an earlier one", grouped(health.vertex_count),
                     grouped(health.equal_vertex_count)));
    std::string edges = fmt::format("  edges    {}, {} of them creases, {} between parts", grouped(health.edge_count),
                                    grouped(checked.crease_edge_count), grouped(checked.material_edge_count));
    if (checked.silhouette_edge_count)
      edges += fmt::format(", {} silhouettes from there", grouped(*checked.silhouette_edge_count));
    line(edges);
    if (const std::string doubt = unit_suspicion(health.bounds); !doubt.empty()) line("  unit?    " + doubt);
    print_unseen(checked);
    print_findings(checked);
  }

  void print_unseen(const CheckedMesh& checked) {
    if (!checked.crossings.is_complete)
      line("  unseen   the search for triangles that meet each other ended early: there are more");
    if (checked.health.seam_unseen_count > 0) {
      line(fmt::format(
          "  unseen   {} points of the border were not looked at for cracks: too many borders lie near each other",
          grouped(checked.health.seam_unseen_count)));
    }
  }

  /// The findings, worst kind first; below each its worst places, as far as the screen allows.
  void print_findings(const CheckedMesh& checked) {
    const std::vector<MeshFinding> findings = by_weight(findings_of(checked, kWorstInTable));
    if (findings.empty()) line("  nothing is wrong with it");
    const bool names_objects = checked.parts != nullptr && checked.parts->size() > 1;
    std::size_t kinds_left = findings.size();
    for (const MeshFinding& finding : findings) {
      line(finding_text(finding));
      --kinds_left;
      if (finding.worst.empty()) continue;
      if (!full_ && printed_ + 1 + kinds_left + lines_after_ > kScreenLines) {
        is_cut_ = true;
        continue;
      }
      line(std::string(kIndent, ' ') + (finding.count > finding.worst.size() ? "the worst: " : "") +
           places_text(finding, names_objects));
    }
  }

  /// If the screen is too narrow for all clauses of a consequence, only the first and the last, which recommends an
  /// action.
  std::string finding_text(const MeshFinding& finding) {
    const std::string head = fmt::format("  {:>11}  {:<20} ", grouped(finding.count), finding.what);
    const std::string& all = finding.consequence;
    const std::size_t first = all.find("; ");
    if (full_ || head.size() + all.size() <= kScreenColumns || first == std::string::npos) return head + all;
    is_cut_ = true;
    const std::string ends = all.substr(0, first) + all.substr(all.rfind("; "));
    return head + (head.size() + ends.size() <= kScreenColumns ? ends : all.substr(0, first));
  }

  std::string places_text(const MeshFinding& finding, bool names_objects) {
    constexpr std::size_t kHead = kIndent + std::string_view("the worst: ").size();
    std::string text;
    for (const FindingPlace& place : finding.worst) {
      const auto named = [&](const std::string& object, std::uint32_t number) {
        const std::string name = full_ ? object : short_name(object);
        return fmt::format("{}triangle {}", names_objects ? name + " " : "", number);
      };
      const std::string triangle = (text.empty() ? "" : "; ") + named(place.object, place.triangle);
      std::string one = triangle + (place.detail.empty() ? "" : " " + place.detail);
      if (place.with) one += " with " + named(place.with->object, place.with->triangle);
      if (!full_ && kHead + text.size() + one.size() > kScreenColumns) {
        is_cut_ = true;
        if (!text.empty()) break;
        one = triangle;
      }
      text += one;
    }
    return text;
  }

  /// The name within its scene, cut if it is long: an IFC part's ends in 22 characters that no one reads.
  std::string short_name(const std::string& name) {
    constexpr std::size_t kLongest = 30;
    std::string_view text = name;
    if (text.starts_with(scene_.name + "/")) text.remove_prefix(scene_.name.size() + 1);
    if (text.size() <= kLongest) return std::string(text);
    is_cut_ = true;
    std::size_t end = kLongest - 3;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0U) == 0x80U) --end;  // not within a character
    return std::string(text.substr(0, end)) + "...";
  }

  /// One line per mesh, those with findings first.
  void summarize_meshes() {
    std::vector<std::string> faulty;
    std::vector<std::string> sound;
    for (const CheckedMesh& checked : meshes_) {
      std::string kinds;
      for (const MeshFinding& finding : by_weight(findings_of(checked, 0)))
        kinds += fmt::format("{}{} {}", kinds.empty() ? "" : ", ", grouped(finding.count), finding.what);
      const std::string text =
          fmt::format("  {}  {}, {}", short_name(checked.name), counted(checked.health.triangle_count, "triangle"),
                      kinds.empty() ? "nothing is wrong with it" : kinds);
      (kinds.empty() ? sound : faulty).push_back(text);
    }
    faulty.insert(faulty.end(), sound.begin(), sound.end());
    is_cut_ = true;
    for (std::size_t i = 0; i < faulty.size(); ++i) {
      if (printed_ + 1 + lines_after_ >= kScreenLines && i + 1 < faulty.size()) {
        line(fmt::format("  and {} more meshes", grouped(faulty.size() - i)));
        return;
      }
      line(faulty[i]);
    }
  }

  /// Full digits on request; else enough to resolve a millionth of the size.
  std::string corner_text(const Vec3& corner, double size_m) const {
    const bool rounds = !full_ && size_m > 0 && std::isfinite(size_m);
    if (!rounds) return point_text(corner);
    const double step = std::pow(10, std::floor(std::log10(size_m)) - 5);
    const auto places = static_cast<int>(std::max(0.0, -std::log10(step)));
    std::string text;
    for (int axis = 0; axis < 3; ++axis)
      text += (axis == 0 ? "" : " ") + shortest(std::stod(fmt::format("{:.{}f}", corner[axis], places)) + 0.0);
    return text;
  }

  const Scene& scene_;
  const std::vector<CheckedMesh>& meshes_;
  const LoadReport& report_;
  const bool full_;
  const bool quiet_;
  std::size_t printed_ = 0;
  std::size_t lines_after_ = 0;  // that will follow the meshes
  bool is_cut_ = false;          // something was left out for lack of space
};

}  // namespace

int check(const FileOptions& file, const CheckOptions& options) {
  // Share of the time, measured with a million triangles.
  constexpr double kLoaded = 0.15;
  LoadReport report;
  std::optional<ProgressLine> line(std::in_place, "checking");
  const Scene scene = load(file, report, [&](double fraction) { line->tell(kLoaded * fraction); });
  Scrutiny scrutiny{.crack_m = crack_in_metres(file), .crease_deg = options.crease_deg};
  if (!options.eye.empty()) scrutiny.eye = parse_point("--eye", options.eye);
  const std::vector<CheckedMesh> meshes =
      check_meshes(scene, scrutiny, [&](double fraction) { line->tell(kLoaded + (1 - kLoaded) * fraction); });
  line.reset();
  if (options.as_json) print_json(scene, meshes, report);
  else CheckReport(scene, meshes, report, options).print();
  if (options.volumes) print_volumes(scene);
  if (options.encodings) print_encodings(scene);
  return report.refused.empty() ? 0 : 1;
}

}  // namespace collided::engine::files
