#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace collided::draw {

/// A point of a picture.
using Spot = std::array<double, 2>;  // pixels, y downward

/// How a stroke is drawn. All strokes of one ink make one mark, which is no darker where they overlap.
struct Ink {
  std::string name;   // its meaning; the class in SVG
  std::string color;  // #rrggbb
  double width_px = 1;
  bool operator==(const Ink&) const = default;
};

struct Stroke {
  std::vector<Spot> points;
  Ink ink;
};

struct CircleMark {
  Spot center{};
  double radius_px = 0;
  Ink ink{};
};

/// A colour for each pixel, by its number in `colors`; kPaperPixel: none.
struct Pixels {
  static constexpr std::uint8_t kPaperPixel = 255;
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> numbers;  // row by row
  std::vector<std::string> colors;    // #rrggbb
};

/// A finished drawing: pixels below, then strokes and rings in their order.
struct Picture {
  double width_px = 0;
  double height_px = 0;
  std::string title{};
  bool is_black_and_white = false;  // for print: white paper, and no grey along the strokes
  std::optional<Pixels> pixels{};
  std::vector<Stroke> strokes{};
  std::vector<CircleMark> rings{};
};

/// The picture as SVG: one path for each ink, pixels as rectangles without gaps. The same picture gives the same bytes.
std::string as_svg(const Picture& picture);

/// The picture as PNG, with strokes anti-aliased by each pixel's distance from their middle. Empty if libpng fails.
std::string as_png(const Picture& picture);

/// The strokes as text in braille: a dot for a pixel, two across and four down for each character. Lines end with "\n".
std::string as_braille(const Picture& picture);

}  // namespace collided::draw
