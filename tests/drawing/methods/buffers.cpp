#include "tests/drawing/methods/buffers.hpp"

#include <cmath>

namespace collided::drawing_test {

Buffers cast_buffers(const draw::Camera& camera, draw::Rays& rays) {
  Buffers buffers{static_cast<int>(camera.width_px()), static_cast<int>(camera.height_px()), {}, {}};
  std::vector<RayQuestion> questions;
  for (int y = 0; y < buffers.height; ++y) {
    for (int x = 0; x < buffers.width; ++x) questions.push_back(camera.through(x + 0.5, y + 0.5));
  }
  const std::vector<Answer> answers = rays.first_hits(questions);
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const bool is_hit = !answers[i].hits.empty();
    buffers.depth_m.push_back(is_hit ? camera.project(answers[i].hits.front().point).depth_m : INFINITY);
    Vec3 normal = is_hit ? answers[i].hits.front().normal : Vec3(Vec3::Zero());
    if (normal.dot(questions[i].direction) > 0) normal = -normal;
    buffers.normals.push_back(normal);
  }
  return buffers;
}

Polygons polygons_of(const ShownObjects& shown) {
  Polygons polygons;
  for (const ShownObject& object : shown.objects) {
    for (const SurfaceRun& run : object.runs) {
      for (std::uint32_t i = run.first_triangle; i < run.first_triangle + run.triangle_count; ++i) {
        const auto first = static_cast<std::uint32_t>(polygons.vertices.size());
        for (const std::uint32_t corner : run.surface->triangles[i]) {
          polygons.vertices.push_back(object.pose.rotation * run.surface->vertices[corner] + object.pose.position);
        }
        polygons.triangles.push_back({first, first + 1, first + 2});
      }
    }
  }
  return polygons;
}

LinePixels biased_lines(const Buffers& buffers, const draw::Camera& camera, const draw::Drawing& drawing,
                        double bias_m) {
  LinePixels pixels;
  for (const draw::Piece& piece : drawing.pieces) {
    const draw::LineSegment& segment = drawing.segments[piece.segment];
    const double length_px = (piece.to - piece.from) * segment.length_px();
    // The ends of a piece are where it goes behind something: what is there is a matter of half pixels.
    for (double s = 1; s < length_px - 1; s += 1) {
      const double fraction = piece.from + (piece.to - piece.from) * s / length_px;
      const draw::ImagePoint p = camera.project(segment.at(camera, fraction));
      if (!buffers.has(static_cast<int>(p.x), static_cast<int>(p.y))) continue;
      const double behind_m = p.depth_m - buffers.depth_m[buffers.index(static_cast<int>(p.x), static_cast<int>(p.y))];
      const bool is_drawn = behind_m <= bias_m;
      pixels.drawn += is_drawn ? 1 : 0;
      if (piece.is_seen) {
        pixels.lost += is_drawn ? 0 : 1;
        pixels.needed_m = std::max(pixels.needed_m, behind_m);
      } else {
        pixels.leaked += is_drawn ? 1 : 0;
      }
    }
  }
  return pixels;
}

}  // namespace collided::drawing_test
