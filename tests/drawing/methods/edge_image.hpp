#pragma once

#include "tests/drawing/methods/buffers.hpp"

namespace collided::drawing_test {

/// A69: a pixel is an edge where its neighbours' depths do not lie in one plane with its own, or their normals differ.
/// source  Saito, Takahashi, "Comprehensible Rendering of 3-D Shapes", 1990
///
/// crease_cosine  of the angle between two neighbours' normals
/// bend_px        how far from one plane, in lengths of a pixel
Mask edge_image(const Buffers& buffers, const draw::Camera& camera, double crease_cosine, double bend_px);

/// Of the places along the lines that are seen (each pixel of their length), how many have a black pixel within a
/// pixel's distance; and of the black pixels, how many have such a line within two.
struct Agreement {
  std::size_t line_pixels = 0;
  std::size_t found = 0;
  std::size_t black_pixels = 0;
  std::size_t justified = 0;
  double recall() const { return static_cast<double>(found) / static_cast<double>(line_pixels); }
  double precision() const { return static_cast<double>(justified) / static_cast<double>(black_pixels); }
};
Agreement agreement(const Mask& mask, const draw::Drawing& drawing);

/// How wide the black is across the silhouette, at every pixel of its length but near its ends; 0 where there is none.
/// One place of a line of pixels is off by its steps; the mean of a line is not.
struct Widths {
  std::vector<double> px;             // ascending
  std::vector<double> line_means_px;  // of each piece
  double mean_px() const;
  double least_px() const { return px.front(); }
  double most_px() const { return px.back(); }
  /// The standard deviation in shares of the mean.
  double spread() const;
};
Widths widths_across_silhouette(const Mask& mask, const draw::Drawing& drawing, double from_ends_px, double reach_px);

/// About each end of a silhouette line, at this distance and where nothing is: the longest arc that is not black, in
/// pixels.
double widest_gap_px(const Mask& mask, const Buffers& buffers, const draw::Drawing& drawing, double radius_px);

}  // namespace collided::drawing_test
