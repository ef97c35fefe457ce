#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>

#include "server/intake/limits.hpp"
#include "server/intake/polygons/triangulate.hpp"
#include "server/intake/readers/json_view.hpp"
#include "server/intake/readers/names.hpp"

namespace collided::engine {
namespace {

using nlohmann::json;

/// How many lists are nested around a surface's list of rings, by the type of the geometry.
std::optional<int> nesting_of(const std::string& type) {
  if (type == "MultiSurface" || type == "CompositeSurface") return 1;
  if (type == "Solid") return 2;
  if (type == "MultiSolid" || type == "CompositeSolid") return 3;
  return std::nullopt;
}

/// Reads a CityJSON file: the surfaces of each object as a part.
/// source    CityJSON specifications 1.0 to 2.0, cityjson.org
class CityReader {
 public:
  CityReader(const Reading& reading, const JsonView& root) : reading_(reading), root_(root) {}

  Scene read() {
    check_kind();
    read_vertices();
    const JsonView objects = root_.at("CityObjects");
    if (!objects.is_object()) objects.complain("is not an object");
    for (const auto& [id, object] : objects.json().items()) add_object(id, objects.at(id.c_str()));
    tell();
    return std::move(scene_);
  }

 private:
  void check_kind() const {
    const std::string type = root_.text_or("type", "");
    if (type == "CityJSONFeature")
      refuse(reading_, "a CityJSON sequence, a feature a line, is not read; join its features to one CityJSON");
    if (type != "CityJSON")
      refuse(reading_, fmt::format("its \"type\" is {}, only \"CityJSON\" is read", in_quotes(std::string_view(type))));
    const std::string version = root_.text_or("version", "");
    if (!version.starts_with("1.") && !version.starts_with("2.")) {
      refuse(reading_, fmt::format("CityJSON version {}, read are 1.x and 2.x", in_quotes(std::string_view(version))));
    }
  }

  Vec3 vec3(const JsonView& view) const {
    return {view.at(std::size_t{0}).number(), view.at(1).number(), view.at(2).number()};
  }

  void read_vertices() {
    Vec3 scale = Vec3::Ones();
    Vec3 origin = Vec3::Zero();
    if (root_.has("transform")) {
      scale = vec3(root_.at("transform").at("scale"));
      origin = vec3(root_.at("transform").at("translate"));
    }
    const JsonView vertices = root_.at("vertices");
    check_vertex_count(reading_, vertices.size());
    scene_.mesh.vertices.reserve(vertices.size());
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      const json& numbers = vertices.json()[i];
      const bool is_point = numbers.is_array() && numbers.size() == 3 && numbers[0].is_number() &&
                            numbers[1].is_number() && numbers[2].is_number();
      if (!is_point) vertices.at(i).complain("is not three numbers");
      const Vec3 raw(numbers[0].get<double>(), numbers[1].get<double>(), numbers[2].get<double>());
      scene_.mesh.vertices.push_back(raw.cwiseProduct(scale) + origin);
      if (!scene_.mesh.vertices.back().allFinite()) vertices.at(i).complain("is not finite where it is placed");
    }
  }

  void add_object(const std::string& id, const JsonView& object) {
    Part part{.name = id, .first_triangle = static_cast<std::uint32_t>(scene_.mesh.triangles.size())};
    const std::size_t count = object.size_of("geometry");
    double finest = -1;
    for (std::size_t i = 0; i < count; ++i) finest = std::max(finest, detail_of(object.element("geometry", i)));
    for (std::size_t i = 0; i < count; ++i) {
      const JsonView geometry = object.element("geometry", i);
      if (detail_of(geometry) < finest) ++coarser_count_;
      else add_geometry(geometry);
    }
    part.triangle_count = static_cast<std::uint32_t>(scene_.mesh.triangles.size()) - part.first_triangle;
    if (part.triangle_count > 0) scene_.parts.push_back(std::move(part));
  }

  /// The level of detail, written as "2.2", or as the number 2 in older files.
  static double detail_of(const JsonView& geometry) {
    if (!geometry.has("lod")) return 0;
    const json& lod = geometry.at("lod").json();
    if (lod.is_number()) return lod.get<double>();
    double value = 0;
    const std::string text = geometry.at("lod").text();
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
  }

  void add_geometry(const JsonView& geometry) {
    const std::string type = geometry.at("type").text();
    const std::optional<int> nesting = nesting_of(type);
    if (!nesting) {
      ++other_count_;
      return;
    }
    add_surfaces(geometry, geometry.at("boundaries").json(), *nesting);
  }

  void add_surfaces(const JsonView& geometry, const json& list, int nesting) {
    if (!list.is_array()) geometry.complain("has boundaries that are no lists");
    for (const json& inner : list) {
      if (nesting > 1) add_surfaces(geometry, inner, nesting - 1);
      else add_surface(geometry, inner);
    }
  }

  void add_surface(const JsonView& geometry, const json& rings) {
    if (!rings.is_array()) geometry.complain("has a surface that is no list of rings");
    std::vector<std::vector<std::uint32_t>> corners;
    for (const json& ring : rings) {
      std::vector<std::uint32_t> taken = ring_of(geometry, ring);
      if (taken.size() >= 3) {
        corners.push_back(std::move(taken));
      } else if (corners.empty()) {
        ++short_count_;
        return;
      }
    }
    if (corners.empty()) return;
    if (corners.size() > 1 && cut_with_holes(corners)) return;
    // An invalid hole is filled, which makes it an obstacle. That errs on the safe side.
    hole_flaw_count_ += corners.size() > 1 ? 1 : 0;
    cut(geometry, corners[0]);
  }

  std::vector<std::uint32_t> ring_of(const JsonView& geometry, const json& ring) const {
    if (!ring.is_array()) geometry.complain("has a ring that is no list of vertices");
    std::vector<std::uint32_t> corners;
    corners.reserve(ring.size());
    for (const json& number : ring) {
      const bool is_whole =
          number.is_number_unsigned() || (number.is_number_integer() && number.get<std::int64_t>() >= 0);
      if (!is_whole || number.get<std::uint64_t>() >= scene_.mesh.vertices.size()) {
        const std::string told = number.is_number() ? number.dump() : "(no number)";
        geometry.complain(fmt::format("has a corner that is vertex {} of {}", told, scene_.mesh.vertices.size()));
      }
      corners.push_back(number.get<std::uint32_t>());
    }
    return corners;
  }

  bool cut_with_holes(const std::vector<std::vector<std::uint32_t>>& rings) {
    std::vector<std::uint32_t> corners;
    std::vector<std::uint32_t> ring_ends;
    for (const std::vector<std::uint32_t>& ring : rings) {
      corners.insert(corners.end(), ring.begin(), ring.end());
      ring_ends.push_back(static_cast<std::uint32_t>(corners.size()));
    }
    check_triangle_count(reading_, scene_.mesh.triangles.size() + corners.size() + 2 * rings.size());
    return triangulate_with_holes(corners, ring_ends, scene_.mesh.vertices, scene_.mesh.triangles) !=
           PolygonKind::crossing;
  }

  void cut(const JsonView& geometry, const std::vector<std::uint32_t>& corners) {
    check_triangle_count(reading_, scene_.mesh.triangles.size() + corners.size() - 2);
    const PolygonKind kind = triangulate(corners, scene_.mesh.vertices, scene_.mesh.triangles);
    if (kind == PolygonKind::too_long) {
      geometry.complain(fmt::format("has a polygon of {} corners, limit {}", corners.size(), kMaxConcaveCorners));
    }
    if (kind == PolygonKind::crossing) {
      ++crossing_count_;
      if (reading_.options.strict) geometry.complain("has a polygon that crosses or touches itself");
    }
  }

  void tell() const {
    LoadReport& report = reading_.report;
    const auto add = [](std::vector<std::string>& lines, std::uint64_t count, const char* sentence) {
      if (count > 0) lines.push_back(fmt::format("{} {}", count, sentence));
    };
    add(report.refused, coarser_count_, "geometries of lower detail than the finest of their object left out");
    add(report.refused, other_count_, "geometries of points, lines and templates left out");
    add(report.refused, short_count_, "surfaces of fewer than 3 corners left out");
    add(report.mended, crossing_count_, "polygons that cross or touch themselves cut into triangles by a guess");
    add(report.mended, hole_flaw_count_, "surfaces closed over holes that cross their border or lie outside of it");
    if (root_.has("metadata") && root_.at("metadata").has("referenceSystem")) {
      report.placed.push_back("coordinates are those of " +
                              mended_name(root_.at("metadata").at("referenceSystem").text()));
    }
  }

  const Reading& reading_;
  JsonView root_;
  Scene scene_;
  std::uint64_t coarser_count_ = 0;
  std::uint64_t other_count_ = 0;
  std::uint64_t short_count_ = 0;
  std::uint64_t crossing_count_ = 0;
  std::uint64_t hole_flaw_count_ = 0;
};

}  // namespace

Scene read_cityjson(const Reading& reading) {
  const json document = parse_json(reading, {reading.begin(), reading.bytes.size()});
  return CityReader(reading, JsonView(reading, document)).read();
}

}  // namespace collided::engine
