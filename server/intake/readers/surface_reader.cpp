#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "server/geometry/tolerance.hpp"
#include "server/intake/limits.hpp"
#include "server/intake/mesh/tessellate.hpp"
#include "server/intake/readers/implicit_lines.hpp"
#include "server/intake/readers/reading.hpp"
#include "server/intake/readers/text_cursor.hpp"

namespace collided::engine {
namespace {

constexpr std::string_view kKinds =
    "sphere R, ellipsoid A B C, cylinder R LENGTH, cone R HEIGHT, torus RING TUBE, "
    "waves LENGTH WIDTH AMPLITUDE KX KY, patch DEGREE DEGREE COLUMNS ROWS POINTS, "
    "implicit POLYNOMIAL";

/// With this factor, a number written with three digits is no less than before.
constexpr double kRoundedUp = 1.0051;

/// Reads one surface from each line: NAME KIND NUMBERS [at X Y Z] (count N [M] | error E), or NAME implicit POLYNOMIAL
/// [in X Y Z X Y Z].
class SurfaceReader {
 public:
  explicit SurfaceReader(const Reading& reading)
      : reading_(reading),
        cursor_(reading, {reading.begin(), reading.bytes.size()}, TextCursor::LineEnd::newline_or_comment, true) {}

  Scene read() {
    while (cursor_.find_word()) {
      read_line();
      tell_progress(reading_, 0.8 * static_cast<double>(cursor_.place() - reading_.begin()) /
                                  static_cast<double>(reading_.bytes.size()));
      cursor_.next_line();
    }
    return std::move(scene_);
  }

 private:
  double number(std::string_view what) { return cursor_.finite_number(what); }
  Vec3 point(std::string_view what) {
    Vec3 p;
    for (double& coordinate : p) coordinate = number(what);
    return p;
  }

  void read_line() {
    const std::string name(cursor_.word());
    const std::string kind(cursor_.word());
    if (kind == "implicit") return skip_implicit(name);
    numbers_.clear();
    std::string word;
    for (word = cursor_.word(); !word.empty() && word != "at" && word != "count" && word != "error";
         word = cursor_.word()) {
      numbers_.push_back(parse(word));
    }
    Vec3 place = Vec3::Zero();
    if (word == "at") {
      place = point("coordinate after 'at'");
      word = cursor_.word();
    }
    const Fineness fineness = read_fineness(word);
    try {
      add(name, kind, tessellated(kind, fineness), place);
    } catch (const std::invalid_argument& wrong) { cursor_.complain(wrong.what()); }
  }

  /// An implicit surface gives no triangles, but its line is checked.
  void skip_implicit(const std::string& name) {
    rest_as_implicit_surface(cursor_);
    reading_.report.refused.push_back(
        fmt::format("{}: an implicit surface is not cut into triangles and left out here; 'collide implicit' asks it",
                    in_quotes(std::string_view(name))));
  }

  double parse(const std::string& word) {
    const Reading one{reading_.file, word, reading_.options, reading_.report};
    try {
      return TextCursor(one, word, TextCursor::LineEnd::newline, false).finite_number("number");
    } catch (const LoadError&) {
      cursor_.complain(fmt::format("{} is no number, nor 'at', 'count' or 'error'", in_quotes(std::string_view(word))));
    }
  }

  Fineness read_fineness(const std::string& word) {
    Fineness fineness{.triangles_at_most = std::min(kMaxTessellationTriangles, reading_.options.max_triangles)};
    if (word == "error") {
      fineness.error_m = number("error");
      if (!(fineness.error_m > 0)) cursor_.complain(fmt::format("error {}, must be above 0", fineness.error_m));
      return fineness;
    }
    if (word != "count") cursor_.complain("how finely is not said: 'count N', 'count N M' or 'error E' ends the line");
    fineness.first = count();
    fineness.second = cursor_.at_line_end() ? fineness.first : count();
    return fineness;
  }

  unsigned count() {
    const std::int64_t pieces = cursor_.integer("number of pieces");
    if (pieces < 1 || pieces > static_cast<std::int64_t>(kMaxTessellationTriangles)) {
      cursor_.complain(fmt::format("{} pieces, allowed are 1 to {}", pieces, kMaxTessellationTriangles));
    }
    return static_cast<unsigned>(pieces);
  }

  void need(std::size_t count) const {
    if (numbers_.size() != count)
      throw std::invalid_argument(fmt::format("{} numbers, this kind takes {}", numbers_.size(), count));
  }

  Tessellation tessellated(const std::string& kind, const Fineness& fineness) const {
    const std::vector<double>& n = numbers_;
    if (kind == "sphere") return need(1), tessellate_sphere(n[0], fineness);
    if (kind == "ellipsoid") return need(3), tessellate_ellipsoid({n[0], n[1], n[2]}, fineness);
    if (kind == "cylinder") return need(2), tessellate_cylinder(n[0], n[1], fineness);
    if (kind == "cone") return need(2), tessellate_cone(n[0], n[1], fineness);
    if (kind == "torus") return need(2), tessellate_torus(n[0], n[1], fineness);
    if (kind == "waves") return need(5), tessellate_heights(waves(), fineness);
    if (kind == "patch") return tessellate_patch(patch(), fineness);
    throw std::invalid_argument(fmt::format("surface {}, allowed are: {}", in_quotes(std::string_view(kind)), kKinds));
  }

  /// z = amplitude sin(kx x) sin(ky y) around the origin.
  HeightFunction waves() const {
    const double amplitude = numbers_[2];
    const double kx = numbers_[3];
    const double ky = numbers_[4];
    const Eigen::Vector2d half(numbers_[0] / 2, numbers_[1] / 2);
    const double steepest = std::abs(amplitude);
    return {[=](double x, double y) { return amplitude * std::sin(kx * x) * std::sin(ky * y); },
            -half,
            half,
            {steepest * kx * kx, steepest * std::abs(kx * ky), steepest * ky * ky}};
  }

  SplinePatch patch() const {
    if (numbers_.size() < 4) throw std::invalid_argument("a patch begins with two degrees, columns and rows");
    for (std::size_t i = 0; i < 4; ++i) {
      if (!(numbers_[i] >= 1 && numbers_[i] <= 10'000 && numbers_[i] == std::floor(numbers_[i]))) {
        throw std::invalid_argument("degrees, columns and rows of a patch are whole numbers from 1 to 10 000");
      }
    }
    SplinePatch patch{
        static_cast<unsigned>(numbers_[0]), static_cast<unsigned>(numbers_[1]), static_cast<unsigned>(numbers_[2]), {}};
    need(4 + 3 * static_cast<std::size_t>(numbers_[2] * numbers_[3]));
    for (std::size_t i = 4; i < numbers_.size(); i += 3)
      patch.points.emplace_back(numbers_[i], numbers_[i + 1], numbers_[i + 2]);
    return patch;
  }

  void add(const std::string& name, const std::string& kind, Tessellation surface, const Vec3& place) {
    TriangleMesh& all = scene_.mesh;
    const auto first_vertex = static_cast<std::uint32_t>(all.vertices.size());
    const auto first_triangle = static_cast<std::uint32_t>(all.triangles.size());
    check_triangle_count(reading_, all.triangles.size() + surface.mesh.triangles.size());
    check_vertex_count(reading_, all.vertices.size() + surface.mesh.vertices.size());
    double reach = place.cwiseAbs().maxCoeff();
    for (const Vec3& vertex : surface.mesh.vertices) {
      all.vertices.push_back(vertex + place);
      reach = std::max(reach, all.vertices.back().cwiseAbs().maxCoeff());
      if (!std::isfinite(reach)) throw std::invalid_argument("a coordinate is too large for a double");
    }
    for (const TriangleCorners& c : surface.mesh.triangles) {
      all.triangles.push_back({c[0] + first_vertex, c[1] + first_vertex, c[2] + first_vertex});
    }
    scene_.parts.push_back({.name = name,
                            .first_triangle = first_triangle,
                            .triangle_count = static_cast<std::uint32_t>(surface.mesh.triangles.size())});
    // Moving the surface rounds each coordinate once more.
    reading_.report.notes.push_back(fmt::format("{}: {} as {} triangles, off by at most {:.3g} of the file's units",
                                                in_quotes(std::string_view(name)), kind, surface.mesh.triangles.size(),
                                                kRoundedUp * (surface.off_by_m + 4 * kRoundoff * reach)));
  }

  const Reading& reading_;
  TextCursor cursor_;
  std::vector<double> numbers_;
  Scene scene_;
};

}  // namespace

Scene read_surfaces(const Reading& reading) { return SurfaceReader(reading).read(); }

}  // namespace collided::engine
