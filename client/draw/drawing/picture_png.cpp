#include <png.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "client/draw/drawing/picture.hpp"
#include "client/draw/svg.hpp"

namespace collided::draw {
namespace {

using Color = std::array<float, 3>;

Color color_of(const std::string& text) {
  Color color{};
  for (std::size_t k = 0; k < 3; ++k) color[k] = static_cast<float>(std::stoi(text.substr(1 + 2 * k, 2), nullptr, 16));
  return color;
}

class Raster {
 public:
  Raster(int width, int height, bool is_black_and_white)
      : width_(width),
        height_(height),
        is_black_and_white_(is_black_and_white),
        colors_(static_cast<std::size_t>(width) * height, color_of(is_black_and_white ? "#ffffff" : kPaper)),
        cover_(colors_.size(), 0) {}

  void paint(const Pixels& pixels) {
    std::vector<Color> colors;
    for (const std::string& text : pixels.colors) colors.push_back(color_of(text));
    for (int y = 0; y < std::min(height_, pixels.height); ++y) {
      for (int x = 0; x < std::min(width_, pixels.width); ++x) {
        const std::uint8_t number = pixels.numbers[static_cast<std::size_t>(y) * pixels.width + x];
        if (number != Pixels::kPaperPixel) colors_[index(x, y)] = colors[number];
      }
    }
  }

  /// Covers the pixels within half the width of a segment; those at the edge are covered in part.
  void cover(const Spot& a, const Spot& b, double width_px) {
    const double reach = width_px / 2 + 0.5;
    const double dx = b[0] - a[0];
    const double dy = b[1] - a[1];
    const double squared = dx * dx + dy * dy;
    const int top = std::max(0, static_cast<int>(std::floor(std::min(a[1], b[1]) - reach)));
    const int bottom = std::min(height_ - 1, static_cast<int>(std::ceil(std::max(a[1], b[1]) + reach)));
    for (int y = top; y <= bottom; ++y) {
      const auto [left, right] = columns(a, b, y + 0.5, reach);
      for (int x = left; x <= right; ++x) {
        const double px = x + 0.5 - a[0];
        const double py = y + 0.5 - a[1];
        const double t = squared > 0 ? std::clamp((px * dx + py * dy) / squared, 0.0, 1.0) : 0;
        const double distance = std::hypot(px - t * dx, py - t * dy);
        // A stroke thinner than a pixel is drawn a pixel wide and paler.
        double share = std::min(1.0, width_px) * std::clamp(std::max(width_px, 1.0) / 2 + 0.5 - distance, 0.0, 1.0);
        if (is_black_and_white_) share = share < 0.5 ? 0 : 1;
        if (share <= 0) continue;
        float& covered = cover_[index(x, y)];
        if (covered == 0) touched_.push_back(index(x, y));
        covered = std::max(covered, static_cast<float>(share));
      }
    }
  }

  /// Paints everything that was covered since the last call in this colour.
  void ink(const Color& color) {
    for (const std::size_t i : touched_) {
      for (std::size_t k = 0; k < 3; ++k) colors_[i][k] += cover_[i] * (color[k] - colors_[i][k]);
      cover_[i] = 0;
    }
    touched_.clear();
  }

  std::vector<png_byte> bytes() const {
    std::vector<png_byte> bytes;
    bytes.reserve(3 * colors_.size());
    for (const Color& color : colors_) {
      for (const float channel : color) bytes.push_back(static_cast<png_byte>(std::lround(channel)));
    }
    return bytes;
  }
  int width() const { return width_; }
  int height() const { return height_; }

 private:
  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y) * width_ + x; }

  /// The columns of a row that may be within `reach` of the segment.
  std::pair<int, int> columns(const Spot& a, const Spot& b, double y, double reach) const {
    double left = std::min(a[0], b[0]);
    double right = std::max(a[0], b[0]);
    const double slope = b[1] - a[1];
    if (std::abs(slope) > 1e-9) {
      const auto x_at = [&](double height) {
        return a[0] + std::clamp((height - a[1]) / slope, 0.0, 1.0) * (b[0] - a[0]);
      };
      const double above = x_at(y - reach);
      const double below = x_at(y + reach);
      left = std::min(above, below);
      right = std::max(above, below);
    }
    return {std::max(0, static_cast<int>(std::floor(left - reach))),
            std::min(width_ - 1, static_cast<int>(std::ceil(right + reach)))};
  }

  int width_;
  int height_;
  bool is_black_and_white_;
  std::vector<Color> colors_;
  std::vector<float> cover_;
  std::vector<std::size_t> touched_;
};

void cover(Raster& raster, const Stroke& stroke) {
  for (std::size_t i = 1; i < stroke.points.size(); ++i)
    raster.cover(stroke.points[i - 1], stroke.points[i], stroke.ink.width_px);
  if (stroke.points.size() == 1) raster.cover(stroke.points[0], stroke.points[0], stroke.ink.width_px);
}

void draw(Raster& raster, const CircleMark& ring) {
  constexpr int kSides = 64;
  const auto at = [&](int i) {
    const double angle = 2 * std::numbers::pi * i / kSides;
    return Spot{ring.center[0] + ring.radius_px * std::cos(angle), ring.center[1] + ring.radius_px * std::sin(angle)};
  };
  for (int i = 0; i < kSides; ++i) raster.cover(at(i), at(i + 1), ring.ink.width_px);
  raster.ink(color_of(ring.ink.color));
}

std::string compressed(const Raster& raster) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(raster.width());
  image.height = static_cast<png_uint_32>(raster.height());
  image.format = PNG_FORMAT_RGB;
  const std::vector<png_byte> bytes = raster.bytes();
  std::string text(PNG_IMAGE_PNG_SIZE_MAX(image), '\0');
  png_alloc_size_t size = text.size();
  if (png_image_write_to_memory(&image, text.data(), &size, 0, bytes.data(), 0, nullptr) == 0) return {};
  text.resize(size);
  return text;
}

}  // namespace

std::string as_png(const Picture& picture) {
  Raster raster(static_cast<int>(std::ceil(picture.width_px)), static_cast<int>(std::ceil(picture.height_px)),
                picture.is_black_and_white);
  if (picture.pixels) raster.paint(*picture.pixels);
  for (std::size_t i = 0; i < picture.strokes.size();) {
    const Ink& ink = picture.strokes[i].ink;
    for (; i < picture.strokes.size() && picture.strokes[i].ink == ink; ++i) cover(raster, picture.strokes[i]);
    raster.ink(color_of(ink.color));
  }
  for (const CircleMark& ring : picture.rings) draw(raster, ring);
  return compressed(raster);
}

}  // namespace collided::draw
