#pragma once

#include <cstdint>
#include <vector>

#include "client/draw/drawing/drawing.hpp"

namespace collided::drawing_test {

/// What a graphics card would have drawn, cast by the service's rays: one through the middle of each pixel.
struct Buffers {
  int width = 0;
  int height = 0;
  std::vector<double> depth_m;  // along the camera's axis; infinite where nothing is
  std::vector<Vec3> normals;    // turned to the eye

  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y) * width + x; }
  bool has(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
};
Buffers cast_buffers(const draw::Camera& camera, draw::Rays& rays);

/// Pixels that are black.
struct Mask {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> black;

  Mask(int mask_width, int mask_height)
      : width(mask_width), height(mask_height), black(static_cast<std::size_t>(mask_width) * mask_height, 0) {}
  bool at(double x, double y) const {
    if (!(x >= 0 && y >= 0 && x < width && y < height)) return false;
    return black[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)] != 0;
  }
};

/// Triangles in the world.
struct Polygons {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};
/// Every surface that is shown, each triangle with three vertices of its own.
Polygons polygons_of(const ShownObjects& shown);

/// A72: pixels of lines, drawn where they are at most bias_m behind what the depth buffer has there.
struct LinePixels {
  std::size_t drawn = 0;
  std::size_t lost = 0;    // of lines that are seen: not drawn
  std::size_t leaked = 0;  // of lines that are hidden: drawn all the same
  double needed_m = 0;     // the least bias that loses none
};
LinePixels biased_lines(const Buffers& buffers, const draw::Camera& camera, const draw::Drawing& drawing,
                        double bias_m);

}  // namespace collided::drawing_test
