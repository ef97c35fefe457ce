#include "client/draw/drawing/tones.hpp"

#include <algorithm>
#include <cmath>

#include "client/draw/drawing/shading_normals.hpp"

namespace collided::draw {
namespace {

constexpr int kCoarseStep = 4;

struct Pixel {
  bool is_known = false;
  std::uint32_t object = ShadingNormals::kNobody;
  float light = ToneMap::kNothing;
  float clearance_m = 0;
};

/// A square of pixels, by its low corner.
struct ToneCell {
  int x;
  int y;
};

class Caster {
 public:
  Caster(const ShownObjects& shown, const Camera& camera, const ToneOptions& options, Rays& rays)
      : camera_(camera),
        options_(options),
        rays_(rays),
        normals_(shown, options.crease_cosine),
        width_(static_cast<int>(camera.width_px())),
        height_(static_cast<int>(camera.height_px())),
        pixels_(static_cast<std::size_t>(width_) * height_),
        has_line_(pixels_.size(), 0) {}

  void mark(std::span<const LineSegment> lines) {
    for (const LineSegment& s : lines) {
      const int steps = 1 + static_cast<int>(s.length_px());
      for (int i = 0; i <= steps; ++i) {
        const double t = static_cast<double>(i) / steps;
        const int x = static_cast<int>(s.image_a.x + t * (s.image_b.x - s.image_a.x));
        const int y = static_cast<int>(s.image_a.y + t * (s.image_b.y - s.image_a.y));
        if (x >= 0 && y >= 0 && x < width_ && y < height_) has_line_[index(x, y)] = 1;
      }
    }
  }

  void cast() {
    std::vector<ToneCell> cells;
    for (int y = 0; y < height_; y += kCoarseStep) {
      for (int x = 0; x < width_; x += kCoarseStep) cells.push_back({x, y});
    }
    for (int step = kCoarseStep; step >= 1; step /= 2) cells = refine(cells, step);
  }

  ToneMap map() const {
    ToneMap map{width_, height_, {}, {}};
    for (const Pixel& pixel : pixels_) {
      map.light.push_back(pixel.light);
      map.numbers.push_back(number_of(pixel));
    }
    return map;
  }

 private:
  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y) * width_ + x; }

  bool is_measured(std::uint32_t object) const {
    return options_.clearance && object != ShadingNormals::kNobody && options_.clearance->is_measured[object] != 0;
  }

  std::uint8_t number_of(const Pixel& pixel) const {
    if (pixel.light == ToneMap::kNothing) return Pixels::kPaperPixel;
    if (!is_measured(pixel.object)) return static_cast<std::uint8_t>(tone_of(pixel.light, options_.tones));
    const ClearanceRamp& ramp = *options_.clearance;
    const int band = static_cast<int>(std::min(1.0, pixel.clearance_m / ramp.reach_m) * ramp.bands);
    return static_cast<std::uint8_t>(options_.tones + std::min(band, ramp.bands - 1));
  }

  /// Casts rays through the corners of cells. Fills the cells whose corners are alike; returns the quarters of the
  /// others.
  std::vector<ToneCell> refine(const std::vector<ToneCell>& cells, int step) {
    std::vector<std::size_t> asked;
    for (const ToneCell& cell : cells) {
      for (const auto& [x, y] : corners(cell, step)) {
        Pixel& pixel = pixels_[index(x, y)];
        if (!pixel.is_known) asked.push_back(index(x, y));
        pixel.is_known = true;
      }
    }
    look(asked);
    std::vector<ToneCell> quarters;
    if (step == 1) return quarters;
    for (const ToneCell& cell : cells) {
      if (fill(cell, step)) continue;
      for (int dy = 0; dy < step; dy += step / 2) {
        for (int dx = 0; dx < step; dx += step / 2) {
          if (cell.x + dx < width_ && cell.y + dy < height_) quarters.push_back({cell.x + dx, cell.y + dy});
        }
      }
    }
    return quarters;
  }

  std::array<std::pair<int, int>, 4> corners(const ToneCell& cell, int step) const {
    const int right = std::min(cell.x + step, width_ - 1);
    const int low = std::min(cell.y + step, height_ - 1);
    return {{{cell.x, cell.y}, {right, cell.y}, {cell.x, low}, {right, low}}};
  }

  /// Fills a cell whose corners have the same number, with light interpolated between them. The pixels between have
  /// that number too, since each number represents an interval of light. False if the corners differ or a line passes.
  bool fill(const ToneCell& cell, int step) {
    const auto corner = corners(cell, step);
    std::array<const Pixel*, 4> p{};
    for (std::size_t i = 0; i < 4; ++i) p[i] = &pixels_[index(corner[i].first, corner[i].second)];
    for (std::size_t i = 1; i < 4; ++i) {
      if (p[i]->object != p[0]->object || number_of(*p[i]) != number_of(*p[0]) ||
          std::abs(p[i]->light - p[0]->light) > 0.3F)
        return false;
    }
    for (int y = cell.y; y <= corner[3].second; ++y) {
      for (int x = cell.x; x <= corner[3].first; ++x) {
        if (has_line_[index(x, y)] != 0) return false;
      }
    }
    const Pixel low_left = *p[0], low_right = *p[1], high_left = *p[2], high_right = *p[3];
    for (int y = cell.y; y <= corner[3].second; ++y) {
      for (int x = cell.x; x <= corner[3].first; ++x) {
        Pixel& pixel = pixels_[index(x, y)];
        if (pixel.is_known) continue;
        const float u = static_cast<float>(x - cell.x) / static_cast<float>(step);
        const float v = static_cast<float>(y - cell.y) / static_cast<float>(step);
        const auto mixed = [&](float Pixel::*value) {
          return (1 - v) * ((1 - u) * low_left.*value + u * low_right.*value) +
                 v * ((1 - u) * high_left.*value + u * high_right.*value);
        };
        pixel = {
            false, low_left.object,
            low_left.object == ShadingNormals::kNobody && low_left.light < 0 ? ToneMap::kNothing : mixed(&Pixel::light),
            mixed(&Pixel::clearance_m)};
      }
    }
    return true;
  }

  void look(const std::vector<std::size_t>& asked) {
    std::vector<RayQuestion> questions;
    for (const std::size_t i : asked) {
      const std::size_t row = i / width_;
      questions.push_back(camera_.through(static_cast<double>(i % width_) + 0.5, static_cast<double>(row) + 0.5));
    }
    const std::vector<Answer> answers = rays_.first_hits(questions);
    std::vector<NearQuestion> measured;
    std::vector<std::size_t> whose;
    for (std::size_t k = 0; k < asked.size(); ++k) {
      if (answers[k].hits.empty()) continue;
      const Hit& hit = answers[k].hits.front();
      Pixel& pixel = pixels_[asked[k]];
      pixel.object = normals_.object_of(hit);
      Vec3 normal = normals_.normal(hit);
      if (normal.dot(questions[k].direction) > 0) normal = -normal;
      pixel.light = static_cast<float>(std::clamp(normal.dot(options_.toward_light), 0.0, 1.0));
      if (!is_measured(pixel.object)) continue;
      measured.push_back({hit.point, options_.clearance->reach_m});
      whose.push_back(asked[k]);
    }
    if (measured.empty()) return;
    const std::vector<Answer> nearest = rays_.nearest(measured, options_.clearance->name_glob);
    for (std::size_t k = 0; k < whose.size(); ++k) {
      const bool is_near = !nearest[k].hits.empty();
      pixels_[whose[k]].clearance_m =
          static_cast<float>(is_near ? nearest[k].hits.front().distance_m : options_.clearance->reach_m);
    }
  }

  const Camera& camera_;
  const ToneOptions& options_;
  Rays& rays_;
  ShadingNormals normals_;
  int width_;
  int height_;
  std::vector<Pixel> pixels_;
  std::vector<std::uint8_t> has_line_;
};

}  // namespace

int tone_of(double light, int tones) { return std::clamp(static_cast<int>(light * tones), 0, tones - 1); }

ToneMap cast_tones(const ShownObjects& shown, const Camera& camera, std::span<const LineSegment> lines,
                   const ToneOptions& options, Rays& rays) {
  Caster caster(shown, camera, options, rays);
  caster.mark(lines);
  caster.cast();
  return caster.map();
}

}  // namespace collided::draw
