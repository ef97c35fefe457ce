#include "client/draw/drawing/features.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <tuple>
#include <type_traits>

#include "client/draw/drawing/outlines.hpp"

namespace collided::draw {
namespace {

/// A surface at one pose, with its runs that are shown. The parts of a scene share one surface, so it is examined once.
struct PlacedSurface {
  std::shared_ptr<const Surface> surface;
  Pose pose;
  struct Run {
    std::uint32_t first_triangle;
    std::uint32_t triangle_count;
    std::uint32_t object;
  };
  std::vector<Run> runs;  // by first_triangle
};

std::vector<PlacedSurface> placed_surfaces(const ShownObjects& shown) {
  using Key = std::tuple<const Surface*, std::array<double, 7>>;
  std::map<Key, PlacedSurface> placed;
  for (std::uint32_t i = 0; i < shown.objects.size(); ++i) {
    const ShownObject& object = shown.objects[i];
    const Vec3& p = object.pose.position;
    const Quat& q = object.pose.rotation;
    for (const SurfaceRun& run : object.runs) {
      PlacedSurface& one = placed[{run.surface.get(), {p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()}}];
      one.surface = run.surface;
      one.pose = object.pose;
      one.runs.push_back({run.first_triangle, run.triangle_count, i});
    }
  }
  std::vector<PlacedSurface> list;
  for (auto& [key, one] : placed) {
    std::sort(one.runs.begin(), one.runs.end(),
              [](const auto& a, const auto& b) { return a.first_triangle < b.first_triangle; });
    list.push_back(std::move(one));
  }
  return list;
}

class SurfaceLines {
 public:
  SurfaceLines(const PlacedSurface& placed, const Camera& camera) : placed_(placed), surface_(*placed.surface) {
    // In the surface's own frame, where the triangles are the server's to the last bit.
    const Quat back = placed.pose.rotation.conjugate();
    is_far_ = camera.is_orthographic();
    eye_ = is_far_ ? Vec3(back * -camera.forward()) : Vec3(back * (camera.eye() - placed.pose.position));
    facing_.resize(surface_.triangles.size());
    object_of_.assign(surface_.triangles.size(), kNobody);
    for (const PlacedSurface::Run& run : placed.runs) {
      for (std::uint32_t i = run.first_triangle; i < run.first_triangle + run.triangle_count; ++i) {
        object_of_[i] = run.object;
        facing_[i] = faces(i);
      }
    }
  }

  void add_to(std::vector<FeatureLine>& lines) const {
    for (const SurfaceEdge& edge : surface_.edges) {
      const std::uint32_t first = shown(edge.triangles[0]);
      const std::uint32_t second = shown(edge.triangles[1]);
      if (first == kNobody && second == kNobody) continue;
      const std::optional<LineKind> kind = kind_of(edge, first != kNobody && second != kNobody);
      if (!kind) continue;
      lines.push_back({{place(edge.ends[0]), place(edge.ends[1])}, *kind, first != kNobody ? first : second});
    }
  }

 private:
  static constexpr std::uint32_t kNobody = 0xffffffff;

  std::uint32_t shown(std::uint32_t triangle) const { return triangle == kNoTriangle ? kNobody : object_of_[triangle]; }
  Vec3 place(std::uint32_t vertex) const {
    return placed_.pose.rotation * surface_.vertices[vertex] + placed_.pose.position;
  }

  bool faces(std::uint32_t triangle) const {
    const auto& [a, b, c] = surface_.triangles[triangle];
    const auto& v = surface_.vertices;
    return is_far_ ? faces_direction(v[a], v[b], v[c], eye_) : faces_eye(v[a], v[b], v[c], eye_);
  }

  std::optional<LineKind> kind_of(const SurfaceEdge& edge, bool both_shown) const {
    const bool has_two = (edge.kinds & (kBoundaryEdge | kManyEdge)) == 0;
    if (has_two && both_shown) {
      const bool is_turned = (edge.kinds & kTurnedEdge) != 0;
      if ((facing_[edge.triangles[0]] != 0) != ((facing_[edge.triangles[1]] != 0) != is_turned))
        return LineKind::silhouette;
    }
    if (!has_two || !both_shown) return LineKind::boundary;
    if ((edge.kinds & kCreaseEdge) != 0) return LineKind::crease;
    if ((edge.kinds & kMaterialEdge) != 0) return LineKind::material;
    return std::nullopt;
  }

  const PlacedSurface& placed_;
  const Surface& surface_;
  bool is_far_ = false;
  Vec3 eye_;
  std::vector<std::uint8_t> facing_;
  std::vector<std::uint32_t> object_of_;
};

void add_box_corners(const Vec3& center, const Eigen::Matrix3d& half_axes, std::vector<Vec3>& points) {
  for (int i = 0; i < 8; ++i) {
    points.push_back(center + half_axes * Vec3((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1));
  }
}

/// Adds the extreme points of a part, in the object's frame.
void add_extremes(const ShapePart& part, std::vector<Vec3>& points) {
  const auto ball = [&](const Vec3& center, double radius_m) {
    for (int k = 0; k < 3; ++k) {
      points.push_back(center + radius_m * Vec3::Unit(k));
      points.push_back(center - radius_m * Vec3::Unit(k));
    }
  };
  std::visit(
      [&](const auto& one) {
        using Part = std::decay_t<decltype(one)>;
        if constexpr (std::is_same_v<Part, SphereShape>) {
          ball(one.center, one.radius_m);
        } else if constexpr (std::is_same_v<Part, CapsuleShape> || std::is_same_v<Part, CylinderShape>) {
          ball(one.a, one.radius_m);
          ball(one.b, one.radius_m);
        } else if constexpr (std::is_same_v<Part, ConeShape>) {
          points.push_back(one.apex);
          ball(one.base, one.radius_m);
        } else if constexpr (std::is_same_v<Part, BoxShape> || std::is_same_v<Part, EllipsoidShape>) {
          add_box_corners(one.center, one.rotation.toRotationMatrix() * one.half_m.asDiagonal(), points);
        }
      },
      part);
}

}  // namespace

std::vector<FeatureLine> feature_lines(const ShownObjects& shown, const Camera& camera) {
  std::vector<FeatureLine> lines;
  for (const PlacedSurface& placed : placed_surfaces(shown)) SurfaceLines(placed, camera).add_to(lines);
  for (std::uint32_t i = 0; i < shown.objects.size(); ++i) {
    for (const ShapePart& part : shown.objects[i].parts) {
      std::visit(
          [&](const auto& one) {
            if constexpr (requires { add_outline(one, shown.objects[i].pose, camera, i, lines); })
              add_outline(one, shown.objects[i].pose, camera, i, lines);
          },
          part);
    }
  }
  return lines;
}

std::vector<Vec3> extreme_points(const ShownObjects& shown) {
  std::vector<Vec3> points;
  for (const ShownObject& object : shown.objects) {
    const std::size_t first = points.size();
    for (const ShapePart& part : object.parts) add_extremes(part, points);
    for (const SurfaceRun& run : object.runs) {
      for (std::uint32_t i = run.first_triangle; i < run.first_triangle + run.triangle_count; ++i) {
        for (const std::uint32_t corner : run.surface->triangles[i]) points.push_back(run.surface->vertices[corner]);
      }
    }
    for (std::size_t i = first; i < points.size(); ++i)
      points[i] = object.pose.rotation * points[i] + object.pose.position;
  }
  return points;
}

}  // namespace collided::draw
