#include "client/draw/drawing/shading_normals.hpp"

#include <bit>
#include <cmath>

namespace collided::draw {
namespace {

struct PlaceHash {
  std::size_t operator()(const std::array<double, 3>& p) const {
    std::uint64_t hash = 0;
    for (const double x : p) hash = (hash ^ std::bit_cast<std::uint64_t>(x + 0.0)) * 0x9e3779b97f4a7c15u + (hash >> 29);
    return hash ^ (hash >> 32);
  }
};

std::vector<std::uint32_t> first_at_place(const std::vector<Vec3>& vertices) {
  std::unordered_map<std::array<double, 3>, std::uint32_t, PlaceHash> first;
  first.reserve(vertices.size());
  std::vector<std::uint32_t> points(vertices.size());
  for (std::uint32_t i = 0; i < vertices.size(); ++i) {
    const Vec3& v = vertices[i];
    points[i] = first.try_emplace({v.x(), v.y(), v.z()}, i).first->second;
  }
  return points;
}

}  // namespace

ShadingNormals::ShadingNormals(const ShownObjects& shown, double crease_cosine)
    : shown_(shown), crease_cosine_(crease_cosine) {
  for (std::uint32_t i = 0; i < shown.objects.size(); ++i) object_of_id_[shown.objects[i].id] = i;
}

std::uint32_t ShadingNormals::object_of(const Hit& hit) const {
  const auto found = object_of_id_.find(hit.object_id);
  return found == object_of_id_.end() ? kNobody : found->second;
}

const ShadingNormals::Corners& ShadingNormals::corners_of(const Surface& surface) {
  const auto [entry, is_new] = corners_.try_emplace(&surface);
  Corners& corners = entry->second;
  if (!is_new) return corners;
  corners.point_of = first_at_place(surface.vertices);
  corners.first.assign(surface.vertices.size() + 1, 0);
  for (const auto& triangle : surface.triangles) {
    for (const std::uint32_t corner : triangle) ++corners.first[corners.point_of[corner] + 1];
  }
  for (std::size_t i = 1; i < corners.first.size(); ++i) corners.first[i] += corners.first[i - 1];
  corners.triangles.resize(3 * surface.triangles.size());
  std::vector<std::uint32_t> next(corners.first.begin(), corners.first.end() - 1);
  corners.normals.reserve(surface.triangles.size());
  for (std::uint32_t i = 0; i < surface.triangles.size(); ++i) {
    const auto& [a, b, c] = surface.triangles[i];
    const auto& v = surface.vertices;
    corners.normals.push_back((v[b] - v[a]).cross(v[c] - v[a]));
    for (const std::uint32_t corner : surface.triangles[i]) corners.triangles[next[corners.point_of[corner]]++] = i;
  }
  return corners;
}

Vec3 ShadingNormals::normal(const Hit& hit) {
  const std::uint32_t object = object_of(hit);
  if (object == kNobody || hit.triangle == kNoTriangle || shown_.objects[object].runs.empty()) return hit.normal;
  const SurfaceRun& run = shown_.objects[object].runs.front();
  if (run.is_hull || hit.triangle >= run.triangle_count) return hit.normal;
  const Corners& corners = corners_of(*run.surface);
  const std::uint32_t triangle = run.first_triangle + hit.triangle;
  const Vec3& own = corners.normals[triangle];
  Vec3 mixed = Vec3::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t point = corners.point_of[run.surface->triangles[triangle][k]];
    Vec3 about = Vec3::Zero();
    for (std::uint32_t i = corners.first[point]; i < corners.first[point + 1]; ++i) {
      const Vec3& other = corners.normals[corners.triangles[i]];
      if (other.dot(own) >= crease_cosine_ * other.norm() * own.norm()) about += other;
    }
    if (about.norm() > 0) mixed += hit.weights[static_cast<Eigen::Index>(k)] * about.normalized();
  }
  const Vec3 turned = shown_.objects[object].pose.rotation * mixed;
  // Hits have the triangle numbers of the file, which differ in a mended mesh. Then the triangle's normal is not the
  // hit's.
  const Vec3 own_turned = shown_.objects[object].pose.rotation * own;
  const bool is_same = std::abs(own_turned.dot(hit.normal)) > 0.999 * own.norm() * hit.normal.norm();
  return is_same && turned.norm() > 0 ? Vec3(turned.normalized()) : hit.normal;
}

}  // namespace collided::draw
