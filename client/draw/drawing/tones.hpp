#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "client/draw/drawing/picture.hpp"
#include "client/draw/drawing/sight.hpp"

namespace collided::draw {

/// Colours some objects by their distance to all objects with other names.
struct ClearanceRamp {
  std::vector<std::uint8_t> is_measured;  // matches the names of coloured objects
  std::string name_glob;                  // matches the names of those that are coloured
  double reach_m = 1;                     // distances beyond it are in the last band
  int bands = 8;
};

/// How surfaces are shaded.
struct ToneOptions {
  int tones = 2;
  Vec3 toward_light = Vec3::UnitZ();  // of unit length, in the world
  double crease_cosine = 0.5;
  std::optional<ClearanceRamp> clearance{};
};

/// The light and the tone at the middle of each pixel.
struct ToneMap {
  static constexpr float kNothing = -1;
  int width = 0;
  int height = 0;
  std::vector<float> light;           // n . l, where n faces the eye, at least 0; kNothing: there is no surface
  std::vector<std::uint8_t> numbers;  // tone, or number of tones + clearance band; Pixels::kPaperPixel: nothing
};

/// The tone, from 0 to k - 1, for a light n . l: 0 below 1/k, also for negative values.
int tone_of(double light, int tones);

/// Computes the tones with rays through every fourth pixel, and through the pixels between if neighbours differ or a
/// line passes. So tones change exactly at the pixel where n . l crosses a threshold, unless a shape is only a few
/// pixels large.
/// lines  of the picture; every pixel on them gets a ray
ToneMap cast_tones(const ShownObjects& shown, const Camera& camera, std::span<const LineSegment> lines,
                   const ToneOptions& options, Rays& rays);

/// Hatching lines for the tones, as polylines. There are 16 sets of lines, the second 8 across the first. Each set has
/// its own threshold and is drawn wherever the light is below it, so that darker places have at least as much ink.
/// source  Praun, Hoppe, Webb, Finkelstein, "Real-Time Hatching", 2001 (tonal art maps: dark tones keep the strokes of
///         light ones)
std::vector<std::vector<Spot>> hatching(const ToneMap& map, double spacing_px);

}  // namespace collided::draw
